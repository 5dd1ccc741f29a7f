"""Every claim and situation that a session must show: the rows of `make claims`. The method is that of the cited documents."""

from typing import NamedTuple


class Claim(NamedTuple):
    """One row: a claim, a situation, or a requirement that stands for the summary."""

    name: str  # as a session's `claims` spells it
    text: str  # what to show
    ids: str  # requirements that do it


_A = (
    ((1, 21), "signal, monitored sequence, entry only within every limit; static under gravity, yields to a push", "FD-2 FD-9"),
    ((2,), "wrong payload or a bump in the sequence: stays in the first mode", "FD-10"),
    ((3, 22), "a signal shorter than the activation period does nothing", "FD-7"),
    ((4, 23), "stays for the free-drive period", "FD-14"),
    ((5, 24), "restart period begins when static", "FD-15"),
    ((6, 25), "left after a static free-drive period, and after a static restart period", "FD-14 FD-15"),
    ((7,), "remainders of all periods are presented", "FD-20"),
    ((8, 26), "deactivation signal", "FD-17"),
    ((9,), "speed, acceleration, torque, motor torque, force, position as parameters", "FD-9"),
    ((19, 31), "angular position, velocity, acceleration of a joint as parameters", "FD-9"),
    ((10,), "two parameters, two limits", "FD-12a"),
    ((11,), "activation limit from a shape around a part", "VW-1 VW-2 VW-6"),
    ((20, 32), "activation limit from a shape that depends on posture", "VW-6 VW-8"),
    ((12,), "feedback to the signal, then a confirmation", "FD-8"),
    ((13,), "the confirmation given at the joints' sensors, with no force/torque sensor", "FD-8 FD-5e"),
    ((14,), "signal given at a joint sensor, no force/torque sensor", "FD-5e FD-5g"),
    ((15, 28), "signal by a force above its threshold", "FD-5c"),
    ((16,), "signal by a force in a direction", "FD-6"),
    ((17,), "signal by force and torque sensor: a twist", "FD-5d"),
    ((29,), "signal by a force at a position on the arm", "FD-6"),
    ((30,), "signal by a force above its threshold with a torque below a limit", "FD-6"),
    ((18,), "the whole arm: joints with output flange, motor, sensors", "AF-1 FD-3"),
    ((27,), "deactivation by an exceeded operation limit", "FD-18"),
)
_B = (
    ((1, 12), "opposite directions, in 3-D", "CD-0"),
    ((2, 18), "force above, acceleration below threshold", "CD-3"),
    ((3, 21), "samples of force and acceleration in buffers", "CD-4"),
    ((4, 22), "a decision from the buffered samples", "CD-6"),
    ((5,), "thresholds from the buffer", "CD-6"),
    ((6,), "thresholds from the payload mass", "CD-11"),
    ((9,), "threshold of the ratio from the payload mass", "CD-5 CD-11"),
    ((7, 19), "differences", "CD-4"),
    ((8, 20), "relationship of values, and of differences", "CD-5"),
    ((10, 15), "pose at contact", "CD-14"),
    ((11, 14), "sensors at the contact part", "CD-2"),
    ((13,), "sensors of force and acceleration at a part of the arm", "CD-2"),
    ((16,), "the arm is controlled by the change in contact", "CD-15"),
    ((17,), "each action on contact", "CD-15"),
)
_C = (
    ((1, 12, 21), "control from friction torque and transmission torque", "AF-2 AF-3 AF-5"),
    ((2,), "each optional input used, by its switch", "AF-5"),
    ((3, 13), "friction from the deflection", "AF-2"),
    ((4, 14), "an encoder on each side of the gear", "AF-1"),
    ((5,), "friction from the two measured angles", "AF-2"),
    ((6,), "transmission torque with the friction estimate", "AF-3"),
    ((7, 16), "desired transmission torque", "AF-4"),
    ((8, 17), "transmission-torque error correction", "AF-5"),
    ((9, 18), "feed-forward", "AF-5"),
    ((10, 19), "each kind of state error correction", "AF-5"),
    ((11,), "resulting torque from each term", "AF-5"),
    ((20,), "resulting torque as a motor current", "AF-6"),
    ((15,), "motor torque sensor", "AF-1"),
)
_SUMMARY = {
    "FD-13": "manipulation by hand is recognised",
    "FD-14": "free-drive period",
    "FD-15": "restart period",
    "FD-16": "restart period asked for",
    "FD-17": "deactivation signal",
    "FD-20": "remainders are published",
    "FD-21": "feedback on the remainder",
    "FD-22": "root cause and guidance",
    "FD-24": "sequence, maintain periods and walls on or off independently",
    "VW-1": "shapes around a part",
    "VW-2": "references of walls",
    "VW-3": "stepwise anchors",
    "VW-4": "anchors at an average",
    "VW-5": "anchors moved by the user",
    "VW-6": "activation and operation shapes",
    "VW-7": "resistance inside a wall",
    "VW-8": "size by posture",
    "HF-1": "patterns of feedback",
}

