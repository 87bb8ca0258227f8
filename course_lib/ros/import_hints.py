"""Hints for imports that fail: misspelled modules and names, names of other modules, and ROS 1."""

import dis
import re
import sys
from pathlib import Path
from pkgutil import iter_modules
from traceback import extract_tb

from course_lib.ros import near_names, shadowing_hints
from course_lib.ros.messages.definitions import FOLDERS, RENAMED
from course_lib.ros.programs.packages import clone_instructions, package_folder_of, skipped_folder_reason
from course_lib.ros.student_code import public_attributes

# Modules that ROS programs often use, by their names on PyPI.
_FROM_PIP = {
    "aiohttp": "aiohttp",
    "bs4": "beautifulsoup4",
    "can": "python-can",
    "cantools": "cantools",
    "casadi": "casadi",
    "cv2": "opencv-python-headless",
    "cvxpy": "cvxpy",
    "depthai": "depthai",
    "dotenv": "python-dotenv",
    "dronekit": "dronekit",
    "dynamixel_sdk": "dynamixel-sdk",
    "fastapi": "fastapi",
    "filterpy": "filterpy",
    "flask": "flask",
    "flask_cors": "flask-cors",
    "flask_socketio": "flask-socketio",
    "gtts": "gTTS",
    "gym": "gym",
    "gymnasium": "gymnasium",
    "imageio": "imageio",
    "imutils": "imutils",
    "inputs": "inputs",
    "jax": "jax",
    "junit_xml": "junit-xml",
    "keras": "keras",
    "langchain": "langchain",
    "lxml": "lxml",
    "mavsdk": "mavsdk",
    "mcap": "mcap",
    "mediapipe": "mediapipe",
    "mujoco": "mujoco",
    "networkx": "networkx",
    "ntplib": "ntplib",
    "numba": "numba",
    "open3d": "open3d",
    "openai": "openai",
    "osrf_pycommon": "osrf-pycommon",
    "paho": "paho-mqtt",
    "pandas": "pandas",
    "PIL": "pillow",
    "plotly": "plotly",
    "psutil": "psutil",
    "py_trees": "py-trees",
    "pyaudio": "pyaudio",
    "pybullet": "pybullet",
    "pydantic": "pydantic",
    "pydub": "pydub",
    "pygame": "pygame",
    "pymap3d": "pymap3d",
    "pymavlink": "pymavlink",
    "pynput": "pynput",
    "pyproj": "pyproj",
    "PyQt5": "PyQt5",
    "PyQt6": "PyQt6",
    "pyquaternion": "pyquaternion",
    "pyrealsense2": "pyrealsense2",
    "PySide6": "PySide6",
    "pyttsx3": "pyttsx3",
    "pyzbar": "pyzbar",
    "qrcode": "qrcode",
    "quaternion": "numpy-quaternion",
    "requests": "requests",
    "rerun": "rerun-sdk",
    "roslibpy": "roslibpy",
    "scipy": "scipy",
    "seaborn": "seaborn",
    "serial": "pyserial",
    "shapely": "shapely",
    "simple_pid": "simple-pid",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "smbus2": "smbus2",
    "squaternion": "squaternion",
    "sounddevice": "sounddevice",
    "speech_recognition": "SpeechRecognition",
    "sympy": "sympy",
    "tensorflow": "tensorflow",
    "torch": "torch",
    "torchvision": "torchvision",
    "tqdm": "tqdm",
    "transforms3d": "transforms3d",
    "trimesh": "trimesh",
    "ultralytics": "ultralytics",
    "urdf_parser_py": "urdf-parser-py",
    "uvicorn": "uvicorn",
    "viser": "viser",
    "wandb": "wandb",
    "websocket": "websocket-client",
    "websockets": "websockets",
    "zmq": "pyzmq",
}
# Installed replacements for some of these packages.
_INSTEAD = [
    (
        ("scipy", "pyquaternion", "quaternion", "squaternion"),
        ". For rotations, tf_transformations and transforms3d are installed already",
    ),
    (("viser", "rerun", "open3d"), ". The displays of Viewer show what your node publishes"),
]
# Modules for the pins, buses and cameras of the computer on a robot.
_ON_A_ROBOT = {
    *(
        "RPi",
        "adafruit_servokit",
        "board",
        "busio",
        "digitalio",
        "gpiozero",
        "lgpio",
        "picamera",
        "picamera2",
    ),
    *("pigpio", "smbus", "spidev"),
}


