"""What hand, button and digital inputs call for in a tick: signal, commands, and what is told of a push (FD-5, FD-6a, FD-17)."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import ProgramState
from pendant.robot.requests import Calls
from pendant.settings.schema import Value
from pendant.signals.sources import BUTTON, DIGITAL, NONE, PRESSES, REMOTE_CONTROLLER, Presence
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

PUSH = Presence("push", by_hand=True)
QUIET, PUSHED = 0.0, [0.0, 30.0, 40.0]
PAUSE, RESUME, STOP = (Command.PAUSE_PROGRAM,), (Command.RESUME_PROGRAM,), (Command.STOP_PROGRAM,)
LEAVE = (Command.LEAVE_FREE_DRIVE,)


class Bench:
    """Calls of an arm that is held, stepped by hand; tells all that they find in a tick."""

    def __init__(self, **changes: Value) -> None:
        names = {"signals." + name.replace("__", "."): value for name, value in changes.items()}
        self.settings = apply(Settings(), names)
        self.calls = Calls(6)
        self.calls.refresh(self.settings)
        self.tick = 0

    def step(
        self,
        force: float | list[float] = QUIET,
        *,
        inputs: Inputs = NOTHING,
        tau_ext: float = 0.0,
        wrench: bool = True,
        holding: bool = True,
        state: ProgramState = ProgramState.NONE,
        button: bool = False,
    ) -> tuple[Presence, tuple[Command, ...], list[Event]]:
        self.tick += 1
        value = estimate(self.tick, force=force, tau_ext=tau_ext)
        events = self.calls.step(value, inputs, self.settings, wrench=wrench, holding=holding, state=state, button=button)
        return self.calls.signal, self.calls.commands, whole(events, self.tick)

    def quiet(self) -> "Bench":
        """The sensors' untouched state is learned, and no hand has been felt for long."""
        for _ in range(120):
            assert self.step() == (NONE, (), [])
        assert (self.calls.hand_off, self.calls.touched, self.calls.force) == (True, False, 0.0)
        return self

    def kept(self) -> tuple[object, ...]:
        return (self.calls._leaving, self.calls.hand_off, self.calls.touched, self.calls.force)


def test_before_a_source_by_hand_is_on_nothing_is_felt() -> None:
    """FD-8a: no hand is felt on the arm."""
    bench = Bench()
    for calls in (bench.calls, Calls(6)):
        assert (calls.feeling, calls.signal, calls.commands) == (False, NONE, ())
        assert (calls.hand_off, calls.touched, calls.force) == (True, False, 0.0)
    for _ in range(200):
        assert bench.step(PUSHED) == (NONE, (), [])
    assert (bench.calls.hand_off, bench.calls.touched, bench.calls.force) == (True, False, 0.0)


@pytest.mark.parametrize(
    "name", ["push.on", "push.reported", "twist.on", "joints.on", "pattern.on", "turn.on", "force_step.on", "tap.on"]
)
def test_each_source_by_hand_feels(name: str) -> None:
    calls = Calls(6)
    calls.refresh(apply(Settings(), {f"signals.{name}": True}))
    assert calls.feeling is True
    calls.refresh(apply(Settings(), {"signals.digital": True}))
    assert calls.feeling is False


@pytest.mark.parametrize(
    ("feels", "wrench", "holding", "signal"), [(True, True, True, PUSH), (True, True, False, NONE), (True, False, True, NONE)]
)
def test_a_push_is_a_signal_of_a_held_arm_with_a_valid_wrench(feels: bool, wrench: bool, holding: bool, signal: Presence) -> None:
    bench = Bench(push__on=feels).quiet()
    found = [bench.step(PUSHED, wrench=wrench, holding=holding) for _ in range(60)]
    assert found[-1] == (signal, (), [])
    assert bench.calls.force == pytest.approx(50.0 if wrench else 0.0, rel=0.05)
    assert (bench.calls.touched, bench.calls.hand_off) == (wrench, not wrench)
    assert bench.kept() == (False, not wrench, wrench, bench.calls.force)


def test_a_hand_is_off_after_a_tenth_of_a_second() -> None:
    """FD-8a: to the tick, while a source by hand is on; the force is smoothed, and below the limit when it has faded."""
    bench = Bench(push__on=True).quiet()
    for _ in range(20):
        bench.step(PUSHED)
    for _ in range(100):
        if not bench.calls.touched:
            break
        assert bench.calls.hand_off is False
        bench.step()
    for _ in range(49):
        bench.step()
        assert (bench.calls.touched, bench.calls.hand_off) == (False, False)
    bench.step()
    assert bench.calls.hand_off is True


@pytest.mark.parametrize(
    ("switch", "state", "commands"),
    [
        ("reported", ProgramState.RUNNING, ()),
        ("pauses", ProgramState.RUNNING, PAUSE),
        ("pauses", ProgramState.PAUSED, ()),
        ("resumes", ProgramState.PAUSED, RESUME),
        ("resumes", ProgramState.RUNNING, ()),
        ("stops", ProgramState.RUNNING, STOP),
        ("stops", ProgramState.PAUSED, STOP),
        ("stops", ProgramState.STOPPED, ()),
    ],
)
def test_a_push_is_told_once_and_steers_the_program(switch: str, state: ProgramState, commands: tuple[Command, ...]) -> None:
    """FD-6a: when it has lasted 0.1 s."""
    bench = Bench(**{"push__reported": True, f"push__{switch}": True}).quiet()
    found = [bench.step(PUSHED, state=state) for _ in range(120)]
    (push,) = [one for one in found if one != (NONE, (), [])]
    assert push[:2] == (NONE, commands)
    (event,) = push[2]
    assert (event.kind, event.values["part"]) == (Kind.PUSHED, "flange")
    assert event.values["force"] == pytest.approx(50.0, rel=0.05)
    assert [event.values[axis] for axis in "xyz"] == pytest.approx([0.0, 0.6, 0.8])


