from pathlib import Path

import pytest

from tests.test_cli import course


@pytest.mark.slow
def test_exported_launch_file_runs(notebook: Path, tmp_path: Path) -> None:
    words = ("export", str(notebook), "--package", "my_robot", "--out", "src")
    process = course(*words, "--node", "TFPublisher", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "course run src/my_robot/launch/my_robot.launch.py" in process.stdout
    checked = course("export", "--check", "src/my_robot", cwd=tmp_path)
    assert (checked.returncode, "lacks" in checked.stdout) == (0, False)
    launch = "src/my_robot/launch/my_robot.launch.py"
    ran = course("run", launch, "use_sim_time:=false", "--seconds", "0.2", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert "[tf_publisher-1]: process has finished cleanly" in ran.stdout
