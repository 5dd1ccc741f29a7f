"""What makes an arm's file unusable although each of its values is in range by itself."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import msgspec
import numpy as np

from sim.arm.arm_file import Arm, Sourced
from sim.arm.chain import chain
from sim.arm.frames import placements
from sim.sensing.sensor_drift import BOUND, most

SHORTEST = 1e-6
"""Length below which an axis or a quaternion has no direction."""

LONGEST = 4.0
"""Times its reach that an arm's links are long end to end, at most; the shipped arms 1.4 to 1.8 times."""

Problem = tuple[str, object, str]
"""A field, its value, and what is allowed."""


def problems(arm: Arm) -> list[Problem]:
    """What the types cannot say: lengths, ranges between fields, tensors of real bodies. Empty for a usable arm."""
    found = _lengths(arm)
    found = found or [*_assumed(arm), *_reach(arm), *_postures(arm), *_tensors(arm), *_curves(arm), *_drift(arm), *_shapes(arm)]
    return found or _last_link(arm)


def _lengths(arm: Arm) -> list[Problem]:
    n = arm.n
    c, m, t, f, o = arm.chain, arm.motors, arm.transmissions, arm.frictions, arm.outline
    lists: dict[str, Sequence[object]] = {
        **{f"chain.{name}": getattr(c, name) for name in (("origins",) if c.origins else ("a", "d", "alpha"))},
        "chain.home": c.home,
        **{f"masses.{name}": getattr(arm.masses, name) for name in ("mass", "com")},
        "inertias.tensor": arm.inertias.tensor,
        **{f"limits.{name}": getattr(arm.limits, name) for name in ("position", "speed", "acceleration", "torque")},
        **{f"motors.{name}": getattr(m, name) for name in ("gear", "torque_constant", "current", "rotor_inertia", "ripple")},
        **{f"transmissions.{name}": getattr(t, name) for name in ("stiffness", "stiffening", "damping")},
        **{f"transmissions.{name}": getattr(t, name) for name in ("hysteresis_stiffness", "hysteresis_yield")},
        **{f"frictions.{name}": getattr(f, name) for name in ("torque", "breakaway", "load", "presliding")},
        **{f"thermals.{name}": getattr(arm.thermals, name) for name in ("capacity", "resistance")},
    }
    if o is not None:
        lists |= {f"outline.{name}": getattr(o, name) for name in ("seam", "housing_radius", "tube_offset", "tube_radius")}
    rows = {
        **{f"masses.com[{k}]": (row, 3) for k, row in enumerate(arm.masses.com)},
        **{f"inertias.tensor[{k}]": (row, 6) for k, row in enumerate(arm.inertias.tensor)},
        **{f"frictions.torque[{k}]": (row, len(f.speed)) for k, row in enumerate(f.torque)},
        **{f"shapes[{k}].start": (shape.start, 3) for k, shape in enumerate(arm.shapes)},
        **{f"shapes[{k}].end": (shape.end, 3) for k, shape in enumerate(arm.shapes)},
    }
    found = _ways(arm)
    for name, value in lists.items():
        if len(value) != n:
            found.append((name, value, f"expected a list of {n}, one a joint"))
    for name, (row, length) in rows.items():
        if len(row) != length:
            found.append((name, row, f"expected a list of {length}"))
    return found


def _ways(arm: Arm) -> list[Problem]:
    """A chain is given in one way, and its turns and axes have a direction."""
    c = arm.chain
    if not c.origins:
        return [("chain.flange", "given", "expected origins beside it, or none of both")] if c.flange is not None else []
    found = [
        (f"chain.{name}", getattr(c, name), "expected nothing beside origins: they say the same")
        for name in ("a", "d", "alpha")
        if getattr(c, name)
    ]
    if c.flange is None:
        found.append(("chain.flange", None, "expected the flange in the last link: origins do not say it"))
    for name, origin in [*((f"origins[{k}]", each) for k, each in enumerate(c.origins)), ("flange", c.flange)]:
        if origin is None:
            continue
        if origin.rpy is not None and origin.quaternion is not None:
            found.append((f"chain.{name}.quaternion", origin.quaternion, "expected rpy or quaternion, not both"))
        if origin.axis is not None and name == "flange":
            found.append(("chain.flange.axis", origin.axis, "expected none: nothing turns there"))
        for what in ("quaternion", "axis"):
            given = getattr(origin, what)
            if given is not None and not math.hypot(*given) > SHORTEST:
                found.append((f"chain.{name}.{what}", given, "expected a direction, not zeros"))
    return found


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


