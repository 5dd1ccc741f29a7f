"""What descriptions of arms do not hold, estimated: from each joint's rated torque and the kind of drive.

The rules are lines through what is known of drives, in proportion to a power of the rated torque T [N·m].
`HARMONIC` goes through the two joint sizes of assets/robots/ur5e.yaml (150 and 28 N·m), which says what of it was measured;
`SERVO` through one geared servo of 3 N·m.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import (
    Accuracy,
    Channels,
    Encoders,
    Frictions,
    Motors,
    SensorNumbers,
    Thermals,
    Transmissions,
)

Array = NDArray[np.float64]
Drive = Literal["harmonic", "servo"]

SERVO_BELOW = 15.0
"""Largest rated torque of an arm that is taken for one of geared servos [N·m]; the smallest cobots have 30 and more."""

LOADED = 2.0 / 3.0
"""Share of the rated torque that own weight and payload together take at most in any posture; of shipped arms 0.6 to 0.7."""

CURRENT_RESERVE = 1.3
"""Largest current over that of the rated torque, so that friction is overcome at full load: as in assets/robots/ur5e.yaml."""

STIFFENED = 0.15
"""By how much the secant stiffness at rated torque is above that at rest: as in assets/robots/ur5e.yaml."""

SPEEDS = [0.01, 0.5, 1.5, 3.2]
"""Where the friction curve has its points [rad/s]: as in assets/robots/ur5e.yaml."""


class PowerLaw(NamedTuple):
    """value = at · (T / of)^exponent."""

    at: float
    of: float  # [N·m]
    exponent: float = 1.0

    def __call__(self, torque: Array) -> list[float]:
        """The value of each joint; torque (n,) [N·m]."""
        return _rounded(self.at * (torque / self.of) ** self.exponent)

    def __str__(self) -> str:
        power = "" if self.exponent == 1.0 else f"^{self.exponent:g}"
        return f"{self.at:g}·(T/{self.of:g} N·m){power}"


@dataclass(frozen=True, slots=True)
class DriveRules:
    """The numbers of one kind of drive."""

    title: str
    gear: float
    torque_constant: PowerLaw  # motor side [N·m/A]
    rotor_inertia: PowerLaw  # at the output [kg·m²]
    ripple: PowerLaw  # [N·m]
    stiffness: PowerLaw  # [N·m/rad]
    damping: float  # share of critical, of the rotor on its spring
    hysteresis: float  # stiffness of the stick-slip element over that of the transmission
    yield_share: float  # of the rated torque at which that element slips
    breakaway: PowerLaw  # [N·m]
    curve: tuple[float, ...]  # friction at `SPEEDS` over the breakaway torque
    load: float  # rise of friction with load [N·m per N·m]
    presliding: float  # deflection of the bristles at breakaway [rad]
    capacity: PowerLaw  # of heat [J/K]
    time_constant: float  # of warming up [s]
    speed: float  # where the file has none [rad/s]
    acceleration: PowerLaw  # [rad/s²]
    motor_counts: int  # a turn of the motor
    output_counts: int  # a turn of the output
    encoder_ripple: float  # [rad]
    current_step: float  # quantum of the current sensor, share of its range
    accuracy: tuple[float, float, float, float, float]  # motor constant, stiffness, rotor inertia, link mass, link centre [m]


HARMONIC = DriveRules(
    title="harmonic drives with motor and output encoder",
    gear=101.0,
    torque_constant=PowerLaw(0.1, 150.0, 0.13),
    rotor_inertia=PowerLaw(0.6, 150.0),
    ripple=PowerLaw(0.3, 150.0),
    stiffness=PowerLaw(20000.0, 150.0, 0.83),
    damping=0.035,
    hysteresis=0.1,
    yield_share=0.01,
    breakaway=PowerLaw(5.8, 150.0, 0.89),
    curve=(1.0, 1.7, 2.5, 3.3),
    load=0.025,
    presliding=2e-4,
    capacity=PowerLaw(2600.0, 150.0, 0.63),
    time_constant=1800.0,
    speed=3.14,
    acceleration=PowerLaw(14.0, 150.0, -0.21),
    motor_counts=65536,
    output_counts=524288,
    encoder_ripple=1e-4,
    current_step=1.0 / 8192.0,
    accuracy=(0.03, 0.20, 0.10, 0.02, 0.003),
)

SERVO = DriveRules(
    title="servos with spur gears and an encoder of 12 bits",
    gear=345.0,
    torque_constant=PowerLaw(0.005, 3.0, 0.13),
    rotor_inertia=PowerLaw(0.03, 3.0),
    ripple=PowerLaw(0.006, 3.0),
    stiffness=PowerLaw(150.0, 3.0, 0.83),
    damping=0.1,
    hysteresis=0.1,
    yield_share=0.01,
    breakaway=PowerLaw(0.12, 3.0, 0.89),
    curve=(1.0, 1.5, 2.1, 2.7),
    load=0.1,
    presliding=2e-3,
    capacity=PowerLaw(35.0, 3.0, 0.63),
    time_constant=600.0,
    speed=4.0,
    acceleration=PowerLaw(20.0, 3.0, -0.21),
    motor_counts=4096,
    output_counts=4096,
    encoder_ripple=1e-3,
    current_step=1.0 / 512.0,
    accuracy=(0.10, 0.30, 0.20, 0.03, 0.003),
)

DRIVES: dict[Drive, DriveRules] = {"harmonic": HARMONIC, "servo": SERVO}


def drive_of(torques: Sequence[float]) -> Drive:
    """The kind of drive that an arm of these rated torques [N·m] usually has."""
    return "servo" if max(torques) < SERVO_BELOW else "harmonic"


class RuleEstimates(NamedTuple):
    """Groups of an arm file, all assumed."""

    motors: Motors
    transmissions: Transmissions
    frictions: Frictions
    thermals: Thermals
    sensors: SensorNumbers
    accuracy: Accuracy


def estimates(torques: Sequence[float], rotors: Sequence[float | None], drive: Drive) -> RuleEstimates:
    """What the rules make of an arm.

    Args:
        torques: rated, of each joint [N·m].
        rotors: inertia at the output as the description has it [kg·m²]; None: the rule.
        drive: kind of all joints.
    """
    rules, T = DRIVES[drive], np.array(torques, dtype=float)
    n, all_of = len(T), f"By the rules of import for {rules.title}, T being a joint's rated torque"
    constant = rules.torque_constant(T)
    current = _rounded(CURRENT_RESERVE * T / (rules.gear * np.array(constant)))
    by_rule = rules.rotor_inertia(T)
    rotor = [max(own if own is not None else rule, 1e-4) for own, rule in zip(rotors, by_rule, strict=True)]
    stiffness = np.array(rules.stiffness(T))
    breakaway = np.array(rules.breakaway(T))
    capacity = np.array(rules.capacity(T))
    largest = 1.3 * max(current)
    motor_error, stiffness_error, rotor_error, mass_error, centre_error = rules.accuracy
    return RuleEstimates(
        Motors(
            status="assumed",
            source=f"{all_of}: gear {rules.gear:g}; torque constant {rules.torque_constant} N·m/A; "
            f"current for {CURRENT_RESERVE:g} T; "
            f"rotor inertia {rules.rotor_inertia} kg·m² where the description has no armature; ripple {rules.ripple} N·m.",
            gear=[rules.gear] * n,
            torque_constant=constant,
            current=current,
            rotor_inertia=rotor,
            ripple=rules.ripple(T),
        ),
        Transmissions(
            status="assumed",
            source=f"{all_of}: stiffness {rules.stiffness} N·m/rad; at T its secant is {STIFFENED:.0%} above; "
            f"damping {rules.damping:g} of critical; "
            f"hysteresis of {rules.hysteresis:g} of the stiffness, slipping at {rules.yield_share:g} T.",
            stiffness=stiffness.tolist(),
            stiffening=_rounded(STIFFENED * stiffness * ((1.0 + STIFFENED) * stiffness / T) ** 2),
            damping=_rounded(2.0 * rules.damping * np.sqrt(stiffness * np.array(rotor))),
            hysteresis_stiffness=_rounded(rules.hysteresis * stiffness),
            hysteresis_yield=_rounded(rules.yield_share * T / (rules.hysteresis * stiffness)),
        ),
        Frictions(
            status="assumed",
            source=f"{all_of}: breakaway {rules.breakaway} N·m, then {', '.join(f'{each:g}' for each in rules.curve[1:])} times "
            f"that; {rules.load:g} of the load more; breakaway after {rules.presliding:g} rad; temperature as in ur5e.yaml.",
            speed=SPEEDS,
            torque=[_rounded(np.array(rules.curve) * each) for each in breakaway],
            breakaway=breakaway.tolist(),
            output_share=0.08,
            load=[rules.load] * n,
            temperature=44.0,
            per_kelvin=-0.008,
            presliding=_rounded(breakaway / rules.presliding),
        ),
        Thermals(
            status="assumed",
            source=f"{all_of}: capacity {rules.capacity} J/K; resistance for a time constant of {rules.time_constant:g} s.",
            capacity=capacity.tolist(),
            resistance=_rounded(rules.time_constant / capacity),
            ambient=25.0,
        ),
        SensorNumbers(
            encoders=Encoders(
                status="assumed",
                source=f"By the rules of import for {rules.title}.",
                motor_counts=rules.motor_counts,
                output_counts=rules.output_counts,
                ripple=rules.encoder_ripple,
                noise_counts=0.5,
            ),
            current=Channels(
                status="assumed",
                source="A range that holds the largest joint.",
                range=largest,
                quantum=largest * rules.current_step,
                noise=4e-4 * largest,
            ),
            temperature=Channels(status="assumed", source="As in ur5e.yaml.", range=150.0, quantum=0.1, noise=0.1),
        ),
        Accuracy(
            status="assumed",
            source=f"By the rules of import for {rules.title}. No sensor at the flange.",
            motor_constant=motor_error,
            stiffness=stiffness_error,
            rotor_inertia=rotor_error,
            link_mass=mass_error,
            link_centre=centre_error,
            force_offset=0.0,
            torque_offset=0.0,
            wrench_gain=0.0,
            wrench_cross_talk=0.0,
        ),
    )


MEASURE_FIRST = {
    "payload": "how heavy a tool or load may be, and how firm a push is taken for one",
    "limits.torque": "what the arm can hold and how hard it accelerates; every rule below is scaled from it",
    "limits.speed": "how fast programs and hands may move a joint",
    "limits.position": "where a joint's range ends",
    "frictions.breakaway": "the force that a hand must have in free-drive, and the smallest contact that is seen without sensors",
    "frictions.torque": "how heavy a moving arm feels, and false contacts in motion",
    "motors.torque_constant": "what the current tells of forces: its error looks like payload",
    "motors.rotor_inertia": "how heavy the arm feels when it is accelerated by hand, and false contacts in fast motion",
    "accuracy": "the wrong payload that is refused, and the contact that is seen: what may be an error is held against nobody",
    "sensors": "a sensor at the flange or in the joints refuses smaller errors and sees lighter contacts",
    "transmissions.stiffness": "how far the flange gives way under a push, and vibration after stops",
    "motors.gear": "the current behind each torque, ripple and the encoder's resolution",
    "limits.acceleration": "how soon a program's motion is at its speed",
    "thermals.capacity": "how fast friction falls while the arm works",
}
"""What an assumed field does, in the order in which it is worth measuring."""


def _rounded(values: Array | Sequence[float]) -> list[float]:
    """Four digits: more than any rule knows."""
    return [float(f"{value:.4g}") for value in np.asarray(values, dtype=float)]
