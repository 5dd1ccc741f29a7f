"""An arm's numbers: the only place that knows them. Parsed from a file of assets/robots/, each value with its source."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

import msgspec
import numpy as np
from msgspec import Meta

Positive = Annotated[float, Meta(gt=0)]
NotNegative = Annotated[float, Meta(ge=0)]
Count = Annotated[int, Meta(ge=1)]
Status = Literal["official", "measured", "assumed"]


class Sourced(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Where a group of values comes from. `assumed` names those of its values that are assumed although the rest is not."""

    status: Status
    source: Annotated[str, Meta(min_length=1)]
    assumed: list[str] = []


class Chain(Sourced):
    """Kinematics, standard Denavit-Hartenberg (link i's frame sits behind joint i: Rz(q) Tz(d) Tx(a) Rx(alpha))."""

    joints: list[str]  # names, base to flange
    a: list[float]  # [m]
    d: list[float]  # [m]
    alpha: list[float]  # [rad]
    elbow: int  # index of the joint whose origin is the elbow
    home: list[float]  # default posture [rad]


class Masses(Sourced):
    """Link masses and centres."""

    mass: list[Positive]  # [kg]
    com: list[list[float]]  # centre of mass in the DH link frame [m]


class Inertias(Sourced):
    """Link inertia about the centre of mass: ixx iyy izz ixy ixz iyz [kg·m²], axes of the joint frame (z = joint axis, q = 0)."""

    tensor: list[list[float]]


class Limits(Sourced):
    """Joint limits."""

    position: list[Positive]  # ± [rad]
    speed: list[Positive]  # [rad/s]
    acceleration: list[Positive]  # [rad/s²]
    torque: list[Positive]  # at the output [N·m]


class Motors(Sourced):
    """Motors, with the gear."""

    gear: list[Positive]
    torque_constant: list[Positive]  # motor side [N·m/A]
    current: list[Positive]  # largest [A]
    rotor_inertia: list[Positive]  # reflected to the output [kg·m²]
    ripple: list[NotNegative]  # torque ripple amplitude at the output [N·m], at twice the wave generator's turn


class Transmissions(Sourced):
    """Transmission of each joint: tau_J(x) = stiffness·x + stiffening·x³ + damping·x' + hysteresis, x = theta - q."""

    stiffness: list[Positive]  # [N·m/rad]
    stiffening: list[NotNegative]  # [N·m/rad³]
    damping: list[NotNegative]  # [N·m·s/rad]
    hysteresis_stiffness: list[NotNegative]  # of a stick-slip element in parallel [N·m/rad]
    hysteresis_yield: list[NotNegative]  # the deflection at which it slips [rad]


class Frictions(Sourced):
    """Joint friction, both sides together, without load at the reference temperature."""

    speed: list[NotNegative]  # where the curve was measured [rad/s], rising
    torque: list[list[Positive]]  # a row a joint, friction at those speeds [N·m]
    breakaway: list[Positive]  # at rest [N·m]
    output_share: NotNegative  # part of it that acts on the output side (bearings, seals)
    load: list[NotNegative]  # rise with |tau_J| [N·m per N·m]
    temperature: Positive  # reference [°C]
    per_kelvin: float  # relative change a kelvin at the reference
    presliding: list[Positive]  # bristle stiffness [N·m/rad]


class Thermals(Sourced):
    """Joint temperature, one mass a joint."""

    capacity: list[Positive]  # [J/K]
    resistance: list[Positive]  # to the room [K/W]
    ambient: float  # [°C]


class Encoders(Sourced):
    """Both angle sensors of a joint."""

    motor_counts: Count  # a turn of the motor
    output_counts: Count  # a turn of the output
    ripple: NotNegative  # largest error of the output encoder over a turn [rad]
    noise_counts: NotNegative  # standard deviation, in counts


class Channels(Sourced):
    """A sensor with like channels: range, quantum and noise in the sensor's unit."""

    range: Positive
    quantum: Positive
    noise: NotNegative


class ForceTorque(Sourced):
    """The flange sensor."""

    force: Channels
    torque: Channels
    stiffness: Positive  # between its two faces [N/m]
    stiffness_soft: Positive  # demonstration setting (CD-17) [N/m]
    damping_ratio: NotNegative
    plate_mass: Positive  # of the tool-side face [kg]
    plate_length: NotNegative  # from the sensing plane to the tool-side face [m]


