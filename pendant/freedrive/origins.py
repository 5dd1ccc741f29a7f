"""The modes from which free-drive can be entered (FD-1)."""

from pendant.all_settings import Settings
from pendant.signals.sources import REMOTE_CONTROLLER
from pendant.tick.modes import Mode


def may_enter(mode: Mode, source: str, settings: Settings) -> bool:
    """Free-drive can be entered from `mode`, asked for by `source`; from REMOTE by the remote controller, and by nobody else."""
    if mode is Mode.REMOTE or source == REMOTE_CONTROLLER.source:
        return mode is Mode.REMOTE and source == REMOTE_CONTROLLER.source
    allowed = settings.free_drive.allowed_from
    normal = allowed.normal or (allowed.teach and allowed.teach_first)
    return (mode is Mode.TEACH and allowed.teach) or (mode is Mode.NORMAL and normal) or (mode is Mode.RUN and allowed.run)


def teach_first(mode: Mode, settings: Settings) -> bool:
    """Free-drive that begins in `mode` begins with a switch to TEACH."""
    allowed = settings.free_drive.allowed_from
    return allowed.teach and allowed.teach_first and mode in (Mode.NORMAL, Mode.RUN)


def origins(source: str, settings: Settings) -> str:
    """The modes from which `source` can ask for free-drive, as text."""
    return ", ".join(mode for mode in Mode if may_enter(mode, source, settings)) or "none"
