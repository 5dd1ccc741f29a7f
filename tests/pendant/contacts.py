"""Signals for tests of contact detection: a load on an arm of some effective mass, moved about and pushed."""

import numpy as np
from numpy.typing import NDArray

from pendant.contact.contact_limits import ContactLimits, limits
from pendant.contact.detector import Detector, Finding
from pendant.contact.settings import ContactUse
from pendant.tick.modes import Mode
from pendant.tick.source_signal import ContactSignals, Signal

Array = NDArray[np.float64]
USE = ContactUse(on=True, instant=False, ratio_of_values=False)
GRAVITY = np.array([0.0, 0.0, -9.81])


def limit(use: ContactUse = USE, mass: float = 1.0, effective_mass: float = 2.0) -> ContactLimits:
    return limits(use, Mode.RUN, mass=mass, effective_mass=effective_mass, speed=0.0)


def signals(
    n: int,
    *,
    mass: float = 1.0,
    arm: float = 2.0,
    push: Array | None = None,
    motion: Array | None = None,
    gravity: Array | None = None,
    believed: float | None = None,
    noise: float = 1.0,
    seed: int = 0,
) -> list[Signal]:
    """n ticks. `push` (n, 3) is the force of the arm on an object, `motion` (n, 3) the free acceleration.

    The object pushes back on load and arm together: a = motion - push / (arm + mass), and what the flange exerts on the load is
    m·(a - g) + push (docs/explanation/contact.md).
    """
    rng = np.random.default_rng(seed)
    zero = np.zeros((n, 3))
    push, motion = zero if push is None else push, zero if motion is None else motion
    g = np.tile(GRAVITY, (n, 1)) if gravity is None else gravity
    acceleration = motion - push / (arm + mass) - g
    force = mass * acceleration + push + rng.normal(0.0, 0.15 * noise, (n, 3))
    acceleration = acceleration + rng.normal(0.0, 0.1 * noise, (n, 3))
    rows = np.hstack([force, acceleration, g]).tolist()
    return [Signal(*row, mass if believed is None else believed, arm) for row in rows]


def ramp(n: int, start: int, slope: float, top: float = 1e9, way: tuple[float, float, float] = (1.0, 0.0, 0.0)) -> Array:
    """A push that grows by `slope` [N a tick] from `start` on, up to `top`."""
    size = np.clip(slope * (np.arange(n) - start), 0.0, top)
    return size[:, None] * np.array(way)


def found(stream: list[Signal], use: ContactUse = USE, limit_: ContactLimits | None = None) -> list[tuple[int, Finding]]:
    """What a detector finds, with the tick, counted from 0."""
    detector, result = Detector(), []
    for tick, signal in enumerate(stream):
        detector.sense(signal)
        finding = detector.step(use, limit_ or limit(use, signal.mass, signal.effective_mass))
        if finding is not None:
            result.append((tick, finding))
    return result


def on_links(
    link: Signal,
    torques: Array,
    doubt: Array,
    causes: tuple[Array, Array, Array],
    held: Array | None = None,
) -> ContactSignals:
    """A tick in which the links alone are watched; `causes` are they, their shares and the misfit, as in `ContactSignals`.

    The arm stands where friction may hold something.
    """
    n = torques.size
    (each, shares, misfit), held = causes, np.zeros(n) if held is None else held
    numbers = np.concatenate([np.tile(link, 4), torques, each.ravel(), held, doubt, shares.ravel(), misfit.ravel()])
    return ContactSignals(numbers, (False, False, True, True), n, stands=bool(held.any()))
