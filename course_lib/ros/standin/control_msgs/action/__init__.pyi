# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final
from typing import TypeAlias

from course_lib.ros.messages.message import Message
import action_msgs.msg
import action_msgs.srv
import builtin_interfaces.msg
import control_msgs.action
import control_msgs.msg
import std_msgs.msg
import trajectory_msgs.msg
import unique_identifier_msgs.msg

class FollowJointTrajectory_Feedback(Message):
    header: std_msgs.msg.Header
    joint_names: list[str]
    desired: trajectory_msgs.msg.JointTrajectoryPoint
    actual: trajectory_msgs.msg.JointTrajectoryPoint
    error: trajectory_msgs.msg.JointTrajectoryPoint
    multi_dof_joint_names: list[str]
    multi_dof_desired: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    multi_dof_actual: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    multi_dof_error: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        joint_names: list[str] = ...,
        desired: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        actual: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        error: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        multi_dof_joint_names: list[str] = ...,
        multi_dof_desired: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        multi_dof_actual: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        multi_dof_error: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_FeedbackMessage(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    feedback: control_msgs.action.FollowJointTrajectory_Feedback
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        feedback: control_msgs.action.FollowJointTrajectory_Feedback = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_GetResult_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_GetResult_Response(Message):
    status: int
    result: control_msgs.action.FollowJointTrajectory_Result
    def __init__(
        self,
        *,
        status: int = ...,
        result: control_msgs.action.FollowJointTrajectory_Result = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_Goal(Message):
    trajectory: trajectory_msgs.msg.JointTrajectory
    multi_dof_trajectory: trajectory_msgs.msg.MultiDOFJointTrajectory
    path_tolerance: list[control_msgs.msg.JointTolerance]
    component_path_tolerance: list[control_msgs.msg.JointComponentTolerance]
    goal_tolerance: list[control_msgs.msg.JointTolerance]
    component_goal_tolerance: list[control_msgs.msg.JointComponentTolerance]
    goal_time_tolerance: builtin_interfaces.msg.Duration
    def __init__(
        self,
        *,
        trajectory: trajectory_msgs.msg.JointTrajectory = ...,
        multi_dof_trajectory: trajectory_msgs.msg.MultiDOFJointTrajectory = ...,
        path_tolerance: list[control_msgs.msg.JointTolerance] = ...,
        component_path_tolerance: list[control_msgs.msg.JointComponentTolerance] = ...,
        goal_tolerance: list[control_msgs.msg.JointTolerance] = ...,
        component_goal_tolerance: list[control_msgs.msg.JointComponentTolerance] = ...,
        goal_time_tolerance: builtin_interfaces.msg.Duration = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_Result(Message):
    SUCCESSFUL: Final = 0
    INVALID_GOAL: Final = -1
    INVALID_JOINTS: Final = -2
    OLD_HEADER_TIMESTAMP: Final = -3
    PATH_TOLERANCE_VIOLATED: Final = -4
    GOAL_TOLERANCE_VIOLATED: Final = -5
    error_code: int
    error_string: str
    def __init__(
        self,
        *,
        error_code: int = ...,
        error_string: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_SendGoal_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    goal: control_msgs.action.FollowJointTrajectory_Goal
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        goal: control_msgs.action.FollowJointTrajectory_Goal = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_SendGoal_Response(Message):
    accepted: bool
    stamp: builtin_interfaces.msg.Time
    def __init__(
        self,
        *,
        accepted: bool = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_Feedback(Message):
    position: float
    effort: float
    stalled: bool
    reached_goal: bool
    def __init__(
        self,
        *,
        position: float = ...,
        effort: float = ...,
        stalled: bool = ...,
        reached_goal: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_FeedbackMessage(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    feedback: control_msgs.action.GripperCommand_Feedback
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        feedback: control_msgs.action.GripperCommand_Feedback = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_GetResult_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_GetResult_Response(Message):
    status: int
    result: control_msgs.action.GripperCommand_Result
    def __init__(
        self,
        *,
        status: int = ...,
        result: control_msgs.action.GripperCommand_Result = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_Goal(Message):
    command: control_msgs.msg.GripperCommand
    def __init__(
        self,
        *,
        command: control_msgs.msg.GripperCommand = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_Result(Message):
    position: float
    effort: float
    stalled: bool
    reached_goal: bool
    def __init__(
        self,
        *,
        position: float = ...,
        effort: float = ...,
        stalled: bool = ...,
        reached_goal: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_SendGoal_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    goal: control_msgs.action.GripperCommand_Goal
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        goal: control_msgs.action.GripperCommand_Goal = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GripperCommand_SendGoal_Response(Message):
    accepted: bool
    stamp: builtin_interfaces.msg.Time
    def __init__(
        self,
        *,
        accepted: bool = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        check_fields: bool = ...,
    ) -> None: ...

class FollowJointTrajectory_GetResult:
    Request: TypeAlias = FollowJointTrajectory_GetResult_Request
    Response: TypeAlias = FollowJointTrajectory_GetResult_Response

class FollowJointTrajectory_SendGoal:
    Request: TypeAlias = FollowJointTrajectory_SendGoal_Request
    Response: TypeAlias = FollowJointTrajectory_SendGoal_Response

class GripperCommand_GetResult:
    Request: TypeAlias = GripperCommand_GetResult_Request
    Response: TypeAlias = GripperCommand_GetResult_Response

class GripperCommand_SendGoal:
    Request: TypeAlias = GripperCommand_SendGoal_Request
    Response: TypeAlias = GripperCommand_SendGoal_Response

class FollowJointTrajectory:
    Goal: TypeAlias = FollowJointTrajectory_Goal
    Result: TypeAlias = FollowJointTrajectory_Result
    Feedback: TypeAlias = FollowJointTrajectory_Feedback
    class Impl:
        SendGoalService: TypeAlias = FollowJointTrajectory_SendGoal
        GetResultService: TypeAlias = FollowJointTrajectory_GetResult
        FeedbackMessage: TypeAlias = FollowJointTrajectory_FeedbackMessage
        CancelGoalService: TypeAlias = action_msgs.srv.CancelGoal
        GoalStatusMessage: TypeAlias = action_msgs.msg.GoalStatusArray

class GripperCommand:
    Goal: TypeAlias = GripperCommand_Goal
    Result: TypeAlias = GripperCommand_Result
    Feedback: TypeAlias = GripperCommand_Feedback
    class Impl:
        SendGoalService: TypeAlias = GripperCommand_SendGoal
        GetResultService: TypeAlias = GripperCommand_GetResult
        FeedbackMessage: TypeAlias = GripperCommand_FeedbackMessage
        CancelGoalService: TypeAlias = action_msgs.srv.CancelGoal
        GoalStatusMessage: TypeAlias = action_msgs.msg.GoalStatusArray
