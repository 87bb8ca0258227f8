# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
import std_msgs.msg
import trajectory_msgs.msg

class GripperCommand(Message):
    position: float
    max_effort: float
    def __init__(
        self,
        *,
        position: float = ...,
        max_effort: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class JointComponentTolerance(Message):
    X_AXIS: Final = 1
    Y_AXIS: Final = 2
    Z_AXIS: Final = 3
    TRANSLATION: Final = 4
    ROTATION: Final = 5
    joint_name: str
    component: int
    position: float
    velocity: float
    acceleration: float
    def __init__(
        self,
        *,
        joint_name: str = ...,
        component: int = ...,
        position: float = ...,
        velocity: float = ...,
        acceleration: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class JointTolerance(Message):
    name: str
    position: float
    velocity: float
    acceleration: float
    def __init__(
        self,
        *,
        name: str = ...,
        position: float = ...,
        velocity: float = ...,
        acceleration: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class JointTrajectoryControllerState(Message):
    header: std_msgs.msg.Header
    joint_names: list[str]
    reference: trajectory_msgs.msg.JointTrajectoryPoint
    feedback: trajectory_msgs.msg.JointTrajectoryPoint
    error: trajectory_msgs.msg.JointTrajectoryPoint
    output: trajectory_msgs.msg.JointTrajectoryPoint
    multi_dof_joint_names: list[str]
    multi_dof_reference: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    multi_dof_feedback: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    multi_dof_error: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    multi_dof_output: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint
    speed_scaling_factor: float
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        joint_names: list[str] = ...,
        reference: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        feedback: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        error: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        output: trajectory_msgs.msg.JointTrajectoryPoint = ...,
        multi_dof_joint_names: list[str] = ...,
        multi_dof_reference: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        multi_dof_feedback: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        multi_dof_error: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        multi_dof_output: trajectory_msgs.msg.MultiDOFJointTrajectoryPoint = ...,
        speed_scaling_factor: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
