# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._duration import Duration as Duration
from ._time import Time as Time
