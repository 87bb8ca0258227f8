"""The jail with all of its layers, and with the remaining layers where some do not work."""

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.jail import filters, launch
from course_lib.grading.jail.filters import LAYERS, Isolation
from course_lib.grading.jail.launch import (
    KilledStartError,
    TemplateProcess,
    WorkerError,
    is_usable,
    shared_template,
)
from course_lib.grading.run.run import Job, Step, prepare, run
from course_lib.grading.run.submission_run import SubmissionRun
from course_lib.grading.task import Scenario, Task

ANSWER = Task("week01.answer", "An answer", "value", "answer", ("a", "b", "c"), (Scenario("public"),))
ATTACKS = {
    "a file of the user": "open({file!r}).read()",
    "the listing of a folder": "os.listdir({folder!r})",
    "whether a file is there": "os.stat({file!r})",
    "a socket": "socket.socket()",
    "a connection": "socket.create_connection(('127.0.0.1', {port}), 1)",
    "another program": "os.execv('/bin/true', ['true'])",
    "a signal": "os.kill({pid}, 0)",
    "a datagram": "socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)",
    "a signal by a file": "fcntl.fcntl(0, fcntl.F_SETOWN, {pid})",
    "a file in a message": "socket.send_fds(socket.socketpair()[0], [b'x'], [0])",
    "hidden files": "libc.prctl(4, 0, 0, 0, 0) and 1 / 0",
    "a lease": "fcntl.fcntl(os.open('own', os.O_RDONLY), fcntl.F_SETLEASE, fcntl.F_RDLCK)",
    "a watched folder": "fcntl.fcntl(os.open('.', os.O_RDONLY), fcntl.F_NOTIFY, 0)",
    "uncounted processes": "signal.signal(signal.SIGCHLD, signal.SIG_IGN)",
    "the mode of a file": "[os.chmod('own', 0o700), os.stat('own').st_mode & 0o100 or 1 / 0]",
    "another user": "os.setresuid(0, 0, 0)",
    "memory in files": "libc.memfd_create(b'x', 0) >= 0 or 1 / 0",
    "much memory": "mmap.mmap(-1, 3 * 10**9)",
    "a large file": "open('f', 'wb').write(b'x' * 10**8)",
    "many processes": "[os.fork() or signal.pause() for _ in range(300)]",
}
PROGRAM = """
import ctypes, fcntl, mmap, os, signal, socket
libc = ctypes.CDLL(None)
open('own', 'w').close()
def works(line):
    pid = os.fork()
    if pid == 0:
        try:
            eval(line)
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitpid(pid, 0)[1] == 0
answer = [name for name, line in {attacks!r}.items() if works(line)]
"""
SEEN = {"whether a file is there"}
FILES = {"a file of the user", "the listing of a folder", *SEEN}
NETWORK = {"a socket", "a connection"}
CALLS = {
    "another program", "a datagram", "a signal by a file", "the mode of a file", "memory in files",
    "another user", "a file in a message", "hidden files", "uncounted processes",
    "a lease", "a watched folder",
}  # fmt: skip
BUBBLEWRAP = "bubblewrap"
OPEN = {  # disabled layers: remaining layers
    (): set[str](),
    (BUBBLEWRAP,): set[str](),
    (BUBBLEWRAP, "namespaces"): SEEN,
    (BUBBLEWRAP, "Landlock"): set[str](),
    (BUBBLEWRAP, "seccomp"): {"a socket", *CALLS},
    (BUBBLEWRAP, "namespaces", "Landlock"): FILES,
    ("namespaces",): set[str](),
    ("namespaces", "Landlock"): set[str](),
    ("namespaces", "seccomp"): {"a socket", *CALLS},
    LAYERS[:4]: {*FILES, *NETWORK, *CALLS, "a signal"},
    LAYERS: {*FILES, *NETWORK, *CALLS, "a signal", "much memory", "a large file", "many processes"},
}


@pytest.fixture
def places(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, object]]:
    import socket

    folder = tmp_path_factory.mktemp("mine")
    (folder / "file").write_text("secret")
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        yield {"file": str(folder / "file"), "folder": str(folder), "port": port, "pid": os.getpid()}


@pytest.mark.slow
@pytest.mark.sample(2)
@pytest.mark.parametrize("off", OPEN, ids=lambda off: "without " + " ".join(off) if off else "everything")
def test_disabled_isolation_layers_permit_only_the_expected_attacks(
    off: tuple[str, ...], places: dict[str, object]
) -> None:
    with closing(TemplateProcess(off)) as template:
        unused = {BUBBLEWRAP} if "namespaces" not in off else set[str]()
        if missing := set(LAYERS) - set(off) - set(template.isolation.layers) - unused:
            pytest.skip(f"no {missing} on this machine")
        attacks = {name: line.format(**places) for name, line in ATTACKS.items()}
        cells = [PROGRAM.format(attacks=attacks)]
        with closing(SubmissionRun(cells, {ANSWER.id: {}}, Limits(), template)) as session:
            evidence = session.run(ANSWER, ANSWER.scenarios[0])
        assert session.log.errors == []
        assert set(evidence.returns[0]) <= OPEN[off]
        assert template.isolation.is_protective == (not (FILES - SEEN) & OPEN[off])
        assert template.isolation.hides_names == (not SEEN & OPEN[off])


