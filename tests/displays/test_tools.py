"""RViz's tools in the graph: they advertise the topics of the layout."""

import json
from pathlib import Path

from course_lib.displays.panel.tools import all_tools, load_tools
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos

BEST_EFFORT = {
    "Value": "/my_goal",
    "Depth": 3,
    "Reliability Policy": "Best Effort",
    "Durability Policy": "Transient Local",
    "History Policy": "Keep All",
}
TOOLS = [
    {"Class": "rviz_default_plugins/SetInitialPose", "Topic": {"Value": "/initialpose", "Depth": 7}},
    {"Class": "rviz_default_plugins/SetGoal", "Topic": BEST_EFFORT},
    {"Class": "rviz_default_plugins/PublishPoint", "Topic": "/clicked"},
]


def advertised(graph: Graph) -> dict[str, tuple[str, Qos]]:
    ends = (end for end in graph.endpoints() if end.kind == "pub" and not end.is_service)
    return {end.topic: (end.type_name, end.qos) for end in ends}


def layout(folder: Path) -> Path:
    path = folder / "tools.rviz"
    path.write_text(json.dumps({"Visualization Manager": {"Displays": [], "Tools": TOOLS}}))
    return path


def test_tools_of_a_layout_advertise_its_topics_with_its_qos(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer.from_rviz(layout(tmp_path))
    found = advertised(graph)
    assert found["/initialpose"] == ("geometry_msgs/msg/PoseWithCovarianceStamped", Qos(depth=7))
    assert found["/my_goal"] == (
        "geometry_msgs/msg/PoseStamped",
        Qos(depth=3, reliability="best_effort", durability="transient_local", history="keep_all"),
    )
    assert found["/clicked"] == ("geometry_msgs/msg/PointStamped", Qos(depth=5))
    viewer.close()
    assert advertised(graph) == {}


def test_tool_advertises_its_new_topic(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer.from_rviz(layout(tmp_path))
    viewer.tool("2D Goal Pose")["Topic"] = "/other"
    assert advertised(graph)["/other"][1].reliability == "best_effort"
    assert "/my_goal" not in advertised(graph)
    viewer.close()


def test_viewer_without_a_layout_advertises_nothing(graph: Graph) -> None:
    viewer = Viewer()
    assert advertised(graph) == {}
    viewer.close()


def test_all_unknown_tools_of_a_layout_have_one_hint() -> None:
    known = {"Class": "rviz_default_plugins/SetGoal"}
    names = ["rviz/Interact", "rviz/Measure"]
    (hint,) = load_tools(all_tools(), [{"Class": names[0]}, known, {"Class": names[1]}])
    expected = "There are no tools 'rviz/Interact', 'rviz/Measure'; the layout keeps the settings."
    assert hint == expected
    assert [*load_tools(all_tools(), [{"Class": names[0]}])] == [
        "There is no tool 'rviz/Interact'; the layout keeps the settings."
    ]
