import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from course_lib.viewer import drawables
from course_lib.viewer.drawables import MeshFileError, load_mesh, parse_mesh

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
ASCII_STL = """solid t
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 0 2 0
 endloop
endfacet
endsolid t"""
OBJ = """# a square and its first corner again
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
f 1/1/1 2/2/1 3/3/1 4/4/1
f -4 -3 -2
"""
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="paint"><profile_COMMON><technique sid="c"><phong>
 <diffuse><color>1 0.5 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="orange"><instance_effect url="#paint"/></material></library_materials>
<library_geometries><geometry id="quad"><mesh>
 <source id="p"><float_array id="f" count="12">0 0 0 100 0 0 100 100 0 0 100 0</float_array>
  <technique_common><accessor source="#f" count="4" stride="3"><param name="X" type="float"/>
  <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
 <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
 <polylist material="m" count="1"><input semantic="VERTEX" source="#v" offset="0"/>
  <vcount>4</vcount><p>0 1 2 3</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>0 0 100</translate><rotate>1 0 0 90</rotate>
 <node><scale>2 1 1</scale><instance_geometry url="#quad"><bind_material><technique_common>
 <instance_material symbol="m" target="#orange"/></technique_common></bind_material></instance_geometry>
 </node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def binary_stl(corners: Any) -> bytes:
    facet = np.zeros(1, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    facet["corners"] = corners
    return b"solid but binary".ljust(80) + (1).to_bytes(4, "little") + facet.tobytes()


@pytest.mark.parametrize("data", [ASCII_STL.encode(), binary_stl(CORNERS)], ids=["ascii", "binary"])
def test_binary_and_ascii_stl_files_are_read(data: bytes) -> None:
    mesh = parse_mesh(data, "stl")
    assert sorted(mesh.vertices[mesh.faces[0]].tolist()) == sorted(CORNERS)


def test_obj_polygons_become_triangles() -> None:
    mesh = parse_mesh(OBJ.encode(), "obj")
    assert mesh.faces.tolist() == [[0, 1, 2], [2, 3, 0], [0, 1, 2]]


def test_dae_nodes_transform_and_color_their_children() -> None:
    mesh = parse_mesh(DAE.encode(), "dae")
    assert len(mesh.faces) == 2
    assert mesh.vertices.min(axis=0) == pytest.approx([0, 0, 1], abs=1e-6)
    assert mesh.vertices.max(axis=0) == pytest.approx([2, 0, 2])
    assert mesh.colors[0] == pytest.approx([1, 0.5, 0, 1], abs=0.01)


def test_mesh_with_a_broken_material_is_read_without_it() -> None:
    mesh = parse_mesh(DAE.replace('target="#orange"', 'target="#nobody"').encode(), "dae")
    assert len(mesh.faces) == 2
    assert mesh.colors[0].tolist() != pytest.approx([1, 0.5, 0, 1], abs=0.01)


def test_normals_of_a_dae_file_are_read_and_rotated_with_its_nodes() -> None:
    source = (
        DAE[DAE.index(' <source id="p">') : DAE.index(" <vertices")]
        .replace('"p"', '"n"')
        .replace('"#f"', '"#g"')
    )
    source = source.replace('id="f"', 'id="g"').replace("0 0 0 100 0 0 100 100 0 0 100 0", "0.6 0 0.8 " * 4)
    data = DAE.replace(" <vertices", source + " <vertices").replace(
        '<input semantic="VERTEX" source="#v" offset="0"/>',
        '<input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="0"/>',
    )
    normals = parse_mesh(data.encode(), "dae").normals
    assert normals is not None
    expected = np.array([0.6 / 2, -0.8, 0.0])  # stretched along x, then rotated about it: z is mapped to -y
    np.testing.assert_allclose(normals, [expected / np.linalg.norm(expected)] * len(normals), atol=1e-6)


def test_texture_is_sampled_at_the_vertices(tmp_path: Path) -> None:
    picture = Image.new("RGB", (8, 8), (255, 0, 0))
    picture.paste((0, 0, 255), (4, 0, 8, 8))
    picture.save(tmp_path / "half.png")
    (tmp_path / "m.mtl").write_text("newmtl m\nmap_Kd half.png\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.1 0.5\nvt 0.9 0.5\nvt 0.2 0.9"
    (tmp_path / "quad.obj").write_text(f"mtllib m.mtl\nusemtl m\n{corners}\nf 1/1 2/2 3/3\n")
    mesh = load_mesh(tmp_path / "quad.obj")
    by_x = dict(zip(mesh.vertices[:, 0].tolist(), mesh.colors.tolist(), strict=True))
    assert by_x == {0.0: [1, 0, 0, 1], 1.0: [0, 0, 1, 1]}


def test_texture_of_dae_is_sampled_at_the_vertices(tmp_path: Path) -> None:
    picture = Image.new("RGB", (8, 8), (255, 0, 0))
    picture.paste((0, 0, 255), (4, 0, 8, 8))
    picture.save(tmp_path / "half.png")
    sampler = (
        '<newparam sid="a"><surface type="2D"><init_from>i</init_from></surface></newparam>'
        '<newparam sid="b"><sampler2D><source>a</source></sampler2D></newparam><technique sid="c">'
    )
    image = '<library_images><image id="i"><init_from>half.png</init_from></image></library_images>'
    places = (
        '<source id="t"><float_array id="g" count="8">0.1 0.5 0.9 0.5 0.9 0.6 0.1 0.6</float_array>'
        '<technique_common><accessor source="#g" count="4" stride="2"><param name="S" type="float"/>'
        '<param name="T" type="float"/></accessor></technique_common></source><vertices id="v">'
    )
    text = (
        DAE.replace("<library_effects>", f"{image}<library_effects>")
        .replace('<technique sid="c">', sampler)
        .replace("<color>1 0.5 0 1</color>", '<texture texture="b" texcoord="t"/>')
        .replace('<vertices id="v">', places)
        .replace("<vcount>", '<input semantic="TEXCOORD" source="#t" offset="0"/><vcount>')
    )
    (tmp_path / "quad.dae").write_text(text)
    mesh = load_mesh(tmp_path / "quad.dae")
    colors = {(round(float(v[0])), *c) for v, c in zip(mesh.vertices, mesh.colors.tolist(), strict=True)}
    assert colors == {(0, 1, 0, 0, 1), (2, 0, 0, 1, 1)}
    (tmp_path / "half.png").unlink()
    drawables.parse_mesh.cache_clear()
    assert (load_mesh(tmp_path / "quad.dae").colors == 1).all()


def test_dae_file_with_faults_that_rviz_ignores_is_read() -> None:
    sound = parse_mesh(DAE.encode(), "dae")
    named = DAE.replace("<node", '<node name="<STL_BINARY> of A&B"', 1)
    for text in (f"\n {DAE}", f"{DAE}{3 * chr(0)}", f"{DAE}{chr(0)}{DAE[-99:]}", named):
        mesh = parse_mesh(text.encode(), "dae")
        assert (mesh.vertices == sound.vertices).all()
        assert (mesh.colors == sound.colors).all()


def test_missing_texture_prints_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "m.mtl").write_text("newmtl m\nmap_Kd gone.png\n")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.1 0.5\nvt 0.9 0.5\nvt 0.2 0.9"
    (tmp_path / "quad.obj").write_text(f"mtllib m.mtl\nusemtl m\n{corners}\nf 1/1 2/2 3/3\n")
    # pytest's own handlers would receive what logging prints without any handler.
    root = logging.getLogger()
    handlers, root.handlers = root.handlers, []
    try:
        assert len(load_mesh(tmp_path / "quad.obj").faces) == 1
    finally:
        root.handlers = handlers
    assert capsys.readouterr() == ("", "")


def test_ply_is_read_without_the_colors_of_its_vertices() -> None:
    properties = [f"property float {axis}" for axis in "xyz"]
    properties += [f"property uchar {name}" for name in ("red", "green", "blue")]
    head = ["ply", "format ascii 1.0", "element vertex 3", *properties, "element face 1"]
    corners = [f"{x} {y} {z} 255 0 0" for x, y, z in CORNERS]
    lines = [*head, "property list uchar int vertex_index", "end_header", *corners, "3 0 1 2\n"]
    mesh = parse_mesh("\n".join(lines).encode(), "ply")
    assert mesh.vertices.tolist() == CORNERS
    np.testing.assert_allclose(mesh.colors, [[0.7, 0.7, 0.7, 1.0]] * 3, atol=1e-6)


def test_requested_color_replaces_the_color_in_the_file() -> None:
    assert parse_mesh(DAE.encode(), "dae", (0, 0, 1, 0.5)).colors.tolist() == [0, 0, 1, 0.5]


@pytest.mark.parametrize("file_format", ["dae", "stl", "obj", "ply"])
def test_broken_file_is_rejected_with_an_error_message(file_format: str) -> None:
    with pytest.raises(MeshFileError, match=f"not a readable {file_format.upper()} file"):
        parse_mesh(b"v 1 2\n<not any of these", file_format)


@pytest.mark.parametrize("file_format", ["dae", "stl", "obj", "ply"])
def test_mesh_that_git_lfs_has_not_fetched_is_reported(file_format: str) -> None:
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9990\n"
    with pytest.raises(MeshFileError, match=r"pointer of Git LFS .*: git lfs install, then git lfs pull\."):
        parse_mesh(pointer, file_format)


def test_missing_files_and_unknown_formats_are_rejected_with_their_name(tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=r"gone\.stl"):
        load_mesh(tmp_path / "gone.stl")
    (tmp_path / "mesh.blend").write_bytes(b"")
    with pytest.raises(
        MeshFileError, match="'blend' is not a supported mesh format; use one of dae, stl, obj, ply"
    ):
        load_mesh(tmp_path / "mesh.blend")


@pytest.mark.slow
def test_robot_meshes_agree_with_another_reader() -> None:
    coal = pytest.importorskip("coal")
    pinocchio = pytest.importorskip("pinocchio")
    robots = Path(pinocchio.__file__).parents[4] / "share" / "example-robot-data" / "robots"
    files = sorted((robots / "ur_description" / "meshes" / "ur10").rglob("*.[ds]*"))
    assert len(files) == 14
    for file in files:
        expected = np.array(coal.MeshLoader().load(str(file), np.ones(3)).vertices())
        vertices = load_mesh(file).vertices
        assert vertices.min(axis=0) == pytest.approx(expected.min(axis=0), abs=1e-5), file.name
        assert vertices.max(axis=0) == pytest.approx(expected.max(axis=0), abs=1e-5), file.name


def test_file_of_another_format_is_rejected_without_reading_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read_bytes(path: Path) -> bytes:
        raise AssertionError(f"{path} was read")

    monkeypatch.setattr(drawables, "read_bytes", read_bytes)
    with pytest.raises(MeshFileError, match="'log' is not a supported mesh format"):
        load_mesh(tmp_path / "endless.log")