@pytest.fixture
def start_killed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kill the next template before it can report its layers."""
    start, killed = launch._start, list[int]()

    def start_and_kill(*settings: Any) -> "subprocess.Popen[bytes]":
        process = start(*settings)
        if not killed:
            process.kill()
            killed.append(process.pid)
        return process

    monkeypatch.setattr(launch, "_start", start_and_kill)


@pytest.mark.usefixtures("start_killed_once")
def test_killed_template_start_does_not_fall_back_to_fewer_layers() -> None:
    with pytest.raises(KilledStartError, match="killed while it started"):
        TemplateProcess()


@pytest.mark.slow
def test_killed_worker_start_is_retried_with_a_notice(request: pytest.FixtureRequest) -> None:
    shared_template().close()
    request.getfixturevalue("start_killed_once")
    assert prepare("any", ()) == ["Tried again: a worker was killed while it started"]


def test_second_killed_worker_start_ends_grading_with_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    def kill(*_: Any) -> None:
        raise KilledStartError("a worker was killed while it started")

    monkeypatch.setattr("course_lib.grading.run.run.shared_template", kill)
    with pytest.raises(WorkerError, match=r"started, 2 times\. .* --jobs 1\. Nothing is lost"):
        prepare("any", ())


def test_layer_with_one_killed_trial_is_tried_again(tmp_path: Path) -> None:
    def layer() -> None:
        if not (tmp_path / "tried").exists():
            (tmp_path / "tried").touch()
            os.kill(os.getpid(), signal.SIGKILL)

    assert is_usable(layer)


def test_layer_with_all_trials_killed_does_not_work() -> None:
    assert not is_usable(lambda: os.kill(os.getpid(), signal.SIGKILL))


@pytest.mark.slow
def test_killed_template_start_does_not_change_the_evidence(
    request: pytest.FixtureRequest,
) -> None:
    job = Job(("answer = 1",), None, (Step(ANSWER, ANSWER.scenarios[0]),), Limits())
    undisturbed = run(job).evidence
    shared_template().close()
    request.getfixturevalue("start_killed_once")
    assert run(job).evidence == undisturbed


@pytest.mark.slow
def test_courses_outside_the_python_paths_share_one_template_process(tmp_path: Path) -> None:
    one, other = (shared_template((str(tmp_path / name),)) for name in ("one", "other"))
    assert one is other


@pytest.mark.slow
def test_closing_one_template_process_keeps_the_shared_template() -> None:
    shared = shared_template()
    TemplateProcess((BUBBLEWRAP, "namespaces")).close()
    assert shared_template() is shared


@pytest.mark.slow
def test_deeply_nested_scratch_folders_are_removed() -> None:
    cells = ["import os\nfor _ in range(1200): os.mkdir('d'); os.chdir('d')\nanswer = 1"]
    with closing(TemplateProcess((BUBBLEWRAP, "namespaces"))) as template:
        with closing(SubmissionRun(cells, {ANSWER.id: {}}, Limits(), template)) as session:
            assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
        assert template.is_sound


@pytest.mark.slow
def test_total_size_of_scratch_files_is_limited() -> None:
    cells = ["for n in range(10**5): open(str(n), 'wb').write(bytes(10**6))", "answer = 1"]
    limits = Limits(scratch_megabytes=16)
    with closing(TemplateProcess((BUBBLEWRAP, "namespaces"))) as template:
        with closing(SubmissionRun(cells, {ANSWER.id: {}}, limits, template)) as session:
            assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
        assert session.log.limit == "size"


HOLD_DELETED_FILES = """
import mmap, os
kept = []
def delete(name):
    file = os.open(name, os.O_CREAT | os.O_RDWR)
    os.unlink(name)
    return file
def hold(number):
    if {way!r} == "unnamed":
        file = os.open(".", os.O_TMPFILE | os.O_RDWR)
    else:
        file = delete(f"f{{number}}")
    for _ in range(15):
        os.write(file, bytes(2**20))
    if {way!r} == "mapped":
        kept.append(mmap.mmap(file, 4096))
        os.close(file)
for number in range(60):
    hold(number)
    begin = os.times().elapsed
    while os.times().elapsed < begin + 0.05: pass
