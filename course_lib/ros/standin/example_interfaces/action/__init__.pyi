# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any
from typing import TypeAlias

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import action_msgs.msg
import action_msgs.srv
import builtin_interfaces.msg
import example_interfaces.action
import unique_identifier_msgs.msg

class Fibonacci_Feedback(Message):
    @property
    def sequence(self) -> array[int]: ...
    @sequence.setter
    def sequence(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(self, *, sequence: Sequence[int] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...

class Fibonacci_FeedbackMessage(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    feedback: example_interfaces.action.Fibonacci_Feedback
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        feedback: example_interfaces.action.Fibonacci_Feedback = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Fibonacci_GetResult_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Fibonacci_GetResult_Response(Message):
    status: int
    result: example_interfaces.action.Fibonacci_Result
    def __init__(
        self,
        *,
        status: int = ...,
        result: example_interfaces.action.Fibonacci_Result = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Fibonacci_Goal(Message):
    order: int
    def __init__(self, *, order: int = ..., check_fields: bool = ...) -> None: ...

class Fibonacci_Result(Message):
    @property
    def sequence(self) -> array[int]: ...
    @sequence.setter
    def sequence(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(self, *, sequence: Sequence[int] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...

class Fibonacci_SendGoal_Request(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    goal: example_interfaces.action.Fibonacci_Goal
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        goal: example_interfaces.action.Fibonacci_Goal = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Fibonacci_SendGoal_Response(Message):
    accepted: bool
    stamp: builtin_interfaces.msg.Time
    def __init__(
        self,
        *,
        accepted: bool = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Fibonacci_GetResult:
    Request: TypeAlias = Fibonacci_GetResult_Request
    Response: TypeAlias = Fibonacci_GetResult_Response

class Fibonacci_SendGoal:
    Request: TypeAlias = Fibonacci_SendGoal_Request
    Response: TypeAlias = Fibonacci_SendGoal_Response

class Fibonacci:
    Goal: TypeAlias = Fibonacci_Goal
    Result: TypeAlias = Fibonacci_Result
    Feedback: TypeAlias = Fibonacci_Feedback
    class Impl:
        SendGoalService: TypeAlias = Fibonacci_SendGoal
        GetResultService: TypeAlias = Fibonacci_GetResult
        FeedbackMessage: TypeAlias = Fibonacci_FeedbackMessage
        CancelGoalService: TypeAlias = action_msgs.srv.CancelGoal
        GoalStatusMessage: TypeAlias = action_msgs.msg.GoalStatusArray
