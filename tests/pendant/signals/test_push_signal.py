"""Which wrench at the flange is a push or a twist: size, torque, cone, band, force off the axis (FD-5c, FD-5d, FD-6)."""

import math
from itertools import product

import numpy as np
import pytest

from pendant.signals.push_signal import PushSignal
from pendant.signals.settings import PushDirection, PushFrame, PushSettings
from pendant.tick.pose import UNTURNED, flat

CALM = (0.0, 0.0, 0.0)
LARGEST = 200.0  # [N], so large that it forbids nothing

AXES = [(0.2, -0.5, 0.4), (-0.9, 0.3, 0.1), (1.0, 0.0, 0.0), (0.0, -0.4, 0.0), (0.0, 0.0, 0.7)]
FORCES = [(6.0, -18.0, 11.0), (-21.0, 5.0, 9.0), (-7.0, -12.0, 16.0)]
TURNED = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def pushes(force: tuple[float, ...], use: PushSettings, torque: tuple[float, ...] = CALM, R_BF: np.ndarray | None = None) -> bool:
    """Whether a first tick of force [N] and torque [N·m] is a push."""
    return PushSignal().step((*force, *torque), UNTURNED if R_BF is None else flat(R_BF), use)


@pytest.mark.parametrize(
    ("share", "there"), [(0.999, False), (1.0, False), (1.001, True), (1.999, True), (2.0, True), (2.001, False)]
)
def test_a_push_is_beyond_its_threshold_and_not_beyond_its_limit(share: float, there: bool) -> None:
    use = PushSettings(threshold=15.0, force_limit=30.0)
    assert pushes((2.0 * share, -10.0 * share, 11.0 * share), use) is there


@pytest.mark.parametrize(("share", "there"), [(0.749, False), (0.75, False), (0.751, True)])
def test_a_push_that_is_there_stays_beyond_three_quarters_of_its_threshold(share: float, there: bool) -> None:
    signal, use = PushSignal(), PushSettings(threshold=15.0)
    assert signal.step((4.0, -20.0, 22.0, *CALM), UNTURNED, use)
    assert signal.step((2.0 * share, -10.0 * share, 11.0 * share, *CALM), UNTURNED, use) is there


@pytest.mark.parametrize(("limit", "there"), [(12.99, False), (13.0, True), (13.01, True)])
def test_a_torque_at_its_limit_is_no_hindrance(limit: float, there: bool) -> None:
    assert pushes((20.0, 0.0, 0.0), PushSettings(torque_limit=limit), (3.0, -4.0, 12.0)) is there


@pytest.mark.parametrize("R_BF", [None, TURNED])
@pytest.mark.parametrize("band", [False, True])
@pytest.mark.parametrize(("axis", "force"), list(product(AXES, FORCES)))
def test_the_cone_is_about_the_axis_and_the_band_across_it(
    axis: tuple[float, float, float], force: tuple[float, ...], band: bool, R_BF: np.ndarray | None
) -> None:
    """FD-6: just within the angle that numpy finds, and just not."""
    x, y, z = axis
    along = np.array(axis) if R_BF is None else R_BF @ axis
    cosine = np.dot(force, along) / np.linalg.norm(force) / np.linalg.norm(along)
    angle = math.degrees(math.asin(abs(cosine)) if band else math.acos(cosine))
    for more, there in ((-0.01, False), (0.01, True)):
        use = PushSettings(
            x=x,
            y=y,
            z=z,
            angle=angle + more,
            direction=PushDirection.ACROSS if band else PushDirection.ALONG,
            off_axis=LARGEST,
            frame=PushFrame.BASE if R_BF is None else PushFrame.FLANGE,
        )
        assert pushes(force, use, R_BF=R_BF) is there


@pytest.mark.parametrize(("band", "force"), [(False, (0.0, 0.0, 20.0)), (True, (12.0, -16.0, 0.0))])
def test_a_cone_or_band_without_width_takes_a_push_along_it(band: bool, force: tuple[float, ...]) -> None:
    assert pushes(force, PushSettings(z=1.0, angle=0.0, direction=PushDirection.ACROSS if band else PushDirection.ALONG))


@pytest.mark.parametrize(("most", "there"), [(4.99, False), (5.0, True), (5.01, True)])
def test_force_across_the_axis_is_allowed_up_to_its_limit(most: float, there: bool) -> None:
    assert pushes((3.0, -4.0, 12.0), PushSettings(threshold=10.0, z=1.0, off_axis=most)) is there


@pytest.mark.parametrize("count", [0, 1, 2, 10])
def test_a_push_comes_when_the_torque_has_been_within_its_limit_for_longer_than_its_period(count: int) -> None:
    """FD-6: from the first tick on, and from each in which it was beyond."""
    signal, use = PushSignal(), PushSettings(torque_period=0.002 * count)
    course = [*[0.0] * (count + 1), use.torque_limit + 0.1, *[0.0] * (count + 1)]
    seen = [signal.step((20.0, 0.0, 0.0, torque, 0.0, 0.0), UNTURNED, use) for torque in course]
    assert seen == [*[False] * count, True, False, *[False] * count, True]
