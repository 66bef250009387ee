import dataclasses
import math
import types

import numpy as np
import pytest
from PIL import Image
from states import impact

from warpsph import render, units
from warpsph.drawing import camera, spheres
from warpsph.drawing.look import KERNEL_COLOURS, choose, time_stamp
from warpsph.drawing.painter import Painter
from warpsph.errors import InputError, RunError
from warpsph.scalars import names, scalar
from warpsph.storage import snapshot

SMALL = (320, 240)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "snapshots").mkdir()
    for number in range(3):
        snapshot.write(tmp_path / "snapshots" / f"block_{number:04d}.vtkhdf", impact(number * 1e-6))
    return tmp_path


def coloured(picture):
    """Pixels that are clearly red or blue, as particles are and text is not, shape [height, width], bool."""
    picture = picture.astype(int)
    return abs(picture[..., 0] - picture[..., 2]) > 60


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_frame_shows_particles_where_they_are(dim):
    look = choose([impact(0.0, dim)], field="speed", size=SMALL, cmap="coolwarm")
    with Painter(look) as painter:
        picture = painter.draw(impact(0.0, dim))
        assert picture.shape == (240, 320, 3) and picture.dtype == np.uint8
        left = picture[30:210, 40:260]  # the picture without axes and key
        assert coloured(left).sum() > 20
        later = painter.draw(impact(2.5e-6, dim))
    assert (picture != later).any(axis=2).sum() > 20


def test_2d_frame_puts_pixels_at_the_coordinates_of_its_axes():
    state = impact()
    for name in state.fields:
        state.fields[name] = state.fields[name][:2]
    state.fields["x"] = np.array([[0.0, 0.0, 0.0], [20e-3, 10e-3, 0.0]])
    state.fields["body"] = np.array([0, 0], dtype=np.int32)
    look = choose([state], field="id", size=(800, 600), cmap="coolwarm", range=(0.0, 1.0))
    with Painter(look) as painter:
        rows, columns = np.nonzero(coloured(painter.draw(state))[:, : int(0.85 * 800)])
        to_pixels = painter._content.axes.transData.transform
    spots = [(columns < 400), (columns >= 400)]
    for spot, place in zip(spots, state.x * 1e3, strict=True):
        x, y = to_pixels(place[:2])
        assert columns[spot].mean() == pytest.approx(x, abs=1.0)
        assert rows[spot].mean() == pytest.approx(600 - y, abs=1.0)


def test_render_writes_one_frame_per_snapshot(folder):
    files = render.render(folder, size=SMALL)
    assert files == [folder / "frames" / f"pressure_{k:04d}.png" for k in range(3)]
    pictures = [np.asarray(Image.open(file)) for file in files]
    assert all(coloured(picture).sum() > 100 for picture in pictures)
    key = np.s_[60:, int(0.87 * 320) :]
    assert (pictures[0][key] == pictures[2][key]).all()  # one colour range for all
    assert (pictures[0] != pictures[2]).any()


def test_render_every_other_into_another_folder(folder, tmp_path):
    files = render.render(folder, field="velocity_x", every=2, output=tmp_path / "a" / "b", size=SMALL)
    assert [file.name for file in files] == ["velocity_x_0000.png", "velocity_x_0002.png"]
    assert all(file.parent == tmp_path / "a" / "b" for file in files)


def test_movie(folder):
    pytest.importorskip("imageio_ffmpeg")
    import imageio.v2

    files = render.render(folder, size=SMALL, movie=folder / "film.mp4")
    assert files[-1] == folder / "film.mp4"
    with imageio.v2.get_reader(files[-1]) as film:
        frames = [np.asarray(frame) for frame in film]
    assert len(frames) == 3 and frames[0].shape == (240, 320, 3)
    assert not list(folder.glob(".*"))


def test_movie_without_its_packages(folder, monkeypatch):
    import importlib

    def missing(name):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(InputError, match=r'pip install "warpsph\[movie\]"'):
        render.render(folder, movie=folder / "film.mp4")
    assert not (folder / "frames").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"field": "presure"}, "field 'presure' is unknown .did you mean 'pressure'.*allowed: .*pressure"),
        ({"view": "iso"}, "2D view 'iso' is unknown; allowed: xy"),
        ({"range": (2.0, 1.0)}, "range"),
        ({"range": (math.nan, 1.0)}, "range"),
        ({"cut": "y"}, "cut = 'y' does not go with a scene in 2D"),
        ({"size": (10, 10)}, "size"),
        ({"every": 0}, "every"),
        ({"cmap": "rainbows"}, "cmap 'rainbows' is unknown"),
        ({"movie": "film.avi"}, r"movie = 'film.avi'.*\.mp4"),
    ],
)
def test_bad_arguments_write_nothing(folder, arguments, message):
    with pytest.raises(InputError, match=message):
        render.render(folder, **arguments)
    assert not (folder / "frames").exists()


