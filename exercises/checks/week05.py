"""Week 5, configurations: tasks, hints and public checks."""

from collections.abc import Iterator

from course_lib.grading import (
    Call,
    Message,
    Scenario,
    Task,
    expect_display,
    expect_displays_on,
    expect_drawn,
    expect_launch_argument,
    expect_launch_node,
    expect_layout,
    expect_value,
    inputs,
    lightly_weighted,
    my,
)

GREEN, RED = [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]  # RGBA
SEEN_FROM = (0.5, 50.0)  # minimum distance at which a person is visible [m]
PLAIN = """
Visualization Manager:
  Displays:
    - {Class: my_robot/Battery, Name: Charge, Enabled: true}
    - {Class: rviz_default_plugins/Map, Name: Room, Enabled: false}
    - {Class: rviz_default_plugins/Path, Name: Plan}
"""
GROUPS = """
Visualization Manager:
  Displays:
    - {Class: rviz_default_plugins/Grid, Name: Floor, Enabled: true}
    - Class: rviz_common/Group
      Name: Sensors
      Enabled: true
      Displays:
        - {Class: rviz_default_plugins/LaserScan, Name: Laser, Enabled: true}
        - Class: rviz_common/Group
          Name: Deep
          Enabled: true
          Displays:
            - {Class: rviz_default_plugins/Image, Name: Camera, Enabled: true}
    - Class: rviz_common/Group
      Name: Off
      Enabled: false
      Displays:
        - {Class: rviz_default_plugins/TF, Name: Frames, Enabled: true}
"""


def detections(at: float) -> Message:
    """One person."""
    marker = {
        "header": inputs.header(at, "world"),
        "ns": "people",
        "type": 1,
        "pose": {"position": inputs.xyz((3.0, 0.0, 0.9)), "orientation": {"w": 1.0}},
        "scale": inputs.xyz((0.5, 0.5, 1.8)),
        "color": {"g": 1.0, "a": 1.0},
    }
    return Message("/detections", "visualization_msgs/msg/MarkerArray", {"markers": [marker]}, at=at)


def robot(at: float) -> Iterator[Message]:
    """Return the robot's messages: its frames, a half circle of 3 m, and one person in the laser's range."""
    base = inputs.pose("world", "base_link", (1.0, 0.0, 0.0))
    yield inputs.transforms((base, inputs.pose("base_link", "laser", (0.2, 0.0, 0.0))), at)
    yield inputs.scan([3.0] * 14 + [1.55] * 3 + [3.0] * 14, at, first=-1.5, step=0.1)  # [m], [rad]
    yield detections(at)


ROBOT = tuple(message for n in range(1, 5) for message in robot(n / 2))  # [s]
BEST_EFFORT = ("/scan",)

ROBOT_LAYOUT = Task(
    "week05.robot_layout",
    title="A layout by hand",
    kind="function",
    name="robot_layout",
    hints=(
        "Press Add (TF is below By display type), open each display by its triangle, then Ctrl+S.",
        "The scan needs Reliability Policy: Best Effort. Distance is in the panel Views, below Orbit.",
        "return Path('robot_layout.rviz').read_text(), after you have saved under that name.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                expect_layout(fixed_frame="world").titled("the Fixed Frame"),
                expect_layout(view="Orbit", view_properties={"Distance": my("distance")})
                .worth(4)
                .titled("the view, at your distance"),
                expect_display("Grid", properties={"Plane Cell Count": 50}).titled("the grid"),
                expect_display("TF", properties={"Show Names": True}).titled("TF with names"),
                expect_display("MarkerArray", "/detections", properties={"Name": "Detections"}).titled(
                    "the detections and their name"
                ),
                expect_drawn("MarkerArray", ROBOT).titled("the detections are drawn"),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT).titled("the scan is drawn"),
            ),
        ),
    ),
    personal={"distance": (6.0, 7.0, 8.0, 9.0, 11.0, 12.0)},  # [m]; 10 is the default
)

