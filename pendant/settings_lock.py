"""Settings at run time: limits are locked while the arm moves by hand or by program, and while free-drive is being activated."""

from pendant.all_settings import Settings, apply, find, value_of
from pendant.events.event import Event, Kind
from pendant.settings.schema import SettingError, Value
from pendant.tick.modes import Mode


def locked(mode: Mode, trying: bool) -> str:
    """Where no limit, wall or area may change, if that is now; else "".

    Args:
        mode: of the robot.
        trying: free-drive is being activated, from the signal on.
    """
    if not trying and mode not in (Mode.RUN, Mode.FREE_DRIVE):
        return ""
    return str(mode) if mode is Mode.FREE_DRIVE or not trying else "the activation of free-drive"


def change(settings: Settings, changes: dict[str, Value], *, mode: Mode, trying: bool, tick: int) -> tuple[Settings, list[Event]]:
    """The settings after the changes that are allowed, each on its own, and what became of every change.

    Args:
        settings: as they are.
        changes: by dotted name.
        mode: of the robot.
        trying: free-drive is being activated, from the signal on.
        tick: for the events.
    """
    events: list[Event] = []
    for name, value in changes.items():
        try:
            if find(name).locked and (where := locked(mode, trying)):
                raise SettingError(name, value, f"no change of a limit in {where}")
            old = value_of(settings, name)
            settings = apply(settings, {name: value})
        except SettingError as error:
            events.append(Event(Kind.SETTING_REFUSED, tick, {"name": name, "value": value, "reason": error.allowed}))
            continue
        new = value_of(settings, name)
        if new != old:
            events.append(Event(Kind.SETTING_CHANGED, tick, {"name": name, "old": old, "new": new}))
    return settings, events
