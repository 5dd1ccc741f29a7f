"""A log held against the controller: torques, friction as it is learned, external torques, contacts."""

from collections.abc import Callable
from dataclasses import dataclass, field

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.real_logs.joint_log import JointLog
from app.real_logs.log_controller import Estimates, LogController, LogNotice
from app.real_logs.log_mending import MOVES
from app.real_logs.log_ticks import SHORT, bandwidth, in_ticks, rows_are_ticks
from app.real_logs.torque_residuals import LEARNED, Residuals
from app.session.timeline_checks import Prepared
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm

Array = NDArray[np.float64]

STARTS = {"half": 0.5, "double": 2.0}
"""Friction that the learner is started from as well, over that of the arm's file."""
WATCHED = 60.0
"""Motion over which these are watched [s]: twice that in which they are to be there."""
ROWS = 20_000
"""Of the table, at most: a longer log is thinned."""

Progress = Callable[[int, int], None]


@dataclass(slots=True)
class Against:
    """What became of it, n joints."""

    name: str
    arm: Arm
    seconds: float
    rate: float
    said: list[str]  # what was mended of the log, what it lacks and what that does, a sentence each
    residuals: Residuals
    started: dict[str, Residuals]  # of `STARTS`, over the first `WATCHED` seconds of motion
    told: list[LogNotice] = field(default_factory=list)
    rows: list[Array] = field(default_factory=list)  # of `table`
    drifts: list[Array] = field(default_factory=list)  # of `drift`
    external: Array = field(default_factory=lambda: np.zeros(0))  # (n,) root mean square [N·m]
    largest: Array = field(default_factory=lambda: np.zeros(0))  # (n,) [N·m]
    force: tuple[float, float] | None = None  # on the flange, root mean square and largest [N]

    @property
    def table(self) -> Array:
        """(k, 1 + 5 n + 3): time [s], then for each joint angle [rad], measured, predicted, predicted with fixed friction and
        external torque [N·m], then the force on the flange in B [N]."""
        return np.concatenate(self.rows)

    @property
    def drift(self) -> Array:
        """(k, n): by how much the model's arm is beside the measured one at the times of `table` [rad]; see `ModelDrift`."""
        return np.concatenate(self.drifts)


def hold_against(log: JointLog, prepared: Prepared, advance: Progress) -> Against:
    """Run the controller's estimators and detectors over a log.

    Args:
        log: of the arm.
        prepared: arm, tool, payload, mounting, settings that the controller believes in.
        advance: is told how many ticks are done, of how many.

    Raises:
        BadInput: gaps leave nothing of it.
    """
    arm, two = prepared.arm, log.theta is not None
    controller = LogController(prepared, two_angles=two)
    starts = STARTS if np.ptp(log.q, axis=0).max() > MOVES else {}
    others = {name: LogController(_rubs(prepared, factor), two_angles=two, looks=False) for name, factor in starts.items()}
    found = Against(
        log.name,
        arm,
        log.seconds,
        log.rate,
        [*log.told, *lacks(log)],
        Residuals(arm),
        {name: Residuals(arm) for name in starts},
    )
    every, ticks = max(1, -(-round(log.seconds / TICK) // ROWS)), round(log.seconds / TICK)
    done, squares, forces, sensed = 0, np.zeros(arm.n), 0.0, 0
    found.largest = np.zeros(arm.n)
    drift = controller.drift()
    for block in in_ticks(log, arm):
        part = slice(block.run_in, None)
        t, q, temperature = block.t[part], block.q[part], block.temperature[part]
        out, told = controller.follow(block)
        out = Estimates(*(each[part] for each in out))
        fixed = found.residuals.add(t, temperature, out)
        for name, other in others.items():
            watched = found.started[name]
            if watched.moved < WATCHED:
                watched.add(t, temperature, Estimates(*(each[part] for each in other.follow(block)[0])))
        found.told += told
        chosen = slice((-done) % every, None, every)
        if block.run_in:
            drift.begin()
        apart = drift.add(out.left, out.driven, out.speed, holds=controller.breakaway)
        # Taken before they are put together: a part of a block would keep all of it, half a gigabyte of an hour.
        found.rows.append(_rows(t[chosen], q[chosen], Estimates(*(each[chosen] for each in out)), fixed[chosen]))
        found.drifts.append(drift.angles(q[chosen], apart[chosen]))
        squares += (out.felt**2).sum(axis=0)
        found.largest = np.maximum(found.largest, np.abs(out.felt).max(axis=0))
        size = np.linalg.norm(out.force[:, :3], axis=1)
        known = np.isfinite(size)
        if known.any():
            forces, sensed = forces + float((size[known] ** 2).sum()), sensed + int(known.sum())
            most = 0.0 if found.force is None else found.force[1]
            found.force = 0.0, max(most, float(size[known].max()))
        done += len(t)
        advance(done, ticks)
    if not done:
        raise BadInput(log.name, "", ABSENT, f"has no stretch of {SHORT * TICK:g} s without a gap")
    found.external = np.sqrt(squares / done)
    if found.force is not None:
        found.force = float(np.sqrt(forces / sensed)), found.force[1]
    return found


def _rows(t: Array, q: Array, out: Estimates, fixed: Array) -> Array:
    driven = out.rotor + out.rigid
    return np.column_stack([t, q, out.tau_m, driven + out.friction, driven + fixed, out.felt, out.force[:, :3]])


def _rubs(prepared: Prepared, factor: float) -> Prepared:
    """The same with an arm whose file has another friction."""
    filed = prepared.arm.frictions
    curves = [[factor * each for each in row] for row in filed.torque]
    frictions = msgspec.structs.replace(filed, torque=curves, load=[factor * each for each in filed.load])
    return prepared._replace(arm=msgspec.structs.replace(prepared.arm, frictions=frictions))


def lacks(log: JointLog) -> list[str]:
    """What a log does not have, with what that does to the figures, a sentence each."""
    said = list[str]()
    if not rows_are_ticks(log):
        said.append(
            f"it has {log.rate:.0f} rows a second, the controller 500: motion above {bandwidth(log):.0f} Hz is not in it, so "
            f"accelerations are smooth, and a contact is told up to {1e3 / log.rate:.0f} ms late"
        )
    if log.theta is None:
        said.append(
            "it has one encoder a joint: the torque behind a gear is that of the motor less friction, so external torques are "
            "good to the friction's error, and at rest to the whole stiction; nothing is learned of gears"
        )
    if log.wrench is None:
        said.append(
            "it has no force at the flange: no force on the tool is told, contacts are told by the joints alone, and an error of "
            "the payload counts as one"
        )
    said.append("it has no accelerometer at the flange: the detectors of the tool do not run, those of the links do")
    if log.temperature is None:
        said.append("it has no temperatures: friction is that of the arm's file, and its change with warmth is learned")
    if log.guided is None:
        said.append("it does not tell when a hand led the arm: a pull that seems no contact is learned as friction")
    return said


def after_learning(found: Against, begin: float = LEARNED) -> tuple[Array, dict[str, Array]] | None:
    """What is left after `begin` seconds of motion, until `WATCHED`: as `Residuals.rms`, from the arm's file and from each of
    `STARTS`; None where the log has less motion."""
    if found.residuals.moved <= begin:
        return None
    return found.residuals.rms(begin, WATCHED), {name: each.rms(begin, WATCHED) for name, each in found.started.items()}