SENSOR = {"Topic/Reliability Policy": "Best Effort"}
SCAN_SHOWN = expect_display("LaserScan", "/front/scan", properties=SENSOR)
CLOUD_SHOWN = expect_display("PointCloud2", "/points", properties=SENSOR, call=1)
NAMED = (
    expect_display("LaserScan", "/front/scan", properties={"Name": "/front/scan"}),
    expect_display("Path", "/plan", properties={"Name": "/plan"}),
)

LAYOUT_FOR = Task(
    "week05.layout_for",
    title="A layout by code",
    kind="function",
    name="layout_for",
    hints=(
        "topics.items() gives pairs of a topic and its display. viewer.add takes the class first.",
        "viewer.add(display_class, topic, name=topic) returns the display. Set properties by labels.",
        "`added = made.add(display_class, topic, name=topic)`; for sensors set Topic/Reliability Policy.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call("odom", {"/front/scan": "LaserScan", "/plan": "Path"}),
                Call("map", {"/points": "PointCloud2"}),
            ),
            checks=lightly_weighted(
                SCAN_SHOWN.titled("the scan, with best effort"),
                CLOUD_SHOWN.titled("the point cloud, with best effort"),
                expect_display("Path", "/plan", properties={"Topic/Reliability Policy": "Reliable"}).titled(
                    "the path, which stays reliable"
                ),
                NAMED[0].titled("the scan's name"),
                NAMED[1].titled("the path's name"),
                expect_displays_on("/front/scan", "/plan").requiring(*NAMED),
                expect_layout(fixed_frame="odom").titled("the Fixed Frame").requiring(SCAN_SHOWN),
                expect_layout(fixed_frame="map", call=1).titled("another Fixed Frame").requiring(CLOUD_SHOWN),
            ),
        ),
    ),
)

MENDED_FRAME = expect_layout(fixed_frame="world").titled("the Fixed Frame")

MENDED_LAYOUT = Task(
    "week05.mended_layout",
    title="Five faults in a layout",
    kind="function",
    name="mended_layout",
    hints=(
        "Fix the Fixed Frame first, look at the statuses again, then continue from the top.",
        "Two faults have no status: a check box, and a camera that is very far away.",
        "Frame world; Frames enabled; Laser Best Effort; People on /detections; Distance about 8 m.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                MENDED_FRAME,
                expect_drawn("TF", ROBOT).titled("the frames are enabled"),
                expect_drawn("LaserScan", ROBOT, best_effort=BEST_EFFORT).titled("the scan is drawn"),
                expect_drawn("MarkerArray", ROBOT).titled("the people are drawn"),
                expect_layout(view_within={"Distance": SEEN_FROM}).titled("the camera is near enough"),
                expect_display("Grid", properties={"Name": "Floor", "Color": "100; 100; 200"})
                .titled("the floor is as before")
                .worth(0.2)
                .requiring(MENDED_FRAME),
                *(
                    expect_display(kind, properties={"Name": name})
                    .titled(f"the name {name} is as before")
                    .worth(0.2)
                    .requiring(MENDED_FRAME)
                    for kind, name in (("TF", "Frames"), ("LaserScan", "Laser"), ("MarkerArray", "People"))
                ),
            ),
        ),
    ),
)

BAR, BAR_AXES = ("size", "centre", "color"), "x y z, red green blue alpha"
HALF_FULL = expect_value(
    [[0.2, 0.2, 0.5], [0.0, 0.0, 0.25], GREEN],
    call=0,
    name="a half full bar",
    parts=BAR,
    axes=BAR_AXES,
)

