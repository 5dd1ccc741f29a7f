"""What can happen: an event is a fact of one tick, with its numbers. pendant.event_table says what it does and how it reads."""

from collections.abc import Iterable
from enum import StrEnum

import msgspec

Values = dict[str, float | int | str | bool]


class Kind(StrEnum):
    """Every kind of event. Its row in pendant.event_table.TABLE says which values it carries."""

    ACTIVATION_STARTED = "activation_started"
    ACTIVATION_CANCELLED = "activation_cancelled"
    SIGNAL_SEEN = "signal_seen"
    CONFIRM_ASKED = "confirm_asked"
    REFUSED_UNCONFIRMED = "refused_unconfirmed"
    LET_GO_ASKED = "let_go_asked"
    REFUSED_STILL_HELD = "refused_still_held"
    PUSHED = "pushed"
    SEQUENCE_STARTED = "sequence_started"
    ENTERED = "entered"
    ENTRY_PREVENTED = "entry_prevented"
    REFUSED_LIMIT = "refused_limit"
    REFUSED_PAYLOAD = "refused_payload"
    SEQUENCE_STOPPED = "sequence_stopped"
    COMPENSATING = "compensating"
    COMPENSATED = "compensated"
    NOT_COMPENSATED = "not_compensated"
    LOAD_FOUND = "load_found"
    RESIDUAL_GONE = "residual_gone"
    RESIDUAL_STAYED = "residual_stayed"
    REFUSED_WALL = "refused_wall"
    REFUSED_MODE = "refused_mode"
    REFUSED_SENSORS = "refused_sensors"
    REFUSED_CHANGING = "refused_changing"
    REFUSED_SHORT = "refused_short"
    REFUSED_NOT_STORED = "refused_not_stored"
    REFUSED_MOVING = "refused_moving"
    NOT_YET = "not_yet"
    MANIPULATION = "manipulation"
    WAYPOINT = "waypoint"
    RESTARTED = "restarted"
    PERIOD_ANEW = "period_anew"
    WALL_REACHED = "wall_reached"
    SINGULARITY = "singularity"
    WRENCH_LOST = "wrench_lost"
    SENSOR_STEPPED = "sensor_stepped"
    SENSOR_DRIFTED = "sensor_drifted"
    HOLD_SILENT = "hold_silent"
    LEFT_PERIOD = "left_period"
    LEFT_RESTART = "left_restart"
    LEFT_PRESS = "left_press"
    LEFT_RELEASE = "left_release"
    LEFT_LIMIT = "left_limit"
    STOPPED_LIMIT = "stopped_limit"
    STOPPED_MOTION = "stopped_motion"
    STOPPED_PAYLOAD = "stopped_payload"
    WAY_BACK = "way_back"
    LEFT_WALL = "left_wall"
    STOPPED_WALL = "stopped_wall"
    DEACTIVATED = "deactivated"
    SENSORS_LOST = "sensors_lost"
    RUN_SENSORS_LOST = "run_sensors_lost"
    JOINT_SENSOR_LOST = "joint_sensor_lost"
    JOINT_SENSOR_BACK = "joint_sensor_back"
    REFUSED_ENABLING = "refused_enabling"
    LEFT_ENABLING = "left_enabling"
    RUN_ENABLING = "run_enabling"
    EMERGENCY_STOP = "emergency_stop"
    EMERGENCY_STOP_RELEASED = "emergency_stop_released"
    POWERED_OFF = "powered_off"
    SAFEGUARD_STOP = "safeguard_stop"
    SAFEGUARD_CLOSED = "safeguard_closed"
    REDUCED_ON = "reduced_on"
    REDUCED_OFF = "reduced_off"
    REDUCED_EXCEEDED = "reduced_exceeded"
    STOPPED = "stopped"
    RESET = "reset"
    RESET_REFUSED_SAFEGUARD = "reset_refused_safeguard"
    RESET_REFUSED_SIGNAL = "reset_refused_signal"
    RESET_REFUSED_MOVING = "reset_refused_moving"
    RESET_REFUSED_SENSORS = "reset_refused_sensors"
    MODE_CHANGED = "mode_changed"
    COMMAND_REFUSED = "command_refused"
    PROGRAM_LOADED = "program_loaded"
    PROGRAM_REFUSED = "program_refused"
    PROGRAM_STARTED = "program_started"
    PROGRAM_PAUSED = "program_paused"
    PROGRAM_RESUMED = "program_resumed"
    PROGRAM_STOPPED = "program_stopped"
    PROGRAM_FINISHED = "program_finished"
    PROGRAM_FAILED = "program_failed"
    JOG_STARTED = "jog_started"
    JOG_ENDED = "jog_ended"
    JOG_REFUSED = "jog_refused"
    CONTACT_GAINED = "contact_gained"
    CONTACT_LOST = "contact_lost"
    CONTACT_RESISTANCE = "contact_resistance"
    CONTACT_CLAMPING = "contact_clamping"
    TOOL_SWITCHED = "tool_switched"
    TOOL_CHANGED = "tool_changed"
    TOOL_REFUSED = "tool_refused"
    TOOLS_CHANGED = "tools_changed"
    PAYLOAD_CHANGED = "payload_changed"
    POSTURE_MEASURED = "posture_measured"
    POSTURE_REFUSED = "posture_refused"
    PAYLOAD_FOUND = "payload_found"
    SENSOR_ZEROED = "sensor_zeroed"
    ZERO_REFUSED = "zero_refused"
    ZERO_DUE = "zero_due"
    SETTING_CHANGED = "setting_changed"
    SETTING_REFUSED = "setting_refused"
    OVERRUN = "overrun"
    BROKEN_DOWN = "broken_down"


class Event(msgspec.Struct, frozen=True):
    """One event."""

    kind: Kind
    tick: int
    values: Values = msgspec.field(default_factory=dict)


def posture_text(q: Iterable[float]) -> str:
    """Joint angles [rad] as a value of an event: to 1e-4, separated by spaces."""
    return " ".join(f"{angle:.4f}" for angle in q)


def posture_of(values: Values) -> tuple[float, ...]:
    """The joint angles [rad] that an event carries as `posture`; none where it says nothing."""
    return tuple(float(angle) for angle in str(values.get("posture", "")).split())