class Sensors(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All sensors; the flange sensor and the accelerometers are optional (FD-3a)."""

    encoders: Encoders
    current: Channels  # [A]
    temperature: Channels  # [°C]
    force_torque: ForceTorque | None = None
    accelerometer: Channels | None = None  # [m/s²], at both faces of the flange sensor
    gyro: Channels | None = None  # [rad/s], at both faces


class Outline(Sourced):
    """The housings, for pictures. Link k starts at the seam of joint k and ends at the seam of joint k + 1."""

    seam: list[float]  # where link k meets its predecessor: z in the joint frame of link k [m]
    housing_radius: list[Positive]  # of the housing of each joint [m]
    tube_offset: list[float]  # z of a link's tube in its joint frame [m]; of use only where a is not 0
    tube_radius: list[Positive]  # of a link's tube in its middle [m]; of use only where a is not 0
    foot_radius: Positive  # of the base [m]
    flange_radius: Positive  # of the tool flange [m]


class Capsule(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A collision shape of a link: a segment with a radius, in the link's joint frame (z = joint axis, q = 0) [m]."""

    link: int  # -1 the base, 0 the first link, ...
    start: list[float]
    end: list[float]
    radius: Positive


class Arm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """An arm, as its file says. Lists run from base to flange; n joints."""

    name: str
    title: str
    reach: Positive  # [m]
    payload: Positive  # largest [kg]
    rating: Sourced  # of reach and payload
    chain: Chain
    masses: Masses
    inertias: Inertias
    limits: Limits
    motors: Motors
    transmissions: Transmissions
    frictions: Frictions
    thermals: Thermals
    sensors: Sensors
    outline: Outline
    shapes: list[Capsule]

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.chain.joints)


Problem = tuple[str, object, str]
"""A field, its value, and what is allowed."""


def problems(arm: Arm) -> list[Problem]:
    """What the types cannot say: lengths, ranges between fields, tensors of real bodies. Empty for a usable arm."""
    found = _lengths(arm)
    return found or [*_assumed(arm), *_postures(arm), *_tensors(arm), *_curves(arm), *_shapes(arm)]


def _lengths(arm: Arm) -> list[Problem]:
    n = arm.n
    if n == 0:
        return [("chain.joints", [], "expected at least one joint")]
    c, m, t, f, o = arm.chain, arm.motors, arm.transmissions, arm.frictions, arm.outline
    lists: dict[str, list[object]] = {
        **{f"chain.{name}": getattr(c, name) for name in ("a", "d", "alpha", "home")},
        **{f"masses.{name}": getattr(arm.masses, name) for name in ("mass", "com")},
        "inertias.tensor": list(arm.inertias.tensor),
        **{f"limits.{name}": getattr(arm.limits, name) for name in ("position", "speed", "acceleration", "torque")},
        **{f"motors.{name}": getattr(m, name) for name in ("gear", "torque_constant", "current", "rotor_inertia", "ripple")},
        **{f"transmissions.{name}": getattr(t, name) for name in ("stiffness", "stiffening", "damping")},
        **{f"transmissions.{name}": getattr(t, name) for name in ("hysteresis_stiffness", "hysteresis_yield")},
        **{f"frictions.{name}": getattr(f, name) for name in ("torque", "breakaway", "load", "presliding")},
        **{f"thermals.{name}": getattr(arm.thermals, name) for name in ("capacity", "resistance")},
        **{f"outline.{name}": getattr(o, name) for name in ("seam", "housing_radius", "tube_offset", "tube_radius")},
    }
    rows = {
        **{f"masses.com[{k}]": (row, 3) for k, row in enumerate(arm.masses.com)},
        **{f"inertias.tensor[{k}]": (row, 6) for k, row in enumerate(arm.inertias.tensor)},
        **{f"frictions.torque[{k}]": (row, len(f.speed)) for k, row in enumerate(f.torque)},
        **{f"shapes[{k}].start": (shape.start, 3) for k, shape in enumerate(arm.shapes)},
        **{f"shapes[{k}].end": (shape.end, 3) for k, shape in enumerate(arm.shapes)},
    }
    return [(name, value, f"expected a list of {n}, one a joint") for name, value in lists.items() if len(value) != n] + [
        (name, row, f"expected a list of {length}") for name, (row, length) in rows.items() if len(row) != length
    ]


