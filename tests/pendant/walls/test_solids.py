"""Fields of the single solids at places that sampled points hardly meet (VW-1); test_shapes.py has the rest of them."""

import math

import pytest

from pendant.walls.solids import cone


@pytest.mark.parametrize("turn", [0.0, 1.0, 4.0])
@pytest.mark.parametrize(("below", "beside"), [(0.5, 0.2), (0.05, 0.02), (0.9, 0.3)])
def test_below_a_cone_and_beside_its_base_the_rim_is_nearest(below: float, beside: float, turn: float) -> None:
    """There the plane of the side, which goes on outwards, is above the point: of radius and height 1 m, at 45 degrees."""
    assert beside < below
    rho = 1.0 + beside
    distance, x, y, z = cone(1.0, 1.0)(rho * math.cos(turn), rho * math.sin(turn), -0.5 - below)
    far = math.hypot(beside, below)
    assert distance == pytest.approx(far)
    assert (x, y, z) == pytest.approx((beside / far * math.cos(turn), beside / far * math.sin(turn), -below / far))
