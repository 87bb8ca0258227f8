"""The server and the menus, as the official tutorials use them (simple_marker, basic_controls, menu)."""

from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Point, Pose
from interactive_markers import InteractiveMarkerServer, MenuHandler
from rclpy.node import Node
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerControl,
    InteractiveMarkerFeedback,
    InteractiveMarkerUpdate,
    MenuEntry,
)
from visualization_msgs.srv import GetInteractiveMarkers

POSE_UPDATE, MENU_SELECT = InteractiveMarkerFeedback.POSE_UPDATE, InteractiveMarkerFeedback.MENU_SELECT


class Client:
    """A client node of the server, with its received messages."""

    def __init__(self, server: InteractiveMarkerServer) -> None:
        self.server, self.node = server, Node("client")
        self.updates: list[InteractiveMarkerUpdate] = []
        self.node.create_subscription(InteractiveMarkerUpdate, "/simple/update", self.updates.append, 10)
        self.publisher = self.node.create_publisher(InteractiveMarkerFeedback, "/simple/feedback", 10)

    def send(self, event: int, *, client: str = "rviz", x: float = 0.0, **fields: Any) -> None:
        pose = Pose(position=Point(x=x))
        feedback = InteractiveMarkerFeedback(
            marker_name="box", client_id=client, event_type=event, pose=pose, **fields
        )
        self.publisher.publish(feedback)
        self.wait()

    def wait(self, seconds: float = 0.1) -> None:
        end = self.node.get_clock().now().nanoseconds + round(seconds * 1e9)
        while self.node.get_clock().now().nanoseconds < end:
            for node in (self.server.node, self.node):
                rclpy.spin_once(node, timeout_sec=seconds / 10)


def box(name: str = "box") -> InteractiveMarker:
    control = InteractiveMarkerControl(name="x", interaction_mode=InteractiveMarkerControl.MOVE_AXIS)
    return InteractiveMarker(header=Header(frame_id="map"), name=name, controls=[control])


@pytest.fixture
def server(node: Node) -> InteractiveMarkerServer:
    return InteractiveMarkerServer(node, "simple")


@pytest.fixture
def client(server: InteractiveMarkerServer) -> Client:
    client = Client(server)
    server.insert(box())
    server.applyChanges()
    client.wait(1.5)  # for the first second a marker is no client's
    return client


def x_of(server: InteractiveMarkerServer) -> float:
    marker = server.get("box")
    assert marker is not None
    return marker.pose.position.x


def test_marker_changes_are_published_together_on_apply(client: Client) -> None:
    server = client.server
    server.insert(box("other"))
    assert server.setPose("box", Pose(position=Point(x=2.0)))
    client.wait()
    assert len(client.updates) == 1
    server.applyChanges()
    server.applyChanges()  # of nothing
    client.wait()
    first, second = client.updates
    assert (first.seq_num, first.type, [m.name for m in first.markers]) == (1, 1, ["box"])
    assert (second.seq_num, [m.name for m in second.markers]) == (2, ["other"])
    assert [(p.name, p.header.frame_id, p.pose.position.x) for p in second.poses] == [("box", "map", 2.0)]


def test_late_client_requests_all_markers_and_the_sequence_number(client: Client) -> None:
    service_client = client.node.create_client(GetInteractiveMarkers, "simple/get_interactive_markers")
    future = service_client.call_async(GetInteractiveMarkers.Request())
    client.wait()
    response = future.result()
    assert response is not None
    assert (response.sequence_number, [marker.name for marker in response.markers]) == (1, ["box"])


def test_feedback_moves_the_marker_calls_the_callback_and_reaches_other_clients(client: Client) -> None:
    calls: list[float] = []
    client.server.setCallback("box", lambda feedback: calls.append(feedback.pose.position.x))
    for step in (0.5, 1.0, 1.5):
        client.send(POSE_UPDATE, x=step, control_name="x")
    assert calls == [0.5, 1.0, 1.5]
    assert x_of(client.server) == 1.5
    assert [update.poses[0].pose.position.x for update in client.updates[1:]] == calls


