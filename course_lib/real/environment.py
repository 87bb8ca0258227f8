"""The environment of the real rclpy, created by `course ros --install`.

The wheels are not installed into the kit's own environment, because they would replace the `lark`
of JupyterLab, and they start every Python of their environment twice.
"""

import errno
import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from pathlib import Path

from course_lib.errors import CourseError

REQUIREMENTS = Path(__file__).parent / "requirements.txt"
# The variable that selects the Python of another environment.
PYTHON = "REAL_ROS_PYTHON"
# The newest Python with wheels.
NEWEST_PYTHON = (3, 14)
SIZE = "60 MB of downloads, 260 MB on the disk"
# Free space that an installation needs, including temporary files [B].
NEEDED_BYTES = 300 * 10**6
# Wheels that select the version of another wheel, or start Python twice.
WITHOUT_FOLDER = ("ros-jazzy-", "ros-wheels-")
INSTALL = "course ros --install"
_PIN = re.compile(r"^(ros-[\w-]+)==([\w.]+)$", re.MULTILINE)
_OTHER_FOLDER = "Set XDG_DATA_HOME to a folder that you may write"
_FULL_DISK = "a disk or your quota is full, where the files are installed or in TMPDIR. Remove files there"
# Advice for errors of venv and pip. The first pattern that matches one of their lines counts.
_CAUSES = tuple(
    (re.compile(pattern), advice)
    for pattern, advice in (
        *((re.escape(os.strerror(number)), _FULL_DISK) for number in (errno.ENOSPC, errno.EDQUOT)),
        *((re.escape(os.strerror(number)), _OTHER_FOLDER) for number in (errno.EACCES, errno.EROFS)),
        (
            "DO NOT MATCH THE HASHES",
            "a wheel was changed on its way, or pip's cache is damaged. Run `pip cache purge`",
        ),
        (
            "certificate verify failed",
            "your network replaces the certificate of the package index. Ask its administrators "
            "for their certificate, then run `pip config set global.cert FILE`",
        ),
        ("ProxyError", "your proxy rejects the connection. Check HTTPS_PROXY and `pip config list`"),
        (
            "connection broken by|timed out",
            "pip does not reach the package index. Check that this computer is online",
        ),
        (
            "No matching distribution found",
            "the package index does not have this wheel. If your network has a login page, log in "
            "with a browser. If `pip config list` shows another index, remove it",
        ),
    )
)
# Variables of a sourced ROS, or of the user's settings for DDS, which would change the programs'
# behavior.
REMOVED_VARIABLES = (
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    "AMENT_PREFIX_PATH",
    "CYCLONEDDS_URI",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "LD_LIBRARY_PATH",
    "PYTHONHOME",
    "PYTHONPATH",
    "RMW_IMPLEMENTATION",
    "ROS_DISCOVERY_SERVER",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
)


@dataclass(frozen=True)
class RealEnvironment:
    """An environment with the real rclpy."""

    python: Path

    @property
    def folder(self) -> Path:
        """The environment's folder."""
        return self.python.parent.parent

    @cached_property
    def _packages_folder(self) -> Path | None:
        return next(iter(sorted(self.folder.glob("lib/python3*/site-packages"))), None)

    @cached_property
    def versions(self) -> dict[str, str]:
        """The versions of the installed distributions by name."""
        if self._packages_folder is None:
            return {}
        packages = metadata.distributions(path=[str(self._packages_folder)])
        return {package.metadata["Name"].replace("_", "-"): package.version for package in packages}

    @cached_property
    def packages(self) -> list[str]:
        """The Python packages in the environment."""
        return [path.name for path in self._packages_folder.iterdir()] if self._packages_folder else []

    @property
    def incomplete_mark(self) -> Path:
        """The file next to the folder that exists while the folder is created or removed."""
        return self.folder.with_name(f"{self.folder.name}.incomplete")

    def problem(self) -> str:
        """Return the first pinned package that is missing, damaged or of another version, or ""."""
        if self.incomplete_mark.exists():
            return "its installation has not ended"
        for name, version in pins().items():
            installed = self.versions.get(name)
            if installed != version:
                return f"{name} {installed or 'is missing'}, expected {version}"
            folder = name.removeprefix("ros-").replace("-", "_")
            if not name.startswith(WITHOUT_FOLDER) and folder not in self.packages:
                return f"the folder {folder} of {name} is missing"
        return ""

    def __str__(self) -> str:
        return (
            f"rclpy {self.versions.get('ros-rclpy')} of ROS 2 Jazzy with Fast DDS "
            f"{self.versions.get('ros-fastrtps')}"
        )


