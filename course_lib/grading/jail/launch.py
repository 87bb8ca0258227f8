"""The grader's end of the template: start it inside as many isolation layers as this machine supports.

A place is the environment in which submissions run: a root with readable files, a user, and a
scratch folder. Readable are the interpreter, the declared distributions and the kit.
"""

import atexit
import glob
import json
import os
import shutil
import site
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal

import course_lib
from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.jail import filters
from course_lib.grading.jail.filters import Excess, Usage
from course_lib.third_party import read_json

DISTRIBUTION = "course-lib"
CACHE = "__pycache__"
KIT = os.path.dirname(os.path.realpath(course_lib.__file__))
HANDED_OUT = os.path.join(KIT, "_course")  # lessons, exercises and their checks in an installed wheel
PACKAGE_FOLDERS = ("site-packages", "dist-packages")  # only declared distributions in these are readable
# Files that programs need on every machine: shared libraries, fonts, time zones.
SYSTEM = (
    "/etc/ld.so.cache", "/etc/alternatives", "/etc/localtime", "/etc/fonts",
    "/usr/share/fonts", "/usr/local/share/fonts", "/usr/share/fontconfig", "/usr/share/zoneinfo",
    "/usr/lib/locale", "/lib64", "/usr/lib64", "/lib/*-linux-*", "/usr/lib/*-linux-*",
    "/lib/*.so*", "/usr/lib/*.so*", "/usr/local/lib/*.so*",
)  # fmt: skip


def distribution_files() -> Iterator[str]:
    """Yield the top-level files and folders of each declared distribution, without its scripts.

    Raises:
        CourseError: The kit itself is not installed.
    """
    for package in _declared_distributions():
        folder = Path(str(package.locate_file("")))
        # importlib.metadata has no public attribute for the folder of the metadata.
        metadata_folder = Path(str(getattr(package, "_path", ""))).name
        # The top-level names in RECORD, and the full paths in a shared `__pycache__`.
        names = {metadata_folder}
        for line in (package.read_text("RECORD") or "").splitlines():
            path = line.strip('"').split(",", 1)[0]
            first = path.split("/", 1)[0]
            if first not in ("", "..") and not path.startswith("/"):
                names.add(path if first == CACHE else first)
        # The distribution has no RECORD, or was installed with -e.
        if not names - {metadata_folder} - {name for name in names if name.endswith(".pth")}:
            names |= set((package.read_text("top_level.txt") or "").split())
            spec = find_spec(package.metadata["Name"].replace("-", "_"))
            if spec is not None:
                yield from spec.submodule_search_locations or filter(None, [spec.origin])
        for name in names:
            yield str(folder / name)
            # top_level.txt lists modules without their suffix.
            yield str(folder / f"{name}.py")


def _declared_distributions() -> Iterator[Distribution]:
    """Yield the kit's distribution and its recursive requirements; missing ones are skipped."""
    from packaging.requirements import Requirement

    visited, waiting = set[tuple[str, frozenset[str]]](), [Requirement(DISTRIBUTION)]
    while waiting:
        need = waiting.pop()
        identity = (need.name.lower(), frozenset(need.extras))
        if identity in visited:
            continue
        visited.add(identity)
        try:
            package = distribution(need.name)
        except PackageNotFoundError as error:
            if need.name == DISTRIBUTION:
                problem = (
                    f"{DISTRIBUTION} is not installed for {sys.executable}. In its checkout: pip install -e ."
                )
                raise CourseError(problem) from error
            continue
        yield package
        extras = need.extras or {""}
        # Parsing the whole file, with its long description, is slow.
        head, _, _ = (package.read_text("METADATA") or "").partition("\n\n")
        key = "Requires-Dist:"
        lines = [line.removeprefix(key).strip() for line in head.splitlines() if line.startswith(key)]
        waiting += [
            more for more in map(Requirement, lines if head else package.requires or ())
            if more.marker is None or any(more.marker.evaluate({"extra": extra}) for extra in extras)
        ]  # fmt: skip


@dataclass(frozen=True)
class ReadablePaths:
    """Files and folders that a submission may read. None of them contains a forbidden path.

    Args:
        paths: Real paths of files, and of folders with everything in them.
        links: Symbolic links on the way to them, with their targets.
        listed: Folders that may be listed, as the import system does.
        conflict: A path of the course inside a folder that is needed, or "".
    """

    paths: tuple[str, ...]
    links: tuple[tuple[str, str], ...] = ()
    listed: tuple[str, ...] = ()
    conflict: str = ""


