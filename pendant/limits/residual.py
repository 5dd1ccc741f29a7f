"""The payload-like residual: the part of the user's wrench that a wrong payload explains (FD-9, FD-13, FD-19).

A payload error (dm, dm·c) at rest gives the flange a force dm·g and a torque c x dm·g. In one posture every force along gravity
and every torque across it has such an error behind it, so the best fit is a projection, and what is left is the user's for sure.
The flange sensor's offset looks like both.
"""

import math
from collections.abc import Sequence

import msgspec

from pendant.tick.estimate import GRAVITY

Vector = tuple[float, float, float]


class Split(msgspec.Struct, frozen=True, gc=False):
    """A wrench in two parts; sizes, but for the first."""

    payload_force: float  # along `up`, signed: negative when the payload is heavier than configured [N]
    payload_torque: float  # across gravity [N·m]
    user_force: float  # across gravity [N]
    user_torque: float  # about the direction of gravity [N·m]


class PayloadError(msgspec.Struct, frozen=True, gc=False):
    """What is known of the error of the payload's mass, true minus configured."""

    mass: float  # [kg]
    margin: float  # a right payload seems wrong by so much at most [kg]


def upward(g: Sequence[float]) -> Vector:
    """Unit vector against gravity `g`, which is not zero."""
    x, y, z = g
    size = math.sqrt(x * x + y * y + z * z)
    return -x / size, -y / size, -z / size


def split(wrench: Sequence[float], up: Vector) -> Split:
    """Split a wrench: force [N], then torque [N·m], in the same axes as `up`."""
    fx, fy, fz, tx, ty, tz = wrench
    ux, uy, uz = up
    along = fx * ux + fy * uy + fz * uz
    about = tx * ux + ty * uy + tz * uz
    # The differences, not Pythagoras: that would take the root of a rounding error.
    dx, dy, dz = fx - along * ux, fy - along * uy, fz - along * uz
    force = math.sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = tx - about * ux, ty - about * uy, tz - about * uz
    return Split(along, math.sqrt(dx * dx + dy * dy + dz * dz), force, abs(about))


def mass_error(payload_force: float) -> float:
    """The payload error dm [kg] that explains `payload_force`: true minus configured."""
    return -payload_force / GRAVITY


def weight_error(mass: float) -> float:
    """The payload force [N] of a payload error [kg]."""
    return -mass * GRAVITY
