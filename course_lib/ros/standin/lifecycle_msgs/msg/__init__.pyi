# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._state import State as State
from ._transition import Transition as Transition
from ._transition_description import TransitionDescription as TransitionDescription
from ._transition_event import TransitionEvent as TransitionEvent
