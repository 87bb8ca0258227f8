# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._uuid import UUID as UUID
