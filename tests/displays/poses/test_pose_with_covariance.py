from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseWithCovarianceStamped

from course_lib.displays.display import INVALID
from tests.displays.bench import Bench
from tests.displays.poses.test_poses import add, drawables_of, extent, pose


def message(x: float = 0.0, **fields: Any) -> PoseWithCovarianceStamped:
    message = PoseWithCovarianceStamped()
    message.header.frame_id = "map"
    message.pose.pose = pose(x, turned=True)
    message.pose.covariance = fields.get("covariance", np.eye(6).ravel())
    return message


def test_pose_is_shown_with_its_covariance() -> None:
    bench = Bench()
    display = add(bench, "PoseWithCovariance")
    bench.publish("/pose", message(2.0))
    assert sorted(drawables_of(bench)) == ["discs", "head", "place", "shaft"]
    assert extent(bench, "shaft")[0].tolist() == [2, 0, 0]
    display["Shape"] = "Axes"
    display["Covariance"] = False
    assert sorted(drawables_of(bench)) == ["axes"]
    display.reset()
    assert not drawables_of(bench)


@pytest.mark.parametrize("wrong", [message(np.nan), message(covariance=np.full(36, np.inf))])
def test_non_finite_pose_is_an_error(wrong: PoseWithCovarianceStamped) -> None:
    bench = Bench()
    display = add(bench, "PoseWithCovariance")
    bench.publish("/pose", wrong)
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert not drawables_of(bench)
