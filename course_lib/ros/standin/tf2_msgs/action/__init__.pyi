# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message
import action_msgs.msg
import action_msgs.srv
import builtin_interfaces.msg
import geometry_msgs.msg
import tf2_msgs.action
import tf2_msgs.msg
import unique_identifier_msgs.msg

class LookupTransform_Feedback(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class LookupTransform_FeedbackMessage(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    feedback: tf2_msgs.action.LookupTransform_Feedback
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        feedback: tf2_msgs.action.LookupTransform_Feedback = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_GetResult_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_GetResult_Response(Message):
    status: int
    result: tf2_msgs.action.LookupTransform_Result
    def __init__(
        self,
        *,
        status: int = ...,
        result: tf2_msgs.action.LookupTransform_Result = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_Goal(Message):
    target_frame: str
    source_frame: str
    source_time: builtin_interfaces.msg.Time
    timeout: builtin_interfaces.msg.Duration
    target_time: builtin_interfaces.msg.Time
    fixed_frame: str
    advanced: bool
    def __init__(
        self,
        *,
        target_frame: str = ...,
        source_frame: str = ...,
        source_time: builtin_interfaces.msg.Time = ...,
        timeout: builtin_interfaces.msg.Duration = ...,
        target_time: builtin_interfaces.msg.Time = ...,
        fixed_frame: str = ...,
        advanced: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_Result(Message):
    transform: geometry_msgs.msg.TransformStamped
    error: tf2_msgs.msg.TF2Error
    def __init__(
        self,
        *,
        transform: geometry_msgs.msg.TransformStamped = ...,
        error: tf2_msgs.msg.TF2Error = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_SendGoal_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    goal: tf2_msgs.action.LookupTransform_Goal
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        goal: tf2_msgs.action.LookupTransform_Goal = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_SendGoal_Response(Message):
    accepted: bool
    stamp: builtin_interfaces.msg.Time
    def __init__(
        self,
        *,
        accepted: bool = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LookupTransform_GetResult:
    Request: TypeAlias = LookupTransform_GetResult_Request
    Response: TypeAlias = LookupTransform_GetResult_Response

class LookupTransform_SendGoal:
    Request: TypeAlias = LookupTransform_SendGoal_Request
    Response: TypeAlias = LookupTransform_SendGoal_Response

class LookupTransform:
    Goal: TypeAlias = LookupTransform_Goal
    Result: TypeAlias = LookupTransform_Result
    Feedback: TypeAlias = LookupTransform_Feedback
    class Impl:
        SendGoalService: TypeAlias = LookupTransform_SendGoal
        GetResultService: TypeAlias = LookupTransform_GetResult
        FeedbackMessage: TypeAlias = LookupTransform_FeedbackMessage
        CancelGoalService: TypeAlias = action_msgs.srv.CancelGoal
        GoalStatusMessage: TypeAlias = action_msgs.msg.GoalStatusArray
