"""What must hold whatever anybody does: invariants over random streams of inputs, with estimates that may be broken."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import LEAVING, Effect
from pendant.inputs import Button, Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.settings.schema import ticks
from pendant.supervisor import Supervisor
from pendant.tick.modes import Law, Mode, Phase, Safety
from tests.pendant.estimates import estimate

PROGRAM = Program(steps=(JointMove(q=(0.0,) * 6),))
BASE = {
    "activation.period": 0.04,
    "sequence.period": 0.25,
    "free_drive.period": 0.5,
    "free_drive.restart_period": 0.5,
    "hold.silence": 0.1,
    "button.short_press": 0.1,
    "static.time": 0.02,
}
CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "activation.period": st.sampled_from([0.0, 0.002, 0.1]),
        "sequence.on": st.booleans(),
        "sequence.amplified": st.booleans(),
        "sequence.beyond_limit": st.sampled_from(["refuse", "balance", "protective_stop"]),
        "free_drive.cool_down": st.sampled_from([0.0, 0.1]),
        "free_drive.allowed_from.run": st.booleans(),
        "free_drive.allowed_from.normal": st.booleans(),
        "free_drive.allowed_from.teach": st.booleans(),
        "button.hold_to_run": st.booleans(),
        "static.speed": st.sampled_from([0.01, 0.1]),
    },
)


@dataclass(frozen=True)
class Piece:
    """Some ticks of the same."""

    count: int
    held: bool
    released: bool
    joints_valid: bool
    wrench_valid: bool
    qd: float
    force: float
    commands: tuple[Command, ...]
    load: bool


COMMANDS = st.sampled_from(Command)
CALM = st.builds(
    Piece,
    count=st.sampled_from([1, 12, 25, 60, 130, 300]),
    held=st.booleans(),
    released=st.booleans(),
    joints_valid=st.just(True),
    wrench_valid=st.just(True),
    qd=st.sampled_from([0.0, 0.0, 0.0, 0.3]),
    force=st.sampled_from([0.0, 20.0]),
    commands=st.just(()) | st.tuples(COMMANDS),
    load=st.booleans(),
)
WILD = st.builds(
    Piece,
    count=st.integers(1, 8),
    held=st.booleans(),
    released=st.booleans(),
    joints_valid=st.booleans(),
    wrench_valid=st.booleans(),
    qd=st.sampled_from([0.0, 0.02, -1.0, math.nan, math.inf]),
    force=st.sampled_from([0.0, -30.0, math.nan, -math.inf]),
    commands=st.lists(COMMANDS, max_size=3).map(tuple),
    load=st.booleans(),
)
PIECES = st.lists(CALM | CALM | WILD, min_size=1, max_size=30)


@dataclass(frozen=True)
class Tick:
    """What went in and what came out."""

    index: int
    inputs: Inputs
    ok: bool  # joints valid and finite
    static_speed: bool
    qd: float
    wrench: bool  # valid and finite
    decision: Decision


def play(settings: Settings, pieces: list[Piece]) -> Iterator[Tick]:
    supervisor = Supervisor(settings, 6)
    index = 0
    button = frozenset({Button.FREE_DRIVE})
    for piece in pieces:
        value = estimate(joints_valid=piece.joints_valid, wrench_valid=piece.wrench_valid, qd=piece.qd, force=piece.force)
        for tick in range(piece.count):
            inputs = Inputs(
                button if piece.held else frozenset(),
                button if piece.released and tick == 0 else frozenset(),
                piece.commands if tick == 0 else (),
                {},
                PROGRAM if piece.load and tick == 0 else None,
            )
            value.tick = index
            ok = piece.joints_valid and math.isfinite(piece.qd)
            slow = ok and abs(piece.qd) < settings.static.speed
            wrench = piece.wrench_valid and math.isfinite(piece.force)
            yield Tick(index, inputs, ok, slow, piece.qd, wrench, supervisor.step(value, inputs))
            index += 1


def present(history: list[Tick], silence: int) -> bool:
    """The button is held, from the inputs alone: refreshed lately, and not let go since."""
    for tick in reversed(history[-silence - 1 :]):
        if tick.inputs.released:
            return False
        if tick.inputs.held:
            return True
    return False


@hypothesis_settings(max_examples=120, deadline=None)
@given(changes=CHANGES, pieces=PIECES)
def test_invariants(changes: dict[str, float | bool], pieces: list[Piece]) -> None:
    settings = apply(Settings(), {**BASE, **changes})
    silence, period = ticks(settings.hold.silence), ticks(settings.activation.period)
    history: list[Tick] = []
    held: list[bool] = []
    before: Decision | None = None
    for tick in play(settings, pieces):
        history.append(tick)
        held.append(present(history, silence))
        now = tick.decision
        effects = {TABLE[event.kind].effect for event in now.events}
        free, was_free = now.mode is Mode.FREE_DRIVE, before is not None and before.mode is Mode.FREE_DRIVE

        # phases, law and mode tell the same
        tried = now.phase is Phase.SEQUENCE
        assert free == (now.phase in (Phase.HELD, Phase.PERIOD, Phase.GUIDED, Phase.RESTART))
        assert (free or tried) == (now.law is Law.FREE)
        assert (tried and now.balance is None) == bool(now.monitored)
        assert now.balance is None or (tried and now.gain == 0.0)
        assert (now.law is Law.FOLLOW) == (now.move is not None)
        assert now.mode is Mode.RUN or now.move is None
        assert now.mode is not Mode.STOP or now.law in (Law.BRAKE, Law.OFF)
        assert now.law is not Law.OFF or now.mode is Mode.STOP
        assert free or tried or (now.gain, now.baseline) == (0.0, (0.0,) * 6)
        assert not tried or settings.sequence.amplified or now.gain == 0.0
        assert all(math.isfinite(value) for value in now.baseline)
        assert (now.safety > Safety.REDUCED) <= (now.mode is Mode.STOP)

        # what is not valid never frees; a released button is never seen as held
        assert tick.ok or not free
        assert now.phase not in (Phase.HELD, Phase.ACTIVATION) or held[-1]

        # never FREE_DRIVE without the activation period, from rest, and the sequence, with the arm staying where it is
        if free and not was_free:
            assert Effect.ENTER in effects
            length = ticks(settings.sequence.period) if settings.sequence.on else 0
            start = len(held) - length - 1
            assert start >= period
            assert all(held[start - period : start + 1])
            assert all(past.static_speed for past in history[start + 1 - ticks(settings.static.time) : start + 1])
            assert all(past.ok and abs(past.qd) <= 0.05 for past in history[start:])
            assert all(past.decision.phase is Phase.SEQUENCE for past in history[start:-1])
            assert not length or len({past.wrench for past in history[start:]}) == 1
            allowed = settings.free_drive.allowed_from
            origin = before.mode if before else Mode.TEACH
            switched = [event.values["to"] for event in now.events if "to" in event.values]
            origin = Mode(switched[-1]) if switched else origin
            origin = Mode.TEACH if Command.RESET in tick.inputs.commands else origin
            if not set(tick.inputs.commands):
                assert {Mode.TEACH: allowed.teach, Mode.NORMAL: allowed.normal, Mode.RUN: allowed.run}[origin]

        # every leaving has a cause, and says what to do
        if was_free and not free:
            causes = [event for event in now.events if TABLE[event.kind].effect in LEAVING]
            both = {Kind.SAFEGUARD_STOP, Kind.EMERGENCY_STOP}  # pressed and opened in one tick
            assert len(causes) == 1 or {cause.kind for cause in causes} == both
            assert TABLE[causes[0].kind].guidance
            assert now.mode is not Mode.RUN or now.law is not Law.FOLLOW

        # STOP is left by a reset alone, to TEACH, and not while a signal is present
        if before is not None and before.mode is Mode.STOP and now.mode is not Mode.STOP:
            assert Command.RESET in tick.inputs.commands
            assert not held[-1]
            assert now.safety in (Safety.NORMAL, Safety.REDUCED)
        if Command.EMERGENCY_STOP in tick.inputs.commands:
            assert (now.mode, now.safety) == (Mode.STOP, Safety.EMERGENCY_STOP)

        # periods count down by one, and are whole
        for running in now.periods:
            assert 0 < running.ticks <= running.total
            old = {item.name: item for item in before.periods} if before else {}
            if running.ticks < running.total:
                assert running.ticks == old[running.name].ticks - 1
        before = now


@hypothesis_settings(max_examples=60, deadline=None)
@given(changes=CHANGES, pieces=PIECES)
def test_left_alone_free_drive_ends_within_its_periods(changes: dict[str, float | bool], pieces: list[Piece]) -> None:
    settings = apply(Settings(), {**BASE, **changes})
    longest = sum(
        ticks(seconds)
        for seconds in (
            settings.hold.silence,
            settings.sequence.period,
            settings.free_drive.period,
            settings.static.time,
            settings.free_drive.restart_period,
        )
    )
    alone = Piece(longest + 3, False, False, True, True, 0.0, 0.0, (), False)
    *_, last = play(settings, [*pieces, alone])
    assert last.decision.mode is not Mode.FREE_DRIVE


@hypothesis_settings(max_examples=40, deadline=None)
@given(pieces=PIECES)
def test_equal_inputs_give_equal_decisions(pieces: list[Piece]) -> None:
    settings = apply(Settings(), BASE)
    for one, other in zip(play(settings, pieces), play(settings, pieces), strict=True):
        assert one.decision == other.decision
