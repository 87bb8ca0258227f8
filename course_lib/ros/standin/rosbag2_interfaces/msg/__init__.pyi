# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._read_split_event import ReadSplitEvent as ReadSplitEvent
from ._write_split_event import WriteSplitEvent as WriteSplitEvent