def module_hint(error: ModuleNotFoundError) -> str:
    """Return the hint for a module that is misspelled or belongs to ROS 1, or ""."""
    package, _, inner = (error.name or "").partition(".")
    if inner and (found := shadowing_hints.hiding_file_hint(package)):
        return found
    if inner and (found := _interface_module_hint(package, inner, _imported_name(error))):
        return found
    if package in _FROM_PIP:
        instead = next((text for names, text in _INSTEAD if package in names), "")
        return f"it is not part of ROS 2 for Python: pip install {_FROM_PIP[package]}{instead}"
    if package in _ON_A_ROBOT:
        return (
            f"{package} drives devices of the robot's own computer: run this program there. Here a "
            "node of your own can publish the same messages."
        )
    if package in near_names.ROS_1:
        return f"there is no module {package} in ROS 2: {near_names.ROS_1[package]}."
    if found := clone_instructions(package):
        return f"{found}."
    kind, imported = inner.partition(".")[0], _imported_name(error)
    if kind in ("msg", "srv", "action") and (line := near_names.import_of_interface(imported, package)):
        return f"it is elsewhere: `{line}`."
    if folder := next(
        (above for above in Path.cwd().parents[:3] if (above / f"{package}.py").is_file()), None
    ):
        return f"{package}.py is in the folder {folder.name}: move this file there, or copy it to here."
    if re.fullmatch(r"week\d\d_\w+", package):
        return f"{package}.py is next to its lesson: open the notebook there, or copy the file to here."
    if Path(f"{package}.ipynb").exists():
        return f"{package} is a notebook, and Python imports files ending in .py: copy the cell to here."
    if inner and package in sys.modules:
        holder, _, last = (error.name or "").rpartition(".")
        # As in Java, where `import rclpy.node.Node` imports a class.
        if hasattr(sys.modules.get(holder), last):
            return f"{last} is not a module: `from {holder} import {last}`."
        folders = map(Path, getattr(sys.modules.get(holder), "__path__", ()))
        submodules = [p.stem for folder in folders for p in folder.iterdir() if p.suffix in ("", ".py")]
        similar = near_names.nearest(last, submodules)
        return f"did you mean `import {holder}.{similar}`?" if similar else ""
    # A package like my_msgs is more likely a student's own than a misspelled
    # one. The standard library has hundreds of short names.
    cutoff = 0.85 if package.endswith(("_msgs", "_srvs", "_interfaces")) else 0.8
    similar = near_names.nearest(package, near_names.known_packages(), cutoff) or near_names.nearest(
        package, sys.stdlib_module_names, 0.85
    )
    return f"did you mean {similar}?" if similar else ""


def _interface_module_hint(package: str, inner: str, name_in_import: str) -> str:
    """Return the hint for a module that a package of interfaces does not have, or "".

    Args:
        package: The package.
        inner: The rest of the module's name, "mgs" or "msg.String".
        name_in_import: The name that was to be imported from the module, or "".
    """
    kinds = near_names.interfaces().get(package)
    if kinds is None:
        return ""
    kind, _, name = inner.partition(".")
    if name and kind in kinds:
        similar = name if name in kinds[kind] else near_names.nearest(name, kinds[kind])
        return f"write `from {package}.{kind} import {similar}`." if similar else ""
    if name_in_import and (line := near_names.import_of_interface(name_in_import, package)):
        return f"it is elsewhere: `{line}`."
    similar = near_names.nearest(kind, kinds, 0.5) or next(iter(kinds))
    return f"did you mean `import {package}.{similar}`?"


def _imported_name(error: BaseException) -> str:
    """Return the first name of the failing `from … import …`, or "".

    The source text is not always available, but the bytecode contains the names.
    """
    trace = error.__traceback__
    while trace is not None:
        constant: object = None
        for one in dis.get_instructions(trace.tb_frame.f_code):
            if (one.offset, one.opname) == (trace.tb_lasti, "IMPORT_NAME") and one.argval == getattr(
                error, "name", None
            ):
                return str(constant[0]) if isinstance(constant, tuple) and constant else ""
            if one.opname == "LOAD_CONST":
                constant = one.argval
        trace = trace.tb_next
    return ""


