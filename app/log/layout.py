"""The packed messages of a tick: which numbers, in which order, under which names. One place for writer, reader and schema.

They are CDR, the binary form of ROS 2 messages: fixed arrays of numbers without padding, which numpy lays out for many ticks
at once. Frames, units and signs as in docs/reference/conventions.md.
"""

from typing import NamedTuple

import numpy as np

from pendant.limits.parameters import PARAMETERS
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode, Phase, Safety

JOINTS = 0
"""Size of a field with a number for each joint."""


class Field(NamedTuple):
    """Numbers of a message under one name."""

    name: str
    size: int  # JOINTS, 1, or a fixed number
    text: str


STATE = (
    Field("q", JOINTS, "output angle [rad]"),
    Field("qd", JOINTS, "output speed [rad/s]"),
    Field("qdd", JOINTS, "output acceleration [rad/s2]"),
    Field("theta", JOINTS, "motor angle referred to the output [rad]"),
    Field("theta_d", JOINTS, "motor speed referred to the output [rad/s]"),
    Field("tau_m", JOINTS, "motor torque referred to the output [N m]"),
    Field("tau_J", JOINTS, "transmission torque [N m]"),
    Field("tau_ext", JOINTS, "external torque [N m]"),
    Field("friction", JOINTS, "friction of both sides, as estimated [N m]"),
    Field("w_sensor", 6, "wrench of the flange on what it carries, in F [N, N m]"),
    Field("F_user", 6, "the user's wrench on the flange, axes of B [N, N m]"),
    Field("a_F", 3, "specific force at the flange, in F [m/s2]"),
    Field("p_BF", 3, "flange position in B [m]"),
    Field("v_F", 6, "flange velocity, axes of B [m/s, rad/s]"),
    Field("v_tcp", 1, "speed of the tool centre point [m/s]"),
    Field("v_elbow", 1, "speed of the elbow [m/s]"),
    Field("gain", 1, "factor on the user's force"),
    Field("configured_mass", 1, "payload that the controller believes in [kg]"),
    Field("felt", 1, "a hand on the free arm: 0 none, 1 at the flange, 2 on a link; NaN while it is not free"),
    Field("lost_odds", 1, "log of the odds that the payload changed, NaN while nothing is compared"),
    Field("lost_share", 1, "of the payload that is gone then, below 0 what has come"),
    Field("step_odds", 1, "log of the odds that the flange sensor stepped, NaN while nothing is compared"),
    Field("link_force", 1, "least force on a link that explains what the joints feel [N]"),
    *(Field(f"monitored_{name}", 1, f"{row.text} [{row.unit}], NaN while not checked") for name, row in PARAMETERS.items()),
    *(Field(f"limit_{name}", 1, f"limit of {row.text} [{row.unit}], NaN while not checked") for name, row in PARAMETERS.items()),
)
"""/state: what the controller knows and decides."""

TRUTH = (
    Field("q", JOINTS, "true output angle [rad]"),
    Field("qd", JOINTS, "true output speed [rad/s]"),
    Field("theta", JOINTS, "true motor angle referred to the output [rad]"),
    Field("tau_J", JOINTS, "true transmission torque [N m]"),
    Field("friction", JOINTS, "true friction of both sides [N m]"),
    Field("temperature", JOINTS, "true temperature of the joints [degC]"),
    Field("flange", 7, "pose of the flange in W: position [m], quaternion wxyz"),
    Field("touch_force", 3, "sum of all hands' forces, in W [N]"),
    Field("payload_mass", 1, "mass of what is attached [kg]"),
    Field("touched", 1, "1 while a hand or an object touches the arm or what it carries, else 0"),
    Field("contact_tool", 1, "true force of hands and objects on tool and payload [N]"),
    Field("contact_link", 1, "the largest of those on a link [N]"),
)
"""/truth: what the physics knows and the controller does not."""

PULL = ("felt", "lost_odds", "lost_share", "step_odds")
"""What pulls at the free arm, in /state."""

LATER = frozenset(
    {"touched", "contact_tool", "contact_link", "link_force", "monitored_motor_current", "limit_motor_current", *PULL}
)
"""What recordings lack that were made before it came; it is not a number in each tick of them."""

CODES = ("mode", "safety", "phase", "program", "step", "valid")
"""/state also has these, a byte each; `valid` has a bit for joints, wrench and acceleration."""

WORDS: dict[str, tuple[str, ...]] = {
    "mode": tuple(mode.value for mode in Mode),
    "safety": tuple(safety.name for safety in Safety),
    "phase": tuple(phase.value for phase in Phase),
    "program": tuple(state.value for state in ProgramState),
}
"""What the codes 0, 1, 2, ... mean."""

CDR = 0x00000100
"""Start of every message, read as a little-endian number: plain CDR, little-endian."""


def width(fields: tuple[Field, ...], n: int) -> int:
    """Numbers in a message for an arm of n joints."""
    return sum(field.size or n for field in fields)


def record(numbers: int, codes: int) -> np.dtype:
    """A whole MCAP message record: opcode to data, with `numbers` doubles and `codes` bytes after the tick."""
    head = [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8")]
    data = [("publish_time", "<u8"), ("cdr", "<u4"), ("tick", "<u8"), ("numbers", "<f8", (numbers,)), ("codes", "u1", (codes,))]
    return np.dtype([*head, *data])


def schema(fields: tuple[Field, ...], n: int, codes: tuple[str, ...] = ()) -> str:
    """The message as a ROS 2 definition, whose names are in lower case."""
    lines = ["uint64 tick"]
    for field in fields:
        size = field.size or n
        lines.append(f"float64{'' if size == 1 else f'[{size}]'} {field.name.lower()}  # {field.text}")
    for code in codes:
        for number, word in enumerate(WORDS.get(code, ())):
            lines.append(f"uint8 {code.upper()}_{word.upper()}={number}")
        lines.append(f"uint8 {code}")
    return "\n".join(lines) + "\n"