@cache
def find_readable_paths(forbidden_paths: tuple[str, ...] = ()) -> ReadablePaths:
    """Return the files that submissions may read on this machine.

    Args:
        forbidden_paths: Paths of the course that must stay hidden, even inside needed folders.

    Raises:
        CourseError: A needed path is itself forbidden.
    """
    folders, needed_paths = _needed_files()
    return select_readable(needed_paths, folders, forbidden_paths)


@cache
def _needed_files() -> tuple[list[str], list[str]]:
    """Return the module search path, and all needed files and folders, including forbidden ones."""
    files = [path for pattern in SYSTEM for path in glob.iglob(pattern)]
    # Only Linux has this file.
    with suppress(OSError):
        mapped = Path("/proc/self/maps").read_text(errors="surrogateescape").splitlines()
        files += [line[line.index("/") :] for line in mapped if "/" in line and ".so" in line]
    files += [sys.executable, os.path.join(sys.prefix, "pyvenv.cfg")]
    for prefix in {sys.prefix, sys.base_prefix, sys.base_exec_prefix}:
        files += glob.iglob(os.path.join(glob.escape(prefix), "lib", "*.so*"))
    search_path = [*site.getsitepackages(), site.getusersitepackages(), *sys.path]
    package_folders = [
        path for path in search_path if os.path.basename(path) in ("lib-dynload", *PACKAGE_FOLDERS)
    ]
    folders = list(filter(os.path.isdir, dict.fromkeys([os.path.dirname(os.__file__), *package_folders])))
    return folders, [*files, *folders, *distribution_files(), KIT]


def select_readable(
    needed_paths: Iterable[str], folders: Collection[str], forbidden_paths: Collection[str]
) -> ReadablePaths:
    """Return the readable subset of the needed files and folders.

    Args:
        needed_paths: Files and folders that are needed completely, except for forbidden paths.
        folders: The module search path. Of folders with packages, only needed packages are
            readable.
        forbidden_paths: Paths of the course.

    Raises:
        CourseError: A needed path is itself forbidden.
    """
    existing = [path for path in dict.fromkeys(needed_paths) if os.path.exists(path)]
    real_paths = map(os.path.realpath, forbidden_paths)
    course = [path for path in real_paths if not _contains(HANDED_OUT, path)]
    # Folders with packages that the kit may not need, including folders of other interpreters.
    shared = [path for path in folders if os.path.basename(path) in PACKAGE_FOLDERS]
    shared += [os.path.join(folder, name) for folder in folders for name in PACKAGE_FOLDERS]
    shared += glob.glob("/usr/lib*/python*/*-packages")
    shared = list(map(os.path.realpath, shared))
    handed_out = [HANDED_OUT] * os.path.exists(HANDED_OUT)
    paths, conflict = set[str](), ""
    for path in map(os.path.realpath, existing):
        if path in course:
            raise CourseError(f"submissions must not read {path}, but Python needs it to run them: move it")
        conflict = next(
            (place for place in course if _contains(path, place) and path not in shared), conflict
        )
        is_package = any(_contains(folder, path) and folder != path for folder in shared)
        paths.update(_exclude(path, [*course, *handed_out, *([] if is_package else shared)]))
    looked_in = map(os.path.realpath, [*folders, KIT])
    listed_folders = [path for path in looked_in if not any(_contains(path, place) for place in course)]
    links = dict(link for path in existing for link in symlinks_along(path))
    # These are the links, not their targets.
    links |= {path: os.readlink(path) for path in paths if os.path.islink(path)}
    outermost: list[str] = []
    for path in sorted(paths - links.keys(), key=lambda path: path.split("/")):
        if not (outermost and _contains(outermost[-1], path)):
            outermost.append(path)
    return ReadablePaths(tuple(outermost), tuple(links.items()), tuple(listed_folders), conflict)


def symlinks_along(path: str) -> Iterator[tuple[str, str]]:
    """Yield the symbolic links on the way to an existing path, with their targets."""
    prefix, components = "/", path.split("/")
    while components:
        name = components.pop(0)
        prefix = os.path.normpath(os.path.join(prefix, name))
        if os.path.islink(prefix):
            target = os.readlink(prefix)
            yield prefix, target
            prefix, components = os.path.dirname(prefix), [*target.split("/"), *components]
            prefix = "/" if target.startswith("/") else prefix