def import_hint(error: ImportError) -> str:
    """Return a question with the name closest to one that cannot be imported, or ""."""
    if "relative import with no known parent package" in str(error):
        file = Path(extract_tb(error.__traceback__)[-1].filename)
        if package_folder_of(file) not in (None, file.resolve().parent):
            return f"{file.parent.name} is no Python package: put an empty __init__.py next to {file.name}."
        return "a started file has no package: leave out the dot to import a file next to it."
    match = re.match(r"cannot import name '(\w+)' from '([\w.]+)'", str(error))
    if match is None:
        return ""
    missing, module = match[1], match[2]
    package, _, kind = module.partition(".")
    if found_file := shadowing_hints.hiding_file_hint(package):
        return found_file
    if package in near_names.interfaces() and (interface := _interface_hint(missing, package, kind)):
        return interface
    if module.partition(".")[0] in ("launch", "launch_ros"):
        line = near_names.IN_LAUNCH_FILES.get(missing) or near_names.IMPORTS.get(missing)
    else:
        line = near_names.IMPORTS.get(missing) or near_names.LAUNCH_IMPORTS.get(missing)
    if line:
        return f"it is elsewhere: `{line}`."
    imported_module = sys.modules.get(module)
    submodules = [match.name for match in iter_modules(getattr(imported_module, "__path__", None) or [])]
    names = [*public_attributes(imported_module), *submodules]
    longer = [name for name in names if name.startswith(f"{missing}_")]
    similar = near_names.nearest(missing, names) or (longer[0] if len(longer) == 1 else "")
    return f"did you mean {similar}? `from {module} import {similar}`" if similar else ""


def _interface_hint(missing: str, package: str, kind: str) -> str:
    """Return the hint for a name that a package of interfaces, or its module of a kind, does not have."""
    kinds = near_names.interfaces()[package]
    line = near_names.import_of_interface(missing, package)
    # turtlesim has a Color, but a marker has a ColorRGBA.
    if line and not line.startswith(tuple(f"from {one}." for one in (package, *near_names.COMMON))):
        for holder in (package, *near_names.COMMON):
            for one, names in near_names.interfaces()[holder].items():
                longer = [name for name in names if name.startswith(missing)] if one == kind else []
                if len(longer) == 1:
                    return f"did you mean {longer[0]}? `from {holder}.{one} import {longer[0]}`"
    if line:
        return f"it is elsewhere: `{line}`." if kind else f"write `{line}`."
    if not kind and (similar := near_names.nearest(missing, kinds, 0.6)):
        return f"did you mean {similar}? `from {package} import {similar}`"
    modules = {kind: kinds[kind]} if kind in kinds else kinds
    places = [(package, one, names) for one, names in modules.items()]
    # A name of another package must be more similar.
    places += [
        (p, one, names) for p, other in near_names.interfaces().items() for one, names in other.items()
    ]
    for number, (holder, one, names) in enumerate(places):
        if similar := near_names.nearest(missing, names, 0.75 if number < len(modules) else 0.85):
            return f"did you mean {similar}? `from {holder}.{one} import {similar}`"
    if kind not in kinds:
        return ""
    if package in RENAMED or any((folder / package).is_dir() for folder in FOLDERS):
        return (
            f"your package {package} has no file {kind}/{missing}.{kind}: write it, or import what "
            f"the package has: {', '.join(kinds[kind])}."
        )
    return f"`%ros2 interface package {package}` lists what {package} has."


def skipped_interfaces_hint(error: BaseException) -> str:
    """Return the hint for a package of interfaces whose folder is not used, such as an empty one."""
    if not isinstance(error, ModuleNotFoundError):
        return ""
    package = (error.name or "").partition(".")[0]
    # The search may take a second in a large folder.
    if not package.endswith(("_msgs", "_srvs", "_interfaces")) and imported_interfaces(error) is None:
        return ""
    reason = skipped_folder_reason(package)
    return f"the package {package} is not used: {reason}" if reason else ""


def imported_interfaces(error: ModuleNotFoundError) -> tuple[str, str] | None:
    """Return the package and kind if the import of a missing package requests its interfaces."""
    names = [error.name or ""]
    trace = error.__traceback__
    while trace is not None:
        # The source text is not always available, but the bytecode contains the imported name.
        code = dis.get_instructions(trace.tb_frame.f_code)
        names += [
            str(step.argval) for step in code if (step.offset, step.opname) == (trace.tb_lasti, "IMPORT_NAME")
        ]
        trace = trace.tb_next
    for name in names:
        package, _, kind = name.partition(".")
        if package == (error.name or "").partition(".")[0] and kind in ("msg", "srv", "action"):
            return package, kind
    return None
