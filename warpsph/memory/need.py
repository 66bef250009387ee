"""What a run will need of memory, known before anything is allocated; `usage.usage` tells what it has then taken."""

from dataclasses import dataclass

import numpy as np
import warp as wp

from warpsph.device.blocks import CUDA_STEP_BLOCKS, Blocks
from warpsph.fields import of_groups
from warpsph.kernels.guards import COLUMNS
from warpsph.kernels.ledger import MAXIMA, SUMS
from warpsph.kernels.spec import Spec
from warpsph.particles import element_types
from warpsph.scene import SceneData
from warpsph.schemes.scheme import Scheme
from warpsph.search.block import LINE
from warpsph.search.cells import count_cells, order_of
from warpsph.search.rows import lasting
from warpsph.search.tiles import first_width, tiles_of

from . import census
from .policy import Policy

EXTREMES = 7
"""Numbers that each block of the time step leaves: dt, and the least and largest velocity."""

AT_HAND = 160
"""Bytes for each particle that an output takes beside its copy of the state: a tensor, in order and in the file's form."""


@dataclass(frozen=True)
class Need:
    """Memory of a run.

    Attributes:
        particles: Number of particles.
        device: Bytes on the device, by what they hold.
        copies: Copies of the state on the host that outputs may take at a time.
        outputs: Bytes of these, and of what writing them takes.
        later: Bytes more on the device if all particles turn Eulerian.
    """

    particles: int
    device: dict[str, int]
    copies: int
    outputs: int
    later: int = 0

    @property
    def on_device(self) -> int:
        """Bytes on the device."""
        return sum(self.device.values())


def estimate(
    data: SceneData, spec: Spec, scheme: Scheme, policy: Policy, device: wp.Device, copies: int = 0
) -> Need:
    """Estimate what a solver of a scene will take on a device.

    Neighbours are counted for a sample of the particles, and their rows get what the policy gives them; rows that
    outgrow that in the run get more.

    Args:
        data: The scene.
        spec: Dimension and precision.
        scheme: The scheme; what its arrays take is found by having them made for one and for two particles.
        policy: Room of the rows.
        device: The device.
        copies: Copies of the state on the host that outputs may take at a time.
    """
    n, size = len(data.x), wp.types.type_size_in_bytes
    types = element_types(spec, scheme.parts)
    fields = [types[f.kind] for f in of_groups(scheme.groups)]
    state = n * sum(map(size, fields))
    rows, all_rows, beside = _rows(data, spec, scheme, policy, device)
    work = _work_space(n, data, scheme, max(map(size, fields)), device)
    neighbours = max(rows, work) if scheme.searching else 0
    found = {"fields": state, "neighbours": neighbours + beside, "work": _work(n, spec, scheme, device)}
    if "lagrangian" in scheme.groups:
        found["reference"] = _reference(data, spec, scheme, policy)
    listed = n * (size(spec.point) + 4 * ("lagrangian" in scheme.groups)) if scheme.searching else 0
    kept = n * size(spec.real) * len(scheme.lasting)
    outputs = copies * (state + listed + kept) + (AT_HAND * n if copies else 0)
    return Need(n, found, copies, outputs, max(all_rows - neighbours, 0) if scheme.searching else 0)


def _rows(
    data: SceneData, spec: Spec, scheme: Scheme, policy: Policy, device: wp.Device
) -> tuple[int, int, int]:
    """Bytes of the entries of present rows, of them if every particle has a row, and of what else the search keeps."""
    n, size = len(data.x), wp.types.type_size_in_bytes
    radius = scheme.support * data.h + data.numerics.skin * data.h
    most, hands = tiles_of(device)
    selective = "lagrangian" in scheme.groups
    point, vec, real = map(size, (spec.point, spec.vec, spec.real))
    beside = n * (4 * (4 + selective) + point)  # order, start, n_neigh, member, role and x_listed
    beside += 4 * _cells(data, radius, [axis for axis, _ in data.planes])
    beside += most * (2 * point + 2 * vec + 4 + 16 * selective + hands * (real + (hands > 1) * 2 * vec))
    if not scheme.searching:
        return 0, 0, beside
    chosen = _chosen(data, spec, radius)
    counts = census.neighbours(data, chosen.ravel(), radius).reshape(chosen.shape)
    everyone = 4 * policy.growth * _entries(n, counts, policy)
    if not selective:
        return int(everyone), int(everyone), beside
    width = first_width(n, most, data.spacing, data.dim)
    listed = census.with_rows(data, radius, width, most)
    counts[~listed[chosen]] = 0
    return int(4 * policy.growth * _entries(n, counts, policy)), int(everyone), beside


