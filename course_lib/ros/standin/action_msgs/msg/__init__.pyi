# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._goal_info import GoalInfo as GoalInfo
from ._goal_status import GoalStatus as GoalStatus
from ._goal_status_array import GoalStatusArray as GoalStatusArray
