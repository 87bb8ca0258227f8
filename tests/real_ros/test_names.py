"""The stand-in has the names of the real rclpy, which are frozen with its version."""

import ast
import importlib
import inspect
import json
import re
import subprocess
from collections.abc import Iterable
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.real_ros import differences
from tests.warm import run_course

HERE = Path(__file__).parent
Names = dict[str, list[str]]

# Private names that no program chooses: Python mangled them with a class of the stand-in, or they
# are marked.
OF_THE_KIT = re.compile(
    r"_(course_\w+|"
    r"(Node|LifecycleNodeMixin|Executor|MultiThreadedExecutor|Entity|ServiceEnd|TopicEnd|Timer"
    r"|Rate|RcutilsLogger|Subscription|Client|Service|ActionServer|ActionClient|GuardCondition|Context|Time|Duration|TimeSource"
    r"|AsyncParameterClient|ParameterEventHandler)__\w+)"
)

# Names of everyday use with which students' nodes were seen to break.
EVERYDAY = [
    "_service",
    "_set",
    "_store",
    "_declare",
    "_profile",
    "_resolve",
    "_keep",
    "_all",
    "_created",
    "_parameter_events",
    "_on_set",
    "_post_set",
    "_pre_set",
    "_on_topic",
    "_of_node",
    "_rosout",
    "_publish_log",
    "_keep_parameters",
    "_names",
    "_alarm",
    "_queue",
    "_events",
    "_client",
    "_server",
    "_goal",
    "_handle",
    "_state",
    "_running",
    "_done",
    "_results",
    "_start",
    "_stop",
    "_run",
    "_update",
    "_send",
    "_publish",
    "_receive",
]


@cache
def frozen() -> Names:
    return _parsed(json.loads((HERE / "frozen" / "names.json").read_text("utf-8")))


@cache
def kits() -> Names:
    process = run_course("run", HERE / "probes" / "names.py")
    assert process.returncode == 0, process.stderr
    return _parsed({"outcomes": json.loads(process.stdout)})


def _parsed(content: dict[str, dict[str, str]]) -> Names:
    names: Names = ast.literal_eval(content["outcomes"]["names"])
    return names


def test_both_lists_cover_the_same_classes() -> None:
    assert set(frozen()) == set(kits())
    assert {"_publishers", "_validate_topic_or_service_name"} <= set(frozen()["Node"])


def test_classes_have_no_private_name_missing_in_rclpy() -> None:
    extra = {
        kind: [name for name in names if _is_private(name) and name not in frozen()[kind]]
        for kind, names in kits().items()
    }
    assert {kind: names for kind, names in extra.items() if names} == {}


def _is_private(name: str) -> bool:
    return name.startswith("_") and not OF_THE_KIT.fullmatch(name) and name != "_abc_impl"


def test_public_names_missing_in_the_kit_are_listed_as_missing() -> None:
    frozen = json.loads((HERE / "frozen" / "modules.json").read_text("utf-8"))["outcomes"]["modules"]
    names: list[str] = ast.literal_eval(frozen)
    assert {"rclpy.node.Node.create_publisher", "rclpy.waitable.Waitable"} <= set(names)
    page = (HERE.parents[1] / "docs" / "simulated.md").read_text("utf-8")
    section = page.split("\n## Names of rclpy")[1].split("\n## ")[0]
    listed = set(re.findall(r"`(rclpy\.[\w.]+)`", section))
    missing = {name for name in names if not _is_in_kit(name)}
    assert {name for name in missing if not _with_owners(name) & listed} == set()
    assert listed - missing == set()


def _with_owners(name: str) -> set[str]:
    """Return a dotted name with the names of its class and modules."""
    parts = name.split(".")
    return {".".join(parts[:count]) for count in range(1, len(parts) + 1)}


