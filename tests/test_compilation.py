"""Compilation: a run loads the modules it launches kernels of, all of them before the first launch, and no others."""

import inspect

import pytest
from tools import DOUBLE, collision, scene

from warpsph import solver
from warpsph.config import Contact, Conversion
from warpsph.device.launch import Launcher
from warpsph.device.score import Score
from warpsph.kernels.constitutive import laws_text, make_constitutive
from warpsph.shapes import Box
from warpsph.solver import Solver


def alone(scheme):
    """One body in one dimension, with a symmetry plane."""
    made = scene(1, scheme=scheme)
    made.add_body("bar", Box(0.5e-3, 20.5e-3), "aluminium", velocity=(-100.0,))
    made.add_symmetry_plane("x", 0.0)
    return made


@pytest.mark.parametrize(
    "make",
    [
        lambda: collision(2, scheme="sav1-mixed-as"),
        lambda: collision(2, scheme="mon", contact=Contact(stiffness=0.25)),
        lambda: collision(1, scheme="pm-mixed"),
        lambda: collision(1, scheme="ts2"),
        lambda: collision(2, scheme="tl"),
        lambda: collision(2, scheme="tl", contact=Contact(stiffness=0.25)),
        lambda: collision(2, scheme="adaptle-mixed-as", conversion=Conversion(strain=0.1)),
        lambda: alone("tl"),
        lambda: alone("sav1"),
    ],
)
def test_the_modules_of_a_run_are_loaded_at_its_start(make, monkeypatch):
    loaded, launched, late = set(), set(), []
    load, bind, record = solver.compile_modules, Launcher.bind, Score._launch

    def recorded_load(kernels, device):
        loaded.update(kernel.module.name for kernel in kernels)
        late.append(bool(launched))
        load(kernels, device)

    def recorded_bind(self, kernel, *args, **named):
        launched.add(kernel.module.name)
        return bind(self, kernel, *args, **named)

    def recorded_record(self, kernel, *args):
        launched.add(kernel.module.name)
        record(self, kernel, *args)

    monkeypatch.setattr(solver, "compile_modules", recorded_load)
    monkeypatch.setattr(Score, "_launch", recorded_record)
    monkeypatch.setattr(Launcher, "bind", recorded_bind)
    run = Solver(make().finalize())
    run.prepare()
    run.advance(1e-8)
    run.ledger()
    assert late == [False]
    assert loaded == launched


def test_a_change_of_a_material_law_is_compiled_anew(monkeypatch):
    """Warp's hash of a module does not see functions that a loop picks from a table; it sees the module's options."""
    laws_text.cache_clear()
    before = laws_text()
    assert make_constitutive(DOUBLE[1], False, False).module.options["tables"] == before
    laws_text.cache_clear()
    monkeypatch.setattr(inspect, "getsource", lambda module: f"{module.__name__}, changed")
    assert laws_text() != before
    laws_text.cache_clear()