def _contains(folder: str, path: str) -> bool:
    return path == folder or path.startswith(folder.rstrip("/") + "/")


def _exclude(path: str, forbidden_paths: Collection[str]) -> list[str]:
    """Return the path or, if it contains forbidden paths, the remaining entries around them."""
    if path in forbidden_paths:
        return []
    if not any(_contains(path, other) for other in forbidden_paths):
        return [path]
    return [
        remaining_path
        for name in os.listdir(path)
        for remaining_path in _exclude(os.path.join(path, name), forbidden_paths)
    ]


Root = Literal["own", "bubblewrap", "host"]
User = Literal["another", "real", "same"]
INSIDE = "/submission/home"  # the scratch folder in a separate root
HOMES = ("HOME", "TMPDIR", "IPYTHONDIR", "MPLCONFIGDIR")
# Not /dev/zero: memory that is mapped from it belongs to no process, so no limit would count it.
DEVICES = ("/dev/null", "/dev/urandom", "/dev/random")
# The range of systemd's temporary service users, which own no files.
FIRST_USER, USERS = 61184, 4336


@dataclass(frozen=True)
class JailEnvironment:
    """The root, the user and the folders of submissions.

    Args:
        root: A new root, bubblewrap's root, or the machine's root.
        user: A user without files ("another"); the same user with another real user id ("real"); or
            the same user.
        number: The user id, if it is another user.
        scratch: The folder that submissions may write to.
        read: Files and folders that submissions may read.
        listed: Folders that submissions may list.
    """

    root: Root
    user: User
    number: int
    scratch: str
    read: tuple[str, ...]
    listed: tuple[str, ...] = ()


def settle(
    roots: Collection[Root], users: Sequence[User], scratch: str, read: Sequence[str], listed: Sequence[str],
    links: Sequence[tuple[str, str]],
) -> JailEnvironment:  # fmt: skip
    """Switch this process to the first root folder and user that work.

    Each pair is tried in a forked process.

    Args:
        roots: Acceptable roots, the best first.
        users: Acceptable users, the best first.
        scratch: An empty folder, which is removed if the root has its own.
        read: Files and folders that submissions may read.
        listed: Folders that submissions may list.
        links: Symbolic links that a new root needs.

    Raises:
        OSError: No place works.
    """
    number = FIRST_USER + os.getpid() % USERS
    for root in roots:
        for user in users:
            has_own = root == "own"
            # A separate root contains only readable files.
            tops = sorted({"/" + path.split("/")[1] for path in read})
            folder, visible_paths = (INSIDE, tops) if has_own else (scratch, read)
            place = JailEnvironment(root, user, number, folder, tuple(visible_paths), tuple(listed))
            if is_usable(lambda place=place: _try(place, read, links)):  # type: ignore[misc]
                if has_own:
                    os.rmdir(scratch)
                _move(place, read, links)
                os.environ.update(dict.fromkeys(HOMES, place.scratch))
                return place
    raise OSError("no jail environment can be set up")


def is_usable(layer: Callable[[], object]) -> bool:
    """Return whether a call succeeds in a fork. If the fork is killed, the call is repeated.

    The call may fork itself.
    """
    return (_try_in_fork(layer) or _try_in_fork(layer)) == b"y"


