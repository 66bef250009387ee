"""Mesh files: what is read from sound ones, and how unsound ones are refused."""

import os
import struct

import numpy as np
import pytest
import pyvista

from warpsph import mesh_files
from warpsph.errors import InputError
from warpsph.shapes import Mesh

BALL = pyvista.Icosphere(nsub=1)
CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
INSIDE = np.array([[0.5, 0.5, 0.5], [0.1, 0.9, 0.2], [1.5, 0.5, 0.5], [-0.1, 0.5, 0.5]])


def box(kind):
    """A box of one triangle pair and five quadrilaterals, as a file of text."""
    faces = [*SIDES[1:], SIDES[0][:3], (SIDES[0][0], *SIDES[0][2:])]
    if kind == "obj":
        lines = [
            "# a box",
            "mtllib none.mtl",
            *("v {} {} {}".format(*c) for c in CORNERS),
            "vt 0 0",
            "vn 0 0 1",
        ]
        lines += ["f " + " ".join(f"{k - 8}/1/1" if k % 2 else f"{k + 1}//1" for k in face) for face in faces]
        return "\n".join(lines) + "\n"
    head = "ply\nformat ascii 1.0\ncomment a box\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
    head += "element face 7\nproperty list uchar int vertex_index\nproperty uchar red\nelement edge 1\n"
    head += "property int vertex1\nproperty int vertex2\nend_header\n"
    lines = ["{} {} {}".format(*c) for c in CORNERS]
    lines += [" ".join(map(str, (len(face), *face, 255))) for face in faces]
    return head + "\n".join([*lines, "0 1"]) + "\n"


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
@pytest.mark.parametrize("binary", [True, False])
def test_a_file_holds_the_triangles_that_were_saved(tmp_path, suffix, binary):
    path = tmp_path / f"ball.{suffix.upper()}"
    BALL.save(tmp_path / f"ball.{suffix}", binary=binary)
    os.replace(tmp_path / f"ball.{suffix}", path)
    polygons = mesh_files.read(path)
    assert (polygons.sizes == 3).all()
    saved = BALL.points[BALL.regular_faces]
    np.testing.assert_allclose(polygons.points[polygons.corners].reshape(-1, 3, 3), saved, atol=2e-7)


@pytest.mark.parametrize("kind", ["obj", "ply"])
def test_polygons_of_several_sizes(tmp_path, kind):
    path = tmp_path / f"box.{kind}"
    path.write_text(box(kind))
    assert mesh_files.read(path).sizes.tolist() == [4, 4, 4, 4, 4, 3, 3]
    assert Mesh(path).contains(INSIDE).tolist() == [True, True, False, False]
    assert Mesh(path).source.n_cells == 12


