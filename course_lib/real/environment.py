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

    def problem(self) -> str:
        """Return the first pinned package that is missing, damaged or has a different version, or ""."""
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
        data = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")
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
    if not python.exists():
        if configured:
            raise CourseError(f"{PYTHON} is {configured}, where there is no Python. Correct it, or unset it.")
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
        with _only_installer(folder):
            _check_disk(folder)
            report(f"Installing the real ROS 2 into {folder}: {SIZE}, up to a minute.")
            try:
                _create(folder)
            except BaseException:
                # An incomplete environment must not be mistaken for a complete one, even after
                # Ctrl+C.
                shutil.rmtree(folder, ignore_errors=True)
                raise
            environment = RealEnvironment(folder / "bin" / "python")
            if problem := environment.problem():
                shutil.rmtree(folder, ignore_errors=True)
                raise CourseError(f"pip installed {problem}. Is another package index configured?")
    report(f"{environment} is in {folder}.")
    return environment


@contextmanager
def _only_installer(folder: Path) -> Iterator[None]:
    """Lock the parent of a folder against other installations, until the block or the process ends.

    Raises:
        CourseError: The parent cannot be created, or another process installs.
    """
    # Windows, for which there are no wheels, does not have this module.
    import fcntl

    parent = folder.parent
    try:
        parent.mkdir(parents=True, exist_ok=True)
        lock = os.open(parent, os.O_RDONLY)
    except OSError as error:
        raise CourseError(
            f"The real ROS 2 cannot be installed in {parent}: {error.strerror}. Set XDG_DATA_HOME to "
            "a folder that you may write, then repeat the command."
        ) from error
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise CourseError(
            f"Another `{INSTALL}` is installing into {folder}. Wait until it has ended, then repeat "
            "the command."
        ) from error
    else:
        yield
    finally:
        os.close(lock)


def _check_disk(folder: Path) -> None:
    """Check that the disk of a folder, whose earlier installation is removed, has enough space.

    Raises:
        CourseError: It has not.
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


def _create(folder: Path) -> None:
    venv = [sys.executable, "-P", "-m", "venv", str(folder)]
    _run(venv, "Python's venv fails; on Debian: apt install python3-venv")
    pip = [str(folder / "bin" / "python"), "-P", "-m", "pip", "install", "--quiet", "--no-deps"]
    options = ["--only-binary", ":all:", "--disable-pip-version-check", "--requirement", str(REQUIREMENTS)]
    _run([*pip, *options], "pip cannot install the wheels; is this computer online?")


def _run(command: list[str], problem: str) -> None:
    process = subprocess.run(command, capture_output=True, text=True, env=clean_variables(), check=False)
    if process.returncode:
        lines = [line for line in (process.stderr or process.stdout).splitlines() if line.strip()]
        if any(os.strerror(errno.ENOSPC) in line for line in lines):
            problem = "a disk is full, where the files are installed or in TMPDIR"
        raise CourseError(f"{problem} ({lines[-1].strip() if lines else f'exit code {process.returncode}'})")


def clean_variables() -> dict[str, str]:
    """Return this process's environment variables without the variables of another ROS."""
    return {name: value for name, value in os.environ.items() if name not in REMOVED_VARIABLES}
