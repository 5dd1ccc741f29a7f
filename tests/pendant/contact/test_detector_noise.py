"""One detector in noise, in motion, with a bias and a drift: what it must not find, and what it finds all the same."""

import msgspec
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.contact.detector import SILENCE
from tests.pendant.contacts import GRAVITY, USE, found, ramp, signals

START = 150


def test_more_sensitive_is_sooner_and_less_is_later() -> None:
    stream = signals(400, push=ramp(400, START, 0.3))
    ticks = [found(stream, msgspec.structs.replace(USE, sensitivity=value))[0][0] for value in (2.0, 1.0, 0.25)]
    assert ticks == sorted(ticks)
    assert ticks[0] < ticks[2]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 9), st.floats(0.5, 5.0), st.floats(-0.2, 0.2), st.floats(0.3, 2.0), st.floats(2.0, 30.0))
def test_free_motion_of_a_wrong_payload_is_no_contact(seed: int, mass: float, wrong: float, rate: float, size: float) -> None:
    """Fast to and fro, the tool turning in gravity: dF and dA stay parallel, whatever the payload weighs."""
    t = np.arange(800) * 0.002
    motion = size * np.sin(2 * np.pi * rate * t)[:, None] * np.array([0.6, -0.5, 0.62])
    gravity = 9.81 * np.stack([np.sin(rate * t), np.zeros_like(t), -np.cos(rate * t)], axis=1)
    assert found(signals(800, mass=mass * (1 + wrong), believed=mass, motion=motion, gravity=gravity, seed=seed)) == []


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9), st.lists(st.floats(-8.0, 8.0), min_size=3, max_size=3))
def test_a_constant_bias_changes_nothing(seed: int, bias: list[float]) -> None:
    plain = signals(500, push=ramp(500, START, 1.0, top=20.0), seed=seed)
    biased = [s._replace(fx=s.fx + bias[0], fy=s.fy + bias[1], fz=s.fz + bias[2]) for s in plain]
    first, second = found(plain), found(biased)
    assert [(tick, f.change, f.rule, f.steps) for tick, f in first] == [(tick, f.change, f.rule, f.steps) for tick, f in second]
    assert len(first) == 1


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9), st.floats(-2.0, 2.0))
def test_a_slow_drift_changes_nothing(seed: int, drift: float) -> None:
    """Up to 2 N a minute, four times what the arms' files allow."""
    stream = [s._replace(fx=s.fx + drift / 60.0 * 0.002 * k) for k, s in enumerate(signals(1500, seed=seed))]
    assert found(stream) == []


def test_it_finds_what_lies_in_any_direction() -> None:
    rng = np.random.default_rng(4)
    for _ in range(10):
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        (_, finding), *_ = found(signals(250, push=ramp(250, START, 8.0, way=tuple(way))))
        assert np.dot(finding.force, way) > 0.9 * np.linalg.norm(finding.force)
        assert np.dot(finding.acceleration, way) < 0.0
        assert finding.ratio < 0.0


def test_gravity_is_that_of_the_earth() -> None:
    assert np.linalg.norm(GRAVITY) == 9.81


def test_it_is_silent_until_the_force_has_settled() -> None:
    n = START + SILENCE + 400
    seen = found(signals(n, push=ramp(n, START, 0.6)))
    assert len([tick for tick, _ in seen if tick < START + 200]) == 1
