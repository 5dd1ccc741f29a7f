"""How firmly a grip holds: the share of its strength that a load takes. More than 1, and the part slips (GR-1).

The contact is Coulomb friction on a round patch of even pressure: force along it and torque about its normal share what friction
gives on an ellipse (Howe and Cutkosky, Practical force-motion models for sliding manipulation, 1996). A disc of radius R, pressed
on with N, holds mu N along its face, or 2/3 mu N R about its normal.
"""

import math
from typing import NamedTuple

from sim.compiled.kernel import kernel

TURNING = 2.0 / 3.0
"""Arm of friction about the middle of a disc of even pressure, as a share of its radius."""


class GripContact(NamedTuple):
    """A grip, in F. Two fingers: `axis` is where they close along; a cup: away from the part."""

    point: tuple[float, float, float]  # middle of the grip [m]
    axis: tuple[float, float, float]  # of length 1
    fingers: bool  # two fingers; else a cup
    force: float  # of one finger, or of the vacuum [N]
    friction: float  # Coulomb coefficient
    radius: float  # of the patch, of each finger or of the cup [m]


class HeldBody(NamedTuple):
    """A part as the gripper holds it, in F."""

    mass: float  # [kg]
    com: tuple[float, float, float]  # [m]
    inertia: tuple[float, float, float, float, float, float]  # about its centre: xx yy zz xy xz yz [kg·m²]


def pad_radius(side: float) -> float:
    """Radius of the disc with the area of a square pad [m]."""
    return side / math.sqrt(math.pi)


@kernel
def load_on_grip(motion, faster, body, touched):
    """What the grip does to the part, at the part's centre.

    f = m (a + alpha × c + w × (w × c)) - f_t;  t = I alpha + w × I w - t_t, with the acceleration a against gravity of the
    origin of F, and f_t, t_t what touches the part elsewhere.

    Args:
        motion: means over the tick at the origin of F, in F: acceleration against gravity [m/s²], angular velocity [rad/s] (6,).
        faster: angular acceleration, in F (3,) [rad/s²].
        body: a `HeldBody`.
        touched: force [N] and torque about the part's centre [N·m] of what touches the part elsewhere, in F (6,).

    Returns:
        Force and torque, in F (6,).
    """
    m, (cx, cy, cz), (xx, yy, zz, xy, xz, yz) = body
    ax, ay, az, wx, wy, wz = motion
    px, py, pz = faster
    # w × c, then alpha × c + w × (w × c)
    ux, uy, uz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
    fx = m * (ax + py * cz - pz * cy + wy * uz - wz * uy)
    fy = m * (ay + pz * cx - px * cz + wz * ux - wx * uz)
    fz = m * (az + px * cy - py * cx + wx * uy - wy * ux)
    hx, hy, hz = xx * wx + xy * wy + xz * wz, xy * wx + yy * wy + yz * wz, xz * wx + yz * wy + zz * wz
    tx = xx * px + xy * py + xz * pz + wy * hz - wz * hy
    ty = xy * px + yy * py + yz * pz + wz * hx - wx * hz
    tz = xz * px + yz * py + zz * pz + wx * hy - wy * hx
    return (
        fx - touched[0],
        fy - touched[1],
        fz - touched[2],
        tx - touched[3],
        ty - touched[4],
        tz - touched[5],
    )


@kernel
def strength_taken(grip, load, centre):
    """The share of a grip's strength that a load takes.

    Two fingers, each with the force F on a pad of radius R:
        max( sqrt(f_t² + (t_n / (2/3 R))²) / (2 mu F),  |f_n| / F,  t_t / (2 F R) )
    A cup, drawn on with the force F, its rim of radius R:
        ( f_n + t_t / R + sqrt(f_t² + (t_n / (2/3 R))²) / mu ) / F

    n along the grip's axis, t across it; f_n of the cup draws the part away from it.

    Args:
        grip: a `GripContact`.
        load: force [N] and torque about the part's centre [N·m] of the grip on the part, in F (6,).
        centre: of the part, in F (3,) [m].
    """
    point, axis, fingers, force, friction, radius = grip
    fx, fy, fz, tx, ty, tz = load
    x, y, z = centre[0] - point[0], centre[1] - point[1], centre[2] - point[2]
    tx, ty, tz = tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx
    f_n = fx * axis[0] + fy * axis[1] + fz * axis[2]
    t_n = tx * axis[0] + ty * axis[1] + tz * axis[2]
    f_t = math.sqrt(max(fx * fx + fy * fy + fz * fz - f_n * f_n, 0.0))
    t_t = math.sqrt(max(tx * tx + ty * ty + tz * tz - t_n * t_n, 0.0))
    if force <= 0.0 or friction <= 0.0:
        return math.inf
    rubs = math.sqrt(f_t * f_t + (t_n / (TURNING * radius)) ** 2)
    if fingers:
        return max(rubs / (2.0 * friction * force), abs(f_n) / force, t_t / (2.0 * force * radius))
    return max((f_n + t_t / radius + rubs / friction) / force, 0.0)