@pytest.mark.parametrize(("name", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_binary_ply_of_both_byte_orders(tmp_path, name, order):
    text = box("ply").replace("ascii", name).replace("double", "float")
    head, body = text[: text.index("end_header\n") + 11], text[text.index("end_header\n") + 11 :].split("\n")
    rows = [struct.pack(order + "3f", *map(float, line.split())) for line in body[:8]]
    for line in body[8:15]:
        numbers = list(map(int, line.split()))
        rows.append(struct.pack(f"{order}B{numbers[0]}iB", *numbers))
    path = tmp_path / "box.ply"
    path.write_bytes(head.encode() + b"".join(rows) + struct.pack(order + "2i", 0, 1))
    assert mesh_files.read(path).sizes.tolist() == [4, 4, 4, 4, 4, 3, 3]
    assert Mesh(path).contains(INSIDE).tolist() == [True, True, False, False]


def changed(kind, old, new):
    """A box with one passage of its text replaced."""
    assert old in box(kind)
    return box(kind).replace(old, new, 1).encode()


ASCII_STL = b"solid a\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid a\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.vtk", b"# vtk DataFile Version 3.0", "its name ends in '.vtk'"),
        ("a.py", b"raise SystemExit", "its name ends in '.py'"),
        ("a", b"", "its name ends in 'nothing'"),
        ("a.stl", b"", "take 84"),
        (
            "a.stl",
            bytes(80) + b"\xff\xff\xff\xff" + bytes(100),
            "4294967295 facets, as it says, take 214748364834",
        ),
        ("a.stl", bytes(84), "no polygons"),
        ("a.stl", bytes(80) + struct.pack("<I12fH", 1, *[np.nan] * 12, 0), "not finite"),
        ("a.stl", bytes(80) + struct.pack("<I12fH", 1, *[1e30] * 12, 0), "beyond 1e\\+12"),
        ("a.stl", ASCII_STL[:-11], "without endsolid"),
        ("a.stl", ASCII_STL.replace(b"vertex 1 0", b"vertex 1"), "a facet is not whole, after"),
        ("a.stl", ASCII_STL.replace(b"vertex 1", b"vertex one"), "could not convert"),
        ("a.stl", ASCII_STL.replace(b"vertex 1", b"vertex " + b"1" * 10**6), "a facet is not whole"),
        ("a.stl", ASCII_STL + ASCII_STL, "encloses no volume"),
        ("a.obj", b"", "no polygons"),
        ("a.obj", changed("obj", "v 0 0 1", "v 0 0"), "line 4, 'v 0 0', is not understood"),
        ("a.obj", changed("obj", "v 0 0 1", "v 0 0 nan"), "not finite"),
        ("a.obj", changed("obj", "v 0 0 1", "\x1b[2J"), r"line 4, '\\x1b\[2J', is not understood"),
        ("a.obj", changed("obj", "f 5//1", "f 0//1"), "line 13"),
        ("a.obj", changed("obj", "f 5//1", "f 9//1"), "none of its 8 points"),
        ("a.obj", changed("obj", "f 5//1", "f -9//1"), "none of its 8 points"),
        ("a.obj", changed("obj", "f 5//1", "f 1" + "0" * 400), "line 13"),
        ("a.obj", changed("obj", "f 5//1", "f" + 300 * " 1"), "a polygon has 303 corners"),
        ("a.obj", changed("obj", "f 5//1", "f 1 2\nf 5//1"), "a polygon has 2 corners"),
        ("a.obj", changed("obj", "vn 0 0 1", "call evil.obj"), "'call evil.obj', is not understood"),
        ("a.ply", b"ply\n", "no PLY header"),
        ("a.ply", b"\x80\x04\x95pickle", "no PLY header"),
        ("a.ply", changed("ply", "ascii", "ebcdic"), "header line 'format ebcdic 1.0' is not understood"),
        ("a.ply", changed("ply", "vertex 8", "vertex 800000000000"), "ends in row"),
        ("a.ply", changed("ply", "vertex 8", "vertex -8"), "is not understood"),
        ("a.ply", changed("ply", "vertex 8", "vertex 7"), "is not understood|more than|list has|ends in"),
        ("a.ply", changed("ply", "element edge 1", "element edge 0"), "more than its header says"),
        (
            "a.ply",
            changed("ply", "element edge 1", "element nothing 900000000000000\nelement edge 1"),
            "properties of",
        ),
        ("a.ply", changed("ply", "double x", "double y"), "is damaged|more than once|cannot be read"),
        ("a.ply", changed("ply", "double x", "list uchar int x"), "list has|numbers|ends in"),
        ("a.ply", changed("ply", "double x", "object x"), "is not understood"),
        (
            "a.ply",
            changed("ply", "list uchar int vertex_index", "uchar vertex_index"),
            "faces are lists|more than|ends",
        ),
        ("a.ply", changed("ply", "4 4 6 7 5", "4 4 6 7 8"), "none of its 8 points"),
        ("a.ply", changed("ply", "4 4 6 7 5", "4 4 6 7 4.5"), "no whole number"),
        ("a.ply", changed("ply", "4 4 6 7 5", "nan 4 6 7 5"), "cannot be read"),
        ("a.ply", changed("ply", "4 4 6 7 5", "900000000 4 6 7 5"), "a list has 900000000"),
        ("a.ply", changed("ply", "0 1\n", "1" * 10**6), "too long"),
        (
            "a.ply",
            changed("ply", "element face 7", "element faces 7"),
            "no 'vertex_indices' of element 'face'",
        ),
    ],
)
def test_an_unsound_file_is_refused_in_one_line(tmp_path, capfd, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        Mesh(path)
    text = str(caught.value)
    assert "allowed: a closed surface" in text and text.isprintable() and len(text) < 500
    assert capfd.readouterr().err == ""


def test_what_is_no_plain_file_is_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "folder.stl").mkdir()
    (tmp_path / "loop.stl").symlink_to(tmp_path / "loop.stl")
    for name in ("pipe", "folder", "loop", "none"):
        with pytest.raises(InputError, match="does not exist or is no file"):
            Mesh(tmp_path / f"{name}.stl")


def test_a_surface_around_nothing_is_refused(tmp_path):
    points, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]), [[0, 1, 2], [0, 2, 1]]
    with pytest.raises(InputError, match="encloses no volume"):
        Mesh(pyvista.PolyData.from_regular_faces(points, np.array(faces)))
