"""What the types of an arm cannot say. Each case breaks one thing of a good arm."""

from typing import Any

import msgspec
import pytest

from app.files.library import load_arm
from sim.arm.arm_file import Arm
from sim.arm_problems import problems

GOOD, TRANSFORMS = load_arm("ur5e"), load_arm("iiwa7")


def broken(field: str, value: object, good: Arm = GOOD) -> Arm:
    """The good arm with one dotted field replaced."""
    raw: Any = msgspec.to_builtins(good)
    *path, last = [int(step) if step.isdigit() else step for step in field.split(".")]
    place = raw
    for step in path:
        place = place[step]
    place[last] = msgspec.to_builtins(value)
    return msgspec.convert(raw, Arm)


def test_a_good_arm_has_no_problems() -> None:
    assert problems(GOOD) == []
    assert problems(TRANSFORMS) == []


@pytest.mark.parametrize(
    ("field", "value", "named", "allowed"),
    [
        ("chain.a", [0.0] * 7, "chain.a", "nothing beside origins"),
        ("chain.flange", None, "chain.flange", "the flange in the last link"),
        ("chain.flange.axis", [0.0, 0.0, 1.0], "chain.flange.axis", "none"),
        ("chain.origins", TRANSFORMS.chain.origins[:-1], "chain.origins", "a list of 7"),
        ("chain.origins.1.axis", [0.0, 0.0, 0.0], "chain.origins[1].axis", "a direction"),
        ("chain.origins.2.quaternion", [0.0] * 4, "chain.origins[2].quaternion", "a direction"),
        (
            "chain.origins.2",
            {"xyz": [0.0] * 3, "rpy": [0.0] * 3, "quaternion": [1.0, 0.0, 0.0, 0.0]},
            "chain.origins[2]",
            "not both",
        ),
        ("limits.position.3", [-0.1, -3.0], "limits.position[3]", "the smallest angle, then the largest"),
        ("limits.position.3", [-3.0, -1.5], "chain.home[3]", "-3 .. -1.5 rad"),
        ("chain.origins.2.xyz", [0.0, 0.0, 4.0], "reach", "at least a quarter"),
    ],
)
def test_what_is_wrong_with_a_chain_of_transforms_is_named(field: str, value: object, named: str, allowed: str) -> None:
    found = problems(broken(field, value, TRANSFORMS))
    assert any(where.startswith(named) and allowed in said for where, _, said in found), found


def test_denavit_hartenberg_says_the_flange_itself() -> None:
    found = problems(broken("chain.flange", {"xyz": [0.0, 0.0, 0.1]}))
    assert [where for where, _, _ in found] == ["chain.flange"]


def test_a_joint_may_turn_further_to_one_side() -> None:
    sided = broken("limits.position.3", [-3.0, -0.1], TRANSFORMS)
    assert problems(sided) == []
    assert sided.limits.ends[2:4] == [(-2.9670597, 2.9670597), (-3.0, -0.1)]


@pytest.mark.parametrize(
    "field",
    [
        *(f"chain.{name}" for name in ("a", "d", "alpha", "home")),
        *(f"masses.{name}" for name in ("mass", "com")),
        "inertias.tensor",
        *(f"limits.{name}" for name in ("position", "speed", "acceleration", "torque")),
        *(f"motors.{name}" for name in ("gear", "torque_constant", "current", "rotor_inertia", "ripple")),
        *(f"transmissions.{name}" for name in ("stiffness", "stiffening", "damping", "hysteresis_stiffness", "hysteresis_yield")),
        *(f"frictions.{name}" for name in ("torque", "breakaway", "load", "presliding")),
        *(f"thermals.{name}" for name in ("capacity", "resistance")),
        *(f"outline.{name}" for name in ("seam", "housing_radius", "tube_offset", "tube_radius")),
    ],
)
def test_every_list_has_one_value_a_joint(field: str) -> None:
    group, name = field.split(".")
    short = getattr(getattr(GOOD, group), name)[:-1]
    assert (field, short, "expected a list of 6, one a joint") in problems(broken(field, short))


@pytest.mark.parametrize(
    ("field", "value", "named", "allowed"),
    [
        ("masses.com.2", [0.0, 1.0], "masses.com[2]", "a list of 3"),
        ("inertias.tensor.1", [1.0, 1.0, 1.0], "inertias.tensor[1]", "a list of 6"),
        ("frictions.torque.4", [1.0, 2.0], "frictions.torque[4]", "a list of 4"),
        ("shapes.3.start", [0.0], "shapes[3].start", "a list of 3"),
        ("chain.a.1", -4.25, "reach", "5.137 m, and at least a quarter"),
        ("reach", 8.5, "reach", "at most the chain's length end to end, 1.312 m"),
        ("chain.elbow", 6, "chain.elbow", "0 to 5"),
        ("chain.elbow", -1, "chain.elbow", "0 to 5"),
        ("chain.home.1", 6.5, "chain.home[1]", "6.28319"),
        ("chain.joints.3", "elbow", "chain.joints[3]", "differ"),
        ("chain.joints.3", "flange", "chain.joints[3]", "not foot, flange or tool"),
        ("inertias.tensor.0", [1.0, 1.0, -1.0, 0.0, 0.0, 0.0], "inertias.tensor[0]", "> 0"),
        ("inertias.tensor.0", [1.0, 1.0, 2.1, 0.0, 0.0, 0.0], "inertias.tensor[0]", "sum of the others"),
        ("inertias.tensor.0", [1.0, 1.0, 1.0, 1.1, 0.0, 0.0], "inertias.tensor[0]", "> 0"),
        ("frictions.speed", [0.01, 0.5, 0.5, 3.2], "frictions.speed", "rising"),
        ("frictions.torque.0", [5.0, 9.0, 8.9, 12.0], "frictions.torque[0]", "do not fall"),
        ("frictions.breakaway.5", 1.0, "frictions.breakaway[5]", "0.9 times 1.26"),
        ("transmissions.hysteresis_yield.0", 0.0, "transmissions.hysteresis_yield[0]", "> 0"),
        ("motors.current.2", 10.0, "motors.current[2]", "150 N·m"),
        ("sensors.current.range", 10.0, "sensors.current.range", "19.2 A"),
        ("sensors.force_torque.drift.force", 99.5, "sensors.force_torque.drift.force", "below the sensor's range, 100"),
        (
            "sensors.force_torque.drift.walk_torque",
            7.0,
            "sensors.force_torque.drift.torque",
            "3 times walk_torque to stay below the sensor's range, 20",
        ),
        ("sensors.force_torque.drift.assumed", ["x"], "sensors.force_torque.drift.assumed[0]", "warm_up"),
        ("shapes.0.link", 6, "shapes[0].link", "-1 to 5"),
        ("motors.assumed", ["geer"], "motors.assumed[0]", "gear"),
        ("sensors.gyro.assumed", ["x"], "sensors.gyro.assumed[0]", "quantum"),
    ],
)
def test_what_is_wrong_is_named(field: str, value: object, named: str, allowed: str) -> None:
    found = problems(broken(field, value))
    assert named in [name for name, _, _ in found]
    assert any(allowed in text for name, _, text in found if name == named)


def test_an_arm_without_drift_has_no_problems() -> None:
    assert problems(broken("sensors.force_torque.drift", None)) == []
    assert problems(broken("sensors.force_torque", None)) == []
