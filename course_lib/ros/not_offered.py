"""ROS software that a kit without ROS can't offer, and what does its work here."""

import re
from dataclasses import dataclass

_ELSEWHERE = "or run it on a computer with ROS 2 and link to that: course run FILE --robot tcp/HOST:7447"


@dataclass(frozen=True)
class _NotOffered:
    """Packages of one project; `names` matches their whole names, `instead` goes behind "Here"."""

    names: str
    reason: str
    instead: str


_NOT_OFFERED = (
    _NotOffered(
        r"gazebo_(?!msgs)\w+|ros_(gz|ign)(_\w+)?|(gz|ign)_ros2_control",
        "Gazebo is a simulator of compiled programs",
        "World, LaserScanNode and CameraNode of course_lib.sensors simulate",
    ),
    _NotOffered(
        r"webots_\w+",
        "Webots is a simulator of compiled programs",
        "World, LaserScanNode and CameraNode of course_lib.sensors simulate",
    ),
    _NotOffered(
        r"moveit(_(?!msgs)\w+)?",
        "MoveIt plans in compiled programs",
        "course_lib.robots has inverse kinematics, straight_line and JointTrajectoryController",
    ),
    _NotOffered(
        r"nav2_(?!msgs|common)\w+|slam_toolbox|cartographer_ros|robot_localization",
        "navigation runs in compiled servers",
        "a node of your own can publish maps, paths and goals",
    ),
    _NotOffered(
        r"controller_manager|ros2_control(_\w+)?|ros2_controllers|hardware_interface|joint_state_broadcaster|"
        r"(joint_trajectory|diff_drive|forward_command|mecanum_drive)_controller",
        "ros2_control is made of compiled plugins",
        "course_lib.robots has JointTrajectoryController and OmniBase",
    ),
    _NotOffered(
        r"demo_nodes_cpp(_native)?|composition|image_tools|intra_process_demo|dummy_robot_bringup",
        "the demos in C++ are compiled programs",
        "demo_nodes_py has talker, listener, add_two_ints_server and add_two_ints_client",
    ),
    _NotOffered(
        r"usb_cam|v4l2_camera|urg_node2?|[rs]llidar_ros2?|rplidar_ros|realsense2_camera|velodyne(_\w+)?|"
        r"ydlidar_ros2_driver|micro_ros_agent|ur_robot_driver|turtlebot3_(node|bringup)",
        "a driver runs beside its device",
        "the nodes of course_lib.sensors and a bag of the device publish the same messages",
    ),
)


def not_offered(package: str) -> str:
    """Return the reason for a package to be missing, and what to do; "" for other packages."""
    for one in _NOT_OFFERED:
        if re.fullmatch(one.names, package):
            return f"{one.reason}, which pip can't install. Here {one.instead}; {_ELSEWHERE}."
    return ""
