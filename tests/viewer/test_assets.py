import re
from pathlib import Path

from course_lib.viewer import html

FOLDER = Path(html.__file__).parent / "js"


def test_bundle_contains_every_module_without_import_statements() -> None:
    key, script = html.bundle().name, html.bundle().script
    assert {path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.js")} == {
        *html._MODULES,
        "widget",
    }
    ours = script[script.rindex("const { THREE } = MeshCat") :]
    assert not re.search(r"^(import|export) ", ours, re.M)
    assert key in html.widget_module()


def test_modules_import_only_modules_earlier_in_the_bundle() -> None:
    for position, name in enumerate(html._MODULES):
        module = FOLDER / f"{name}.js"
        imported = re.findall(r'^import .* from "(.*)";$', module.read_text(), re.M)
        paths = {(module.parent / path).resolve() for path in imported}
        assert paths <= {(FOLDER / f"{before}.js").resolve() for before in html._MODULES[:position]}


def test_javascript_bundle_stays_small() -> None:
    assert len(html.bundle().zipped) < 255_000
