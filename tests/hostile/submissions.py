"""All of the hostile and broken submissions."""

from tests.hostile.escapes import ESCAPES
from tests.hostile.mistakes import MISTAKES
from tests.hostile.resources import RESOURCES
from tests.hostile.tampering import TAMPERING

ALL = (*RESOURCES, *ESCAPES, *TAMPERING, *MISTAKES)
