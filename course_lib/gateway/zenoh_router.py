"""A Zenoh router in this process: what `rmw_zenohd` is on a robot."""

import json
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError

if TYPE_CHECKING:
    import zenoh


def open_router(settings: dict[str, Any], option: str = "--listen") -> "zenoh.Session":
    """Open a router in this process; it keeps trying to connect.

    Args:
        settings: Of Zenoh, by their keys; `listen/endpoints` among them.
        option: That chooses another port.

    Raises:
        CourseError: Zenoh is missing, or refuses an address or a file.
    """
    try:
        import zenoh
    except ImportError as error:
        raise CourseError("Robots need Zenoh. Type: pip install 'course-lib[robot]'") from error
    config = zenoh.Config()
    common = {
        "mode": "router",
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2},
        "timestamping/enabled": True,
        "queries_default_timeout": 600_000,
        "adminspace": {"enabled": True, "permissions": {"read": True, "write": False}},  # for Gateway.links
    }
    for name, value in (common | settings).items():
        config.insert_json5(name, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        place = settings["listen/endpoints"][-1]
        said = str(error).split(" at /")[0]  # the rest names Zenoh's own source
        raise CourseError(
            f"Zenoh can't listen at {place}: {said}. Is the port taken? {option} takes another."
        ) from error
