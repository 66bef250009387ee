"""Contact: the force of its potential, its conservation laws, who takes part, and how interpenetration is measured."""

import math

import numpy as np
import pytest
import warp as wp
from tools import DOUBLE, SPACING, jittered, launch, scene

from warpsph.config import KERNELS, Contact
from warpsph.contact import contact_constants
from warpsph.kernels.contact import make_contact
from warpsph.kernels.kernel_type import ERODED
from warpsph.kernels.mirror import INDEX_BITS
from warpsph.kernels.parts import CONTACT, PARTS, part_types
from warpsph.kernels.smoothing import make_smoothing
from warpsph.watching.penetration import interpenetration

MODULUS = np.array([80e9, 30e9])
STIFFNESS = 0.25
H = 1.2 * SPACING
ALL = tuple(range(len(PARTS)))


def cubic_spline(r, dim):
    """W and dW/dr."""
    q, sigma = r / H, {1: 2 / 3, 2: 10 / (7 * math.pi), 3: 1 / math.pi}[dim] / H**dim
    w = np.where(q < 1, 1 - 1.5 * q**2 + 0.75 * q**3, 0.25 * np.maximum(2 - q, 0) ** 3)
    dw = np.where(q < 1, -3 * q + 2.25 * q**2, -0.75 * np.maximum(2 - q, 0) ** 2)
    return sigma * w, sigma * dw / H


def cloud(dim, seed=0):
    """Disordered particles of three bodies and two materials; two are eroded."""
    rng, x = np.random.default_rng(seed), jittered(dim, {1: 24, 2: 6, 3: 4}[dim], seed=seed)
    n = len(x)
    moving = np.zeros((n, 3))
    moving[:, :dim] = rng.normal(size=(n, dim)) * 100.0
    kind = rng.integers(0, 2, n)
    kind[:2] = ERODED
    return {
        "x": x,
        "v": moving,
        "m": rng.uniform(0.5, 2.0, n),
        "vol": rng.uniform(0.7, 1.3, n) * SPACING**dim,
        "body": rng.integers(0, 3, n),
        "mat": rng.integers(0, 2, n),
        "kernel_type": kind,
    }


def pair(dim, r, **changes):
    """Two particles of two bodies at distance r along a general direction."""
    x = np.zeros((2, 3))
    x[1, :dim] = r * np.array({1: [1.0], 2: [0.6, 0.8], 3: [0.48, 0.64, 0.6]}[dim])
    given = {"x": x, "v": np.zeros((2, 3)), "m": np.ones(2), "vol": np.full(2, SPACING**dim)}
    integers = {"body": np.array([0, 1]), "mat": np.zeros(2, int), "kernel_type": np.zeros(2, int)}
    return given | integers | changes


def everybody(n):
    """Rows that name every other particle."""
    return [[j for j in range(n) if j != i] for i in range(n)]


def contact(spec, state, rows=None, kernel="cubic_spline", plane=None, **before):
    """Run the kernel; every output by its name, in double precision."""
    n = len(state["x"])
    rows = everybody(n) if rows is None else rows
    types = part_types(spec, len(PARTS))
    before = {
        "dvdt": np.zeros((n, 3)),
        "dedt": np.zeros(n),
        "contact_rate": np.zeros(n),
        "cover": np.zeros(n),
        "part_a": np.zeros((n, 4, 3)),
        "part_power": np.zeros((n, 4)),
        "dt": np.ones(1),
    } | before
    parts = {
        "part_a": wp.array(before.pop("part_a"), dtype=types.acceleration, device="cpu"),
        "part_power": wp.array(before.pop("part_power"), dtype=types.power, device="cpu"),
    }
    state = {k: a.astype(np.int32) if a.dtype.kind == "i" else a for k, a in state.items()}
    found = launch(
        make_contact(spec, make_smoothing(spec, kernel), plane is not None, ALL), n, spec,
        **state, **before, **parts,
        contact_modulus=MODULUS, contact_scale=STIFFNESS / SPACING**spec.dim, h=H, spacing=SPACING,
        plane=spec.vec(*(plane or (0.0, 0.0, 0.0))),
        start=np.cumsum([0, *map(len, rows)]).astype(np.int32),
        n_neigh=np.array([len(row) for row in rows], np.int32),
        neigh=np.concatenate([*rows, []]).astype(np.int32),
        n_strangers=np.ones(n, np.int32),
    )  # fmt: skip
    return {k: a.astype(float) for k, a in (found | {k: a.numpy() for k, a in parts.items()}).items()}


