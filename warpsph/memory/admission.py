"""Whether a run fits into memory: told, and refused if not, before anything is allocated."""

from collections.abc import Callable

import warp as wp

from warpsph.kernels.spec import Spec
from warpsph.lattices import coarse
from warpsph.messages import machine, values
from warpsph.scene import SceneData
from warpsph.schemes.factory import make_scheme
from warpsph.search.neighbours import MAX_PARTICLES

from . import available
from .need import Need, estimate
from .policy import policy_of


def admit(
    data: SceneData, need: Need, spec: Spec, device: wp.Device, say: Callable[[str], None] | None = None
) -> None:
    """Tell what a run needs of memory, and refuse it if that is not there.

    Args:
        data: The scene.
        need: What it needs.
        spec: Dimension and precision.
        device: The device.
        say: Takes the line that says it.

    Raises:
        InputError: It does not fit; says what would. Or there are more particles than an entry of a row can name.
    """
    if need.particles > MAX_PARTICLES:
        raise values.outside("particles", need.particles, f"up to {MAX_PARTICLES} on one device")
    if say is not None:
        say(line(need, device))
    short = _short(need, device)
    if short is None:
        return
    place, needed, free = short
    text = f"{need.particles} particles need about {machine.size(needed)}"
    raise machine.no_room(text, place, free, _fitting(data, need, spec, device, free / needed))


def line(need: Need, device: wp.Device) -> str:
    """What a run needs, in one line: ``17850 particles: about 38.1 MB on cpu of 21.3 GB free (fields 6.8 MB, ...)``."""
    on, at_host = need.device, {"output copies": need.outputs}
    kinds = on if device.is_cuda else on | at_host
    text = f"{need.particles} particles: about {_told(kinds, device.alias, available.on_device(device))}"
    if device.is_cuda and need.outputs:
        text += f", {_told(at_host, 'the host', available.on_host())}"
    if need.later:
        text += f"; {machine.size(need.later)} more if all of them turn Eulerian"
    return text


def _told(kinds: dict[str, int], place: str, free: int | None) -> str:
    of = "" if free is None else f" of {machine.size(free)} free"
    parts = ", ".join(f"{name} {machine.size(value)}" for name, value in kinds.items() if value)
    return f"{machine.size(sum(kinds.values()))} on {place}{of} ({parts})"


def _short(need: Need, device: wp.Device) -> tuple[str, int, int] | None:
    """Where memory is short: the place, and the bytes that are needed and free there; None if nowhere."""
    where = {device.alias: (need.on_device, available.on_device(device))}
    if device.is_cuda:
        where["the host"] = need.outputs, available.on_host()
    else:
        where[device.alias] = need.on_device + need.outputs, where[device.alias][1]
    for place, (needed, free) in where.items():
        if free is not None and needed > free:
            return place, needed, free
    return None


def _fitting(data: SceneData, need: Need, spec: Spec, device: wp.Device, share: float) -> list[str]:
    """What would fit: fewer particles, single precision, another device."""
    most = int(need.particles * share)
    found = ["a machine, or limits, with more memory"]
    if most:
        spacing = coarse(data.spacing * share ** (-1.0 / data.dim))
        found = [f"up to about {most} particles, with a spacing of {spacing:g} m"]
    single = Spec(data.dim, wp.float32, lanes=spec.lanes)
    if spec.real is not wp.float32 and _fits(data, single, device, need.copies):
        found.append("--precision float32")
    for other in wp.get_cuda_devices():
        beside = Spec(data.dim, spec.real, spec.place, lanes=policy_of(other).lanes)
        if other != device and _fits(data, beside, other, need.copies):
            found.append(f"--device {other.alias}")
    return found


def _fits(data: SceneData, spec: Spec, device: wp.Device, copies: int) -> bool:
    need = estimate(data, spec, make_scheme(data, spec), policy_of(device), device, copies)
    return _short(need, device) is None
