"""Moving through a recording: a place in time that can run, and the snapshot that belongs to it. No physics."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np

from app.files.checked import ABSENT, BadInput
from app.log.layout import PULL, WORDS
from app.log.recorded_messages import PendantMessage
from app.log_reading.reader import Log
from pendant.decision import Decision
from pendant.freedrive.periods import Remaining
from pendant.guided.pull import NOT_TOLD, HandFelt, PullCauses
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, TICK_RATE, Law, Mode, Phase, Safety
from sim.exchange.snapshot import Snapshot
from sim.exchange.told_force import UncertainForce
from sim.gripping.finger_drive import GripperState


@dataclass(slots=True)
class Playback(ABC):
    """A place in time, from 0 to `end` [s], that can run."""

    time: float = field(default=0.0, kw_only=True)
    speed: float = field(default=1.0, kw_only=True)
    playing: bool = field(default=False, kw_only=True)

    @property
    @abstractmethod
    def end(self) -> float:
        """The last time."""

    def advance(self, seconds: float) -> None:
        """Let `seconds` of the clock pass; at the end it pauses."""
        if self.playing:
            self.jump(self.time + self.speed * seconds)
            self.playing = self.time < self.end

    def jump(self, time: float) -> None:
        """Go to a time, or to the nearest there is."""
        self.time = min(max(time, 0.0), self.end)


@dataclass(slots=True)
class Player(Playback):
    """Where in a recording we are. Times from the start of the run.

    Raises:
        BadInput: the log has no picture to show.
    """

    log: Log

    def __post_init__(self) -> None:
        """Check that there is something to play."""
        if not len(self.log.picture_ticks) or not len(self.log):
            raise BadInput(self.log.path.name, "", ABSENT, "holds no tick to show")

    @property
    def end(self) -> float:
        """The last time."""
        return self.log.last_tick * TICK

    @property
    def row(self) -> int:
        """The tick that is shown, as row of the log's arrays."""
        return min(self.log.row_of(round(self.time * TICK_RATE)), len(self.log) - 1)

    @property
    def picture(self) -> int:
        """The picture that is shown: the last one that is not after the time."""
        tick = round(self.time * TICK_RATE)
        return max(int(np.searchsorted(self.log.picture_ticks, tick, side="right")) - 1, 0)


def pull_of(state: Mapping[str, Any]) -> PullCauses | None:
    """What pulled at the free arm, of a row of /state; None: it was not free, or the recording is from before this came."""
    felt, lost, share, stepped = (float(state[name]) for name in PULL)
    if math.isnan(felt):
        return None
    told = [NOT_TOLD if math.isnan(odds) else odds for odds in (lost, stepped)]
    return PullCauses(HandFelt(int(felt)), told[0], 0.0 if math.isnan(share) else share, told[1])


def user_at(said: PendantMessage) -> UncertainForce | None:
    """What free-drive took for the user's force; None where it was not free."""
    user = said.user
    if user is None:
        return None
    (x, y, z), (a, b, c) = user.force, user.at
    return UncertainForce((x, y, z), None if user.covariance is None else np.array(user.covariance), (a, b, c))


def snapshot_at(log: Log, picture: int, row: int) -> Snapshot:
    """What was recorded, as the simulation would show it: poses of a picture, numbers of a tick."""
    said, frames, state, truth = log.pictures[picture], log.frames[picture], log.state.row(row), log.truth.row(row)
    names = ["foot", *log.arm.chain.joints, "flange"]
    payload = frames.get("payload")
    objects = [frames[f"object {thing.name}"] for thing in log.scenario.world]
    touches = tuple((t.part, tuple(t.point), tuple(t.force), tuple(t.torque)) for t in said.touches)
    valid = int(state["valid"])
    pull = pull_of(state)
    decision = Decision(
        mode=Mode(WORDS["mode"][state["mode"]]),
        safety=Safety[WORDS["safety"][state["safety"]]],
        phase=Phase(WORDS["phase"][state["phase"]]),
        law=Law.HOLD,
        move=None,
        gain=float(state["gain"]),
        force_cap=0.0,
        baseline=(0.0,) * 6,
        periods=tuple(Remaining(each.name, each.ticks, each.total) for each in said.periods),
        events=(),
        step=int(state["step"]),
        pull=pull,
    )
    arrays = [state[name] for name in ("q", "qd", "qdd", "theta", "theta_d", "tau_m", "tau_J", "tau_ext")]
    wrenches = [state[name] for name in ("w_sensor", "F_user", "a_F", "p_BF")]
    estimate = Estimate(
        int(state["tick"]),
        bool(valid & 1),
        bool(valid & 2),
        bool(valid & 4),
        *arrays,
        *wrenches,
        R_BF=np.eye(3),  # not recorded: pictures have the flange's pose
        v_F=state["v_F"],
        v_tcp=float(state["v_tcp"]),
        v_elbow=float(state["v_elbow"]),
        friction=state["friction"],
    )
    return Snapshot(
        said.tick,
        decision,
        estimate,
        np.array([frames[name] for name in names]),
        np.array(objects).reshape(-1, 7),
        None if payload is None else np.array(payload),
        float(truth["payload_mass"]),
        float(state["configured_mass"]),
        touches,
        truth_touched=bool(truth["touched"] > 0.0),
        pull=pull,
        user=user_at(said),
        gripper=None if said.gripper is None else GripperState(**msgspec.structs.asdict(said.gripper)),
    )