def pairs(dim, state):
    """Reference of all pairs: stiffness V V Kc where they are in contact, separation, distance, W/W(dp), its slope."""
    body, kind = state["body"], state["kernel_type"]
    on = (body[:, None] != body) & (kind[:, None] != ERODED) & (kind != ERODED)
    modulus = np.minimum(MODULUS[state["mat"]][:, None], MODULUS[state["mat"]])
    xij = state["x"][:, None] - state["x"]
    r = np.linalg.norm(xij, axis=-1)
    w, dw = cubic_spline(r, dim)
    scale = cubic_spline(np.array(SPACING), dim)[0]
    stiffness = on * STIFFNESS / SPACING**dim * modulus * np.outer(state["vol"], state["vol"])
    return stiffness, xij, r, w / scale, dw / scale


def forces(dim, state):
    """Forces of b on a [N], shape [a, b, 3]."""
    stiffness, xij, r, f, slope = pairs(dim, state)
    return -(stiffness * 4.0 * f**3 * slope / np.where(r > 0.0, r, 1.0))[..., None] * xij


def energy(dim, state):
    """The potential of all pairs [J]."""
    stiffness, _, _, f, _ = pairs(dim, state)
    return 0.5 * np.sum(stiffness * f**4)


def test_force_and_power_of_every_pair(spec, eps):
    state = cloud(spec.dim)
    f, v, m = forces(spec.dim, state), state["v"], state["m"]
    found = contact(spec, state)
    size = np.abs(f).sum(axis=1).max()
    np.testing.assert_allclose(found["dvdt"] * m[:, None], f.sum(axis=1), atol=100 * eps * size)
    power = 0.5 * np.einsum("abk,abk->a", f, v[None] - v[:, None])
    np.testing.assert_allclose(found["dedt"] * m, power, atol=100 * eps * size * np.abs(v).max())
    assert size > 1e6


@pytest.mark.parametrize("dim", DOUBLE)
def test_force_is_that_of_the_potential(dim):
    state, d = cloud(dim), 1e-6 * SPACING
    found = contact(DOUBLE[dim], state)["dvdt"] * state["m"][:, None]
    slope = np.zeros_like(found)
    for i in range(len(found)):
        for k in range(dim):
            moved = [state["x"].copy(), state["x"].copy()]
            moved[0][i, k] -= d
            moved[1][i, k] += d
            low, high = (energy(dim, state | {"x": x}) for x in moved)
            slope[i, k] = (high - low) / (2.0 * d)
    np.testing.assert_allclose(found, -slope, atol=1e-6 * np.abs(found).max())


def test_momentum_angular_momentum_and_energy(spec, eps):
    state = cloud(spec.dim)
    found, m, v = contact(spec, state), state["m"][:, None], state["v"]
    force, size = found["dvdt"] * m, np.abs(found["dvdt"] * m).sum()
    assert np.abs(force.sum(axis=0)).max() < 20 * eps * size
    lever = np.abs(state["x"]).max()
    assert np.abs(np.cross(state["x"], force).sum(axis=0)).max() < 20 * eps * size * lever
    total = found["dedt"] @ state["m"] + np.sum(force * v)
    assert abs(total) < 20 * eps * size * np.abs(v).max()


def test_reaction_equals_action_to_the_last_bit(spec):
    """With masses that divide exactly: the volumes and materials of the two differ."""
    for r in np.array([0.2, 0.7, 1.0, 1.9]) * SPACING:
        state = pair(spec.dim, r, m=np.array([1.0, 2.0]), mat=np.array([0, 1]))
        state["vol"] = np.array([0.83, 1.31]) * SPACING**spec.dim
        state["v"][0, : spec.dim] = 37.0
        found = contact(spec, state)
        np.testing.assert_array_equal(found["dvdt"][0], -2.0 * found["dvdt"][1])
        assert found["dedt"][0] == 2.0 * found["dedt"][1] != 0.0


