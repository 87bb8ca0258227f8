"""Sliders for joints, as joint_state_publisher_gui has them."""

from typing import TYPE_CHECKING, Any

from course_lib.robots.joint_state_publisher import FreeJoint, JointStatePublisher
from course_lib.ros import pace

if TYPE_CHECKING:
    from ipywidgets import HBox, VBox


def joint_sliders(publisher: JointStatePublisher) -> "VBox | None":
    """Return a slider for each joint of a joint state publisher; None where no page would show them.

    What they say is published while the node runs: `run_live(publisher)`. Tab goes from one to the next,
    arrow keys move it by a thousandth of its range, and its number may be typed.
    """
    if pace.wanted() == "fast":
        return None
    import ipywidgets

    center = ipywidgets.Button(description="Center", tooltip="All joints to where they began")
    box = ipywidgets.VBox()

    def build() -> None:
        box.children = [center, *(_row(name, joint) for name, joint in publisher.joints.items())]

    def to_zeros(_: Any) -> None:
        for row, joint in zip(box.children[1:], publisher.joints.values(), strict=True):
            row.children[0].value = joint.zero

    center.on_click(to_zeros)
    publisher.on_robot.append(build)
    build()
    return box


def _row(name: str, joint: FreeJoint) -> "HBox":
    import ipywidgets

    lower, upper = sorted((joint.lower, joint.upper))
    slider = ipywidgets.FloatSlider(
        joint.position,
        min=lower,
        max=upper,
        step=(upper - lower) / 1000 or 1.0,  # where both limits are one, any step will do
        description=name,
        readout_format=".3f",
        style={"description_width": "14em"},
        layout={"width": "34em"},
    )
    slider.observe(lambda change: setattr(joint, "position", change["new"]), "value")
    return ipywidgets.HBox([slider, ipywidgets.Label(f"{lower:.3f} … {upper:.3f} {joint.unit}")])
