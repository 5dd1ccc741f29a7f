"""Mass, centre and offsets from postures; the expected readings come from Newton's law alone, written out here."""

import math

import numpy as np
import pytest

from pendant.equipment import payload_fit
from pendant.equipment.load import Load
from pendant.equipment.payload_fit import GAIN, LEAST, LIGHT, TOLERATED, FittedPayload, Posture, least_angle, nearest, solve

G = 9.81
WRIST = [(0.0, 0.0, -1.0), (-0.72, 0.0, -0.7), (-0.05, 0.72, -0.7), (0.05, -0.72, -0.7), (0.6, 0.5, 0.62)]
"""Directions of the specific force in F."""

OFFSET = np.array([3.0, -2.0, 1.0, 0.2, -0.1, 0.3])


def up(direction: tuple[float, float, float]) -> np.ndarray:
    return G * np.array(direction) / np.linalg.norm(direction)


def reading(a: np.ndarray, *loads: tuple[float, tuple[float, float, float]]) -> np.ndarray:
    """What an ideal sensor reads under these masses at these places, plus its offset."""
    force = sum((mass * a for mass, _ in loads), np.zeros(3))
    torque = sum((np.cross(place, mass * a) for mass, place in loads), np.zeros(3))
    return np.concatenate([force, torque]) + OFFSET


def postures(directions: list[tuple[float, float, float]], *loads: tuple[float, tuple[float, float, float]]) -> list[Posture]:
    made = []
    for direction in directions:
        a = up(direction)
        made.append(posture(a, reading(a, *loads)))
    return made


def posture(a: np.ndarray, w: np.ndarray) -> Posture:
    (ax, ay, az), (fx, fy, fz, tx, ty, tz) = a.tolist(), w.tolist()
    return Posture((ax, ay, az), (fx, fy, fz), (tx, ty, tz))


def found(made: list[Posture], *known: Load) -> FittedPayload:
    result = solve(made, known)
    assert isinstance(result, FittedPayload), result
    return result


def reason(made: list[Posture], *known: Load) -> str:
    result = solve(made, known)
    assert isinstance(result, str)
    return result


@pytest.mark.parametrize("count", [4, 5])
def test_exact_readings_give_mass_centre_and_offsets_exactly(count: int) -> None:
    finding = found(postures(WRIST[:count], (2.0, (0.02, -0.03, 0.08))))
    assert finding.mass == pytest.approx(2.0, abs=1e-9)
    assert finding.centre == pytest.approx((0.02, -0.03, 0.08), abs=1e-9)
    assert finding.force_offset == pytest.approx(OFFSET[:3], abs=1e-8)
    assert finding.torque_offset == pytest.approx(OFFSET[3:], abs=1e-8)
    assert finding.force_fit == pytest.approx(0.0, abs=1e-9)
    assert finding.torque_fit == pytest.approx(0.0, abs=1e-9)
    assert finding.postures == count
    assert finding.mass_deviation == pytest.approx(GAIN * 2.0, rel=1e-6), "what the fit cannot show is still there"
    assert finding.load == Load(mass=2.0, com=[0.02, -0.03, 0.08])


def test_two_masses_are_one_at_their_common_centre() -> None:
    finding = found(postures(WRIST, (1.0, (0.0, 0.0, 0.1)), (3.0, (0.04, 0.0, 0.02))))
    assert finding.mass == pytest.approx(4.0)
    assert finding.centre == pytest.approx((0.03, 0.0, 0.04), abs=1e-9)


def test_the_tool_and_the_plate_are_taken_off() -> None:
    made = postures(WRIST, (0.13, (0.0, 0.0, 0.0)), (0.9, (0.0, 0.01, 0.06)), (1.5, (0.01, 0.0, 0.2)))
    finding = found(made, Load(mass=0.13, com=[0.0, 0.0, 0.0]), Load(mass=0.9, com=[0.0, 0.01, 0.06]))
    assert finding.mass == pytest.approx(1.5)
    assert finding.centre == pytest.approx((0.01, 0.0, 0.2), abs=1e-9)


