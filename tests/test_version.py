from importlib.metadata import version

from typer.testing import CliRunner

from course_lib.cli import app


def test_version_option_prints_the_version_of_the_kit() -> None:
    result = CliRunner().invoke(app, ["--version"])
    assert (result.exit_code, result.output.split(",")[0]) == (0, f"course_lib {version('course_lib')}")