def _is_in_kit(name: str) -> bool:
    """Return whether a dotted name is a module of the kit's rclpy or an attribute of one."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            drawable: object = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for part in parts[count:]:
            if not hasattr(drawable, part):
                return False
            drawable = getattr(drawable, part)
        return True
    return False


def _frozen_list(file: str) -> Any:
    outcomes = json.loads((HERE / "frozen" / f"{file}.json").read_text("utf-8"))["outcomes"]
    return ast.literal_eval(outcomes[file])


def _find(name: str, *default: object) -> Any:
    """Return the attribute of the kit with a dotted name, in which a class may come last but one."""
    owner, _, attribute = name.rpartition(".")
    try:
        return getattr(importlib.import_module(owner), attribute, *default)
    except ModuleNotFoundError:
        return getattr(_find(owner, *default), attribute, *default)


def test_parameters_of_public_callables_agree_with_rclpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(HERE / "probes")
    parameters = importlib.import_module("signatures").parameters
    found = {name: text for name, text in _frozen_list("signatures").items() if _is_in_kit(name)}
    assert len(found) > 400
    kits = {name: parameters(_find(name)) for name in found}
    different = {name for name, text in found.items() if kits[name] != text}
    assert {name: (found[name], kits[name]) for name in different - differences.SIGNATURES.keys()} == {}
    assert differences.SIGNATURES.keys() - different == set()


LAUNCH = json.loads((HERE / "frozen" / "launch_signatures.json").read_text("utf-8"))["outcomes"]


def test_public_names_of_launch_and_tf2_ros_missing_in_the_kit_are_listed() -> None:
    page = (HERE.parents[1] / "docs" / "simulated.md").read_text("utf-8")
    section = page.split("\n## Names of rclpy")[1].split("\n## ")[0]
    listed = set(re.findall(r"`((?:launch|launch_ros|tf2_ros)\.[\w.]+)`", section))
    everywhere = set(re.findall(r"`(\w+)`", section.partition("|")[0]))
    missing = {name for name in LAUNCH if _find(name, None) is None}
    named = {name for name in missing if name.rpartition(".")[2] not in everywhere}
    assert {name for name in named if not _with_owners(name) & listed} == set()
    assert {name for name in listed if _find(name, None) is not None} == set()


def test_parameters_of_public_callables_of_launch_and_tf2_ros_agree_with_ros(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(HERE / "probes")
    parameters = importlib.import_module("signatures").parameters
    found = {name: value for name in LAUNCH if (value := _find(name, None)) is not None}
    assert len(found) > 200
    different = {}
    for name, value in found.items():
        ros, kit = LAUNCH[name], parameters(value) or ""
        of_ros, of_kit = ({one for one in text.split(", ") if one and one[:2] != "**"} for text in (ros, kit))
        # Either side may collect options of base classes in **kwargs that the other one lists.
        unlike = [one for one in of_ros - of_kit if not (one.startswith("keyword") and "**" in kit)]
        unlike += [one for one in of_kit - of_ros if not (one.startswith("keyword") and "**" in ros)]
        if unlike:
            different[name] = sorted(unlike)
    assert different == differences.LAUNCH_SIGNATURES


def test_names_that_only_the_kit_has_are_listed() -> None:
    page = (HERE.parents[1] / "docs" / "simulated.md").read_text("utf-8")
    row = next(line for line in page.splitlines() if line.startswith("| Names that only the kit has |"))
    names = set(_frozen_list("modules"))
    extra = set()
    for path in ("rclpy", "rclpy.action", "rclpy.lifecycle", "rclpy.exceptions"):
        module = importlib.import_module(path)
        origins = {name: str(getattr(value, "__module__", "")) for name, value in vars(module).items()}
        own = "rclpy" if hasattr(module, "__path__") else path
        extra |= {f"{path}.{name}" for name, origin in origins.items() if origin.startswith(own)}
    owners = {name.rpartition(".")[0] for name in names if name.count(".") > 2}
    classes = {name: _find(name) for name in owners & names if _is_in_kit(name)}
    for path, value in classes.items():
        if inspect.isclass(value) and not issubclass(value, BaseException | Enum):
            extra |= {f"{path}.{name}" for name in dir(value) if callable(getattr(value, name))}
    waitables = {name.rpartition(".")[2] for name in names if name.startswith("rclpy.waitable.Waitable.")}
    attributes = {name: name.rpartition(".")[2] for name in extra - names}
    public = {name for name, last in attributes.items() if last[0] != "_" and last not in waitables}
    assert public == set(re.findall(r"`(rclpy\.[\w.]+)`", row))


def test_node_has_no_public_name_missing_in_rclpy() -> None:
    for kind in ("Node", "LifecycleNode", "SingleThreadedExecutor", "MultiThreadedExecutor", "Future"):
        public = [name for name in kits()[kind] if not name.startswith("_")]
        assert sorted(set(public) - set(frozen()[kind])) == [], kind


PROGRAM = """
import rclpy
import rclpy.node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

rclpy.init()

def nothing(*_, **__):
    raise SystemExit("the stand-in called a method of the student's")

