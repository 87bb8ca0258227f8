"""Every check function, and every check of the course, on generated and corrupted evidence."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from course_lib import grading as v
from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.grading.evidence import Check, Evidence, all_checks
from course_lib.grading.inputs import header, pose, transforms
from course_lib.grading.judge import CHECK_SECONDS
from course_lib.grading.records import Run
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.task import Message, load_catalog, time_limit
from tests.hostile.made_up import random_evidence, spoilt_evidence

T = "/topic"
SCAN = {"angle_max": 1.0, "angle_increment": 0.1, "range_max": 9.0, "ranges": [1.0] * 11}
ROBOT = (
    transforms([pose("map", "laser", (1.0, 0.0, 0.0))], 0.1),
    Message("/scan", "sensor_msgs/msg/LaserScan", {"header": header(0.1, "laser"), **SCAN}, at=0.2),
)
MARKER, ARRAY = "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray"
JOINTS, TF = "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
SQUARE = ((0, 0, 0), (1, 0, 0), (1, 1, 0))
# Each check function with arguments that use all of its inputs, and its topics with their types.
WORDS: tuple[tuple[str, Check], ...] = (
    ("expect_circle", v.expect_circle(T, radius=2.0, height=0.0, period=5.0, counter_clockwise=True)),
    ("expect_circle", v.expect_circle(T, radius=1.0, ns="", id=1, type="CUBE")),
    ("expect_circling_frame", v.expect_circling_frame("map", "base_link", radius=2.0, heading=0.0)),
    ("expect_colors_apart", v.expect_colors_apart("LaserScan", 30.0)),
    ("expect_display", v.expect_display("LaserScan", "/scan", properties={"Topic/Depth": 5})),
    ("expect_displays_on", v.expect_displays_on("/scan", "/tf")),
    ("expect_drawn", v.expect_drawn("LaserScan", ROBOT)),
    ("expect_drawn", v.expect_drawn("TF", ROBOT)),
    ("expect_fact", v.expect_fact("image_rate", serial=11)),
    ("expect_fact", v.expect_fact("threshold", serial=11)),
    ("expect_frame", v.expect_frame(T, "map")),
    ("expect_gone", v.expect_gone(T)),
    ("expect_images", v.expect_images(T)),
    ("expect_joint_states", v.expect_joint_states(["joint_1", "joint_2"])),
    ("expect_joint_swing", v.expect_joint_swing("joint_1", amplitude=0.5, hz=1.0)),
    ("expect_joint_swing", v.expect_joint_swing("joint_1", amplitude=0.0, hz=1.0)),
    ("expect_joints_still", v.expect_joints_still({"joint_1": 0.5, "joint_2": 0.0})),
    ("expect_layout", v.expect_layout(fixed_frame="map", view="Orbit", view_properties={"Focal/X": 1.0})),
    ("expect_launch_argument", v.expect_launch_argument("layout", default="a.rviz")),
    ("expect_launch_node", v.expect_launch_node("a", "b", name="c", options={"-d": "$(layout)", "--z": 0.5})),
    ("expect_length", v.expect_length(3, 100)),
    ("expect_level", v.expect_level("WARN", says="slow", begin=0.0, end=3.0)),
    *(("expect_levels", c) for c in v.expect_levels(("OK", "fine", "a"), ("WARN", "slow", "b"), seconds=1.0)),
    ("expect_marker", v.expect_marker(T, type="LINE_STRIP", loop=SQUARE, at=1.0)),
    ("expect_marker", v.expect_marker(T, type="CUBE", frame="map", position=(0, 0, 0), yaw=0.0)),
    ("expect_marker", v.expect_marker(T, color=(1, 0, 0, 1), text="a", points=SQUARE, lifetime=1.0)),
    ("expect_marker", v.expect_marker(T, ns="", id=0, scale=(1, 1, 1))),
    ("expect_marker_count", v.expect_marker_count(T, 3, type="SPHERE")),
    ("expect_message", v.expect_message(T, {"header.frame_id": "map", "status.0.name": "a", "pose": [1.0]})),
    ("expect_nothing_before", v.expect_nothing_before(T, 1.0)),
    ("expect_parameters", v.expect_parameters("/node", {"rate": 5.0, "names": ["a", "b"], "n": 3})),
    ("expect_path", v.expect_path(T, count=3, frame="map", ends=((0, 0, 0), (2, 0, 0)), yaw=1.0)),
    ("expect_rate", v.expect_rate(T, 10.0, begin=0.5, end=2.5)),
    ("expect_stamps", v.expect_stamps(T)),
    ("expect_text", v.expect_text("fixed frame", but_not=("target frame",))),
    ("expect_throughout", v.expect_throughout(T)),
    ("expect_throughout", v.expect_throughout(T, hz=10.0, begin=0.5, end=2.0)),
    ("expect_topic", v.expect_topic(T, MARKER, at_most=2)),
    ("expect_topic", v.expect_topic(T, MARKER, at_least=2)),
    ("expect_trajectory", v.expect_trajectory(T, {"joint_1": 1.0}, at=0.0, seconds=1.0)),
    ("expect_transform", v.expect_transform("map", "base_link", translation=(1, 0, 0), yaw=0.0)),
    ("expect_transform", v.expect_transform("map", "odom", at=1.0)),
    ("expect_value", v.expect_value({"x": [1.0, None, "a", True]})),
    ("expect_value", v.expect_value([1.0, 2.0], call=1)),
    ("expect_value", v.expect_value(1.0, call=2)),
)  # fmt: skip
ON_TOPIC = (
    MARKER, ARRAY, JOINTS, "nav_msgs/msg/Path", "trajectory_msgs/msg/JointTrajectory",
    "action_msgs/msg/GoalStatusArray", "visualization_msgs/msg/InteractiveMarkerUpdate",
    "std_msgs/msg/String", "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Image",
)  # fmt: skip
FIXED = (
    ("/joint_states", JOINTS), ("/tf", TF), ("/tf_static", TF),
    ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"),
)  # fmt: skip


def judge(check: Check, evidence: Evidence) -> None:
    """Run a check, which must return a score from 0 to 1 within its time limit.

    Raises:
        AssertionError: The check raised something; names the check, the exception and the evidence.
    """
    try:
        with time_limit(CHECK_SECONDS):
            verdict = check.judge(evidence)
        assert 0 <= float(verdict.score) <= 1, verdict
    except Exception as error:
        topics = sorted(evidence.topics.items())
        what = f"{check.title}: {error!r} over {topics}, {evidence.returns!r:.300}"
        raise AssertionError(what) from error


def words_over(chance: random.Random, rounds: int) -> int:
    """Judge generated evidence by every check function. Return the number of judgements.

    In half of the rounds the words are the checks of one scenario, so that they are bound to one
    marker.
    """
    together = all_checks([check for _, check in WORDS])
    for number in range(rounds):
        evidence = random_evidence(chance, ((T, chance.choice(ON_TOPIC)), *FIXED), seconds=3.0)
        evidence = replace(evidence, checks=together if number % 2 else ())
        for _, check in WORDS:
            judge(check, evidence)
    return rounds * len(WORDS)


def right_runs(weeks: Sequence[str] = ()) -> list[Run]:
    """Return the evidence of the solutions, with the checks that judge it."""
    catalog = load_catalog(exercises_dir(), solutions_dir())
    runs: list[Run] = []
    for week in weeks or catalog.course.weeks:
        path, tasks = solutions_dir() / f"{week}_solution.ipynb", catalog.tasks_of_week(week)
        if tasks:
            cells = parse_notebook(path.read_bytes(), path.name).cells
            steps = plan_scenarios(tasks, catalog, with_hidden=True)
            job = Job(cells, "fuzz", steps, catalog.course.limits, working_files(path, cells))
            runs += run_scenarios(job).runs
    return runs


def checks_of(run: Run) -> Iterator[Check]:
    """Yield the checks of a scenario and the checks that they require."""
    waiting: list[Any] = list(run.scenario.checks)
    while waiting:
        check = waiting.pop()
        waiting += check.requires
        yield check


def course_over(chance: random.Random, runs: Sequence[Run], rounds: int) -> int:
    """Judge corrupted evidence by the checks of its scenario. Return the number of judgements."""
    judged = 0
    for _ in range(rounds):
        run = chance.choice(runs)
        evidence = replace(spoilt_evidence(chance, run.evidence), checks=all_checks(run.scenario.checks))
        for check in checks_of(run):
            judge(check, evidence)
            judged += 1
    return judged
