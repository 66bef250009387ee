"""A picture of the collapsing ring: its radii over time beside the exact ones."""

import io
from pathlib import Path

import numpy as np

from warpsph.storage import atomic, history

STYLES = {"coarse": (0, (4, 2)), "fine": "-"}
"""Line of each resolution."""

COLOURS = ("#2a9d8f", "#e9a03b", "#c8376f")
"""Colours of the schemes, in the order they come."""


def draw_radii(
    runs: dict[tuple[str, str], Path], exact: tuple[np.ndarray, np.ndarray, np.ndarray], path: Path
) -> None:
    """Draw the radii of both surfaces, and how far they are from the exact ones, into a PNG file.

    Args:
        runs: Folders of runs by scheme and resolution, one of `STYLES`.
        exact: Times [s] and exact inner and outer radii [m], each of shape [n].
        path: The file.

    Raises:
        DiskError: If the file cannot be written.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 4.4), dpi=100, layout="constrained")
    whole, difference = figure.subplots(1, 2)
    times = exact[0]
    for radii in exact[1:]:
        whole.plot(1e6 * times, 1e3 * radii, color="black", linewidth=1.2, label="rigid-plastic")
    colours = dict(zip(dict.fromkeys(scheme for scheme, _ in runs), COLOURS, strict=False))
    for (scheme, resolution), folder in runs.items():
        columns = history.read(folder / "history.csv")[2]
        time = columns["time"]
        look = {"color": colours[scheme], "linestyle": STYLES[resolution], "linewidth": 1.4}
        for name, radii in zip(("inner_radius", "outer_radius"), exact[1:], strict=True):
            whole.plot(1e6 * time, 1e3 * columns[name], label=f"{scheme}, {resolution}", **look)
            off = columns[name] - np.interp(time, times, radii)
            difference.plot(1e6 * time, 1e3 * off, label=f"{scheme}, {resolution}", **look)
    whole.set_title("inner and outer radius [mm]", fontsize=11, loc="left")
    difference.set_title("difference from the rigid-plastic radii [mm]", fontsize=11, loc="left")
    difference.axhline(0.0, color="black", linewidth=1.2, zorder=0)
    for axes in (whole, difference):
        axes.set_xlabel("time [µs]")
        axes.grid(color="#dddddd", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
    handles, labels = whole.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    whole.legend(once.values(), once.keys(), frameon=False, fontsize=9)
    memory = io.BytesIO()
    figure.savefig(memory, format="png")
    atomic.write(path, memory.getbuffer())
