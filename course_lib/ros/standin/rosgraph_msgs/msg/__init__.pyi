# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._clock import Clock as Clock
