import json

import griffe
import pytest
from packaging.version import Version

from tests.public_api import breakages, public_api, released, version


@pytest.fixture(scope="module")
def api() -> griffe.Module:
    return public_api()


def copy(api: griffe.Module) -> griffe.Module:
    copied = griffe.Module.from_json(json.dumps(api.as_dict(), cls=griffe.JSONEncoder))
    assert isinstance(copied, griffe.Module)
    return copied


@pytest.mark.slow
def test_breaking_changes_since_the_last_release_require_a_new_minor_version(api: griffe.Module) -> None:
    last, old = released()
    assert breakages(old, api) == [] or Version(version()).release[:2] > Version(last).release[:2]


def test_removed_names_methods_and_parameters_are_breaking_changes(api: griffe.Module) -> None:
    new = copy(api)
    new["robots"].del_member("load_robot")
    new["displays.Viewer"].del_member("refresh")
    del new["displays.Viewer.__init__"].parameters["fixed_frame"]
    assert sorted(breakages(copy(api), new)) == [
        "course_lib.displays.Viewer.__init__: Parameter was removed",
        "course_lib.displays.Viewer.refresh: Public object was removed",
        "course_lib.robots.load_robot: Public object was removed",
    ]


def test_new_optional_parameter_is_not_a_breaking_change(api: griffe.Module) -> None:
    new = copy(api)
    more = griffe.Parameter("more", kind=griffe.ParameterKind.keyword_only, default="0")
    new["displays.Viewer.__init__"].parameters.add(more)
    assert breakages(copy(api), new) == []
