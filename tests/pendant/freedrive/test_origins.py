"""The modes from which free-drive can be entered (FD-1)."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.freedrive.origins import may_enter, origins
from pendant.inputs import Command, Inputs
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
    assert {mode for mode in Mode if may_enter(mode, settings)} == {Mode.NORMAL, Mode.TEACH, Mode.RUN}
    assert origins(settings) == "NORMAL, TEACH, RUN"