def _try_in_fork(layer: Callable[[], object]) -> bytes:
    """Return b"y" if a call succeeds in a fork of this process, b"n" if it fails, b"" if it is killed."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        with suppress(BaseException):
            layer()
            os.write(writer, b"y")
            os._exit(0)
        os.write(writer, b"n")
        os._exit(0)
    os.close(writer)
    # A fork of the fork may have written it.
    answer = os.read(reader, 1)
    os.close(reader)
    os.waitpid(pid, 0)
    return answer


def _move(place: JailEnvironment, read: Sequence[str], links: Sequence[tuple[str, str]]) -> None:
    if place.root == "host":
        # The owner of files that submissions write.
        os.chown(place.scratch, place.number if place.user == "another" else os.geteuid(), -1)
    user = place.number
    if place.user == "real":
        # The owner of new files is unchanged, but the kernel counts processes of the real user.
        os.setresuid(user, -1, -1)
    elif place.user == "another":
        # Building the root requires the capabilities that the change of user takes away.
        filters.prctl(filters.KEEP_CAPABILITIES, 1)
        os.setgroups([])
        os.setresgid(user, user, user)
        os.setresuid(user, user, user)
        filters.use_capabilities()
    if place.root == "own":
        visible_paths = [*read, *filter(os.path.exists, DEVICES)]
        filters.enter_root(visible_paths, place.listed, links, place.scratch)


def _try(place: JailEnvironment, read: Sequence[str], links: Sequence[tuple[str, str]]) -> None:
    _move(place, read, links)
    if place.user != "same":
        filters.drop_capabilities()
        unreadable = [path for path in read if not os.access(path, os.R_OK, effective_ids=True)]
        if unreadable:
            raise OSError(f"another user can't read {unreadable[0]}")


START_SECONDS = 60.0  # [s] timeout of the template's imports on a busy machine
STOP_SECONDS = 60.0  # [s] timeout for killing a submission and its processes
SIGNALLED = 128  # bubblewrap's exit status for a process killed by a signal, minus the signal number
PIPE_HOLDS = 2**20  # [B] pipe size for a submission's output
BUBBLEWRAP = (
    "--die-with-parent --new-session --unshare-pid --unshare-net --unshare-ipc --unshare-uts "
    "--proc /proc --dev /dev"
)
# Where Landlock does not work, a submission could otherwise leave files, or modules on the path of
# Python, that the next one finds. Only the scratch folder is emptied.
READ_ONLY = "--remount-ro /dev --remount-ro /"
# The template of root lists the open files of processes with another real user id.
BECOME_ANOTHER = "--cap-drop ALL --cap-add CAP_SETUID --cap-add CAP_SETGID --cap-add CAP_SYS_PTRACE"
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class WorkerError(CourseError):
    """Raised if no worker starts, because of the kit or the machine, never the student."""


class KilledStartError(WorkerError):
    """Raised if a worker was killed during its start, so that starting again may succeed."""


class TemplateProcess:
    """A template process, started inside the most isolation layers with which it works.

    Args:
        off: Layers to disable, for tests of the remaining ones.
        forbidden_paths: Paths of the course that submissions must not be able to read.

    Raises:
        WorkerError: The template does not start.
        KilledStartError: It was killed during its start.
        CourseError: A forbidden path can't be hidden from submissions on this machine.
    """

    def __init__(self, off: Collection[str] = (), forbidden_paths: tuple[str, ...] = ()) -> None:
        if not hasattr(os, "fork"):
            raise WorkerError("grading needs Linux, macOS or WSL2, because this system can't fork processes")
        files = find_readable_paths(forbidden_paths)
        can_change_user = os.geteuid() == 0 and "process limit" not in off
        users = ["another", "real", "same"] if can_change_user else ["same"]
        output = ""
        for bubblewrap, roots in _attempts(off):
            scratch = INSIDE if bubblewrap else tempfile.mkdtemp(prefix="course_worker_")
            # The arguments of `settle`.
            place = {
                "users": users,
                "read": files.paths,
                "listed": files.listed,
                "links": files.links,
                "roots": roots,
                "scratch": scratch,
            }
            self._control, child_end = socket.socketpair()
            with child_end:
                self._process = _start(child_end, place, bubblewrap, files, off)
            self._control.settimeout(START_SECONDS)
            answer = self._control.recv(2**16)
            if answer:
                self.isolation = filters.Isolation(tuple(read_json(answer)))
                break
            output = self._process.communicate()[0].decode("utf-8", "replace")
            self._control.close()
            if not bubblewrap:
                shutil.rmtree(scratch, ignore_errors=True)
            if not 0 <= self._process.returncode < SIGNALLED:
                why = f"a worker was killed while it started: {output.strip()[-500:]}"
                raise KilledStartError(why.rstrip(": "))
        else:
            raise WorkerError(
                "no process for submissions can be started on this machine. Free memory and disk "
                f"space, or grade on another machine. The last output: {output.strip()[-500:]}"
            )
        if files.conflict and self.isolation.is_protective and not self.isolation.hides_names:
            self.close()
            raise CourseError(
                f"{files.conflict} is in a folder that Python needs in the jail, and this machine "
                f"has only: {self.isolation}. Move it to another folder, or grade on a machine "
                "with namespaces"
            )

    def start(self, limits: Limits, imports: Collection[str]) -> tuple[socket.socket, int]:
        """Start a submission on the processors of the calling thread.

        Args:
            limits: The resource limits.
            imports: Modules that the cells will import, to be imported in advance.

        Returns:
            The grader's ends of the channel and of the output pipe.
        """
        own_end, child_end = socket.socketpair()
        reader, writer = os.pipe()
        if sys.platform == "linux":
            import fcntl

            # A small pipe is only slower.
            with suppress(OSError):
                fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, PIPE_HOLDS)
        with child_end:
            request = {"limits": asdict(limits), "imports": list(imports), "processors": processors()}
            socket.send_fds(self._control, [json.dumps(request).encode()], [child_end.fileno(), writer])
        os.close(writer)
        return own_end, reader

    @property
    def pid(self) -> int:
        """The id of the process whose descendants are the submissions."""
        return self._process.pid

    @property
    def is_sound(self) -> bool:
        """True unless the template was killed."""
        return self._process.poll() in (None, 0)

    def stop(self) -> tuple[Usage, Excess | None]:
        """Kill the submission with all its processes.

        Returns:
            Its usage, and the limit for which the template had killed it before, if any.
        """
        try:
            self._control.settimeout(STOP_SECONDS)
            self._control.send(b"stop")
            report = read_json(self._control.recv(2**12))
            excess = Excess(**report["excess"]) if report["excess"] else None
            return Usage(**report["usage"]), excess
        except (OSError, ValueError):
            # No answer or half an answer means that the template was killed.
            self.close()
            return Usage(), None

    def close(self) -> None:
        """End the template."""
        self._control.close()
        try:
            self._process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        for files in [files for files, template in _shared.items() if template is self]:
            del _shared[files]


def processors() -> list[int]:
    """Return the processors that the calling thread may run on, or [] if they are unknown."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


