"""What a tick's decision tells: put together from the parts, and the last one again while nothing is different."""

from pendant.axis_locks import axis_locks
from pendant.contact import Contact
from pendant.decision import Decision
from pendant.events import Event
from pendant.haptics import Shake
from pendant.modes import Law, Mode, Phase
from pendant.program import ProgramState
from pendant.reduced import SpeedLimits
from pendant.robot import Robot
from pendant.settings import Settings, limits_checksum
from pendant.tooling import Tooling


class Publisher:
    """Makes decisions of what is known after everything that happens in a tick. It decides nothing itself."""

    __slots__ = ("_checksum", "_decision", "_key", "_locks", "_robot", "_settings", "_tooling")

    def __init__(self, robot: Robot, tooling: Tooling, settings: Settings) -> None:
        self._robot, self._tooling = robot, tooling
        self._key: tuple[object, ...] = ()
        self._decision: Decision | None = None  # the last one, if the next may be the same
        self.refresh(settings)

    def refresh(self, settings: Settings) -> None:
        """The settings are new."""
        self._settings = settings
        self._checksum = limits_checksum(settings)
        self._locks = axis_locks(settings.axes)

    def step(
        self,
        law: Law,
        events: list[Event],
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
        robot, tooling, use = self._robot, self._tooling, self._settings
        free, sequencer = robot.free, robot.sequencer
        locks = self._locks if robot.mode is Mode.FREE_DRIVE else None
        periods = free.periods() if not free.idle and use.free_drive.remainders else ()
        trying = free.phase is Phase.SEQUENCE
        helping = free.helping and free.balance is None and not (trying and not use.sequence.amplified)
        gain = use.free_drive.gain if helping else 0.0
        walls = () if free.phase is Phase.OFF else free.walls()
        key: tuple[object, ...] = ()
        if not (events or periods or walls):
            state = (robot.mode, robot.safety, free.phase, law, free.helping, robot.grip, speeds)
            guided = (free.balance, free.damping, free.zones, locks, free.singularity, shake)
            program = (sequencer.move, sequencer.state, sequencer.index, sequencer.tool_on)
            key = (*state, *guided, *program, tooling.fitting, tooling.wizard.progress)
            if self._decision is not None and key == self._key:
                return self._decision
        active = sequencer.state in (ProgramState.RUNNING, ProgramState.PAUSED)
        decision = Decision(
            mode=robot.mode,
            safety=robot.safety,
            phase=free.phase,
            law=law,
            move=sequencer.move,
            gain=gain,
            force_cap=use.free_drive.force_cap,
            baseline=free.baseline,
            periods=periods,
            events=tuple(events),
            program=sequencer.state,
            step=sequencer.index + 1 if active else 0,
            monitored=free.monitored() if trying else (),
            contacts=contacts,
            tool_on=sequencer.tool_on,
            walls=walls,
            grip=robot.grip,
            speed_limits=speeds,
            damping=free.damping,
            zones=free.zones,
            balance=free.balance,
            fitting=tooling.fitting,
            wizard=tooling.wizard.progress,
            locks=locks,
            singularity=free.singularity,
            shake=shake,
            limits=self._checksum,
        )
        self._key = key
        self._decision = decision if key else None
        return decision