def test_the_stated_uncertainty_covers_the_error_that_noise_makes() -> None:
    """Noise without any gain error: of 400 draws the error lies within two standard uncertainties in 80 % or more. Few degrees
    of freedom widen the tails beyond those of a normal distribution, and the gain's share, which is not drawn, narrows them."""
    rng = np.random.default_rng(7)
    mass, centre = [], []
    for _ in range(400):
        made = []
        for direction in WRIST:
            a = up(direction)
            noise = np.concatenate([rng.normal(0.0, 0.1, 3), rng.normal(0.0, 0.01, 3)])
            made.append(posture(a, reading(a, (1.0, (0.0, 0.02, 0.07))) + noise))
        finding = found(made)
        mass.append(abs(finding.mass - 1.0) / finding.mass_deviation)
        centre.append(max(np.abs(np.subtract(finding.centre, (0.0, 0.02, 0.07)))) / finding.centre_deviation)
    assert np.mean(np.array(mass) < 2.0) > 0.9
    assert np.mean(np.array(centre) < 2.0) > 0.8
    assert np.mean(np.array(centre) > 0.5) > 0.5, "and it is not just large"


def noisy(mass: float, seed: int = 11) -> list[Posture]:
    """Always the same noise: what the fit leaves of it does not depend on the mass."""
    rng, made = np.random.default_rng(seed), []
    for direction in WRIST:
        a = up(direction)
        noise = np.concatenate([rng.normal(0.0, 0.3, 3), rng.normal(0.0, 0.02, 3)])
        made.append(posture(a, reading(a, (mass, (0.03, -0.02, 0.07))) + noise))
    return made


@pytest.mark.parametrize("mass", [0.4, 3.0])
def test_the_stated_uncertainty_is_that_of_the_residuals_and_of_the_scale(mass: float) -> None:
    """GUM, type A, by hand: an offset is taken off with the means; 1 and 3 unknowns remain of 3 n readings, 3 for the offset."""
    made = noisy(mass)
    finding, n = found(made), len(made)
    a, f, t = (np.array([getattr(posture, name) for posture in made]) for name in ("a", "force", "torque"))
    a, f, t = (value - value.mean(axis=0) for value in (a, f, t))
    fitted = np.sum(a * f) / np.sum(a * a)
    left = np.sum((f - fitted * a) ** 2)
    deviation = math.sqrt(left / (3 * n - 4) / np.sum(a * a) + (GAIN * fitted) ** 2)
    assert finding.mass == pytest.approx(fitted)
    assert finding.force_fit == pytest.approx(math.sqrt(left / (3 * n)))
    assert finding.mass_deviation == pytest.approx(deviation)
    normal = sum(np.dot(v, v) * np.eye(3) - np.outer(v, v) for v in a)
    h = np.linalg.solve(normal, np.cross(a, t).sum(axis=0))
    left = np.sum((t - np.cross(h, a)) ** 2)
    variances = np.diag(np.linalg.inv(normal)) * left / (3 * n - 6) / fitted**2 + (h / fitted * deviation / fitted) ** 2
    assert finding.centre == pytest.approx(h / fitted)
    assert finding.torque_fit == pytest.approx(math.sqrt(left / (3 * n)))
    assert finding.centre_deviation == pytest.approx(math.sqrt(max(variances)))


@pytest.mark.parametrize(("deviations", "nothing"), [(2.9, True), (3.1, False)])
def test_a_negative_mass_is_nothing_up_to_three_uncertainties_beyond_what_is_tolerated(deviations: float, nothing: bool) -> None:
    one = found(noisy(1.0))
    fitted = math.sqrt(one.mass_deviation**2 - (GAIN * one.mass) ** 2)
    wanted = -TOLERATED
    for _ in range(20):
        wanted = -TOLERATED - deviations * math.hypot(fitted, GAIN * wanted)
    result = solve(noisy(wanted - (one.mass - 1.0)))
    assert isinstance(result, FittedPayload) is nothing


def test_too_few_postures_say_how_many_are_missing() -> None:
    assert reason(postures(WRIST[:3], (2.0, (0.0, 0.0, 0.1)))) == f"3 of at least {LEAST} postures"
    assert reason([]) == f"0 of at least {LEAST} postures"