_shared: dict[ReadablePaths, TemplateProcess] = {}


def shared_template(forbidden_paths: tuple[str, ...] = ()) -> TemplateProcess:
    """Return this process's template that hides these paths; it is started on first use.

    Courses that lie outside everything that Python needs share a template, because their
    submissions may read the same files.
    """
    files = find_readable_paths(forbidden_paths)
    if files not in _shared:
        _shared[files] = TemplateProcess(forbidden_paths=forbidden_paths)
        atexit.register(_shared[files].close)
    return _shared[files]


def _attempts(off: Collection[str]) -> list[tuple[str, list[str]]]:
    """Return (path of bubblewrap or "", acceptable roots) for each start attempt, the most isolated first."""
    bubblewrap = shutil.which("bwrap") or "" if "bubblewrap" not in off else ""
    own_root = ["own"] if "namespaces" not in off else []
    if not bubblewrap:
        return [("", [*own_root, "host"])]
    return [*([("", own_root)] if own_root else []), (bubblewrap, ["bubblewrap"]), ("", ["host"])]


def _start(
    control: socket.socket,
    place: dict[str, Any],
    bubblewrap: str,
    files: ReadablePaths,
    off: Collection[str],
) -> "subprocess.Popen[bytes]":
    environment = {
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "MPLBACKEND": "Agg",
        "PYTHONHASHSEED": "0",
        "PYTHONPATH": os.path.dirname(KIT),  # the kit's checkout, not an installed copy
        # The kit may be installed there, and HOME is not the user's home in the jail.
        "PYTHONUSERBASE": site.getuserbase(),
    }
    settings = {"control": control.fileno(), "off": list(off), "place": place}
    command = [sys.executable, "-P", "-m", "course_lib.grading.jail.template", json.dumps(settings)]
    homes = dict.fromkeys(HOMES, place["scratch"])
    if bubblewrap:
        links = [word for link, target in files.links for word in ("--symlink", target, link)]
        binds = [word for path in files.paths for word in ("--ro-bind", path, path)]
        scratch = ["--perms", "0777", "--tmpfs", INSIDE]
        identity_options = BECOME_ANOTHER.split() if os.geteuid() == 0 else []
        options = [*BUBBLEWRAP.split(), *links, *binds, *scratch, *READ_ONLY.split(), *identity_options]
        command = [bubblewrap, *options, "--", *command]
    return subprocess.Popen(
        command,
        env={**environment, **homes, **THREADS},
        cwd="/",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        pass_fds=[control.fileno()],
        start_new_session=True,
    )