def pins() -> dict[str, str]:
    """Return the pinned versions of ROS packages by name."""
    return dict(_PIN.findall(REQUIREMENTS.read_text(encoding="utf-8")))


def unsupported_reason() -> str:
    """Return why the real rclpy cannot be installed on this computer, or ""."""
    if sys.platform != "linux" or platform.machine() != "x86_64":
        platform_name = f"{platform.system()} on {platform.machine()}"
        return f"there are wheels for Linux on x86-64 only, and this is {platform_name}"
    if platform.libc_ver()[0] != "glibc":
        return "the wheels need glibc, which this Linux does not have"
    if sys.version_info[:2] > NEWEST_PYTHON:
        newest = ".".join(map(str, NEWEST_PYTHON))
        return f"there are wheels up to Python {newest}, and this is {platform.python_version()}"
    return ""


def default_folder() -> Path:
    """Return the folder of the environment in the user's data folder.

    Raises:
        CourseError: The user has no home folder.
    """
    try:
        data = Path(os.environ.get("XDG_DATA_HOME", ""))
        # The specification of XDG ignores a relative path, which would depend on the working
        # folder.
        data = data if data.is_absolute() else Path.home() / ".local" / "share"
    except RuntimeError as error:
        raise CourseError(
            "you have no home folder on this machine, where the real ROS 2 would be installed. Set "
            "HOME, or XDG_DATA_HOME, to a folder that you may write"
        ) from error
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    return data / "course_lib" / f"ros-jazzy-{pins()['ros-rclpy']}-{python}"


def find_environment() -> RealEnvironment:
    """Return the environment selected by REAL_ROS_PYTHON, by default the installed one.

    Raises:
        CourseError: It does not exist, or its versions are not the pinned ones.
    """
    configured = os.environ.get(PYTHON)
    python = Path(configured) if configured else default_folder() / "bin" / "python"
    if not python.is_file():
        if configured:
            raise CourseError(
                f"{PYTHON} is {configured}, which is not a Python. Set it to the file bin/python of an "
                "environment, or unset it."
            )
        reason = unsupported_reason()
        if reason:
            raise CourseError(f"The real ROS 2 cannot be installed here: {reason}.")
        raise CourseError(f"The real ROS 2 is not installed ({SIZE}). Install it: {INSTALL}")
    environment = RealEnvironment(python)
    if problem := environment.problem():
        fix = f"point {PYTHON} elsewhere" if configured else f"install it again: {INSTALL}"
        raise CourseError(f"{environment.folder} lacks the tested ROS 2: {problem}. Therefore {fix}.")
    return environment


def install(report: Callable[[str], None]) -> RealEnvironment:
    """Install the pinned wheels into the user's data folder, unless they are already installed.

    Raises:
        CourseError: The wheels do not support this computer, or pip fails.
    """
    reason = unsupported_reason()
    if reason:
        raise CourseError(f"The real ROS 2 cannot be installed here: {reason}. The kit works without it.")
    folder = default_folder()
    environment = RealEnvironment(folder / "bin" / "python")
    if not environment.python.exists() or environment.problem():
        with _only_installer(environment) as lock:
            try:
                _check_disk(folder)
                report(f"Installing the real ROS 2 into {folder}: {SIZE}, one to three minutes.")
                _create(folder, lock)
                environment.incomplete_mark.unlink()
                environment = RealEnvironment(environment.python)
                if problem := environment.problem():
                    raise CourseError(
                        f"pip did not install the tested ROS 2: {problem}. Does `pip config list` show "
                        "another package index, or a target folder? Remove it, then repeat the command."
                    )
            except BaseException:
                report(f"Nothing is installed: {folder} is removed.")
                shutil.rmtree(folder, ignore_errors=True)
                environment.incomplete_mark.unlink(missing_ok=True)
                raise
    report(f"{environment} is in {folder}.")
    return environment