def _chosen(data: SceneData, spec: Spec, radius: float) -> np.ndarray:
    """Particles whose neighbours are counted, shape [groups, columns]: a group's rows stand side by side."""
    if spec.columns == 1:
        return census.sample(len(data.x))[:, None]
    counts = count_cells(data.x, data.dim, radius, [axis for axis, _ in data.planes])
    return census.groups(order_of(data.x, counts, radius), spec.columns)


def _entries(n: int, counts: np.ndarray, policy: Policy) -> float:
    """Entries that n rows get, see `kernels.neighbours.reserve`; ``counts``: neighbours in some groups of rows."""
    columns, longest = counts.shape[1], counts.max(axis=1)
    rooms = -(-(longest + longest // policy.divisor + policy.spare) // policy.lanes) * policy.lanes
    return -(-n // columns) * columns * float(rooms.mean())


def _work_space(n: int, data: SceneData, scheme: Scheme, largest: int, device: wp.Device) -> int:
    """Bytes that rebuilding the rows works in: sorting and tiles, at a time on a CPU; a field that changes its order."""
    radius = scheme.support * data.h + data.numerics.skin * data.h
    cells, tiles = 16 * n + 4 * _cells(data, radius, [axis for axis, _ in data.planes]), 24 * n
    both = cells + tiles if device.is_cpu else max(cells, tiles)
    return max(both, largest * n) + 8 * wp.types.type_size_in_bytes(LINE)


def _cells(data: SceneData, reach: float, mirrored: list[int]) -> int:
    """Cells of a search."""
    return int(np.prod(count_cells(data.x, data.dim, reach, mirrored)))


def _reference(data: SceneData, spec: Spec, scheme: Scheme, policy: Policy) -> int:
    """Bytes of reference rows and of what goes with each entry and each particle."""
    n, size, reach = len(data.x), wp.types.type_size_in_bytes, scheme.support * data.h
    chosen = _chosen(data, spec, reach + data.numerics.skin * data.h)  # in the order for the present rows
    counts = census.neighbours(data, chosen.ravel(), reach, same_body=True).reshape(chosen.shape)
    entries = _entries(n, counts, lasting(policy))
    corrected = scheme.reference_correction
    own = 8 + size(spec.vec) + (size(spec.mat) + size(spec.vec) if corrected else 0)
    rows = max(4 * entries, 16 * n + 4 * _cells(data, reach, []))
    return int(rows + (1 + corrected) * size(spec.real) * entries + own * n)


def _work(n: int, spec: Spec, scheme: Scheme, device: wp.Device) -> int:
    """Bytes of the arrays of a step, and of what the time step, the ledger and the guards take block by block."""
    with wp.ScopedDevice("cpu"):
        one, two = (sum(array.capacity for array in scheme.arrays(k).values()) for k in (1, 2))
    columns = len(SUMS) + len(MAXIMA) + COLUMNS
    step = Blocks(n, device.is_cuda, CUDA_STEP_BLOCKS if device.is_cuda else None)
    extremes = (step.count + sum(step.folds)) * wp.types.type_size_in_bytes(spec.real) * EXTREMES
    return one + (n - 1) * (two - one) + 8 * Blocks(n, device.is_cuda).count * columns + extremes
