"""Simulations of one process share what is compiled of their arm and world, and nothing that changes."""

import msgspec
import numpy as np
import pytest

from app.files.library import load_arm
from sim.arm.scenario import BoxObject, Load, Scenario
from sim.plant import model
from sim.plant.model import KEPT, Step, model_of

ARM = load_arm("ur5e")


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model, "_compiled", {})


def test_a_change_of_one_model_is_in_no_other() -> None:
    first = model_of(ARM, Scenario(seed=1), Step())
    mass = first.body_mass.copy()
    first.body_mass[:] = 7.0
    assert np.array_equal(model_of(ARM, Scenario(seed=2), Step()).body_mass, mass)


def test_another_seed_posture_or_belief_compiles_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    model_of(ARM, Scenario(), Step())
    monkeypatch.setattr(model, "build", None)
    model_of(ARM, Scenario(seed=3, posture=[0.1] * 6, payload_configured=Load(mass=1.0)), Step())
    assert len(model._compiled) == 1


@pytest.mark.parametrize(
    "scenario",
    [
        Scenario(payload_true=Load(mass=1.0)),
        Scenario(mounting=[3.0, 0.0, 0.0]),
        Scenario(soft_sensor=True),
        Scenario(world=[BoxObject(name="block", position=[0.5, 0.0, 0.5], size=[0.1, 0.1, 0.1])]),
    ],
)
def test_what_the_model_depends_on_makes_another(scenario: Scenario) -> None:
    model_of(ARM, Scenario(), Step())
    model_of(ARM, scenario, Step())
    model_of(msgspec.structs.replace(ARM, name="other"), scenario, Step())
    model_of(ARM, scenario, Step(substeps=4))
    assert len(model._compiled) == 4


def test_few_are_kept_and_the_one_used_last_among_them() -> None:
    for k in range(KEPT + 2):
        model_of(ARM, Scenario(), Step())
        model_of(ARM, Scenario(payload_true=Load(mass=1.0 + k)), Step())
    assert len(model._compiled) == KEPT
    kept = list(model._compiled.values())
    model_of(ARM, Scenario(), Step())
    assert any(each is list(model._compiled.values())[-1] for each in kept)