def test_volumes_so_small_that_their_product_is_none_still_push(spec):
    """Particles of 0.1 micrometres have 1e-21 m³: V_a V_b is 0 in single precision, the force is not."""
    usual, tiny = (pair(spec.dim, 0.7 * SPACING, vol=np.full(2, V)) for V in (SPACING**spec.dim, 1e-23))
    ratio = (1e-23 / SPACING**spec.dim) ** 2
    expected = ratio * contact(spec, usual)["dvdt"]
    np.testing.assert_allclose(contact(spec, tiny)["dvdt"], expected, rtol=1e-5)
    assert expected[0, 0] != 0.0


def test_the_softer_material_decides(precision):
    def push(*mat):
        return np.linalg.norm(contact(precision, pair(3, SPACING, mat=np.array(mat)))["dvdt"][0])

    assert push(0, 1) == push(1, 0) == push(1, 1) < push(0, 0)


@pytest.mark.parametrize(
    "who", [{"body": np.zeros(2, int)}, {"kernel_type": np.array([ERODED, 0])}], ids=["one body", "eroded"]
)
def test_who_takes_no_part(precision, who):
    found = contact(precision, pair(3, 0.5 * SPACING, **who))
    assert not any(
        a.any() for k, a in found.items() if k in ("dvdt", "dedt", "contact_rate", "cover", "part_a")
    )


def test_parted_bodies_feel_nothing(spec):
    """Beyond the support, though in the row for the skin's sake: all that is there stays."""
    before = {"dvdt": np.full((2, 3), 3.0), "dedt": np.full(2, 5.0), "cover": np.full(2, 0.125)}
    found = contact(spec, pair(spec.dim, 2.0001 * H), **before)
    for name, value in before.items():
        np.testing.assert_array_equal(found[name], value)
    assert not found["contact_rate"].any()


