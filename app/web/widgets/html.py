"""Pieces of the page that are sent only when they differ from what is shown."""

from typing import Any

import viser


class Html:
    """A piece of HTML."""

    def __init__(self, gui: viser.GuiApi, content: str = "", order: float | None = None) -> None:
        self.shown = content
        self._handle = gui.add_html(content, order=order)

    def show(self, content: str) -> bool:
        """Show `content`; True if that changed anything."""
        if content == self.shown:
            return False
        self.shown = content
        self._handle.content = content
        return True

    def remove(self) -> None:
        """Take it away."""
        self._handle.remove()


def enable(control: Any, enabled: bool) -> bool:
    """Let a control of viser be used, or not; True if that changed anything."""
    if control.disabled == (not enabled):
        return False
    control.disabled = not enabled
    return True


def reveal(control: Any, visible: bool) -> bool:
    """Let a control of viser be seen, or not; True if that changed anything."""
    if control.visible == visible:
        return False
    control.visible = visible
    return True


def bring(control: Any, value: bool | str) -> bool:
    """Let a control of viser say `value`; True if that changed anything."""
    if control.value == value:
        return False
    control.value = value
    return True
