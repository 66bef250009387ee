import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image
from states import impact

from warpsph.drawing.look import KERNEL_COLOURS
from warpsph.errors import InputError
from warpsph.quality.kernel_panels import (
    PROJECTILE_COLOURS,
    KernelColours,
    draw_debris,
    draw_kernel_types,
    draw_pressures,
    nearest,
)
from warpsph.quality.panels import MARGIN, Colouring, Sight
from warpsph.storage import snapshot

BOX = np.array([[-2e-3, -2e-3], [15e-3, 7e-3]])


def run(folder, times, dim=2, kernel_type=1):
    """A run with a snapshot at each time; the block has one kernel type, the plate is Eulerian."""
    (folder / "snapshots").mkdir(parents=True)
    for number, time in enumerate(times):
        state = impact(time, dim)
        state.fields["kernel_type"][state.of("block")] = kernel_type
        snapshot.write(folder / "snapshots" / f"block_{number:04d}.vtkhdf", state)
    return folder


def panel(picture, number, width, height):
    """A panel of the first row."""
    left, top = MARGIN["left"] + number * (width + MARGIN["gap"]), MARGIN["top"] + MARGIN["gap"]
    return picture[top : top + height, left : left + width]


def shows(picture, colour, share=0.02):
    """Whether a share of a picture has a colour."""
    near = abs(picture.astype(float) - 255.0 * np.array(to_rgb(colour))).max(axis=-1) < 12.0
    return near.mean() > share


def read(path):
    return np.asarray(Image.open(path).convert("RGB"))


def test_kernel_types_over_time(tmp_path):
    runs = {"mixed": run(tmp_path / "a", (0.0, 1e-6, 2e-6)), "left out": tmp_path / "none"}
    path = tmp_path / "kernels.png"
    times, width, height = (1e-6, 2e-6, 5e-6), 300, round(300 * 9 / 17)
    draw_kernel_types(runs, path, rows=["mixed"], times=times[:2], box=BOX, width=width)
    picture = read(path)
    assert picture.shape[1] == MARGIN["left"] + 2 * (width + MARGIN["gap"]) + KernelColours.room
    first, second = (panel(picture, number, width, height) for number in range(2))
    for shown in (first, second):
        light, dark = shown[:, : width // 2], shown[:, -width // 2 :]
        assert shows(light, KERNEL_COLOURS[1]) and not shows(light, KERNEL_COLOURS[0])
        assert shows(dark, KERNEL_COLOURS[0]) and not shows(dark, KERNEL_COLOURS[1])
    assert (first != second).any()


def test_the_projectile_has_its_own_colours(tmp_path):
    runs = {"mixed": run(tmp_path / "a", (1e-6,))}
    path = tmp_path / "kernels.png"
    draw_kernel_types(runs, path, rows=runs, times=[1e-6], box=BOX, projectile="block", width=300)
    shown = panel(read(path), 0, 300, 159)
    assert shows(shown, PROJECTILE_COLOURS[1]) and shows(shown, KERNEL_COLOURS[0])
    assert not shows(shown, KERNEL_COLOURS[1])


def test_the_legend_names_what_occurs():
    state = impact()
    state.fields["kernel_type"][state.of("block")] = [1] * 35 + [2]
    assert list(KernelColours()._kinds([state])) == ["Eulerian", "Total Lagrangian", "eroded"]
    assert list(KernelColours("block")._kinds([state])) == ["block, Total Lagrangian", "eroded", "Eulerian"]
    assert list(KernelColours()._kinds([impact()])) == ["Eulerian"]


def test_a_time_without_a_snapshot_leaves_its_panel_empty(tmp_path):
    runs = {"long": run(tmp_path / "a", (1e-6, 2e-6)), "short": run(tmp_path / "b", (1e-6,))}
    path, width, height = tmp_path / "pressures.png", 200, round(200 * 9 / 17)
    arguments = {"times": (1e-6, 2e-6), "box": BOX, "limit": 1e9, "width": width}
    draw_pressures(runs, path, rows=["short", "long"], **arguments)
    picture = read(path)
    assert (panel(picture, 0, width, height) != 255).any() and (panel(picture, 1, width, height) == 255).all()
    assert nearest(runs["short"], 1.01e-6).time == 1e-6 and nearest(runs["short"], 1.5e-6) is None
    with pytest.raises(InputError, match="no run of short has a snapshot"):
        draw_pressures(runs, path, rows=["short"], **(arguments | {"times": (3e-6,)}))


def test_debris_is_cut_open_above_and_whole_below(tmp_path):
    runs = {"one": run(tmp_path / "a", (0.0,), 3), "two": run(tmp_path / "b", (0.0,), 3, kernel_type=0)}
    box, path = np.array([[-1e-3, -1e-3, -1e-3], [14e-3, 6e-3, 6e-3]]), tmp_path / "debris.png"
    draw_debris(runs, path, columns=runs, box=box, cut="y=2.5e-3", projectile="block", width=200)
    picture = read(path)
    heights = [round(200 / Sight(cut=cut).aspect(box)) for cut in ("y=2.5e-3", None)]
    assert picture.shape[0] == sum(heights) + 2 * MARGIN["gap"] + MARGIN["top"] + MARGIN["bottom"]
    reddish = [panel(picture, k, 200, heights[0]).astype(int) @ (1, 0, -1) > 25 for k in range(2)]
    assert all(shown[:, :100].mean() > 0.1 and not shown[:, 130:].any() for shown in reddish)
    brightness = [panel(picture, k, 200, heights[0])[reddish[k]].mean() for k in range(2)]
    assert brightness[0] > 1.3 * brightness[1]


def test_cross_section_shows_what_lies_behind_the_plane():
    state, box = impact(0.0, 3), np.array([[-1e-3] * 3, [14e-3, 6e-3, 6e-3]])
    colours = np.where(state.x[:, 1:2] > 2.5e-3, [[1.0, 0.0, 0.0, 1.0]], [[0.0, 0.0, 1.0, 1.0]])
    whole = Sight("xz").picture(state, colours, box, (200, 100)).astype(int)
    opened = Sight(cut="y=2.5e-3").picture(state, colours, box, (200, 100)).astype(int)
    blue, red = (
        [(picture @ sign > 60).sum() for picture in (whole, opened)] for sign in ((-1, 0, 1), (1, 0, -1))
    )
    assert blue[0] > 10 * red[0]  # red is seen at the edges of the gap between the bodies
    assert red[1] > 1000 and blue[1] == 0


def test_bar_is_pointed_where_values_go_beyond_it():
    states = [impact()]  # pressures from -1 to 2 GPa; those of the block are the lower half
    assert Colouring("pressure", (-1e9, 2e9))._extend(states) == "neither"
    assert Colouring("pressure", (-1e9, 1e9))._extend(states) == "max"
    assert Colouring("pressure", (0.7e9, 1e9))._extend(states) == "both"
    assert Colouring("pressure", (-5e8, 1e9), black="block")._extend(states) == "max"
