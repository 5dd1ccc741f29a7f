"""The modes from which free-drive can be entered (FD-1)."""

from pendant.all_settings import Settings
from pendant.tick.modes import Mode


def may_enter(mode: Mode, settings: Settings) -> bool:
    """Free-drive can be entered from `mode`."""
    allowed = settings.free_drive.allowed_from
    return (
        (mode is Mode.TEACH and allowed.teach) or (mode is Mode.NORMAL and allowed.normal) or (mode is Mode.RUN and allowed.run)
    )


def origins(settings: Settings) -> str:
    """The modes from which free-drive can be entered, as text."""
    return ", ".join(mode for mode in Mode if may_enter(mode, settings)) or "none"
