"""Action types have the structure that rosidl generates."""

import pytest
from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from control_msgs.action import FollowJointTrajectory
from example_interfaces.action import Fibonacci
from unique_identifier_msgs.msg import UUID

from course_lib.ros.messages import action_class, deserialize, serialize


def test_action_goal_result_and_feedback_agree_with_ros() -> None:
    goal = Fibonacci.Goal(order=5)
    assert repr(goal) == "example_interfaces.action.Fibonacci_Goal(order=5)"
    assert Fibonacci.Goal.__module__ == Fibonacci.__module__ == "example_interfaces.action._fibonacci"
    assert repr(Fibonacci.Feedback(sequence=[0, 1]).sequence) == "array('i', [0, 1])"


def test_generated_types_of_an_action_agree_with_rosidl() -> None:
    request = Fibonacci.Impl.SendGoalService.Request(goal=Fibonacci.Goal(order=3))
    assert repr(request).startswith("example_interfaces.action.Fibonacci_SendGoal_Request(goal_id=")
    assert Fibonacci.Impl.GetResultService.Response.get_fields_and_field_types() == {
        "status": "int8",
        "result": "example_interfaces/Fibonacci_Result",
    }
    feedback = Fibonacci.Impl.FeedbackMessage(goal_id=UUID(uuid=range(16)), feedback=Fibonacci.Feedback())
    assert deserialize(serialize(feedback), Fibonacci.Impl.FeedbackMessage) == feedback
    assert Fibonacci.Impl.CancelGoalService is CancelGoal
    assert Fibonacci.Impl.GoalStatusMessage is GoalStatusArray


def test_action_class_cannot_be_instantiated() -> None:
    with pytest.raises(NotImplementedError, match=r"^Action classes can not be instantiated$"):
        Fibonacci()


def test_constants_belong_to_their_goal_result_or_feedback() -> None:
    assert FollowJointTrajectory.Result.GOAL_TOLERANCE_VIOLATED == -5
    assert action_class("control_msgs/action/FollowJointTrajectory") is FollowJointTrajectory