def test_folder_without_snapshots(tmp_path):
    with pytest.raises(InputError, match="holds no snapshots"):
        render.render(tmp_path)


def test_frame_of_a_running_solver(tmp_path):
    look = choose([impact()], size=SMALL)
    look = dataclasses.replace(look, limits=(-1e9, 5e9))
    render.frame(impact(1e-6), tmp_path / "pressure_0001.png", look)
    assert coloured(np.asarray(Image.open(tmp_path / "pressure_0001.png"))).sum() > 100


def window(kind: str, *, initialise=lambda: None):
    """Stand-in for VTK's window on a machine that cannot draw."""
    return types.SimpleNamespace(GetClassName=lambda: kind, Initialize=initialise, IsCurrent=lambda: False)


def test_machine_without_opengl_is_told_so():
    with pytest.raises(RunError, match="cannot draw off screen: OpenGL is missing"):
        spheres._check(window("vtkEGLRenderWindow"))


def test_window_without_its_library_is_not_touched(monkeypatch):
    monkeypatch.setattr(spheres, "OSMESA", ("libNoSuchLibrary.so",))
    touched = window("vtkOSOpenGLRenderWindow", initialise=lambda: pytest.fail("VTK may crash here"))
    with pytest.raises(RunError, match="cannot draw off screen: OpenGL is missing"):
        spheres._check(touched)


def test_broken_particles_are_left_out():
    state = impact()
    look = choose([state], size=SMALL)
    state.fields["x"][:3] = np.nan
    state.fields["p"][5] = np.inf
    with Painter(look) as painter:
        assert coloured(painter.draw(state)).sum() > 100


def test_cut_takes_away_the_half_towards_the_camera():
    state = impact(0.0, 3)
    cut = choose([state], view="iso", cut="y").cut
    assert cut.position == pytest.approx(2.5e-3)
    assert (state.x[cut.mask(state.x), 1] > 2.5e-3).all()
    assert (state.x[choose([state], view="y", cut="y=1e-3").cut.mask(state.x), 1] <= 1e-3).all()
    for text in ("w", "y=", "y=wide", ""):
        with pytest.raises(InputError, match="allowed: x, y or z"):
            choose([state], cut=text)


@pytest.mark.parametrize(("cut", "view"), [("x", "yz"), ("y=1e-3", "xz"), (" z = 0", "xy"), (None, "iso")])
def test_a_cut_is_seen_straight_on_unless_a_view_is_named(cut, view):
    state = impact(0.0, 3)
    assert choose([state], cut=cut).view == view
    assert choose([state], cut=cut, view="iso").view == "iso"


def test_camera_comes_closer_to_what_a_cut_leaves():
    box = np.array([[-1.0, 2.0, 3.0], [4.0, 2.5, 5.0]])
    for view, kept in (("-y", [2.2, 2.5]), ("y", [2.0, 2.2])):
        clipped = camera.parse_cut("y=2.2", view, box).clip(box)
        np.testing.assert_array_equal(clipped[:, 1], kept)
        np.testing.assert_array_equal(clipped[:, ::2], box[:, ::2])
    np.testing.assert_array_equal(camera.parse_cut("y=9", "y", box).clip(box), box)


def test_aspect_is_that_of_the_side_that_is_seen():
    box = np.array([[-1.0, 2.0, 3.0], [4.0, 2.5, 5.0]])
    for view, aspect in (("xy", 5.0 / 0.5), ("xz", 5.0 / 2.0), ("yz", 0.5 / 2.0)):
        assert camera.aspect_3d(box, view) == pytest.approx(aspect)


@pytest.mark.parametrize("view", camera.VIEWS)
@pytest.mark.parametrize("aspect", [0.5, 2.0])
def test_perspective_camera_shows_the_whole_box_and_no_more(view, aspect):
    box = np.array([[-1.0, 2.0, 3.0], [4.0, 2.5, 5.0]])
    placed = camera.place_3d(box, aspect, view)
    corners = np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3) - placed.position
    depth = corners @ np.cross(placed.up, placed.right)
    slope = math.tan(math.radians(camera.ANGLE / 2))
    reach = np.maximum(abs(corners @ placed.up), abs(corners @ placed.right) / aspect) / (depth * slope)
    assert (depth > 0.0).all() and reach.max() == pytest.approx(1.0)