class Talker(rclpy.node.Node):
    def __init__(self, name):
        super().__init__("talker")
        setattr(self, name, self.create_service(SetBool, "a", print))
        self.use()

    def use(self):
        self.create_service(Trigger, "b", print)
        self.create_client(Trigger, "b")
        self.declare_parameter("speed", 1.0)
        self.set_parameters([rclpy.Parameter("speed", value=2.0)])
        publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", lambda msg: heard.append(msg.data), 10)
        self.create_timer(0.1, lambda: None)
        self.count_publishers("chatter")
        publisher.publish(String(data="hello"))
        rclpy.spin_once(self, timeout_sec=1.0)
        self.destroy_node()

for name in {names}:
    heard = []
    Talker(name)
    kind = type("Speaker", (Talker,), {{name: nothing, "__init__": lambda self: (
        rclpy.node.Node.__init__(self, "speaker"), self.use())[0]}})
    kind()
print("all")
"""


def _run(program: str, tmp_path: Path, *more: str) -> subprocess.CompletedProcess[str]:
    file = tmp_path / "program.py"
    file.write_text(program)
    return run_course("run", file, *more)


@pytest.mark.slow
@pytest.mark.parametrize("names", [EVERYDAY], ids=["everyday"])
def test_attributes_and_methods_of_a_student_node_do_not_break_it(
    names: Iterable[str], tmp_path: Path
) -> None:
    done = _run(PROGRAM.format(names=list(names)), tmp_path)
    assert (done.stdout, done.returncode) == ("all\n", 0), done.stderr


ASSIGNS = """
import rclpy
import rclpy.node
from std_msgs.msg import String

class Talker(rclpy.node.Node):
    def __init__(self):
        super().__init__("talker")
        self.{name} = {{}}
        self.create_publisher(String, "chatter", 10)

rclpy.init()
Talker()
Talker()
print("made")
"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["_publishers", "_timers", "_services", "_parameters", "_context"])
def test_assigning_a_private_name_of_rclpy_gives_one_notice_with_its_line(name: str, tmp_path: Path) -> None:
    lines = _run(ASSIGNS.format(name=name), tmp_path).stdout.splitlines()
    assert [lines[0].count(f"hint: Talker.{name} (program.py, line 9: self.{name}"), lines[1:]] == [
        1,
        ["made"],
    ]
    assert "breaks the node on a robot" in lines[0]


HARMLESS = """
import rclpy
import rclpy.node

class Talker(rclpy.node.Node):
    def __init__(self):
        super().__init__("talker")
        self._logger = self.get_logger()
        self._clock = self.get_clock()
        self._my_publishers = [self._context, self._parameters, self._publishers]
        self.create_timer(0.1, lambda: None)

rclpy.init()
rclpy.spin_once(Talker(), timeout_sec=0.0)
print("made", hasattr(Talker, "_parameter_service"), Talker._clock is not None)
"""


@pytest.mark.slow
def test_equal_values_of_private_rclpy_names_give_no_notice(tmp_path: Path) -> None:
    done = _run(HARMLESS, tmp_path)
    assert (done.stdout, done.stderr) == ("made False True\n", "")


OVERRIDES = """
import rclpy
import rclpy.node
from rclpy.lifecycle import LifecycleNode

class Talker(rclpy.node.Node):
    _timers = []

    def _apply_descriptor(self):
        pass

class Managed(LifecycleNode):
    def _state_machine(self):
        pass
"""


@pytest.mark.slow
def test_overriding_a_private_name_of_rclpy_gives_a_notice(tmp_path: Path) -> None:
    lines = _run(OVERRIDES, tmp_path).stdout.splitlines()
    assert [line.split()[1] for line in lines] == [
        "Talker._apply_descriptor",
        "Talker._timers",
        "Managed._state_machine",
    ]


OWN_EXECUTOR = """
import rclpy
from rclpy.executors import SingleThreadedExecutor

class Counting(SingleThreadedExecutor):
    def __init__(self):
        super().__init__()
        self._guard = 0

    def _take_timer(self, timer):
        pass

rclpy.init()
Counting()
print("made")
"""


@pytest.mark.slow
def test_private_names_of_the_rclpy_executor_give_a_notice(tmp_path: Path) -> None:
    lines = _run(OWN_EXECUTOR, tmp_path).stdout.splitlines()
    assert [line.split()[1] for line in lines[:-1]] == ["Counting._take_timer", "Counting._guard"]
    assert all("rclpy's own Executor" in line and "breaks the executor" in line for line in lines[:-1])
    assert lines[-1] == "made"
