"""Zenoh's versions against each other: `python tests/benchmarks/zenoh_versions.py [1.5.0 1.7.2]`.

The kits of a robot and of a student have one version, the robot's router and the gateway another. A
row says that the student's view shows the robot, also after the gateway was killed and started
again.
"""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
OLD = ("1.5.0", "1.7.2")
NEWEST = "installed"


def kits(folder: str) -> None:
    """Run the kits in this process, the routers with the packages of a folder; print the row's end."""
    sys.path.insert(0, str(ROOT))
    from course_lib.ros.programs import import_path

    import_path.install()
    from tests.gateway.test_restarts import Gateways, View, restarted
    from tests.ros.zenoh.conftest import Routers

    os.environ["PYTHONPATH"] = folder
    routers = Routers()
    with TemporaryDirectory() as place:
        gateways = Gateways(Path(place), f"tcp/127.0.0.1:{routers.port}")
        view = View(f"tcp/127.0.0.1:{routers.port}", gateways.address)
        view.comes_back()
        assert len(list(restarted(view, gateways, 1))) == 1
        view.close()
        gateways.kill()
    routers.kill()
    print("shown, and again behind a new gateway")


def main(versions: tuple[str, ...]) -> None:
    """Install the versions aside, and print a row for each pair of different ones."""
    with TemporaryDirectory() as place:
        folders = {NEWEST: ""}
        for version in versions:
            folders[version] = str(Path(place, version))
            command = [
                sys.executable,
                "-m",
                "pip",
                "install",
                "-q",
                "--no-deps",
                "--target",
                folders[version],
            ]
            subprocess.run([*command, f"eclipse-zenoh=={version}"], check=True, stderr=subprocess.DEVNULL)
        for own, here in folders.items():
            for other, there in folders.items():
                if own != other:
                    print(f"kits {own:10} routers {other:10}", end=" ", flush=True)
                    environment = os.environ | {"PYTHONPATH": here}
                    subprocess.run([sys.executable, __file__, "kits", there], env=environment, check=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["kits"]:
        kits(sys.argv[2])
    else:
        main(tuple(sys.argv[1:]) or OLD)
