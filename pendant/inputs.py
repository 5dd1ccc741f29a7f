"""What the user, the inputs and the program ask for in one tick. Web app, session file and test make the same value."""

from dataclasses import dataclass, field

from pendant.equipment.load import Load
from pendant.equipment.tools import Tool
from pendant.motion.script_requests import Scripted
from pendant.program.jog_move import Jogged
from pendant.program.steps import Program
from pendant.tick.words import Word
from pendant.walls.definitions import AnyBorder


class Button(Word):
    """A control of the pendant that is held (FD-23: a keep-alive)."""

    FREE_DRIVE = "free_drive"
    ENABLING = "enabling_device"  # in its middle position
    ENABLING_FULL = "enabling_device_full"  # pressed beyond it


class Command(Word):
    """A control of the pendant that acts once."""

    EMERGENCY_STOP = "emergency_stop"
    EMERGENCY_STOP_RELEASED = "emergency_stop_released"  # its button is out again; the drives stay off
    PROTECTIVE_STOP = "protective_stop"  # by a program's wish, as after a limit
    POWER_OFF = "power_off"  # the arm comes to rest, then its drives are switched off and the brakes hold it
    RESET = "reset"
    SAFEGUARD_OPEN = "safeguard_open"  # a level of the safety input: door open, light curtain broken
    SAFEGUARD_CLOSED = "safeguard_closed"
    REDUCED_ON = "reduced_on"  # a level of the safety input
    REDUCED_OFF = "reduced_off"
    LEAVE_FREE_DRIVE = "leave_free_drive"  # deactivation signal (FD-17)
    RESTART_PERIOD = "restart_period"  # the running free-drive or restart period starts again (FD-16)
    REGISTER_WAYPOINT = "register_waypoint"  # the user keeps this posture, which counts as manipulation (FD-13)
    NORMAL = "normal"  # switch the mode to NORMAL
    TEACH = "teach"  # switch the mode to TEACH
    REMOTE = "remote"  # switch the mode to REMOTE
    START_PROGRAM = "start_program"
    START_REMOTELY = "start_remotely"  # the remote controller starts the program, in REMOTE alone
    PAUSE_PROGRAM = "pause_program"
    RESUME_PROGRAM = "resume_program"
    STOP_PROGRAM = "stop_program"
    WIZARD_MEASURE = "wizard_measure"  # measure the payload in this posture
    WIZARD_RUN = "wizard_run"  # the arm turns its wrist by itself and measures the payload
    WIZARD_APPLY = "wizard_apply"  # configure what was found
    WIZARD_CLEAR = "wizard_clear"  # forget the postures; an arm that turns its wrist for them comes to rest
    ZERO_SENSOR = "zero_sensor"  # what the flange force/torque sensor says of the untouched arm is subtracted from now on
    ZERO_READING = "zero_reading"  # forces are told, and pushed with, against what is felt now; free-drive goes by the sensor's
    DETECTION = "detection"  # switch contact detection on or off (CD-1)


@dataclass(frozen=True, slots=True)
class Inputs:
    """One tick's inputs.

    `held` names the buttons whose hold was refreshed in this tick (a keep-alive); a button that is not refreshed counts as
    held until it has been silent for the time of FD-23. `released` names the buttons that were let go, which acts at once.
    `settings` are changed settings by dotted name, already validated against the schema.
    """

    held: frozenset[Button] = frozenset()
    released: frozenset[Button] = frozenset()
    commands: tuple[Command, ...] = ()
    settings: dict[str, float | bool | str] = field(default_factory=dict)
    program: Program | None = None  # a program to load
    high: frozenset[int] = frozenset()  # digital inputs that are high
    tool: str = ""  # the tool to use from now on, by its name in the table
    load: Load | None = None  # the payload to configure, beyond the tool
    tools: tuple[Tool, ...] = ()  # the table of tools from now on; empty: as it was
    remote_signal: bool = False  # the remote controller asks for free-drive; a level
    jog: Jogged | None = None  # the motion whose button is held, refreshed in this tick (a keep-alive)
    jog_released: bool = False  # that button was let go
    script: Scripted | None = None  # what the running script wants, said in this tick (a keep-alive)
    borders: tuple[AnyBorder, ...] | None = None  # walls and areas from now on, all of them; None: as they were
    load_time: float | None = None  # in which the arm goes over to tool and payload of this tick [s]; None: as the settings say


NOTHING = Inputs()
"""The inputs of a tick in which nobody does anything."""
