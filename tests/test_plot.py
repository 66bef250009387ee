import numpy as np
import pytest
from PIL import Image

from warpsph.errors import InputError
from warpsph.plot import group, plot
from warpsph.storage.history import History

COLUMNS = [
    ("time", "s"), ("step", "1"), ("dt", "s"), ("kinetic_energy", "J/m"), ("internal_energy", "J/m"),
    ("total_energy", "J/m"), ("energy_error", "1"), ("momentum_x", "kg/s"), ("momentum_y", "kg/s"),
    ("pressure_min", "Pa"), ("pressure_max", "Pa"), ("crater_diameter", "m"),
]  # fmt: skip


def write(folder, rows):
    with History(folder / "history.csv", COLUMNS) as table:
        for k in range(rows):
            table.write([1e-7 * k, k, 1e-9, 100.0 - k, k, 100.0, 1e-13 * k, 3.0, 0.0, -1e9, 2e10, np.nan])


def test_panels():
    panels = group([name for name, _ in COLUMNS[2:]], dict(COLUMNS))
    assert panels == [
        ("energy", "J/m", ["kinetic_energy", "internal_energy", "total_energy"]),
        ("energy_error", "1", ["energy_error"]),
        ("dt", "s", ["dt"]),
        ("momentum", "kg/s", ["momentum_x", "momentum_y"]),
        ("pressure", "Pa", ["pressure_min", "pressure_max"]),
        ("crater_diameter", "m", ["crater_diameter"]),
    ]


@pytest.mark.parametrize("rows", [1, 20])
def test_plot_goes_to_the_folder(tmp_path, rows):
    write(tmp_path, rows)
    assert plot(tmp_path) == tmp_path / "plot.png"
    picture = np.asarray(Image.open(tmp_path / "plot.png"))
    assert (picture[..., :3] < 128).any(axis=2).mean() > 0.005


def test_suffix_gives_the_format(tmp_path):
    write(tmp_path, 5)
    assert "<svg" in plot(tmp_path, tmp_path / "energies.svg").read_text()
    with pytest.raises(InputError, match=r"output = '.*plot.jpg' is not allowed; allowed: .*\.png, \.svg"):
        plot(tmp_path, tmp_path / "plot.jpg")


def test_nothing_to_plot(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        plot(tmp_path)
    write(tmp_path, 0)
    with pytest.raises(InputError, match="has no rows yet"):
        plot(tmp_path)
    assert not (tmp_path / "plot.png").exists()