BATTERY_BAR = Task(
    "week05.battery_bar",
    title="Three faults in a display",
    kind="function",
    name="battery_bar",
    hints=(
        "Where is the centre of a bar that stands on the ground? Which color at exactly 0.2? What about 1.2?",
        "The centre is at half the height; green starts at 0.2; the charge is limited before it is used.",
        "`charge = min(max(charge, 0.0), 1.0)`; the color is green from 0.2 on, else red.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(
                Call(0.5, 1.0),
                Call(0.195, 4.0),
                Call(0.2, 1.0),
                Call(1.2, 0.5),
                Call(-0.1, 1.0),
            ),
            checks=lightly_weighted(
                HALF_FULL,
                expect_value(
                    [[0.2, 0.2, 0.78], [0.0, 0.0, 0.39], RED],
                    call=1,
                    name="a nearly empty bar",
                    parts=BAR,
                    axes=BAR_AXES,
                ),
                expect_value(
                    [[0.2, 0.2, 0.2], [0.0, 0.0, 0.1], GREEN],
                    call=2,
                    name="a bar at exactly 0.2",
                    parts=BAR,
                    axes=BAR_AXES,
                ),
                expect_value(
                    [[0.2, 0.2, 0.5], [0.0, 0.0, 0.25], GREEN],
                    call=3,
                    name="a bar at a charge above 1",
                    parts=BAR,
                    axes=BAR_AXES,
                ),
                expect_value(
                    [[0.2, 0.2, 0.0], [0.0, 0.0, 0.0], RED],
                    call=4,
                    name="a bar at a charge below 0",
                    parts=BAR,
                    axes=BAR_AXES,
                ).requiring(HALF_FULL),
            ),
        ),
    ),
)

DISPLAYS_IN = Task(
    "week05.displays_in",
    title="What is in a layout",
    kind="function",
    name="displays_in",
    hints=(
        "data = yaml.safe_load(text); the list is data['Visualization Manager']['Displays'].",
        "A function that calls itself goes into groups. display['Class'].split('/')[-1] is the short class.",
        "for display in displays: leave it out if it is not enabled; go into a group; else list the pair.",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(PLAIN), Call(GROUPS)),
            checks=lightly_weighted(
                expect_value(
                    [["Charge", "Battery"], ["Plan", "Path"]],
                    call=0,
                    name="the list",
                    parts=("name", "class"),
                ),
                expect_value(
                    [["Floor", "Grid"], ["Laser", "LaserScan"], ["Camera", "Image"]],
                    call=1,
                    name="the list with groups",
                    parts=("name", "class"),
                ),
            ),
        ),
    ),
)

PLACE = {"--x": 0.2, "--z": my("height"), "--frame-id": "base_link", "--child-frame-id": "camera_link"}

LAUNCH_FILE = Task(
    "week05.launch_file",
    title="A launch file",
    kind="launch",
    name="launch_file",
    hints=(
        "Take the lesson's launch file, and change the default, the name and the arguments.",
        "Each argument is a string of its own, numbers too: '--x', '0.2'. Which frame is the parent?",
        "arguments=['-d', LaunchConfiguration('layout')]; '--frame-id', 'base_link', '--child-frame-id', …",
    ),
    scenarios=(
        Scenario(
            "public",
            calls=(Call(),),
            checks=(
                expect_launch_argument("layout", default="robot_layout.rviz").titled("the argument layout"),
                expect_launch_node("rviz2", "rviz2", options={"-d": "$(layout)"}).titled(
                    "RViz2 with the layout of the argument"
                ),
                expect_launch_node("tf2_ros", "static_transform_publisher", name="camera_frame").titled(
                    "a static transform publisher, with its name"
                ),
                expect_launch_node("tf2_ros", "static_transform_publisher", options=PLACE)
                .worth(2)
                .titled("the frames and the place of the camera"),
            ),
        ),
    ),
    personal={"height": (0.35, 0.45, 0.55, 0.65, 0.75, 0.85)},  # [m]
)

TASKS = (ROBOT_LAYOUT, LAYOUT_FOR, MENDED_LAYOUT, BATTERY_BAR, LAUNCH_FILE, DISPLAYS_IN)
