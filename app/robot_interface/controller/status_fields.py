"""Writes the controller's state into the record of RTDE's fields: the modes' numbers, inputs, and registers of our own."""

from app.robot_interface.controller.controller_state import ControllerState
from app.robot_interface.controller.field_record import FieldRecord
from app.robot_interface.controller.rtde_fields import FIRST_BIT
from pendant.contact.contact_change import Change
from pendant.decision import Decision
from pendant.tick.modes import TICK, Mode, Phase

FREE_DRIVE, TRYING, REFUSED, RUNNING_OUT, CONTACT = (f"output_bit_register_{number}" for number in range(64, 69))
"""What a UR's bits do not tell: in free-drive; being activated; refused last; a period that ends it runs; in contact."""

REMAINING = "output_double_register_24"
"""Of the period that runs [s]."""

PHASES = list(Phase)
PHASE = "output_int_register_24"
"""The phase of free-drive, by its place in docs/guide/robot-on-the-network.md."""

TOOL_OUTPUT = 1 << 16
"""The tool's first digital output, which a program switches (CD-15)."""

ALL_OUTPUTS = (1 << 18) - 1
"""A mask of all digital outputs."""

WORD_BITS = 32
"""Boolean registers in a word."""


class StatusFields:
    """State, inputs and registers."""

    def __init__(self, record: FieldRecord) -> None:
        self._record = record
        self._told: tuple[object, ...] = ()
        self._high: frozenset[int] = frozenset()
        self._tool_on = False
        self._outputs: frozenset[int] = frozenset()

    def follow(self, decision: Decision) -> None:
        """Write what a tick alone tells, and no later one does; for every tick."""
        for contact in decision.contacts:
            self._record.put(CONTACT, contact.change is not Change.LOST)
        if decision.tool_on is not self._tool_on:
            self._tool_on = decision.tool_on
            set_outputs(self._record, TOOL_OUTPUT, TOOL_OUTPUT if decision.tool_on else 0)
        if decision.outputs != self._outputs:
            changed = sum(1 << number for number in decision.outputs ^ self._outputs)
            self._outputs = decision.outputs
            set_outputs(self._record, changed, sum(1 << number for number in decision.outputs))

    def fill(self, state: ControllerState, decision: Decision, high: frozenset[int]) -> None:
        """Write the tick done last; what seldom changes only when it does. `high`: digital inputs."""
        put = self._record.put
        if decision.periods:
            put(REMAINING, decision.periods[0].ticks * TICK)
        if high != self._high:
            self._high = high
            bits = sum(1 << number for number in high)
            put("actual_digital_input_bits", bits)
            put("actual_configurable_digital_input_bits", bits >> 8 & 0xFF)
        told = (
            state.robot_mode,
            state.safety_mode,
            state.runtime,
            state.phase,
            state.mode,
            state.refusal,
            bool(decision.periods),
        )
        if told != self._told:
            self.tell(state, bool(decision.periods))
            self._told = told

    def tell(self, state: ControllerState, ending: bool) -> None:
        """Write the controller's state; `ending`: a period runs that ends what is."""
        self._told = ()  # a tick may be as the one before this
        put = self._record.put
        put("robot_mode", state.robot_mode)
        put("joint_mode", (state.joint_mode,) * 6)
        put("safety_mode", state.safety_mode)
        put("safety_status", state.safety_mode)
        put("safety_status_bits", state.safety_bits)
        put("robot_status_bits", state.robot_bits)
        put("runtime_state", state.runtime)
        put(FREE_DRIVE, state.mode is Mode.FREE_DRIVE)
        put(TRYING, state.phase is not Phase.OFF and state.mode is not Mode.FREE_DRIVE)
        put(REFUSED, bool(state.refusal))
        put(RUNNING_OUT, state.mode is Mode.FREE_DRIVE and ending)
        put(PHASE, PHASES.index(state.phase))
        if not ending:
            put(REMAINING, 0.0)


def set_outputs(record: FieldRecord, mask: int, bits: int) -> None:
    """Set the digital outputs in `mask`: 0 to 7 standard, 8 to 15 configurable, 16 and 17 of the tool."""
    with record.lock:
        before = record.get("actual_digital_output_bits")
        assert isinstance(before, int)
        now = (before & ~mask) | (bits & mask)
        record.put("actual_digital_output_bits", now)
        record.put("actual_configurable_digital_output_bits", now >> 8 & 0xFF)


def set_analog_output(record: FieldRecord, number: int, share: float, *, volts: bool) -> None:
    """Set analog output 0 or 1 to a share of its span, 0 to 10 V or 4 to 20 mA, which is told in volts or amperes."""
    share = min(max(share, 0.0), 1.0)
    with record.lock:
        kinds, bit = record.get("analog_io_types"), 1 << number + 2
        assert isinstance(kinds, int)
        record.put("analog_io_types", kinds | bit if volts else kinds & ~bit)
        record.put(f"standard_analog_output{number}", 10.0 * share if volts else 0.004 + 0.016 * share)


def in_volts(record: FieldRecord, output: int) -> bool:
    """Whether an analog output is in volts; else in amperes."""
    return bool(int(record.field("analog_io_types").item()) >> output + 2 & 1)


def read_bit(record: FieldRecord, way: str, address: int) -> bool:
    """A boolean register of "input" or "output"."""
    if address >= FIRST_BIT:
        return bool(record.get(f"{way}_bit_register_{address}"))
    return bool(int(record.field(_word(way, address)).item()) >> address % WORD_BITS & 1)


def write_bit(record: FieldRecord, address: int, value: bool) -> None:
    """Set a boolean register of the outputs."""
    if address >= FIRST_BIT:
        record.put(f"output_bit_register_{address}", value)
        return
    bit = 1 << address % WORD_BITS
    word = _word("output", address)
    with record.lock:
        before = int(record.field(word).item())
        record.put(word, before | bit if value else before & ~bit)


def _word(way: str, address: int) -> str:
    return f"{way}_bit_registers0_to_31" if address < WORD_BITS else f"{way}_bit_registers32_to_63"
