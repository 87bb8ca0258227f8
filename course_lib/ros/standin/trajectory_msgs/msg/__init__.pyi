# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._joint_trajectory import JointTrajectory as JointTrajectory
from ._joint_trajectory_point import JointTrajectoryPoint as JointTrajectoryPoint
from ._multi_dof_joint_trajectory import MultiDOFJointTrajectory as MultiDOFJointTrajectory
from ._multi_dof_joint_trajectory_point import MultiDOFJointTrajectoryPoint as MultiDOFJointTrajectoryPoint
