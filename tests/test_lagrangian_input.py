"""What the schemes with Lagrangian particles, contact and conversion refuse, in one line that says what is allowed."""

import numpy as np
import pytest
from tools import ELASTIC, FLUID, PLASTIC, SPACING, jittered, scene

from warpsph import materials as lib
from warpsph.config import Contact, Conversion, Numerics
from warpsph.errors import InputError
from warpsph.solver import Solver

CONTACT = Contact(stiffness=0.25)
PLATE = lib.get("aluminium-jc")


def solver(material=ELASTIC, eulerian=False, dim=2, **numerics):
    """A small body."""
    made = scene(dim, **numerics)
    made.add_body("body", jittered(dim, 4), material)
    if eulerian:
        made.make_eulerian("body", lambda x: x[:, 0] < SPACING)
    return Solver(made.finalize())


def refused(words, call, *args, **options):
    """The call is refused in one line that has these words."""
    with pytest.raises(InputError) as caught:
        call(*args, **options)
    message = str(caught.value)
    assert "\n" not in message and "allowed" in message
    for word in words:
        assert word in message, message


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, ["stiffness, modulus of Contact = (None, None)", "modulus"]),
        ({"stiffness": 0.25, "modulus": 1e18}, ["(0.25, 1e+18)"]),
        ({"stiffness": 0.0}, ["stiffness of Contact", "0.0"]),
        ({"modulus": -1.0}, ["modulus of Contact", "-1.0"]),
        ({"stiffness": float("nan")}, ["stiffness of Contact", "nan"]),
    ],
)
def test_a_contact_needs_one_stiffness(options, words):
    refused(words, Contact, **options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, ["criterion of Conversion is missing"]),
        ({"layers": 2}, ["criterion of Conversion is missing"]),
        ({"strain": -0.1}, ["strain of Conversion", "-0.1"]),
        ({"strain": 0.5, "measure": "hencky"}, ["measure of Conversion", "hencky", "green-lagrange"]),
        ({"damage": True, "layers": -1}, ["layers of Conversion", "-1"]),
        ({"damage": True, "layers": 1.5}, ["layers of Conversion", "1.5"]),
        ({"damage": True, "radius": 0.0}, ["radius of Conversion", "0.0"]),
        ({"criterion": 0.5}, ["criterion of Conversion", "0.5"]),
    ],
)
def test_a_conversion_needs_a_criterion_within_range(options, words):
    refused(words, Conversion, **options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"contact": 0.25}, ["contact", "Contact(...)"]),
        ({"conversion": 0.85}, ["conversion", "Conversion(...)"]),
        ({"coupling": "exact"}, ["coupling", "conservative, printed"]),
        ({"interface_stress": "eulerian-only"}, ["interface_stress", "both, none, eulerian"]),
        ({"inverted": "go on"}, ["inverted", "stop, convert"]),
        ({"hourglass": -1.0}, ["hourglass", "-1.0"]),
        ({"viscosity_alpha": -0.1}, ["viscosity_alpha", "-0.1"]),
    ],
)
def test_settings_out_of_range(options, words):
    refused(words, Numerics, **options)


@pytest.mark.parametrize(
    ("scheme", "options", "words"),
    [
        ("sav1", {"conversion": Conversion(strain=0.8)}, ["conversion", "'sav1'", "adaptle"]),
        ("ts2", {"conversion": Conversion(strain=0.8)}, ["conversion", "'ts2'"]),
        ("sav1", {"erosion": True}, ["erosion", "'sav1'"]),
        ("sav1", {"hourglass": 5.0}, ["hourglass", "'sav1'"]),
        ("sav1", {"inverted": "convert"}, ["inverted", "'sav1'"]),
        ("tl", {"conversion": Conversion(strain=0.8)}, ["conversion", "'tl'", "adaptle"]),
        ("tl", {"inverted": "convert"}, ["inverted", "'tl'", "adaptle"]),
        ("tl", {"eulerian": True}, ["make_eulerian", "'tl'", "adaptle"]),
        ("adaptle", {"erosion": True}, ["erosion", "'adaptle'", "tl"]),
        ("tl", {"erosion": True}, ["erosion", "'elastic'", "damage law"]),
        ("ts2", {"contact": CONTACT}, ["contact", "'ts2'", "Godunov"]),
        ("pm", {"viscosity_alpha": 0.5}, ["viscosity_alpha", "'pm'", "Godunov"]),
    ],
)
def test_options_that_do_not_go_with_the_scheme(scheme, options, words):
    refused(words, solver, scheme=scheme, **options)


@pytest.mark.parametrize(
    ("material", "conversion", "words"),
    [
        (ELASTIC, Conversion(damage=True), ["damage", "'elastic'"]),
        (PLASTIC, Conversion(damage=True), ["damage", "'plastic'"]),
        (ELASTIC, Conversion(strain=0.5, measure="plastic"), ["plastic strain", "'elastic'"]),
        (PLATE, Conversion(damage=True, radius=1.0), ["radius of Conversion", "0.0024 m"]),
    ],
)
def test_a_conversion_needs_the_state_it_looks_at(material, conversion, words):
    refused(words, solver, material, scheme="adaptle", conversion=conversion)


def test_those_that_have_it_may_convert():
    solver(PLATE, scheme="adaptle", conversion=Conversion(damage=True, radius=2.0 * SPACING))
    solver(PLASTIC, scheme="adaptle", conversion=Conversion(strain=0.5, measure="plastic"))
    solver(PLATE, scheme="tl", erosion=True)


def test_a_fluid_has_no_reference_configuration():
    refused(["'fluid'", "'tl'", "make_eulerian"], solver, FLUID, scheme="tl")
    refused(["'fluid'", "'adaptle'"], solver, FLUID, eulerian=True, scheme="adaptle")
    made = scene(2, scheme="adaptle")
    made.add_body("body", jittered(2, 4), FLUID)
    made.make_eulerian("body")
    Solver(made.finalize())


def test_bodies_must_not_overlap():
    made = scene(2, scheme="tl", contact=CONTACT)
    made.add_body("one", jittered(2, 4, 0.0), ELASTIC)
    made.add_body("two", jittered(2, 4, 0.0) + 0.3 * SPACING * np.array([1.0, 0.0, 0.0]), ELASTIC)
    refused(["'one' and 'two' overlap", "half a spacing"], made.finalize)


@pytest.mark.parametrize("act", ["fix", "make_eulerian"])
def test_a_region_that_holds_no_particle(act):
    made = scene(2, scheme="adaptle")
    made.add_body("plate", jittered(2, 4), ELASTIC)
    refused(
        [f"{act} of body 'plate'", "none of its 16"], getattr(made, act), "plate", lambda x: x[:, 0] > 1.0
    )
    refused([f"body to {act}", "'plat'", "plate"], getattr(made, act), "plat")


def test_a_failed_metal_carries_all_or_compression():
    refused(["carries = 'tension'", "all, compression"], lib.JohnsonCookDamage, D1=0.1, carries="tension")