def test_feedback_callback_can_correct_the_received_pose(client: Client) -> None:
    def to_the_grid(feedback: InteractiveMarkerFeedback) -> None:
        pose = Pose(position=Point(x=float(round(feedback.pose.position.x))))
        client.server.setPose(feedback.marker_name, pose)

    client.server.setCallback("box", to_the_grid)
    client.send(POSE_UPDATE, x=2.8)
    assert [update.poses[0].pose.position.x for update in client.updates[1:]] == [3.0]


def test_marker_is_moved_by_one_client_at_a_time(client: Client) -> None:
    client.send(POSE_UPDATE, x=1.0)
    client.send(POSE_UPDATE, x=2.0, client="second")
    assert x_of(client.server) == 1.0
    client.wait(1.0)
    client.send(POSE_UPDATE, x=3.0, client="second")
    assert x_of(client.server) == 3.0


def test_feedback_callback_for_one_event_type_overrides_the_default_callback(client: Client) -> None:
    calls: list[str] = []
    click = InteractiveMarkerFeedback.BUTTON_CLICK
    client.server.insert(box(), feedback_callback=lambda feedback: calls.append("any"))
    client.server.setCallback("box", lambda feedback: calls.append("click"), click)
    client.server.applyChanges()
    client.send(click)
    client.send(POSE_UPDATE)
    client.server.setCallback("box", None, click)
    client.send(click)
    assert calls == ["click", "any", "any"]


def test_erased_markers_are_removed_and_their_feedback_is_ignored(client: Client) -> None:
    assert client.server.erase("box")
    assert client.server.get("box") is None
    assert not client.server.erase("nothing")
    client.server.applyChanges()
    client.send(POSE_UPDATE, x=1.0)
    assert client.updates[-1].erases == ["box"]
    assert not client.server.setPose("box", Pose())


def test_server_shutdown_erases_its_markers_and_removes_its_topics(client: Client) -> None:
    client.server.shutdown()
    client.server.shutdown()
    client.wait()
    assert client.updates[-1].erases == ["box"]
    assert client.node.count_publishers("/simple/update") == 0


def test_menu_has_check_boxes_submenus_and_hidden_entries_and_calls_the_selected_callback(
    client: Client,
) -> None:
    menu, chosen = MenuHandler(), list[int]()
    for title in ("First", "Second"):
        menu.insert(title, callback=lambda feedback: chosen.append(feedback.menu_entry_id))
    sub = menu.insert("Sub")
    below = menu.insert("Below", parent=sub, command="pkg node", command_type=MenuEntry.ROSRUN)
    assert (sub, below) == (3, 4)
    menu.setCheckState(1, MenuHandler.CHECKED)
    menu.setCheckState(2, MenuHandler.UNCHECKED)
    assert menu.apply(client.server, "box")
    client.server.applyChanges()
    client.wait()
    (marker,) = client.updates[-1].markers
    entries = [(entry.id, entry.parent_id, entry.title, entry.command_type) for entry in marker.menu_entries]
    assert entries == [(1, 0, "[x] First", 0), (2, 0, "[ ] Second", 0), (3, 0, "Sub", 0), (4, 3, "Below", 1)]
    client.send(MENU_SELECT, menu_entry_id=2)
    client.send(MENU_SELECT, menu_entry_id=3)  # without a callback
    assert chosen == [2]
    menu.setVisible(3, False)
    assert menu.reApply(client.server)
    marker_now = client.server.get("box")
    assert marker_now is not None
    assert [entry.id for entry in marker_now.menu_entries] == [1, 2]


def test_menu_reports_an_unknown_parent_and_drops_erased_markers(
    client: Client, capsys: pytest.CaptureFixture[str]
) -> None:
    menu = MenuHandler()
    assert menu.insert("Lost", parent=7) is None
    assert capsys.readouterr().err == "Parent menu entry '7' not found\n"
    assert (menu.getTitle(7), menu.getCheckState(7), menu.setVisible(7, True)) == (None, None, False)
    menu.apply(client.server, "box")
    client.server.erase("box")
    assert not menu.reApply(client.server)
    assert menu.managed_markers_ == set()
