"""An arm fitted to logs: which are learned from and which are judged, and what is said of the result."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import msgspec
import numpy as np
import yaml
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.real_logs.joint_log import JointLog, counted
from app.real_logs.torque_residuals import own_terms
from sim.arm.arm_file import Arm
from sim.arm_problems import problems
from sim.identification.arm_fit import ArmFit, fit, told
from sim.identification.fitted_arm import fitted_arm
from sim.identification.motion_samples import KEPT, sampled
from sim.identification.torque_model import LoggedRun, TorqueModel

Array = NDArray[np.float64]

JUDGED_SHARE = 0.2
"""Of the end of each log, which is judged and not learned from where no other log is given for that."""
LEAST_MOTION = 10.0
"""Of a joint, from which on it is fitted and judged [s]."""
LONGEST_NAMES = 600
"""Of the logs in the file, characters; of more of them, their number is said."""
MOST_SAMPLES = 20_000
"""Of all logs together: 13 minutes at 25 a second, and of longer ones fewer a second. It bounds memory to 0.3 GB."""


@dataclass(frozen=True, slots=True)
class Judged:
    """What a log that was not learned from leaves, RMS of each joint while it moves (n,) [N·m]; NaN where it does not."""

    name: str
    measured: Array  # the torque itself
    before: Array  # left by the arm's file
    after: Array  # left by the fit
    best: Array  # left by a least-squares fit of this very log: sign, speed, rigid torque, offset


@dataclass(frozen=True, slots=True)
class Fitted:
    """An arm fitted to logs."""

    arm: Arm
    found: ArmFit
    judged: tuple[Judged, ...]
    told: tuple[str, ...]  # what the logs could not tell, a sentence each


def fit_logs(
    arm: Arm, logs: Sequence[JointLog], judge: Sequence[JointLog], *, loads: dict[str, float | None], name: str
) -> Fitted:
    """Fit an arm to logs of it.

    Args:
        arm: as its file says.
        logs: to learn from.
        judge: to judge with; none: the end of each log is left out for that.
        loads: names of the logs in which the arm carries a load, each with its mass [kg], None where it is unknown; one load.
        name: of the fitted arm.

    Raises:
        BadInput: no joint moves enough, or two masses are given for the one load.
    """
    masses = set(loads.values())
    if len(masses) > 1:
        raise BadInput("--load", "", ABSENT, "expected one load: the same mass in all of its logs")
    mass = next(iter(masses), None)
    kept = min(KEPT, MOST_SAMPLES / sum(log.seconds for log in [*logs, *judge]))
    runs = [_run(arm, log, kept, loaded=log.name in loads) for log in logs]
    tests = [_run(arm, log, kept, loaded=log.name in loads) for log in judge]
    if not tests:
        cut = [_cut(run) for run in runs]
        runs, tests = [head for head, _ in cut], [tail for _, tail in cut]
    moved = np.sum([run.samples.moves.sum(axis=0) for run in runs], axis=0) / kept
    if moved.max() < LEAST_MOTION:
        raise BadInput(logs[0].name, "", ABSENT, f"no joint moves for {LEAST_MOTION:g} s: nothing can be fitted")
    found = fit(TorqueModel(arm), runs, mass)
    names = ", ".join(log.name for log in logs)
    source = f"Fitted by `pendant fit` to {names if len(names) <= LONGEST_NAMES else counted(len(logs), 'log')}"
    source += f" ({sum(log.seconds for log in logs):.0f} s)."
    weighed = mass is not None
    made = fitted_arm(found, name, source, weighed=weighed)
    said = not_told(found, moved < LEAST_MOTION, weighed=weighed, loaded=bool(loads))
    said += [f"{field}: {allowed}" for field, _, allowed in problems(made)]
    least = round(LEAST_MOTION * kept)
    return Fitted(made, found, tuple(_judge(found, test, least) for test in tests), tuple(said))


def _run(arm: Arm, log: JointLog, kept: float, *, loaded: bool) -> LoggedRun:
    torque = log.motor_torque(arm)
    stretches = [(log.t[part], log.q[part], log.qd[part], torque[part]) for part in log.stretches]
    return LoggedRun(log.name, sampled(stretches, arm.frictions.speed, kept), loaded)


def _cut(run: LoggedRun) -> tuple[LoggedRun, LoggedRun]:
    """The beginning and the end of a run."""
    k = round((1.0 - JUDGED_SHARE) * len(run.samples.t))
    head, tail = run.samples[:k], run.samples[k:]
    return replace(run, samples=head), replace(run, name=f"end of {run.name}", samples=tail)


def _judge(found: ArmFit, run: LoggedRun, least: int) -> Judged:
    after, moving = found.left(run)
    before, _ = found.left(run, found.before)
    best = _best(found, run, moving, least)
    rows = (run.samples.torque.T, before, after)
    measured, by_file, by_fit = (np.array([_rms(row[m], least) for row, m in zip(each, moving, strict=True)]) for each in rows)
    return Judged(run.name, measured, by_file, by_fit, best)


def _best(found: ArmFit, run: LoggedRun, moving: NDArray[np.bool_], least: int) -> Array:
    """What a least-squares fit of this very run leaves, of sign, speed, rigid torque and offset (n,)."""
    s, rigid = run.samples, found.model.rigid(run)
    out = np.full(len(rigid), np.nan)
    for i, m in enumerate(moving):
        speed, torque = s.qd[m, i], s.torque[m, i]
        columns = own_terms(speed, rigid[i, m])
        out[i] = _rms(columns @ np.linalg.lstsq(columns, torque, rcond=None)[0] - torque, least)
    return out


def _rms(values: Array, least: int) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) >= least else np.nan


def not_told(found: ArmFit, still: NDArray[np.bool_], *, weighed: bool, loaded: bool) -> list[str]:
    """What the logs could not tell, and what stands in the file for it, a sentence each.

    Args:
        found: the fit.
        still: joints that hardly moved (n,).
        weighed: a load of known mass was carried.
        loaded: a load was carried.
    """
    arm, at, sure = found.model.arm, found.places, told(found)
    names = np.array(arm.chain.joints)
    said = list[str]()
    if still.any():
        said.append(f"{', '.join(names[still])} hardly moved: friction and inertia stay as filed")
    curve = sure[at.friction].reshape(arm.n, at.m)
    for k, speed in enumerate(arm.frictions.speed):
        rest = ~curve[:, k] & ~still
        if rest.any():
            said.append(f"friction of {', '.join(names[rest])} at {speed:g} rad/s: not seen, it follows the rest")
    for part, what, why in (
        (at.rotor, "rotor inertia", "too little acceleration to tell it from the links'"),
        (at.load_friction, "rise of friction with load", "the torque changes too little"),
    ):
        rest = ~sure[part] & ~still
        if rest.any():
            said.append(f"{what} of {', '.join(names[rest])} stays as filed: {why}")
    if not sure[at.constant].all():
        rest = ", ".join(names[~sure[at.constant]])
        said.append(f"torque constant of {rest}: the weight on it changes too little to say more than the other joints do")
    if not weighed:
        said.append("no load of known mass was carried: torque constants stand on the filed masses of the links")
    if not loaded:
        said.append("no load was named (--load LOG=KG, or LOG=?): the flange is taken to be bare")
    if found.held:
        links = ", ".join(names[list(found.held)])
        said.append(f"links behind {links} are held close to the file's, else no body could have their moments")
    return said


def written(fitted: Fitted, path: Path) -> None:
    """Write the arm's file.

    Raises:
        BadInput: it cannot be written.
    """
    text = yaml.safe_dump(
        msgspec.to_builtins(fitted.arm), sort_keys=False, width=120, default_flow_style=None, allow_unicode=True
    )
    head = "# SI units, radians. Written by `pendant fit`. One standard deviation of each number, in the order of the joints:\n"
    try:
        path.write_text(head + "".join(f"# {line}\n" for line in deviations(fitted.found)) + text, "utf-8")
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be written: {error.strerror}") from None


def deviations(found: ArmFit) -> list[str]:
    """Lines with the standard deviations of what is fitted, and the difference of directions, for which a file has no field."""
    at, d, arm = found.places, found.deviation, found.model.arm
    lines = [f"motors.rotor_inertia {_row(d[at.rotor])} kg·m²"]
    lines.append(f"motors.torque_constant {_row(d[at.constant] * np.array(arm.motors.torque_constant))} N·m/A")
    for i, joint in enumerate(arm.chain.joints):
        lines.append(f"frictions.torque of {joint} {_row(d[at.curve(i)])} N·m")
    lines.append(f"frictions.load {_row(d[at.load_friction])} N·m per N·m")
    lines.append(f"more forwards than backwards {_row(found.x[at.offset])}, of {_row(d[at.offset])} N·m")
    return lines


def _row(values: Array) -> str:
    return "[" + ", ".join(f"{value:.2g}" for value in values) + "]"
