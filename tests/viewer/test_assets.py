import re
from pathlib import Path

from course_lib.viewer import assets

FOLDER = Path(assets.__file__).parent / "js"


def test_every_module_is_in_the_bundle_and_none_of_its_imports() -> None:
    key, script = assets.bundle()
    assert {path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.js")} == {
        *assets._MODULES,
        "widget",
    }
    ours = script[script.rindex("const { THREE } = MeshCat") :]
    assert not re.search(r"^(import|export) ", ours, re.M)
    assert key in assets.widget_module()


def test_modules_import_only_what_comes_before_them() -> None:
    for position, name in enumerate(assets._MODULES):
        module = FOLDER / f"{name}.js"
        imported = re.findall(r'^import .* from "(.*)";$', module.read_text(), re.M)
        paths = {(module.parent / path).resolve() for path in imported}
        assert paths <= {(FOLDER / f"{before}.js").resolve() for before in assets._MODULES[:position]}


def test_the_javascript_stays_small() -> None:
    panels = sum(len(path.read_text().splitlines()) for path in FOLDER.glob("panels/*.js"))
    view = sum(len(path.read_text().splitlines()) for path in FOLDER.glob("*.js"))
    assert panels <= 963
    assert view <= 1709
    assert len(assets.bundle_zipped()) < 250_000