def test_postures_near_one_line_cannot_tell_the_centre() -> None:
    """A fan of 22.5° steps in one plane: each differs enough from the next, all of them lie nearly on a line."""
    angles = np.radians(22.5) * np.arange(4)
    fan = [(math.cos(angle), math.sin(angle), 0.0) for angle in angles]
    # Their spread across the line, by hand: cosines of ±33.75° and ±11.25° about their mean.
    spread = (math.cos(math.radians(11.25)) - math.cos(math.radians(33.75))) / 2.0
    assert f"{spread:.2f}, at least 0.20" in reason(postures(fan, (2.0, (0.0, 0.0, 0.1))))
    wide = [(math.cos(2.0 * angle), math.sin(2.0 * angle), 0.0) for angle in angles]
    assert found(postures(wide, (2.0, (0.0, 0.0, 0.1)))).centre == pytest.approx((0.0, 0.0, 0.1))


def test_a_hand_in_one_posture_is_seen_in_the_fit() -> None:
    made = postures(WRIST, (2.0, (0.0, 0.0, 0.1)))
    x, y, z = made[2].force
    made[2] = made[2]._replace(force=(x, y + 8.0, z))
    said = reason(made)
    assert "no rigid load" in said
    assert "at most 1 N, 0.15 N·m" in said
    made = postures(WRIST, (2.0, (0.0, 0.0, 0.1)))
    made[1] = made[1]._replace(torque=(1.5, 0.0, 0.0))
    assert "no rigid load" in reason(made)


def test_less_than_the_tool_means_another_tool() -> None:
    made = postures(WRIST, (0.1, (0.0, 0.0, 0.05)))
    said = reason(made, Load(mass=0.9, com=[0.0, 0.0, 0.05]))
    assert said == "0.80 kg less than the tool in use: choose the tool that is mounted"


def test_a_little_less_than_nothing_is_nothing() -> None:
    finding = found(postures(WRIST, (0.85, (0.0, 0.0, 0.05))), Load(mass=0.9, com=[0.0, 0.0, 0.05]))
    assert (finding.mass, finding.centre, finding.centre_deviation) == (0.0, (0.0, 0.0, 0.0), 0.0)


def test_what_is_at_its_limit_is_within_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Largest residuals, least spread and mass, each made what these postures have."""
    made = noisy(0.4)
    finding, spread = found(made), payload_fit._spread(np.array([posture.a for posture in made]))
    at = {"MISFIT_FORCE": finding.force_fit, "MISFIT_TORQUE": finding.torque_fit, "LIGHT": finding.mass, "SPREAD": spread}
    for name, value in at.items():
        monkeypatch.setattr(payload_fit, name, value)
    assert found(made) == finding


@pytest.mark.parametrize(("mass", "has_centre"), [(0.9 * LIGHT, False), (1.1 * LIGHT, True)])
def test_a_very_light_load_has_no_centre(mass: float, has_centre: bool) -> None:
    finding = found(postures(WRIST, (mass, (0.0, 0.0, 0.1))))
    assert finding.mass == pytest.approx(mass)
    assert finding.centre == pytest.approx((0.0, 0.0, 0.1 if has_centre else 0.0))


@pytest.mark.parametrize(("count", "degrees"), [(1, 22.5), (2, 22.5), (4, 22.5), (5, 18.0), (6, 15.0), (9, 10.0)])
def test_the_least_angle_is_that_of_the_robots(count: int, degrees: float) -> None:
    """pi / (2 n) with n postures, as `estimate_payload` of URScript asks; never more than pi / 8."""
    assert math.degrees(least_angle(count)) == pytest.approx(degrees)


def test_the_nearest_posture_is_named_with_its_angle() -> None:
    made = postures([(0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    tilted = (math.sin(0.3) * G, 0.0, -math.cos(0.3) * G)
    number, angle = nearest(made, tilted)
    assert (number, angle) == (1, pytest.approx(0.3))
    number, angle = nearest(made, (G, 0.1, 0.0))
    assert (number, angle) == (2, pytest.approx(math.atan2(0.1, G)))
    assert nearest(made[:1], (0.0, 0.0, G)) == (1, pytest.approx(math.pi))


def test_the_angle_to_another_posture_is_that_between_the_directions_of_gravity() -> None:
    rng = np.random.default_rng(2)
    for first, second in rng.normal(size=(50, 2, 3)):
        (x, y, z), (u, v, w) = first.tolist(), second.tolist()
        cosine = np.dot(first, second) / np.linalg.norm(first) / np.linalg.norm(second)
        expected = (1, pytest.approx(math.acos(cosine)))
        assert nearest([Posture((x, y, z), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))], (u, v, w)) == expected
