"""What a tick's decision tells: put together from the parts. Of the last one is kept what is not different."""

from msgspec.structs import replace

from pendant.all_settings import Settings, limits_checksum
from pendant.contact.contact_change import Contact
from pendant.decision import Decision
from pendant.events.event import Event
from pendant.haptics import Shake
from pendant.limits.axis_locks import axis_locks
from pendant.program.steps import ProgramState
from pendant.robot.reduced import SpeedLimits
from pendant.robot.robot_mode import Robot
from pendant.sensor.taring import Taring
from pendant.tick.modes import Law, Mode, Phase
from pendant.tooling.tool_in_use import Tooling


class Publisher:
    """Makes decisions of what is known after everything that happens in a tick. It decides nothing itself."""

    __slots__ = ("_checksum", "_decision", "_key", "_locks", "_passing", "_robot", "_settings", "_taring", "_tooling")

    def __init__(self, robot: Robot, tooling: Tooling, taring: Taring, settings: Settings) -> None:
        self._robot, self._tooling, self._taring = robot, tooling, taring
        self._key: tuple[object, ...] = ()  # what lasts of it
        self._decision: Decision | None = None  # the last one
        self._passing = False  # it tells of what is of its tick alone
        self.refresh(settings)

    def refresh(self, settings: Settings) -> None:
        """The settings are new."""
        self._settings = settings
        self._decision = None
        self._checksum = limits_checksum(settings)
        self._locks = axis_locks(settings.axes)

    def step(
        self,
        law: Law,
        events: list[Event],
        *,
        contacts: tuple[Contact, ...],
        speeds: SpeedLimits | None,
        shake: Shake | None,
    ) -> Decision:
        """The decision of one tick.

        Args:
            law: of this tick.
            events: all that happened in it.
            contacts: changes in contact seen in it.
            speeds: limits of REDUCED.
            shake: haptic feedback.
        """
        robot, tooling, taring, use = self._robot, self._tooling, self._taring, self._settings
        free, sequencer, mode = robot.free, robot.sequencer, robot.mode
        arm, phase, helping = free.arm, free.phase, free.helping
        locks = self._locks if mode is _FREE_DRIVE else None
        trying = phase is _SEQUENCE
        balance = free.balance if trying else None
        damping, singularity, doubtful = (None, None, False) if arm is None else (arm.damping, arm.singularity, arm.doubtful)
        # What lasts, and what is of this tick alone: mostly only the latter is different from what was told last.
        key = (
            mode, robot.safety, phase, law, helping, free.baseline, robot.grip, speeds, balance, damping, free.zones, locks,
            singularity, shake, sequencer.move, sequencer.state, sequencer.index, sequencer.tool_on, tooling.fitting,
            tooling.wizard.progress, taring.zero, taring.due, doubtful,
        )  # fmt: skip
        periods = free.periods() if use.free_drive.remainders and not free.idle else ()
        walls = () if phase is _OFF else free.walls()
        monitored = free.monitored() if trying else ()
        passing = bool(events or periods or walls or monitored or contacts)
        last = self._decision
        if last is not None and key == self._key:
            if passing or self._passing:
                now, self._passing = tuple(events), passing
                last = replace(last, events=now, periods=periods, walls=walls, monitored=monitored, contacts=contacts)
                self._decision = last
            return last
        amplified = helping and balance is None and not (trying and not use.sequence.amplified)
        active = sequencer.state in (ProgramState.RUNNING, ProgramState.PAUSED)
        self._key, self._passing = key, passing
        self._decision = Decision(
            mode=mode,
            safety=robot.safety,
            phase=phase,
            law=law,
            move=sequencer.move,
            gain=use.free_drive.gain if amplified else 0.0,
            force_cap=use.free_drive.force_cap,
            baseline=free.baseline,
            periods=periods,
            events=tuple(events),
            program=sequencer.state,
            step=sequencer.index + 1 if active else 0,
            monitored=monitored,
            contacts=contacts,
            tool_on=sequencer.tool_on,
            walls=walls,
            grip=robot.grip,
            speed_limits=speeds,
            damping=damping,
            zones=free.zones,
            balance=balance,
            fitting=tooling.fitting,
            wizard=tooling.wizard.progress,
            locks=locks,
            singularity=singularity,
            shake=shake,
            zero=taring.zero,
            zero_due=taring.due,
            doubtful=doubtful,
            limits=self._checksum,
        )
        return self._decision


_FREE_DRIVE, _SEQUENCE, _OFF = Mode.FREE_DRIVE, Phase.SEQUENCE, Phase.OFF  # looked up in every tick