@pytest.mark.parametrize("told", [True, False])
def test_a_rising_input_leaves_besides_what_a_push_does(told: bool) -> None:
    """FD-17, FD-6a."""
    first = Bench(push__reported=True, push__pauses=True).quiet()
    running = ProgramState.RUNNING
    count = next(count for count in range(200) if first.step(PUSHED, state=running)[1])
    bench = Bench(push__reported=told, push__pauses=True, leaving=True).quiet()
    for _ in range(count):
        assert bench.step(PUSHED, state=running) == (NONE, (), [])
    _, commands, events = bench.step(PUSHED, state=running, inputs=Inputs(high=frozenset({1})))
    assert commands == (PAUSE + LEAVE if told else LEAVE)
    assert len(events) == told
    assert bench.step(PUSHED, state=running, inputs=Inputs(high=frozenset({1}))) == (NONE, (), [])


@pytest.mark.parametrize("on", [True, False])
def test_an_input_leaves_in_the_tick_in_which_it_rises(on: bool) -> None:
    """FD-17: its own input alone, each time anew, also in the first tick."""
    bench = Bench(leaving=on, leaving_input=3.0)
    course = [{3}, {3}, set(), {1, 2}, {1, 3}, {3}, set(), {3}]
    rises = [0, 4, 7] if on else []
    for tick, high in enumerate(course):
        assert bench.step(inputs=Inputs(high=frozenset(high))) == (NONE, LEAVE if tick in rises else (), [])
        assert bench.kept() == (on and 3 in high, True, False, 0.0)


@pytest.mark.parametrize("digital", [True, False])
@pytest.mark.parametrize("use_button", [True, False])
@pytest.mark.parametrize("feels", [True, False])
def test_button_then_input_then_hand_is_the_signal(feels: bool, use_button: bool, digital: bool) -> None:
    """FD-5: each where it is on, the input where it is its own."""
    bench = Bench(button=use_button, digital=digital, digital_input=2.0, push__on=feels).quiet()
    for _ in range(60):
        bench.step(PUSHED)
    by_hand = PUSH if feels else NONE
    by_input = DIGITAL if digital else by_hand
    for button, high, found in ((False, {0}, by_hand), (False, {2}, by_input), (True, {0}, by_hand), (True, {2}, by_input)):
        signal = BUTTON if button and use_button else found
        assert bench.step(PUSHED, button=button, inputs=Inputs(high=frozenset(high))) == (signal, (), [])


@pytest.mark.parametrize("state", ProgramState)
def test_what_the_joints_feel_is_learned_anew_after_a_program_has_moved_the_arm(state: ProgramState) -> None:
    """FD-5: also where it ends in the posture in which it began."""
    bench = Bench(joints__on=True).quiet()
    bench.step(holding=False, state=state)
    found = [bench.step(tau_ext=20.0) for _ in range(120)][-1]
    learned = state is ProgramState.RUNNING
    assert found == (NONE if learned else Presence("push felt by joints", by_hand=True), (), [])


def test_where_the_last_source_by_hand_is_switched_off_no_hand_is_felt() -> None:
    """FD-8a."""
    bench = Bench(push__on=True).quiet()
    for _ in range(60):
        bench.step(PUSHED)
    assert (bench.calls.hand_off, bench.calls.touched) == (False, True)
    assert bench.calls.force > 40.0
    bench.settings = Settings()
    bench.calls.refresh(bench.settings)
    for _ in range(10):
        assert (bench.calls.hand_off, bench.calls.touched, bench.calls.force) == (True, False, 0.0)
        bench.step(PUSHED)


def test_the_remote_controllers_level_is_a_signal_unless_button_or_input_give_one() -> None:
    asks = Inputs(remote_signal=True)
    bench = Bench(digital=True)
    assert bench.step(inputs=asks)[0] is REMOTE_CONTROLLER
    assert bench.step(inputs=asks, button=True)[0] is BUTTON
    assert bench.step(inputs=Inputs(high=frozenset({bench.settings.signals.digital_input}), remote_signal=True))[0] is DIGITAL
    assert bench.step()[0] is NONE


@pytest.mark.parametrize("of", ["button", "input"])
@pytest.mark.parametrize("pressed", ["button", "input"])
@pytest.mark.parametrize("on", [True, False])
def test_presses_in_a_row_are_a_signal_of_what_is_chosen(of: str, pressed: str, on: bool) -> None:
    """FD-5f: three of 0.1 s, with gaps of 0.1 s; whole when the last one has ended."""
    bench = Bench(presses__on=on, presses__of=of, button=False, digital_input=3.0)
    seen: list[int] = []
    for tick in range(400):
        down = tick // 50 in (1, 3, 5)
        high = Inputs(high=frozenset({3})) if down and pressed == "input" else NOTHING
        signal, _, _ = bench.step(inputs=high, button=down and pressed == "button")
        assert signal in (NONE, PRESSES)
        seen += [tick] if signal is PRESSES else []
    assert seen == ([300] if on and of == pressed else [])


def test_presses_that_were_begun_before_the_source_was_off_count_no_more() -> None:
    """FD-5f."""
    bench = Bench(presses__on=True, button=False)
    for switched in (False, True):
        signals: list[Presence] = []
        for tick in range(350):
            if switched and tick == 260:
                bench.calls.refresh(Settings())
                bench.calls.refresh(bench.settings)
            signals.append(bench.step(button=tick // 50 in (1, 3, 5))[0])
        assert (PRESSES in signals) is not switched
