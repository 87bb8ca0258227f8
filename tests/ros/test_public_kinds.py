"""Each kind of program, launch file, workspace and recording that once failed, with its outcome in ROS 2.

The kinds are those of public repositories and bug reports.
A row is what a student has and types; tests of the rooms try the variants of each.
"""

import io
import os
import shlex
import struct
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from PIL import Image

from tests.warm import run_course

MANIFEST = "<package format='3'><name>{}</name><version>0.0.1</version></package>"
XACRO = 'xmlns:xacro="http://wiki.ros.org/xacro"'
TRIANGLE = bytes(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
LAUNCH = """from launch import LaunchDescription
from launch.actions import LogInfo
from launch.substitutions import Command
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([{}])
"""
TALKER = """import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("n")
publisher = node.create_publisher(String, "chatter", 1)
node.create_timer(0.1, lambda: publisher.publish(String(data="hello")))
rclpy.spin(node)
"""
NOTEBOOK = """from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
shell.run_line_magic("load_ext", "course_lib")
for line in {}:
    shell.run_cell(line)
"""


def blue_png() -> bytes:
    """Return a PNG of one blue pixel."""
    written = io.BytesIO()
    Image.new("RGB", (1, 1), (0, 0, 255)).save(written, "PNG")
    return written.getvalue()


@dataclass(frozen=True)
class Kind:
    """Files, the commands that use them, and the expected output strings in order."""

    commands: tuple[str, ...]
    shows: tuple[str, ...]
    files: dict[str, str | bytes] = field(default_factory=dict)
    lacks: tuple[str, ...] = ("Traceback",)


def program(source: str, *shows: str, run: str = "course run p.py --seconds 3") -> Kind:
    """Return the kind of a single program."""
    return Kind((run,), shows, {"p.py": source})


KINDS = {
    "let in an include": Kind(
        ("course run o.launch.xml", "course run o.launch.yaml"),
        ("[launch.user]: from b", "[launch.user]: from c"),
        {
            "i.launch.xml": '<launch><arg name="a" default="x"/><log message="from $(var a)"/></launch>',
            "o.launch.xml": '<launch><include file="$(dirname)/i.launch.xml"><let name="a" value="b"/>'
            "</include></launch>",
            "o.launch.yaml": "launch:\n- include:\n    file: $(dirname)/i.launch.xml\n    let:\n"
            "    - {name: a, value: c}\n",
        },
    ),
    "description with a colon and without a value type": Kind(
        ("course run d.launch.py --seconds 1",),
        ("Unable to parse the value of parameter robot_description as yaml", "ParameterValue", "d.launch.py"),
        {
            "r.xacro": f"<robot name='r' {XACRO}><!-- licence: MIT --><link name='a'/></robot>",
            "d.launch.py": LAUNCH.format(
                "Node(package='robot_state_publisher', executable='robot_state_publisher',"
                " parameters=[{'robot_description': Command(['xacro r.xacro'])}])"
            ),
        },
    ),
    "whole numbers in fields of doubles": program(
        "from sensor_msgs.msg import JointState, LaserScan\nstate, scan = JointState(), LaserScan()\n"
        "state.velocity, scan.intensities = [1, 0.5], [3, 4]\nprint(state.velocity, scan.intensities)\n",
        "array('d', [1.0, 0.5]) array('f', [3.0, 4.0])",
    ),
    "textured mesh of meshcat": Kind(
        ("python p.py",),
        ("drawn True", "page True"),
        {
            "t.png": blue_png(),
            "p.py": "import course_lib\nfrom course_lib import Viewer\nimport meshcat.geometry as g\n"
            "viewer = Viewer()\ntexture = g.ImageTexture(image=g.PngImage.from_file('t.png'))\n"
            "viewer.meshcat['a'].set_object(g.Mesh(g.Box([3, 3, 3]), g.MeshLambertMaterial(map=texture)))\n"
            "import io\nfrom PIL import Image\nfrom course_lib.viewer.renderer import draw\n"
            "pixels = Image.open(io.BytesIO(draw(viewer.scene, (64, 48)))).convert('RGB').getdata()\n"
            "print('drawn', sum(blue > 2 * red and blue > 60 for red, _, blue in pixels) > 50)\n"
            "print('page', '<html' in viewer.meshcat.static_html())\n",
        },
    ),
    "creation on a destroyed node and after shutdown": program(
        "import rclpy\nfrom std_msgs.msg import String\nrclpy.init()\nfirst, second = "
        "rclpy.create_node('a'), rclpy.create_node('b')\nfirst.destroy_node()\n"
        "def attempt(create):\n    try:\n        create()\n    except Exception as error:\n"
        "        print(type(error).__name__, error)\n"
        "attempt(lambda: first.create_publisher(String, 't', 1))\nrclpy.shutdown()\n"
        "attempt(lambda: second.create_timer(1.0, print))\n",
        "InvalidHandle cannot use Destroyable because destruction was requested",
        "RCLError failed to create timer: the given context is not valid",
    ),
    "packages deeper in src": Kind(
        (
            "course run src/mine/a/launch/a.launch.xml",
            "course ros2 launch b b.launch.xml",
            "course ros2 pkg list",
            "python -c \"import course_lib; print(course_lib.load_robot('src/mine/a/r.xacro').name)\"",
        ),
        ("[launch.user]: found", "[launch.user]: found", "\na\n", "\nb\n", "robot of both"),
        {
            "src/mine/a/package.xml": MANIFEST.format("a"),
            "src/mine/a/launch/a.launch.xml": "<launch><include "
            'file="$(find-pkg-share b)/launch/b.launch.xml"/></launch>',
            "src/mine/a/r.xacro": f"<robot name='robot of both' {XACRO}>"
            "<xacro:include filename='$(find b)/part.xacro'/></robot>",
            "src/group/deep/folder_of_b/package.xml": MANIFEST.format("b"),
            "src/group/deep/folder_of_b/launch/b.launch.xml": '<launch><log message="found"/></launch>',
            "src/group/deep/folder_of_b/part.xacro": f"<robot {XACRO}><link name='part'/></robot>",
        },
    ),
    "executable of a package in a substitution": Kind(
        ("course run x.launch.xml --seconds 1",),
        ("Robot initialized",),
        {
            "r.xacro": f"<robot name='r' {XACRO}><link name='a'/></robot>",
            "x.launch.xml": '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
            '<param name="robot_description" type="str" '
            "value=\"$(command '$(exec-in-pkg xacro xacro) $(dirname)/r.xacro')\"/></node></launch>",
        },
    ),
    "parameters of joint_state_publisher": Kind(
        (
            "course run j.launch.py --seconds 1 --bag b",
            "course ros2 --bag b topic echo /joint_states --once --flow-style",
        ),
        ("name: [bend, spin]", "position: [0.5, 0.0]", "velocity: [0.0, 0.0]"),
        {
            "j.launch.py": LAUNCH.format(
                "*[Node(package=name, executable=name, parameters=[given]) for name, given in "
                "[('robot_state_publisher', {'robot_description': open('r.urdf').read()}), "
                "('joint_state_publisher', {'zeros': {'bend': 0.5}, "
                "'publish_default_velocities': True})]]"
            ),
            "r.urdf": "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
            "<joint name='bend' type='revolute'><parent link='a'/><child link='b'/><limit "
            "lower='-1' upper='1' effort='1' velocity='1'/></joint><joint name='spin' "
            "type='continuous'><parent link='b'/><child link='c'/></joint></robot>",
        },
    ),
    "import of launch_ros alone": Kind(
        ("course run l.launch.py --seconds 2",),
        ("/demo_nodes_py", "Hello World: 0"),
        {
            "l.launch.py": "import launch\nimport launch_ros\n\ndef generate_launch_description():\n"
            "    share = launch_ros.substitutions.FindPackageShare('demo_nodes_py')\n"
            "    return launch.LaunchDescription([launch.actions.LogInfo(msg=share), "
            "launch_ros.actions.Node(package='demo_nodes_py', executable='talker')])\n"
        },
    ),
    "interface package that is not there": Kind(
        tuple(f"course run {name}.py" for name in ("msg", "srv", "action")),
        (
            "No module named 'gripper_interfaces'",
            "put the folder gripper_interfaces with its msg",
            "No module named 'cell_srvs'",
            "put the folder cell_srvs with its srv",
            "No module named 'dock'",
            "put the folder dock with its action",
        ),
        {
            "msg.py": "from gripper_interfaces.msg import Grip\n",
            "srv.py": "import cell_srvs.srv\n",
            "action.py": "from dock.action import Dock\n",
        },
        lacks=("course_lib/",),
    ),
    "syntax of Python 3.12": program(
        "d = {'k': 1}\nprint(f'{d['k']} m')\n",
        *(("1 m",) if sys.version_info >= (3, 12) else ("p.py, line 2", "in Python 3.12, which ROS 2 Jazzy")),
    ),
    "bag that is one file": Kind(
        (
            "course run p.py --seconds 1 --bag b",
            "python -c \"import shutil; shutil.copy('b/recording.mcap', 'one.mcap')\"",
            "course ros2 bag info one.mcap",
            "course bag info one.mcap",
            "course ros2 --bag one.mcap topic list",
            "course ros2 bag play one.mcap",
        ),
        ("Topic: /chatter", "/chatter", "\n/chatter\n"),
        {"p.py": TALKER},
        lacks=("Traceback", "is not a bag", "No such file"),
    ),
    "robot with xacro arguments, and xacro in a urdf file": Kind(
        ("python p.py",),
        ("Undefined substitution argument name", "named ur", "0 0 0.1"),
        {
            "arm.xacro": f"<robot name='$(arg name)' {XACRO}><link name='a'/></robot>",
            "w.urdf": f"<robot name='w' {XACRO}><xacro:property name='r' value='0.1'/><link name='a'/>"
            "<link name='b'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/>"
            "<origin xyz='0 0 ${r}'/></joint></robot>",
            "p.py": "from course_lib import load_robot\ntry:\n    load_robot('./arm.xacro')\n"
            "except Exception as error:\n    print(error)\n"
            "print('named', load_robot('./arm.xacro', name='ur').name)\n"
            "print('at', load_robot('./w.urdf').urdf)\n",
        },
    ),
    "script without .py": Kind(
        ("course ros2 run tools bare --ros-args -p a:=1", "course ros2 pkg executables tools"),
        ("this is bare", "tools bare"),
        {
            "src/tools/package.xml": MANIFEST.format("tools"),
            "src/tools/CMakeLists.txt": "project(tools)\ninstall(PROGRAMS scripts/bare "
            "DESTINATION lib/${PROJECT_NAME})\n",
            "src/tools/scripts/bare": "#!/usr/bin/env python3\nimport rclpy\nrclpy.init()\n"
            "rclpy.create_node('n').get_logger().info('this is bare')\n",
        },
    ),
    "names of nav2_common.launch": Kind(
        ("course run n.launch.py",),
        ("[launch.user]: {}",),
        {
            "n.launch.py": "from nav2_common.launch import HasNodeParams, ParseMultiRobotPose, "
            "ReplaceString, RewrittenYaml\n"
            + LAUNCH.format("LogInfo(msg=str(ParseMultiRobotPose('robots').value()))")
        },
    ),
    "malformed rgba": Kind(
        tuple(f"course run {number}.launch.xml --seconds 1" for number in range(3)),
        ("Robot initialized",) * 3,
        {
            f"{number}.launch.xml": '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
            "<param name='robot_description' type='str' value='&lt;robot name=\"r\"&gt;&lt;link "
            'name="a"&gt;&lt;visual&gt;&lt;geometry&gt;&lt;sphere radius="1"/&gt;&lt;/geometry&gt;'
            "&lt;material "
            f'name="m"&gt;&lt;color rgba="{rgba}"/&gt;&lt;/material&gt;&lt;/visual&gt;&lt;/link&gt;'
            "&lt;/robot&gt;'/></node></launch>"
            for number, rgba in enumerate(("1 0 0", "red", "1,0,0,1"))
        },
    ),
    "spin_once and rate.sleep in one thread": program(
        "import rclpy\nrclpy.init()\nnode = rclpy.create_node('n')\nrate = node.create_rate(1.0)\n"
        "for number in range(3):\n    rclpy.spin_once(node)\n    rate.sleep()\n    print('round', number)\n",
        "round 0",
        "round 1",
        "round 2",
        run="course run p.py --seconds 9",
    ),
    "meshes of an own package in a view": Kind(
        (
            "course run p.py --seconds 1 --bag b",
            "course render --bag b --rviz l.rviz --png b.png",
            "python look.py",
        ),
        ("Wrote b.png", "red True"),
        {
            "src/bot/package.xml": MANIFEST.format("bot"),
            "src/bot/meshes/t.stl": TRIANGLE,
            "l.rviz": "Visualization Manager:\n  Displays:\n  - {Class: rviz_default_plugins/RobotModel, "
            "Name: Robot, Enabled: true, Description Topic: {Value: /robot_description}}\n"
            "  Global Options: {Fixed Frame: a}\n",
            "p.py": "import rclpy\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n"
            "from std_msgs.msg import String\nrclpy.init()\nnode = rclpy.create_node('n')\n"
            "profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
            "publisher = node.create_publisher(String, '/robot_description', profile)\n"
            'publisher.publish(String(data=\'<robot name="r"><link name="a"><visual><geometry><mesh '
            'filename="package://bot/meshes/t.stl"/></geometry><material name="m"><color '
            'rgba="1 0 0 1"/></material></visual></link></robot>\'))\n'
            "rclpy.spin_once(node, timeout_sec=0.1)\n",
            "look.py": "from PIL import Image\npixels = Image.open('b.png').convert('RGB').getdata()\n"
            "print('red', sum(red > 2 * blue and red > 60 for red, _, blue in pixels) > 500)\n",
        },
        lacks=("Traceback", "Could not load"),
    ),
    "words of ROS in a notebook": Kind(
        ("python n.py",),
        (
            "Viewer.from_rviz('layout.rviz')",
            "viewer = Viewer()",
            "%rqt graph",
            "tf2_tools view_frames",
            "Image display",
        ),
        {
            "n.py": NOTEBOOK.format(
                "('!rviz2 -d layout.rviz', '%rviz2', '!rqt_graph', '%rqt tf_tree', '%rqt image_view')"
            )
        },
        lacks=("command not found", "Traceback"),
    ),
    "interface without a file": Kind(
        ("course run p.py",),
        ("your package barrow_msgs has no file msg/Wheel.msg", "what the package has: Load."),
        {
            "barrow_msgs/package.xml": MANIFEST.format("barrow_msgs"),
            "barrow_msgs/msg/Load.msg": "float64 mass\n",
            "p.py": "from barrow_msgs.msg import Wheel\n",
        },
        lacks=("next to the program",),
    ),
    "known package that is not found": Kind(
        ("course run k.launch.xml", "course run t.launch.xml"),
        ("urdf_package", "'twist_mux' not found"),
        {
            "k.launch.xml": '<launch><include file="$(find-pkg-share urdf_launch)/launch/display.launch.py"/>'
            "</launch>",
            "t.launch.xml": '<launch><include file="$(find-pkg-share twist_mux)/launch/a.launch.py"/>'
            "</launch>",
        },
        lacks=("course export", "Traceback"),
    ),
    "names of Jazzy": program(
        "import launch, launch_ros, tf2_ros\nprint(launch.events.process, launch_ros.substitutions)\n"
        "print(tf2_ros.ConvertRegistration, tf2_ros.Stamped if hasattr(tf2_ros, 'Stamped') else '')\n",
        "launch.events.process",
        "ConvertRegistration",
    ),
}


@pytest.mark.sample(5)
@pytest.mark.parametrize("name", KINDS)
def test_public_usage_pattern_has_the_same_output_as_in_ros(name: str, tmp_path: Path) -> None:
    kind = KINDS[name]
    for path, content in kind.files.items():
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        file.chmod(0o755)
    output = "\n" + "".join(output_of(command, tmp_path) for command in kind.commands)
    place = 0
    for text in kind.shows:
        found = output.find(text, place)
        assert found >= 0, f"{text!r} is not, or not in this order, in:\n{output}"
        place = found + len(text.rstrip("\n"))
    assert [text for text in kind.lacks if text in output] == []


def output_of(command: str, folder: Path) -> str:
    """Return the output of a command, with `course` and `python` of this environment."""
    environment = {"HOME": str(folder), "AMENT_PREFIX_PATH": "", "ROS_PACKAGE_PATH": ""}
    program, *words = shlex.split(command)
    if program == "course":
        return run_course(*words, cwd=folder, env=environment, is_merged=True).stdout
    process = subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        env=os.environ | environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=120,
    )
    return process.stdout