def test_adds_and_books_its_part(precision, eps):
    state = pair(3, SPACING, v=np.array([[50.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    before = {"dvdt": np.full((2, 3), 1e9), "dedt": np.full(2, 1e9), "part_a": np.full((2, 4, 3), 7.0)}
    alone, found = contact(precision, state), contact(precision, state, **before)
    np.testing.assert_array_equal(found["part_a"][:, CONTACT], alone["dvdt"])
    np.testing.assert_array_equal(found["part_power"][:, CONTACT], alone["dedt"])
    np.testing.assert_allclose(found["dvdt"], 1e9 + alone["dvdt"], rtol=4 * eps)
    np.testing.assert_allclose(found["dedt"], 1e9 + alone["dedt"], rtol=4 * eps)
    assert (found["part_a"][:, :CONTACT] == 7.0).all() and not found["part_power"][:, :CONTACT].any()


def test_a_particle_that_leaves_contact_limits_no_step(precision):
    rate = contact(precision, pair(3, SPACING))["contact_rate"]
    after = contact(precision, pair(3, 3.0 * H), contact_rate=rate)
    assert rate.all() and not after["contact_rate"].any()


def test_no_step_no_force(precision):
    found = contact(precision, pair(3, SPACING), dt=np.zeros(1))
    assert not any(found[k].any() for k in ("dvdt", "contact_rate", "cover"))


@pytest.mark.parametrize("same_body", [False, True])
def test_images_of_other_bodies_push(spec, same_body, eps):
    """The image of a particle in the plane x = 0 pushes as a particle there does, but not its own body."""
    given = pair(spec.dim, SPACING)
    given["x"] += [-0.4 * SPACING, 0.0, 0.0]  # the first is behind the plane
    real = contact(spec, given, rows=[[], [0]])
    image = {k: a.copy() for k, a in given.items()}
    image["x"][0, 0] *= -1.0
    image["body"][1] = 0 if same_body else 1
    found = contact(spec, image, rows=[[], [0 | 1 << INDEX_BITS]], plane=(0.0, 0.0, 0.0))
    expected = 0.0 * real["dvdt"] if same_body else real["dvdt"]
    assert real["dvdt"][1].any()
    np.testing.assert_allclose(found["dvdt"], expected, rtol=20 * eps, atol=20 * eps * np.abs(expected).max())


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", DOUBLE)
def test_rate_bounds_the_stiffness(dim, kernel):
    """It is above both second derivatives of the potential, and not far above where there is pressure."""
    spec, d = DOUBLE[dim], 1e-4 * SPACING

    def push(r):
        return np.linalg.norm(contact(spec, pair(dim, r), kernel=kernel)["dvdt"][0])

    for r in np.linspace(0.02, 2.2, 25) * SPACING:
        rate = contact(spec, pair(dim, r), kernel=kernel)["contact_rate"][0]
        stiffness = max(abs(push(r + d) - push(r - d)) / (2.0 * d), push(r) / r)
        assert rate >= stiffness * (1.0 - 2e-3)
        assert rate <= 2.2 * stiffness or r > 1.1 * SPACING


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dim", DOUBLE)
@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_interpenetration_of_two_lattices(dim, kernel, offset):
    """Two half-spaces, facing layers at distance d; particle 0 is one of the first, ``offset`` to the side."""
    across = np.arange(-4, 5) + (offset if dim > 1 else 0.0)
    depths = []
    for d in (1.0, 0.9, 0.75, 0.6, 0.5):
        other = np.stack(np.meshgrid(d + np.arange(6), *[across] * (dim - 1), indexing="ij"), axis=-1)
        x = np.zeros((other.size // dim + 1, 3))
        x[1:, :dim] = SPACING * other.reshape(-1, dim)
        n = len(x)
        state = {
            "x": x, "v": np.zeros((n, 3)), "m": np.ones(n), "vol": np.full(n, SPACING**dim),
            "body": np.arange(n).clip(max=1), "mat": np.zeros(n, int), "kernel_type": np.zeros(n, int),
        }  # fmt: skip
        found = contact(DOUBLE[dim], state, rows=[[*range(1, n)]] + [[]] * (n - 1), kernel=kernel)
        depths.append(interpenetration(found["cover"][0], kernel, dim, H, SPACING))
        assert depths[-1] == pytest.approx(1.0 - d, abs=0.075 if kernel.startswith("wendland") else 0.045)
    assert (np.diff(depths) > 0.0).all()


def test_highest_cover_counts(precision):
    near, far = (contact(precision, pair(3, r))["cover"] for r in (0.5 * SPACING, SPACING))
    assert (near > far).all() and far.all()
    kept = contact(precision, pair(3, SPACING), cover=near)["cover"]
    np.testing.assert_array_equal(kept, near)


def test_interpenetration_at_the_ends():
    for kernel in KERNELS:
        assert interpenetration(0.0, kernel, 2, H, SPACING) == 0.0
        assert interpenetration(0.5, kernel, 2, H, SPACING) == pytest.approx(0.5, abs=1e-6)
        assert interpenetration(1.2, kernel, 2, H, SPACING) > 2.0


@pytest.mark.parametrize("dim", DOUBLE)
def test_constants_of_a_scene(dim):
    """Kc is given for all pairs, or k = Kc dx^dim / K with K = ρ c²."""
    for given in (Contact(stiffness=0.25), Contact(modulus=2e18)):
        made = scene(dim, contact=given)
        for k, name in enumerate(("aluminium", "steel")):
            made.add_body(name, np.array([[10.0 * k * SPACING, 0.0, 0.0]]), name)
        data = made.finalize()
        modulus, scale = contact_constants(data)
        K = [m.density * m.bulk_speed**2 for m in data.materials]
        expected = [2e18] * 2 if given.modulus else [0.25 * value / SPACING**dim for value in K]
        np.testing.assert_allclose(scale * np.array(modulus), expected, rtol=1e-14)
