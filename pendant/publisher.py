"""What a tick's decision tells: put together from the parts in every tick, so that nothing in it can be from an older one."""

from pendant.all_settings import Settings, safety_checksum
from pendant.contact.contact_change import Contact
from pendant.decision import Decision, EstimatorCommand
from pendant.events.event import Event, Kind
from pendant.guided.bias_follower import SURE
from pendant.haptics import Shake
from pendant.limits.axis_locks import AxisLocks, axis_locks, locks_of, with_joints
from pendant.motion.scripting import Scripting
from pendant.program.steps import ProgramState
from pendant.robot.robot_mode import Robot
from pendant.safety.robot_limits import JointRange, SpeedLimits
from pendant.sensor.taring import Taring
from pendant.tick.modes import Law, Mode, Phase
from pendant.tooling.tool_in_use import Tooling
from pendant.walls.containment import Containment


class Publisher:
    """Makes decisions of what is known after everything that happens in a tick. It decides nothing itself.

    `refresh` comes before the first `step`.
    """

    __slots__ = ("_checksum", "_containment", "_locks", "_robot", "_scripting", "_settings", "_signs", "_taring", "_tooling")

    def __init__(self, robot: Robot, tooling: Tooling, taring: Taring, *, scripting: Scripting, containment: Containment) -> None:
        self._robot, self._tooling, self._taring, self._scripting = robot, tooling, taring, scripting
        self._containment = containment
        self._signs = 0

    def refresh(self, settings: Settings) -> None:
        """The settings are new."""
        self._settings = settings
        self._checksum = safety_checksum(settings)
        self._locks = with_joints(axis_locks(settings.axes), settings.joints)

    def step(
        self,
        law: Law,
        events: list[Event],
        *,
        contacts: tuple[Contact, ...],
        looks: bool,
        speeds: SpeedLimits | None,
        joint_range: JointRange | None,
        shake: Shake | None,
    ) -> Decision:
        """The decision of one tick.

        Args:
            law: of this tick.
            events: all that happened in it.
            contacts: changes in contact seen in it.
            looks: for them, as in `EstimatorCommand`.
            speeds: that the robot's limits allow.
            joint_range: that they allow, None for the arm's own.
            shake: haptic feedback.
        """
        robot, tooling, taring, use = self._robot, self._tooling, self._taring, self._settings
        free, sequencer, mode = robot.free, robot.sequencer, robot.mode
        arm, phase, helping = free.arm, free.phase, free.helping
        if events:
            told = sum(event.kind is Kind.PROGRAM_TELLS and event.values["tone"] is True for event in events)
            self._signs += told + (len(contacts) if use.contact.audible else 0)
        locks = self._free_axes() if mode is _FREE_DRIVE else None
        trying = phase is _SEQUENCE
        balance = free.balance if trying else None
        damping, singularity, doubtful = (None, None, False) if arm is None else (arm.damping, arm.singularity, arm.doubtful)
        periods = free.periods() if use.free_drive.remainders and not free.idle else ()
        walls = () if phase is _OFF else free.walls()
        monitored = free.monitored() if trying else ()
        flange_help = helping and balance is None and not (trying and not use.sequence.amplified)
        slack, baseline, freed = SURE if arm is None else arm.slack, free.baseline, law is _FREE
        command = EstimatorCommand(
            tooling.fitting,
            taring.zero,
            baseline if freed else None,
            slack.axis if freed else 0.0,
            law is _FOLLOW,
            looks,
            use.joint_control,
            use.contact,
        )
        active = sequencer.state is _RUNNING or sequencer.state is _PAUSED
        return Decision(
            mode=mode,
            safety=robot.safety,
            phase=phase,
            law=law,
            move=robot.move,
            gain=use.free_drive.gain if flange_help else 0.0,
            flange_help=flange_help,
            force_cap=use.free_drive.force_cap,
            baseline=baseline,
            periods=periods,
            events=tuple(events),
            program=sequencer.state,
            step=sequencer.index + 1 if active else 0,
            monitored=monitored,
            contacts=contacts,
            tool_on=sequencer.tool_on,
            outputs=sequencer.outputs,
            walls=walls,
            grip=robot.grip,
            speed_limits=speeds,
            joint_range=joint_range,
            workspace=self._containment.workspace(use.walls),
            damping=damping,
            zones=free.zones,
            balance=balance,
            wizard=tooling.wizard.progress,
            locks=locks,
            singularity=singularity,
            shake=shake,
            reading_zero=taring.reading_zero,
            zero_due=taring.due,
            slack=slack,
            doubtful=doubtful,
            limits=self._checksum,
            static=robot.static,
            speed=use.program.speed,
            force=self._scripting.force,
            offset=self._scripting.offset,
            signs=self._signs,
            script_done=self._scripting.done,
            pull=free.pull,
            taken=None if arm is None else arm.taken,
            estimator=command,
        )

    def _free_axes(self) -> AxisLocks | None:
        """What free-drive keeps of the tool's pose, as the script says, else as the settings do, and of the joints."""
        guided = self._scripting.guided
        if guided is None or all(guided.axes):
            return self._locks
        return with_joints(locks_of(guided.axes, guided.R_BU, self._settings.axes), self._settings.joints)


_FREE_DRIVE, _SEQUENCE, _OFF = Mode.FREE_DRIVE, Phase.SEQUENCE, Phase.OFF  # looked up in every tick
_FREE, _FOLLOW = Law.FREE, Law.FOLLOW
_RUNNING, _PAUSED = ProgramState.RUNNING, ProgramState.PAUSED