"""


@pytest.mark.slow
@pytest.mark.parametrize("way", ["open", "mapped", "unnamed"])
@pytest.mark.parametrize("off", [(BUBBLEWRAP, "namespaces"), ("namespaces", "Landlock")], ids=" ".join)
def test_total_size_of_deleted_files_is_limited(off: tuple[str, ...], way: str) -> None:
    cells = [HOLD_DELETED_FILES.format(way=way), "answer = 1"]
    with closing(TemplateProcess(off)) as template:
        session = SubmissionRun(cells, {ANSWER.id: {}}, Limits(scratch_megabytes=16), template)
        with closing(session):
            assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
    assert session.log.limit == "size"
    assert 32 < session.usage.files_megabytes < 160


LEAVE_FILES = """
import os
folders = ["/", "/dev", "/dev/shm", "/submission", "/submission/home", {modules!r}]
for folder in folders:
    try:
        with open(f"{{folder}}/left_behind.py", "w") as file:
            file.write("answer = 'left'")
    except OSError:
        pass
"""
FIND_FILES = """
import os
from importlib.util import find_spec
places = [folder for folder in folders if os.path.exists(f"{{folder}}/left_behind.py")]
answer = [*places, *[spec.origin for spec in [find_spec("left_behind")] if spec]]
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "off", [(), ("namespaces",), ("namespaces", "Landlock"), (BUBBLEWRAP, "Landlock")], ids=" ".join
)
def test_submission_finds_no_files_of_the_previous_one(off: tuple[str, ...]) -> None:
    leave = LEAVE_FILES.format(modules=os.path.dirname(launch.KIT))
    folders = leave.partition("for folder")[0]
    with closing(TemplateProcess(off)) as template:
        for cells in ([leave, "answer = []"], [folders + FIND_FILES.format()]):
            with closing(SubmissionRun(cells, {ANSWER.id: {}}, Limits(), template)) as session:
                evidence = session.run(ANSWER, ANSWER.scenarios[0])
            assert session.log.errors == []
            assert evidence.returns == ([],)


@pytest.mark.slow
def test_number_of_empty_scratch_files_is_limited() -> None:
    cells = ["for n in range(10**7): open(str(n), 'wb').close()", "answer = 1"]
    with closing(TemplateProcess((BUBBLEWRAP, "namespaces"))) as template:
        session = SubmissionRun(cells, {ANSWER.id: {}}, Limits(), template)
        with closing(session):
            assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
    assert session.log.stopped == {0: "cell 1 was stopped: it wrote more than 4096 files"}
    assert session.log.limit == "size"


@pytest.mark.slow
def test_memory_of_all_processes_is_limited_without_namespaces() -> None:
    fork = "import os, signal\nfor _ in range(20):\n    if os.fork() == 0:\n"
    cells = [f"{fork}        x = bytearray(b'x') * 10**8; signal.pause()\nsignal.pause()", "answer = 1"]
    with closing(TemplateProcess((BUBBLEWRAP, "namespaces"))) as template:
        session = SubmissionRun(cells, {ANSWER.id: {}}, Limits(memory_megabytes=400), template)
        with closing(session):
            assert session.run(ANSWER, ANSWER.scenarios[0]).returns == (1,)
    assert "processes together used" in session.log.stopped[0]
    assert session.log.limit == "memory"


@pytest.mark.parametrize(
    ("layers", "need", "refused"),
    [
        (LAYERS, "full", ""),
        (LAYERS[1:], "full", ""),
        (LAYERS[:1] + LAYERS[2:], "full", "--require-sandbox"),
        (LAYERS[2:], "partial", ""),
        (("limits",), "partial", "add --i-trust-these-submissions"),
        ((), "partial", "add --i-trust-these-submissions"),
        ((), "any", ""),
    ],
)
def test_insufficient_isolation_is_rejected_with_the_option_to_pass(
    layers: tuple[str, ...], need: str, refused: str
) -> None:
    isolation = Isolation(layers)
    if not refused:
        isolation.require(need)  # type: ignore[arg-type]  # one of the three
        return
    with pytest.raises(CourseError, match=refused):
        isolation.require(need)  # type: ignore[arg-type]


def test_missing_isolation_layers_are_listed() -> None:
    text = str(Isolation(("limits", "Landlock", "seccomp")))
    assert text == (
        "partial sandbox (has limits, Landlock, seccomp; lacks namespaces, process limit"
        "; file names are not hidden)"
    )
    assert str(Isolation()).startswith("no sandbox (lacks")


@pytest.mark.parametrize(("column", "machine"), filters.MACHINES.values(), ids=filters.MACHINES)
def test_every_jump_of_the_seccomp_filter_stays_inside_the_program(column: int, machine: int) -> None:
    code = filters.filter_program(column, machine)
    steps = [code[i : i + 8] for i in range(0, len(code), 8)]
    assert len(steps) < 4096  # maximum that the kernel accepts
    for index, step in enumerate(steps):
        if step[0] != filters.RETURN:
            assert index + 1 + max(step[2], step[3]) < len(steps)