def _reach(arm: Arm) -> list[Problem]:
    """The links can reach that far, and are not so long that another unit must be meant, as millimetres."""
    stretched = float(np.linalg.norm(placements(arm)[:, :3, 3], axis=1).sum())
    if arm.reach <= stretched <= LONGEST * arm.reach:
        return []
    allowed = f"expected at most the chain's length end to end, {stretched:.4g} m, and at least a quarter of it"
    return [("reach", arm.reach, allowed)]


def _postures(arm: Arm) -> list[Problem]:
    c = arm.chain
    found: list[Problem] = []
    for k, name in enumerate(c.joints):
        if not name or name in c.joints[:k] or name in ("foot", "flange", "tool"):
            found.append((f"chain.joints[{k}]", name, "expected names that differ, and not foot, flange or tool"))
        low, high = arm.limits.ends[k]
        if not low < high:
            found.append((f"limits.position[{k}]", [low, high], "expected the smallest angle, then the largest"))
        elif not low <= c.home[k] <= high:
            found.append((f"chain.home[{k}]", c.home[k], f"expected within {low:g} .. {high:g} rad"))
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
    for k in range(arm.n if not found else 0):
        # The output side has a share of the straight line through the curve (sim/plant/joint_friction.py).
        straight = f.output_share * float(np.polyfit(f.speed, f.torque[k], 1)[1])
        if not 0.0 <= straight < f.breakaway[k]:
            allowed = f"expected a line through it that passes 0 to {f.breakaway[k] / max(f.output_share, 1e-9):.4g} N·m at rest"
            found.append((f"frictions.torque[{k}]", f.torque[k], allowed))
        if any(b < a for a, b in pairwise(f.torque[k])):
            found.append((f"frictions.torque[{k}]", f.torque[k], "expected torques that do not fall with speed"))
        if f.breakaway[k] < f.torque[k][0] * 0.9:
            found.append((f"frictions.breakaway[{k}]", f.breakaway[k], f"expected at least 0.9 times {f.torque[k][0]:g}"))
        if t.hysteresis_stiffness[k] > 0 and t.hysteresis_yield[k] == 0:
            found.append((f"transmissions.hysteresis_yield[{k}]", 0.0, "expected > 0 where hysteresis_stiffness is"))
        full = arm.motors.torque_per_current[k] * arm.motors.current[k]
        if full < arm.limits.torque[k]:
            allowed = f"expected a current for the torque limit {arm.limits.torque[k]:g} N·m, this gives {full:.3g}"
            found.append((f"motors.current[{k}]", arm.motors.current[k], allowed))
        if arm.sensors.current.range < arm.motors.current[k]:
            allowed = f"expected at least the largest current {arm.motors.current[k]:g} A"
            found.append(("sensors.current.range", arm.sensors.current.range, allowed))
    return found


def _drift(arm: Arm) -> list[Problem]:
    """A sensor that carries nothing is within its range, wherever its zero drifts."""
    sensor = arm.sensors.force_torque
    if sensor is None or sensor.drift is None:
        return []
    found: list[Problem] = []
    largest = most(arm.accuracy, sensor.drift)
    for name, error, channels in zip(("force", "torque"), largest, (sensor.force, sensor.torque), strict=True):
        if error >= channels.range:
            allowed = f"expected it and {BOUND:g} times walk_{name} to stay below the sensor's range, {channels.range:g}"
            found.append((f"sensors.force_torque.drift.{name}", getattr(sensor.drift, name), allowed))
    return found


def _last_link(arm: Arm) -> list[Problem]:
    """What is left of the last link without the sensor's tool-side face is a possible body."""
    plate = arm.sensors.force_torque
    if plate is None:
        return []
    rest = chain(arm).links[-1]
    low, middle, high = np.linalg.eigvalsh(rest.inertia)
    if rest.mass > 0 and low > 0 and high <= low + middle:
        return []
    return [("sensors.force_torque.plate_mass", plate.plate_mass, "expected less, the last link has not so much to give")]


def _shapes(arm: Arm) -> list[Problem]:
    return [
        (f"shapes[{k}].link", shape.link, f"expected -1 to {arm.n - 1}")
        for k, shape in enumerate(arm.shapes)
        if not -1 <= shape.link < arm.n
    ]
