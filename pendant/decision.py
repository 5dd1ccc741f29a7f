"""What the supervisor decides in one tick: the only thing that the control law and every interface read from it."""

import msgspec

from pendant.all_settings import JointControl
from pendant.contact.contact_change import Contact
from pendant.contact.settings import ContactUse
from pendant.events.event import Event
from pendant.freedrive.adaptive_gravity import Balance
from pendant.freedrive.periods import Remaining
from pendant.guided.bias_follower import SURE, Slack
from pendant.guided.pull import PullCauses
from pendant.guided.user_force import TakenForce
from pendant.haptics import Shake
from pendant.limits.axis_locks import AxisLocks
from pendant.limits.nearness import Nearness
from pendant.limits.parameters import ZEROS
from pendant.limits.soft_limits import Damping
from pendant.motion.script_requests import ForceMode, PathOffset
from pendant.program.steps import Move, ProgramState
from pendant.safety.robot_limits import JointRange, SpeedLimits
from pendant.signals.enabling_device import Grip
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.pose import Wrench
from pendant.tooling.payload_wizard import IDLE, Progress
from pendant.tooling.tool_in_use import Fitting
from pendant.walls.containment import WallState
from pendant.walls.workspace import Workspace


class EstimatorCommand(msgspec.Struct, frozen=True, gc=False):
    """What the estimator goes by in the next tick."""

    fitting: Fitting | None = None  # tool and payload
    zero: Wrench = ZEROS  # subtracted from the flange sensor's values, axes of F [N, N·m]
    bias: Wrench | None = None  # of these values in free-drive, axes of F [N, N·m]; None: free-drive is off
    unsure: float = 0.0  # standard deviation of each axis of the bias [N]; infinite: the sensor is not used
    planned: bool = False  # planned motion moves the arm: no hand on a link, which no sensor tells
    looks: bool = True  # changes in contact are looked for, or as soon as something asks for them
    use: JointControl = JointControl()  # sources of the torques
    contact: ContactUse = ContactUse()  # sources in which contacts are looked for


class Decision(msgspec.Struct, frozen=True, gc=False):
    """The supervisor's decision for one tick."""

    mode: Mode
    safety: Safety
    phase: Phase
    law: Law
    move: Move | None  # the move to follow, under Law.FOLLOW
    gain: float  # factor on J^T F_user, under Law.FREE; 0 adds nothing of it (FD-3)
    force_cap: float  # largest force of F_user that is amplified [N] (FD-3)
    baseline: tuple[float, ...]  # F_user that is the sensor's bias, axes of F [N, N·m], subtracted under Law.FREE
    periods: tuple[Remaining, ...]
    events: tuple[Event, ...]  # what happened in this tick
    program: ProgramState = ProgramState.NONE
    step: int = 0  # of the program, from 1; 0 unless it is running or paused
    monitored: tuple[Monitored, ...] = ()  # parameters against their limits, while the activation sequence checks them
    contacts: tuple[Contact, ...] = ()  # changes in contact seen in this tick (CD-16)
    flange_help: bool = False  # a hand is helped by what the flange sensor tells, under Law.FREE (FD-3)
    tool_on: bool = False  # what the program switches (CD-15)
    outputs: frozenset[int] = frozenset()  # digital outputs that the program has switched on
    walls: tuple[WallState, ...] = ()  # that hold
    grip: Grip | None = None  # of the enabling device, None where none is used
    speed_limits: SpeedLimits | None = None  # what the control law keeps the arm within by moving it more slowly (RL-4)
    joint_range: JointRange | None = None  # in which motions under Law.FOLLOW keep the joints; None: the arm's own (RL-6)
    workspace: Workspace | None = None  # what every motion under Law.FOLLOW is kept in (VW-9)
    damping: Damping | None = None  # where free motion is resisted before a limit on its speed (FD-12b)
    zones: tuple[float, ...] = ()  # torque on each joint before the end of its range [N·m]; empty where none is resisted (FD-4)
    balance: Balance | None = None  # of an arm that is refused free-drive, under Law.FREE (FD-10)
    locks: AxisLocks | None = None  # what free-drive keeps of the tool's pose and of the joints' angles (FD-4)
    singularity: Nearness | None = None  # in free-drive (FD-4)
    slack: Slack = SURE  # of F_user beyond the baseline, what may be the sensor's drift: it helps nobody, under Law.FREE (FD-19)
    doubtful: bool = False  # it may be that nobody leads the free arm: its friction is not compensated (FD-19)
    shake: Shake | None = None  # of the last joint, under HOLD, BRAKE and FREE: haptic feedback (HF-1)
    wizard: Progress = IDLE  # of the payload
    reading_zero: Wrench = ZEROS  # F_user that counts as none where forces are told or pushed with, axes of F [N, N·m]
    zero_due: bool = False  # the untouched arm feels what may soon refuse free-drive: the sensor should be zeroed
    limits: str = ""  # safety checksum
    static: bool = True  # the arm stands still
    speed: float = 1.0  # share of its own speed at which a planned motion runs, under Law.FOLLOW
    force: ForceMode | None = None  # with which the arm pushes while it moves, under Law.FOLLOW
    offset: PathOffset | None = None  # beside its motion, under Law.FOLLOW
    signs: int = 0  # that were to be heard so far: of steps that tell the user, and of changes in contact (CD-15)
    script_done: int = 0  # number of the last motion of a script that is done
    pull: PullCauses | None = None  # what pulls at the free arm (FD-19); None while free-drive is off
    estimator: EstimatorCommand = EstimatorCommand()
    taken: TakenForce | None = None  # for the user's force (FD-19); None while free-drive is off
