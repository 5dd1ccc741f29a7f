"""What a control of viser takes from anybody: the right kind of message, of the right type, within its range."""

import math
from typing import Any

import viser

from app.web.access.messages import Admitted, CommandTrigger, HoldMessage, Update, Upload, UploadPart

MAX_FILE = 48 * 1024
"""Largest file from a client: it comes in one message."""

MAX_TEXT = 200
"""Longest text that a control takes."""

MAX_LINES = 40_000
"""Longest text that a control of many lines takes: it comes in one message."""

LARGEST = 1e6
"""Largest number that is squared: the far plane of a camera and the pixels of a window are within it."""

OPEN = (None, None, None)
"""The ends of a range without ends, of each coordinate."""

LARGEST_VALUE = 2.0**53
"""Largest number that a control may be asked to take; its own range says the rest."""


def bounded(message: Admitted) -> bool:
    """Whether every number in a decoded message is finite, and small enough to be computed with."""
    return _within(message, LARGEST_VALUE if isinstance(message, Update) else LARGEST)


def _within(value: Any, most: float) -> bool:
    if isinstance(value, int | float):
        return math.isfinite(value) and abs(value) <= most
    if isinstance(value, dict):
        return all(_within(v, most) for v in value.values())
    if isinstance(value, tuple):
        return all(_within(v, most) for v in value)
    return all(_within(getattr(value, name), most) for name in getattr(value, "__struct_fields__", ()))


def reason_against(control: Any, message: Update | HoldMessage | CommandTrigger | Upload | UploadPart) -> str | None:
    """Why the control cannot be used like that by anybody, or None."""
    if isinstance(message, CommandTrigger):
        return "disabled control" if control.disabled else None
    if control.disabled or not control.visible:
        return "disabled control"
    if isinstance(message, Upload | UploadPart):
        if not isinstance(control, viser.GuiUploadButtonHandle):
            return "not an upload button"
        return None if _small(message) else "not a small file"
    if isinstance(message, HoldMessage):
        holdable = isinstance(control, viser.GuiButtonHandle) and message.frequency in control._hold_callback_freqs
        return None if holdable else "not a hold button"
    if set(message.updates) != {"value"}:
        return "attribute other than value"
    return None if _fits(control, message.updates["value"]) else "value not allowed"


def _small(message: Upload | UploadPart) -> bool:
    """Whether a file, or its content, comes in one piece that is small enough, under a name that can be printed."""
    if isinstance(message, UploadPart):
        return message.part_index == 0 and len(message.content) <= MAX_FILE
    texts = (message.filename, message.transfer_uuid, message.mime_type)
    return message.part_count == 1 and 0 < message.size_bytes <= MAX_FILE and all(map(_plain, texts))


def _plain(text: str) -> bool:
    """Whether a text is one short line without control characters: it may end up in a file, a log or a terminal."""
    return len(text) <= MAX_TEXT and text.isprintable()


def _lines(text: str) -> bool:
    """Whether a text is lines without control characters."""
    return len(text) <= MAX_LINES and text.replace("\n", "").replace("\t", "").isprintable()


def _fits(control: Any, value: Any) -> bool:
    """Whether `value` has the type and range of the control. Kinds of control that are not named here take nothing."""
    if isinstance(control, viser.GuiButtonHandle):
        return value is True
    if isinstance(control, viser.GuiCheckboxHandle):
        return isinstance(value, bool)
    if isinstance(control, viser.GuiSliderHandle):
        return type(value) in (int, float) and control.min <= value <= control.max
    if isinstance(control, viser.GuiNumberHandle):
        return type(value) in (int, float) and _between(control.min, value, control.max)
    if isinstance(control, viser.GuiVector3Handle):
        return isinstance(value, tuple) and all(map(_between, control.min or OPEN, value, control.max or OPEN))
    if isinstance(control, viser.GuiDropdownHandle | viser.GuiButtonGroupHandle):
        return isinstance(value, str) and value in control.options
    if isinstance(control, viser.GuiTextHandle):
        return isinstance(value, str) and (_lines(value) if control.multiline else _plain(value))
    return False


def _between(low: float | None, value: float, high: float | None) -> bool:
    """Whether `value` is in a range whose ends may be open."""
    return (low is None or low <= value) and (high is None or value <= high)
