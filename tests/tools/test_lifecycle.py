from collections.abc import Callable

import pytest
import rclpy
from rclpy.lifecycle import LifecycleNode, State, TransitionCallbackReturn
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import running_nodes

Run = Callable[[str], str]


class Camera(LifecycleNode):
    def on_cleanup(self, state: State) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.FAILURE


@pytest.fixture
def camera(graph: Graph, talker: Node) -> Camera:
    """A lifecycle node, in addition to an ordinary one."""
    node = Camera("camera", namespace="front")
    running_nodes().append(node)
    return node


@pytest.mark.usefixtures("camera")
def test_only_lifecycle_nodes_are_listed(run: Run) -> None:
    running_nodes().append(LifecycleNode("_hidden"))
    assert run("lifecycle nodes") == "/front/camera\n"
    assert run("lifecycle nodes -a") == "/_hidden\n/front/camera\n"
    assert run("lifecycle nodes --count-nodes") == "1\n"


@pytest.mark.usefixtures("camera")
def test_state_of_one_or_all_nodes_is_shown(run: Run) -> None:
    assert run("lifecycle get /front/camera") == "unconfigured [1]\n"
    running_nodes().append(LifecycleNode("arm"))
    assert run("lifecycle get") == "/arm: unconfigured [1]\n/front/camera: unconfigured [1]\n"


@pytest.mark.usefixtures("camera")
def test_state_is_set_by_transition_label_or_id(run: Run) -> None:
    assert run("lifecycle set /front/camera configure") == "Transitioning successful\n"
    assert run("lifecycle set front/camera 3") == "Transitioning successful\n"
    assert run("lifecycle get front/camera") == "active [3]\n"


def test_transition_rejected_by_the_node_is_a_failure(
    run: Run, camera: Camera, capsys: pytest.CaptureFixture[str]
) -> None:
    camera.trigger_configure()
    assert run("lifecycle set /front/camera cleanup") == ""
    assert capsys.readouterr().err == "Transitioning failed\n"
    assert run("lifecycle get /front/camera") == "inactive [2]\n"


@pytest.mark.usefixtures("camera")
def test_transitions_from_the_current_state_or_all_are_listed(run: Run) -> None:
    assert run("lifecycle list /front/camera") == (
        "- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n"
        "- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n"
    )
    every = run("lifecycle list -a /front/camera")
    assert every.count("Start: ") == 25
    assert "- transition_error [62]\n\tStart: errorprocessing\n\tGoal: finalized\n" in every


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("lifecycle get /talker", r"^Node not found"),
        ("lifecycle set /front/camara configure", r"^Node not found\. Did you mean /front/camera\?$"),
        ("lifecycle set /front/camera activate",
         r"^Unknown transition requested, available ones are:\n- configure \[1\]\n- shutdown \[5\]$"),
    ],
)  # fmt: skip
@pytest.mark.usefixtures("camera")
def test_unknown_lifecycle_node_or_transition_is_reported(run: Run, line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        run(line)
    assert rclpy.ok()