@contextmanager
def _only_installer(environment: RealEnvironment) -> Iterator[int]:
    """Mark an environment as incomplete, and lock its parent folder against other installations.

    The lock ends with the block or, if this process is killed, with the last process that has
    inherited its file descriptor, which the block receives.

    Raises:
        CourseError: The parent cannot be written, or another process installs.
    """
    # Windows, for which there are no wheels, does not have this module.
    import fcntl

    parent, lock = environment.folder.parent, -1
    try:
        parent.mkdir(parents=True, exist_ok=True)
        lock = os.open(parent, os.O_RDONLY)
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        environment.incomplete_mark.touch()
    except OSError as error:
        if lock >= 0:
            os.close(lock)
        if isinstance(error, BlockingIOError):
            raise CourseError(
                f"Another `{INSTALL}` is installing into {environment.folder}. Wait until it has "
                "ended, then repeat the command."
            ) from error
        raise CourseError(
            f"The real ROS 2 cannot be installed in {parent}: {error.strerror}. {_OTHER_FOLDER}, then "
            "repeat the command."
        ) from error
    try:
        yield lock
    finally:
        os.close(lock)


def _check_disk(folder: Path) -> None:
    """Check that the disk of a folder has enough space, without its earlier installation.

    Raises:
        CourseError: The space is not sufficient.
    """
    shutil.rmtree(folder, ignore_errors=True)
    disk = next(parent for parent in folder.parents if parent.exists())
    free = shutil.disk_usage(disk).free
    if free < NEEDED_BYTES:
        raise CourseError(
            f"The disk of {disk} has {free // 10**6} MB free, and the real ROS 2 needs "
            f"{NEEDED_BYTES // 10**6} MB. Remove files there, or set XDG_DATA_HOME to a folder "
            "on another disk."
        )


def _create(folder: Path, lock: int) -> None:
    """Create the environment. Its processes inherit the lock, as they may outlive this process.

    Raises:
        CourseError: A process fails. The error states the cause and what to do.
    """
    python = f"python{sys.version_info.major}.{sys.version_info.minor}"
    venv = f"{python} cannot create a virtual environment. On Debian and Ubuntu: apt install {python}-venv"
    # A `user = true` of pip's settings is an error in an environment.
    pip = ["pip", "install", "--no-user", "--quiet", "--no-deps", "--only-binary", ":all:"]
    pip += ["--disable-pip-version-check", "--requirement", str(REQUIREMENTS)]
    for command, advice in (
        ([sys.executable, "-P", "-m", "venv", str(folder)], venv),
        ([str(folder / "bin" / "python"), "-P", "-m", *pip], "pip cannot install the wheels"),
    ):
        process = subprocess.run(
            command, capture_output=True, text=True, env=clean_variables(), check=False, pass_fds=(lock,)
        )
        if process.returncode:
            lines = [line.strip() for line in (process.stderr or process.stdout).splitlines() if line.strip()]
            line = lines[-1] if lines else f"exit code {process.returncode}"
            for pattern, cause in _CAUSES:
                if found := [line for line in lines if pattern.search(line)]:
                    # pip reports each attempt to connect; the reason is at the end of the line.
                    line, advice = found[-1].rpartition("connection broken by ")[2], cause
                    break
            raise CourseError(f"{advice}, then repeat the command. The cause: {line}")


def clean_variables() -> dict[str, str]:
    """Return this process's environment variables without the variables of another ROS."""
    return {name: value for name, value in os.environ.items() if name not in REMOVED_VARIABLES}
