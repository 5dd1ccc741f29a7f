"""The modes from which free-drive can be entered (FD-1)."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.freedrive.origins import may_enter, origins, teach_first
from pendant.inputs import Command, Inputs
from pendant.program.steps import Program, ProgramState, Wait
from pendant.tick.modes import Mode
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench


@pytest.mark.parametrize("mode", [Mode.NORMAL, Mode.REMOTE, Mode.TEACH])
@pytest.mark.parametrize("allowed", [(), ("normal",), ("teach",), ("normal", "teach", "run")])
def test_free_drive_is_entered_from_the_allowed_modes_alone(mode: Mode, allowed: tuple[str, ...]) -> None:
    """FD-1."""
    bench = Bench(**{f"free_drive__allowed_from__{name}": name in allowed for name in ("normal", "teach", "run")})
    bench.run(60)
    bench.step(Inputs(commands=(Command(mode.value.lower()),)))
    bench.events.clear()
    bench.step(HOLD)
    if mode.value.lower() in allowed:
        assert bench.run(500, HOLD).mode is Mode.FREE_DRIVE
        bench.step(LET_GO)
        assert bench.run(1500).mode is mode
    else:
        text = {(): "none", ("normal",): "NORMAL", ("teach",): "TEACH"}.get(allowed, "NORMAL, TEACH, RUN")
        assert bench.events == [Event(Kind.REFUSED_MODE, bench.tick, {"mode": mode, "allowed": text})]
        assert bench.run(600, HOLD).mode is mode


def test_no_setting_allows_entry_from_remote_stop_or_free_drive() -> None:
    everything = {f"free_drive.allowed_from.{name}": True for name in ("normal", "teach", "run")}
    settings = apply(Settings(), everything)
    assert {mode for mode in Mode if may_enter(mode, "button", settings)} == {Mode.NORMAL, Mode.TEACH, Mode.RUN}
    assert origins("button", settings) == "NORMAL, TEACH, RUN"


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("source", ["button", "digital input", "push", "remote controller"])
def test_in_remote_the_remote_controller_alone_enters_and_nowhere_else(mode: Mode, source: str) -> None:
    """FD-1: REMOTE refuses the pendant's activation."""
    settings = Settings()
    if source == "remote controller":
        assert may_enter(mode, source, settings) is (mode is Mode.REMOTE)
        assert origins(source, settings) == "REMOTE"
    else:
        assert may_enter(mode, source, settings) is (mode is Mode.TEACH)


def test_the_remote_controller_goes_through_the_sequence_and_its_period_ends_it() -> None:
    bench = Bench(free_drive__period=1.0, sequence__on=True)
    bench.run(60)
    bench.step(Inputs(commands=(Command.REMOTE,)))
    asks = Inputs(remote_signal=True)
    bench.events.clear()
    assert bench.run(1100, asks).mode is Mode.FREE_DRIVE
    kinds = [event.kind for event in bench.events]
    assert kinds[:3] == [Kind.SIGNAL_SEEN, Kind.SEQUENCE_STARTED, Kind.ENTERED]
    assert bench.events[0].values["source"] == "remote controller"
    assert bench.run(600, asks).mode is Mode.REMOTE
    assert Kind.LEFT_PERIOD in {event.kind for event in bench.events}


def test_the_remote_controller_is_refused_in_local_control() -> None:
    bench = Bench()
    bench.run(60)
    bench.events.clear()
    bench.step(Inputs(remote_signal=True))
    assert bench.events == [Event(Kind.REFUSED_MODE, bench.tick, {"mode": Mode.TEACH, "allowed": "REMOTE"})]


def test_a_sequence_that_the_remote_controller_began_ends_with_its_control() -> None:
    bench = Bench(sequence__on=True)
    bench.run(60)
    bench.step(Inputs(commands=(Command.REMOTE,)))
    bench.run(600, Inputs(remote_signal=True))
    bench.events.clear()
    bench.step(Inputs(commands=(Command.TEACH,), remote_signal=True))
    assert Kind.REFUSED_MODE in {event.kind for event in bench.events}


@pytest.mark.parametrize("mode", list(Mode))
@pytest.mark.parametrize("on", [True, False])
@pytest.mark.parametrize("teach", [True, False])
@pytest.mark.parametrize("normal", [True, False])
def test_with_a_switch_to_teach_normal_counts_as_teach(mode: Mode, on: bool, teach: bool, normal: bool) -> None:
    """FD-1."""
    names = {"teach_first": on, "teach": teach, "normal": normal}
    settings = apply(Settings(), {f"free_drive.allowed_from.{name}": value for name, value in names.items()})
    assert teach_first(mode, settings) is (on and teach and mode in (Mode.NORMAL, Mode.RUN))
    expected = {Mode.TEACH: teach, Mode.NORMAL: normal or (on and teach)}
    assert may_enter(mode, "button", settings) is expected.get(mode, False)


def test_a_program_is_given_up_for_teach_and_free_drive_leads_back_there() -> None:
    """FD-1: a paused one, too."""
    for paused in (False, True):
        bench = Bench(free_drive__allowed_from__run=True, free_drive__allowed_from__teach_first=True, free_drive__period=0.5)
        bench.run(60)
        bench.step(Inputs(program=Program(steps=(Wait(duration=60.0),))))
        bench.step(Inputs(commands=(Command.START_PROGRAM,)))
        if paused:
            bench.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
        bench.run(60)
        bench.events.clear()
        assert bench.run(501, HOLD).mode is Mode.FREE_DRIVE
        assert [event.kind for event in bench.events[1:]] == [Kind.TEACH_FIRST, Kind.PROGRAM_STOPPED, Kind.ENTERED]
        assert bench.last.program is ProgramState.STOPPED
        bench.step(LET_GO)
        assert bench.run(260).mode is Mode.TEACH
