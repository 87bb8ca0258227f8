"""Files and folders whose writer is killed, or whose disk is full."""

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from course_lib import files
from course_lib.files import draft_folder, write_atomically
from tests.patience import PATIENCE

_KILL = "\nimport os, signal\nos.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)\n"
_FILE = f"from course_lib.files import write_atomically{_KILL}write_atomically(path, b'half')"
_FOLDER = f"from course_lib.files import draft_folder{_KILL}with draft_folder(path): os.fsync(0)"


def write_file(path: Path) -> None:
    write_atomically(path, b"new")


def write_folder(path: Path) -> None:
    with draft_folder(path) as draft:
        (draft / "new").mkdir()
        if path.exists():
            path.rename(draft / "old")
        (draft / "new").rename(path)


@pytest.fixture(autouse=True)
def sweep_each_folder_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.files._swept", set[Path]())


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no named pipes as files")
def test_special_file_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    for name in ("pipe", "link"):
        with pytest.raises(OSError, match="Not a regular file"):
            write_atomically(tmp_path / name, b"new")
    assert (tmp_path / "pipe").is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link", "pipe"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows ends programs without signals")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_draft_folder_is_deleted_when_its_program_is_ended(name: str, tmp_path: Path) -> None:
    code = (
        "import os, signal\nfrom pathlib import Path\nfrom course_lib.files import draft_folder\n"
        "with draft_folder(Path('new/target')) as draft:\n"
        "    (draft / 'part').write_text('x')\n"
        f"    os.kill(os.getpid(), signal.{name})\n"
        "    print('not reached')\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (128 + getattr(signal, name), "", "")
    assert list(tmp_path.iterdir()) == []


def test_draft_folder_leaves_handled_signals_and_threads_alone(tmp_path: Path) -> None:
    handled: list[int] = []
    previous = signal.signal(signal.SIGTERM, lambda number, _: handled.append(number))
    try:
        with draft_folder(tmp_path / "target"):
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGTERM, previous)
    assert handled == [signal.SIGTERM]
    with ThreadPoolExecutor(1) as pool:
        pool.submit(write_folder, tmp_path / "in_thread").result(PATIENCE)
    assert (tmp_path / "in_thread").is_dir()


@pytest.mark.parametrize(("code", "write"), [(_FILE, write_file), (_FOLDER, write_folder)])
def test_draft_of_a_killed_program_is_removed_by_a_later_write(
    code: str, write: Callable[[Path], None], tmp_path: Path
) -> None:
    target = tmp_path / "target"
    write(target)
    command = [sys.executable, "-c", f"from pathlib import Path\npath = Path('target')\n{code}"]
    killed = subprocess.run(command, cwd=tmp_path, timeout=PATIENCE)
    assert killed.returncode == -signal.SIGKILL
    (draft,) = (path for path in tmp_path.iterdir() if path.name != "target")
    assert draft.name.startswith(".target.")

    # Another program may still write a recent draft.
    write(tmp_path / "recent")
    assert draft.exists()

    os.utime(draft, (0, 0))
    files._swept.clear()
    write(target)
    assert {path.name for path in tmp_path.iterdir()} == {"target", "recent"}


def test_draft_of_a_missing_target_and_other_hidden_files_are_kept(tmp_path: Path) -> None:
    for name in (".lost.a_1.draft", ".target.2024", ".draft", "notes.draft"):
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (0, 0))
    write_file(tmp_path / "target")
    assert len(list(tmp_path.iterdir())) == 5


def test_full_disk_leaves_no_folder_and_is_reported_with_the_target(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space left") as refusal, draft_folder(tmp_path / "a" / "b" / "c"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert refusal.value.filename == str(tmp_path / "a" / "b" / "c")
    assert not any(tmp_path.iterdir())