def test_far_flung_particles_do_not_shrink_the_picture():
    states = [impact(0.0, 3), impact(0.0, 3)]
    states[1].fields["x"] = states[1].x.copy()
    states[1].fields["x"][7] += 10.0
    with_spall = choose(states).box
    assert with_spall[1].max() < 0.02
    assert (with_spall[0] == states[0].x.min(axis=0)).all()


def test_colour_range_is_robust_and_centred():
    state = impact(0.0, 3)
    state.fields["p"][0] = 1e15
    look = choose([state])
    assert -1.01e9 < look.limits[0] < -0.9e9 and 1.9e9 < look.limits[1] < 2.01e9
    assert look.centred and look.cmap == "coolwarm" and look.extend == "max"
    look = choose([state], range=(-2e9, 3e9), cmap="magma")
    assert look.limits == (-2e9, 3e9) and look.cmap == "magma" and not look.centred


def test_uniform_field_has_a_range_and_an_index_has_names():
    look = choose([impact()], field="density")
    assert look.limits[0] < 2700.0 < look.limits[1]
    look = choose([impact()], field="body")
    assert look.categories == tuple(impact().bodies) and look.limits == (-0.5, 1.5)
    assert choose([impact()], field="fixed").categories[:4] == ("free", "x", "y", "xy")


def test_kernel_types_have_their_colours_and_only_those_that_occur_a_name():
    states = [impact(0.0, 3), impact(1e-6, 3)]
    states[1].fields["kernel_type"][::2] = 2
    look = choose(states, field="kernel_type", size=SMALL)
    assert look.cmap == KERNEL_COLOURS and look.occurring == (0, 2)
    assert choose(states, field="kernel_type", cmap="viridis").cmap == "viridis"
    with Painter(look) as painter:
        legend = painter._content.axes.figure.legends[0]
        assert [text.get_text() for text in legend.get_texts()] == ["Eulerian", "eroded"]
        pictures = [painter.draw(state).astype(int) for state in states]
    blue, yellow = (
        (lambda p: (p[..., 2] - p[..., 0] > 40).sum()),
        (lambda p: (p[..., 0] - p[..., 2] > 60).sum()),
    )
    assert blue(pictures[0]) > blue(pictures[1]) > 100
    assert yellow(pictures[1]) > yellow(pictures[0]) + 100


def test_every_quantity_on_offer_can_be_had():
    state = impact()
    for name in names(state):
        quantity = scalar(state, name)
        assert quantity.values.shape == (len(state.x),) and quantity.values.dtype == np.float64
    np.testing.assert_array_equal(scalar(state, "p").values, state.p)
    np.testing.assert_array_equal(scalar(state, "velocity_x").values, state.v[:, 0])
    np.testing.assert_array_equal(scalar(state, "velocity").values, scalar(state, "speed").values)
    np.testing.assert_array_equal(scalar(state, "deviatoric_stress_xz").values, state.tau[:, 0, 2])


def test_stresses_of_uniaxial_tension():
    state = impact()
    state.fields["tau"] = np.zeros_like(state.tau) + np.diag([2.0, -1.0, -1.0]) * 1e8
    state.fields["p"] = np.full_like(state.p, -1e8)
    np.testing.assert_allclose(scalar(state, "von_mises").values, 3e8)
    np.testing.assert_allclose(scalar(state, "stress_xx").values, 3e8)
    np.testing.assert_allclose(scalar(state, "stress_yy").values, 0.0, atol=1.0)


@pytest.mark.parametrize(
    ("unit", "largest", "factor", "text"),
    [
        ("Pa", 1.94e10, 1e-9, "GPa"),
        ("m", 0.02, 1e3, "mm"),
        ("m/s", 3100.0, 1e-3, "km/s"),
        ("m/s", 1000.0, 1e-3, "km/s"),
        ("kg/m^3", 2700.0, 1.0, "kg/m³"),
        ("J/kg", 3e6, 1e-6, "MJ/kg"),
        ("1/s", 5e7, 1e-6, "10⁶ 1/s"),
        ("1", 0.5, 1.0, ""),
        ("Pa", 0.0, 1.0, "Pa"),
    ],
)
def test_units_that_read_well(unit, largest, factor, text):
    assert units.scale(unit, largest) == (pytest.approx(factor), text)


def test_time_stamp_keeps_one_unit():
    assert [time_stamp(t, 8e-6) for t in (0.0, 4e-7, 8e-6)] == ["0.00 µs", "0.40 µs", "8.00 µs"]
    assert time_stamp(1e-5, 1.53e-4) == "10.0 µs"
    assert time_stamp(0.0, 0.0) == "0.00 s"