_EMBODIMENTS = {
    "FD-1 teach first": "activation switches to TEACH first",
    "FD-1 after reset": "from STOP only after a reset",
    "FD-5 presses": "a pattern of the button, or of an input, as the signal",
    "FD-5 posture": "a posture, or a series of postures, as the signal",
    "FD-8 within": "the confirmation is asked for within the activation sequence",
    "FD-8 gesture": "a chosen second gesture, another than the first, some time after it",
    "FD-9 current": "motor current as a parameter",
    "FD-9 motion": "without a force sensor: a wrong payload that moves the arm is refused by its motion alone",
    "FD-9 joints": "without a force sensor the joints tell a payload that nobody told",
    "FD-13 press": "a hand that presses on an arm that cannot move keeps it free",
    "FD-13 touch": "a hand that touches a link of a standing arm, and does not move it, keeps it free",
    "FD-12b vertical": "speed along gravity limited more than across it",
    "FD-19 falls": "a payload that falls off ends free-drive at once",
    "FD-19 joints": "without a force sensor the joints tell that a payload fell",
    "FD-19 led": "without a force sensor the joints tell a hand that leads from an arm that goes on alone",
    "VW-6 inside": "free-drive is kept only while the part is inside the shape, as shipped",
    "VW-6 payload": "without a force sensor: a wrong payload that moves the arm into a wall is refused by it",
    "VW-7 push": "a wall pushes back, the harder the nearer, at rest, too",
    "AF-6 limit": "a current within the motor's limits; what is asked beyond winds nothing up",
    "CD-2 self-contact": "the arm touches itself",
    "CD-4 buffers": "how far back differences of force and of acceleration reach, i and j",
    "CD-8 statistic": "the statistic of the buffered samples",
    "CD-9 older pairs": "the comparison repeated on older pairs of samples",
    "CD-11 operating": "thresholds from commanded acceleration, target force, joint torque, current, mode",
    "CD-15 stop": "stop at once, within a distance, within a time, at a position",
    "CD-15 trigger": "wait for another trigger",
    "CD-15 tell": "a step tells the user; an audible sign of a contact",
}


def _claims() -> list[Claim]:
    numbered = [
        (group, number, Claim(f"{group} {number}", text, ids))
        for group, table in (("A", _A), ("B", _B), ("C", _C))
        for numbers, text, ids in table
        for number in numbers
    ]
    return [claim for _, _, claim in sorted(numbered)]


def _situations() -> list[Claim]:
    """Figures 3a to 3i and 4a to 4i; h and i each with friction falling and rising: twenty-two."""
    rows: list[Claim] = []
    for figure in "34":
        for letter in "abcdefghi":
            free = ", which never reports contact" if letter in "ab" else ""
            for friction in (" falling", " rising") if letter in "hi" else ("",):
                text = f"situation of figure {figure}{letter}" + (f", friction{friction}" if friction else "") + free
                rows.append(Claim(f"B fig {figure}{letter}{friction}", text, "CD-17"))
    return rows


def _embodiments() -> list[Claim]:
    """What the sources name beyond their claims: each by its requirement and a word."""
    return [Claim(name, text, name.partition(" ")[0]) for name, text in _EMBODIMENTS.items()]


CLAIMS: dict[str, Claim] = {
    claim.name: claim
    for claim in [*_claims(), *_situations(), *(Claim(ident, text, ident) for ident, text in _SUMMARY.items()), *_embodiments()]
}
"""All rows by name, in the order of `make claims`: `A 1` .. `A 32`, `B 1` .. `B 22`, `C 1` .. `C 21`, `B fig 3a` ..
`B fig 4i rising`, the requirements that stand for the summary, and embodiments: `FD-8 within`."""
