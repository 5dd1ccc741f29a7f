"""Bodies add up, and the chain is the arm's file cut at the flange sensor."""

import math

import numpy as np
import pytest

from sim.arm.arm_file import Arm
from sim.arm.chain import Body, chain, load_body, plate_body, tool_body
from sim.arm.scenario import Load, ToolModel
from tests.sim.arms import PROBE, TWO_KG, UR5E, arms


def point(mass: float, *position: float) -> Body:
    return Body(mass, np.array(position), np.zeros((3, 3)))


def test_two_point_masses_are_a_dumbbell() -> None:
    both = point(2.0, 0.3, 0.0, 0.0) + point(2.0, -0.3, 0.0, 0.0)
    assert both.mass == 4.0
    assert np.allclose(both.com, 0.0)
    assert np.allclose(both.inertia, np.diag([0.0, 4.0 * 0.09, 4.0 * 0.09]))


def test_between_two_bodies_mass_and_moment_lie_on_a_line() -> None:
    one, other = point(1.0, 0.3, 0.0, 0.0), point(3.0, -0.1, 0.0, 0.2)
    between = one.blend(other, 0.25)
    assert between.mass == pytest.approx(0.75 * 1.0 + 0.25 * 3.0)
    assert between.mass * between.com == pytest.approx(0.75 * one.com + 0.25 * 3.0 * other.com)
    assert np.linalg.eigvalsh(between.inertia).min() > -1e-12, "it is a body: parts of both at once"
    assert one.blend(other, 0.0).com == pytest.approx(one.com)
    assert one.blend(other, 1.0).com == pytest.approx(other.com)


def test_an_inertia_that_is_given_is_taken() -> None:
    tool = ToolModel(name="x", mass=1.0, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.2], inertia=[1.0, 2.0, 2.5, 0.1, 0.0, 0.0])
    assert tool_body(tool).inertia == pytest.approx(np.array([[1.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 2.5]]))


def test_uneven_masses_meet_at_their_centre_of_mass() -> None:
    both = point(1.0, 0.0, 0.0, 0.0) + point(3.0, 0.4, 0.0, 0.8)
    assert np.allclose(both.com, [0.3, 0.0, 0.6])
    # Reduced mass times distance squared, across the line between them.
    assert np.trace(both.inertia) == pytest.approx(2.0 * 0.75 * 0.8)


def test_taking_a_part_away_undoes_adding_it() -> None:
    whole, part = load_body(TWO_KG), tool_body(PROBE)
    back = (whole + part) - part
    assert back.mass == pytest.approx(whole.mass)
    assert np.allclose(back.com, whole.com)
    assert np.allclose(back.inertia, whole.inertia)


def test_nothing_added_to_nothing_is_nothing() -> None:
    nothing = load_body(Load(mass=0.0))
    assert (nothing + nothing).mass == 0.0
    assert np.isfinite((nothing + nothing).com).all()


def test_a_load_without_an_inertia_is_a_ball_of_water() -> None:
    """2 kg of water: a ball of 2 litres, radius 78.2 mm."""
    radius = (3.0 * 0.002 / (4.0 * math.pi)) ** (1.0 / 3.0)
    assert radius == pytest.approx(0.0782, abs=1e-4)
    body = load_body(TWO_KG)
    assert np.allclose(body.inertia, np.eye(3) * 2.0 / 5.0 * 2.0 * radius**2)
    assert body.com.tolist() == [0.01, -0.02, 0.07]


def test_a_given_inertia_is_taken_as_it_is() -> None:
    body = load_body(Load(mass=1.0, inertia=[1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
    assert body.inertia.tolist() == [[1.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 3.0]]


def test_a_tool_is_a_cylinder_along_z() -> None:
    body = tool_body(ToolModel(name="rod", mass=1.2, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.2], length=0.2, radius=0.02))
    assert np.allclose(np.diag(body.inertia), [1.2 * (0.02**2 / 4 + 0.2**2 / 12)] * 2 + [1.2 * 0.02**2 / 2])
    assert tool_body(None).mass == 0.0


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_links_and_plate_weigh_what_the_file_says(arm: Arm) -> None:
    rigid = chain(arm)
    assert sum(link.mass for link in rigid.links) + plate_body(arm).mass == pytest.approx(sum(arm.masses.mass))
    for link in rigid.links:
        moments = np.linalg.eigvalsh(link.inertia)
        assert moments[0] > 0.0
        assert moments[0] + moments[1] >= moments[2] * (1 - 1e-9), f"{link}: no body has such moments"
        assert np.allclose(link.inertia, link.inertia.T)


def test_stretched_out_the_chain_is_as_long_as_its_parameters() -> None:
    """At q = 0 a UR lies along -x: a2 + a3 from the base axis, the wrist offsets aside and below."""
    rigid = chain(UR5E)
    p, R = np.zeros(3), np.eye(3)
    for step, turn in zip(rigid.p, rigid.R, strict=True):
        p, R = p + R @ step, R @ turn
    p = p + R @ rigid.p_flange
    assert np.allclose(p, [-0.425 - 0.3922, -0.1333 - 0.0996, 0.1625 - 0.0997], atol=1e-9)
