"""What an arm can bear: rated torques, payload, reach, where the description does not say it or cannot mean it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.arm_import.size_rules import LOADED
from app.files.bad_input import BadInput
from sim.arm.chain import Body, Chain
from sim.rigid_body.dynamics import GRAVITY, Dynamics

Array = NDArray[np.float64]

POSTURES = 1000
"""In which own weight and payload are weighed."""

HEAVIEST = 0.5
"""Rated payload over the mass that the joints move, at most; of the arms in assets/robots it is 0.2 to 0.35."""

USUAL = 0.25
"""The same, where the file says no torques."""

LITTLE = 0.05
"""The same, from which down a file's torques are told to bear little more than the arm."""

LEAST_SHARE = 0.2
"""Rated torque of a joint that bears little, over the largest: the wrists of cobots have a fifth."""

UNLIKELY = 2.0
"""A file whose largest torque is so many times what own weight and the heaviest payload ask for holds a placeholder."""


class Ratings(NamedTuple):
    """What the rules make of an arm."""

    torque: list[float]  # [N·m]
    believed: bool  # the file's torques, as far as it has them
    payload: float  # [kg]
    told: list[str]  # rules that were used, a line each


class Weights(NamedTuple):
    """Torques at rest in drawn postures: of the links (m, n) [N·m], and of a kilogram at the flange (m, n) [N·m/kg]."""

    own: Array
    kilogram: Array
    moving: float  # mass of the links [kg]

    def needed(self, payload: float) -> Array:
        """Largest torque of each joint (n,) with a payload [kg] at the flange [N·m]."""
        return np.abs(self.own + payload * self.kilogram).max(axis=0)


def weights(rigid: Chain, postures: Array) -> Weights:
    """Weigh an arm on the floor in postures (m, n)."""
    nothing = Body(0.0, np.zeros(3), np.zeros((3, 3)))
    model = Dynamics(rigid, rigid.links, nothing, mounting=[0.0, 0.0, 0.0], elbow=0)
    own, kilogram = np.empty_like(postures), np.empty_like(postures)
    for k, q in enumerate(postures):
        own[k] = model.gravity(q)
        kilogram[k] = GRAVITY * model.update(q)[2][2]
    return Weights(own, kilogram, sum(link.mass for link in rigid.links))


def ratings(said: Sequence[float | None], payload: float | None, weighed: Weights, *, where: str) -> Ratings:
    """Rated torques and payload.

    Args:
        said: torques of the file [N·m].
        payload: as measured, or as its maker says [kg]; None: the rule.
        weighed: own weight.
        where: the file's name.

    Raises:
        BadInput: with these torques the arm cannot hold itself.
    """
    told: list[str] = []
    most = HEAVIEST * weighed.moving
    asked = weighed.needed(most) / LOADED
    given = [each for each in said if each is not None]
    believed = bool(given) and max(given) <= UNLIKELY * asked.max()
    if given and not believed:
        told.append(
            f"limits.torque: {max(given):g} N·m of the file is not taken: with half of its own mass, {most:.2g} kg, "
            f"the arm asks for {asked.max():.3g} N·m"
        )
    guess = weighed.needed(USUAL * weighed.moving if payload is None else payload) / LOADED
    by_rule = np.maximum(guess, LEAST_SHARE * guess.max())
    torque = [each if each is not None and believed else float(f"{rule:.3g}") for each, rule in zip(said, by_rule, strict=True)]
    short = LOADED * np.array(torque) - weighed.needed(0.0)
    if short.min() <= 0.0 and believed:
        k = int(short.argmin())
        allowed = f"expected at least {weighed.needed(0.0)[k] / LOADED:.3g} N·m: own weight takes at most two thirds of it"
        raise BadInput(where, f"torque of joint {k + 1}", torque[k], allowed)
    if not believed or len(given) < len(torque):
        told.append(
            f"limits.torque: 1.5 times what own weight and {USUAL:g} of it as payload ask for in {POSTURES} postures, at "
            f"least {LEAST_SHARE:g} of the largest"
        )
    if payload is None:
        payload = min(_payload(np.array(torque), weighed), most)
        told.append(
            f"payload: what two thirds of each joint's torque bear in {POSTURES} postures beside own weight, at most half of the "
            f"{weighed.moving:.3g} kg that move"
        )
        if payload < LITTLE * weighed.moving:
            told.append(
                f"payload: {payload:.2g} kg, as the file's torques bear little more than the arm itself: give its maker's "
                "payload and limits.torque by --measured"
            )
    return Ratings(torque, believed, max(float(f"{payload:.2g}"), 0.01), told)


def _payload(torque: Array, weighed: Weights) -> float:
    """The heaviest payload with which no joint exceeds its share in any posture [kg]."""
    limit = LOADED * torque
    # own + m·kilogram within ±limit: the first m at which one of them is not, whichever way the kilogram pulls.
    room = np.where(weighed.kilogram > 0.0, limit - weighed.own, limit + weighed.own)
    pull = np.maximum(np.abs(weighed.kilogram), 1e-9)
    return max(0.0, float((room / pull).min()))


def reach_of(frames: Array) -> float:
    """Largest distance of the last joint from the second [m], as data sheets measure it; frames (m, n + 1, 4, 4) of postures."""
    return float(np.linalg.norm(frames[:, -2, :3, 3] - frames[:, 1, :3, 3], axis=1).max())


def elbow_of(lengths: Array) -> int:
    """Index of the joint that parts a chain best in two; lengths (n + 1,) from each joint to the next [m], the base first."""
    along = np.cumsum(lengths)
    middle = (along[1] + along[-1]) / 2.0
    inner = range(1, max(2, len(lengths) - 2))
    return min(inner, key=lambda k: abs(along[k] - middle))