def _groups(value: msgspec.Struct, path: str = "") -> Iterator[tuple[str, Sourced]]:
    """All sourced groups below `value`, with their dotted paths."""
    for name in value.__struct_fields__:
        inner = getattr(value, name)
        if isinstance(inner, Sourced):
            yield path + name, inner
        if isinstance(inner, msgspec.Struct):
            yield from _groups(inner, f"{path}{name}.")


def _assumed(arm: Arm) -> list[Problem]:
    """Every name in an `assumed` list is a field of its group."""
    found: list[Problem] = []
    for path, group in _groups(arm):
        allowed = [field for field in group.__struct_fields__ if field not in Sourced.__struct_fields__]
        found += [
            (f"{path}.assumed[{k}]", name, f"expected one of {', '.join(allowed) or 'nothing'}")
            for k, name in enumerate(group.assumed)
            if name not in allowed
        ]
    return found


def _postures(arm: Arm) -> list[Problem]:
    c = arm.chain
    found: list[Problem] = []
    for k, name in enumerate(c.joints):
        if not name or name in c.joints[:k] or name in ("foot", "flange", "tool"):
            found.append((f"chain.joints[{k}]", name, "expected names that differ, and not foot, flange or tool"))
        if abs(c.home[k]) > arm.limits.position[k]:
            found.append((f"chain.home[{k}]", c.home[k], f"expected within ±{arm.limits.position[k]:g} rad"))
    if not 0 <= c.elbow < arm.n:
        found.append(("chain.elbow", c.elbow, f"expected 0 to {arm.n - 1}"))
    return found


def _tensors(arm: Arm) -> list[Problem]:
    """A body's principal moments are positive and none exceeds the sum of the others."""
    found: list[Problem] = []
    for k, (xx, yy, zz, xy, xz, yz) in enumerate(arm.inertias.tensor):
        low, middle, high = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if low <= 0 or high > low + middle:
            value = ", ".join(f"{moment:.3g}" for moment in (low, middle, high))
            found.append((f"inertias.tensor[{k}]", value, "expected principal moments > 0, each at most the sum of the others"))
    return found


def _curves(arm: Arm) -> list[Problem]:
    f, t = arm.frictions, arm.transmissions
    found: list[Problem] = []
    if len(f.speed) < 2 or any(b <= a for a, b in pairwise(f.speed)):
        found.append(("frictions.speed", f.speed, "expected at least 2 speeds, rising"))
    for k in range(arm.n):
        if any(b < a for a, b in pairwise(f.torque[k])):
            found.append((f"frictions.torque[{k}]", f.torque[k], "expected torques that do not fall with speed"))
        if f.breakaway[k] < f.torque[k][0] * 0.9:
            found.append((f"frictions.breakaway[{k}]", f.breakaway[k], f"expected at least 0.9 times {f.torque[k][0]:g}"))
        if t.hysteresis_stiffness[k] > 0 and t.hysteresis_yield[k] == 0:
            found.append((f"transmissions.hysteresis_yield[{k}]", 0.0, "expected > 0 where hysteresis_stiffness is"))
        full = arm.motors.gear[k] * arm.motors.torque_constant[k] * arm.motors.current[k]
        if full < arm.limits.torque[k]:
            allowed = f"expected a current for the torque limit {arm.limits.torque[k]:g} N·m, this gives {full:.3g}"
            found.append((f"motors.current[{k}]", arm.motors.current[k], allowed))
        if arm.sensors.current.range < arm.motors.current[k]:
            allowed = f"expected at least the largest current {arm.motors.current[k]:g} A"
            found.append(("sensors.current.range", arm.sensors.current.range, allowed))
    if f.output_share > 1:
        found.append(("frictions.output_share", f.output_share, "expected 0 to 1"))
    return found


def _shapes(arm: Arm) -> list[Problem]:
    return [
        (f"shapes[{k}].link", shape.link, f"expected -1 to {arm.n - 1}")
        for k, shape in enumerate(arm.shapes)
        if not -1 <= shape.link < arm.n
    ]
