"""Which settings change at run time, and what is said where one does not."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.settings_lock import change
from pendant.tick.modes import Mode

LIMIT, FREE = "limits.activation.user_force.max", "free_drive.period"
START = Settings()


@pytest.mark.parametrize(
    ("mode", "trying", "where"),
    [
        (Mode.TEACH, False, None),
        (Mode.NORMAL, False, None),
        (Mode.STOP, False, None),
        (Mode.TEACH, True, "the activation of free-drive"),
        (Mode.NORMAL, True, "the activation of free-drive"),
        (Mode.RUN, False, Mode.RUN),
        (Mode.RUN, True, "the activation of free-drive"),
        (Mode.FREE_DRIVE, False, Mode.FREE_DRIVE),
        (Mode.FREE_DRIVE, True, Mode.FREE_DRIVE),
    ],
)
def test_limits_are_locked_where_the_arm_may_be_touched(mode: Mode, trying: bool, where: str | None) -> None:
    """One that is locked keeps no other change off."""
    settings, events = change(START, {LIMIT: 14.0, FREE: 5.0}, mode=mode, trying=trying, tick=7)
    free = Event(Kind.SETTING_CHANGED, 7, {"name": FREE, "old": START.free_drive.period, "new": 5.0})
    if where is None:
        old = START.limits.activation.user_force.max
        assert events == [Event(Kind.SETTING_CHANGED, 7, {"name": LIMIT, "old": old, "new": 14.0}), free]
        assert settings == apply(START, {LIMIT: 14.0, FREE: 5.0})
    else:
        reason = f"no change of a limit in {where}"
        assert events == [Event(Kind.SETTING_REFUSED, 7, {"name": LIMIT, "value": 14.0, "reason": reason}), free]
        assert settings == apply(START, {FREE: 5.0})


def test_a_value_that_is_not_allowed_or_not_new_changes_nothing() -> None:
    settings, events = change(
        START, {FREE: -1.0, LIMIT: START.limits.activation.user_force.max}, mode=Mode.TEACH, trying=False, tick=0
    )
    assert settings == START
    assert [event.kind for event in events] == [Kind.SETTING_REFUSED]
