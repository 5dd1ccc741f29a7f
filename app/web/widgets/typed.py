"""A text field that counts once nobody has typed for a while: of "above" the "ab" is not meant."""

import asyncio
from collections.abc import Callable

import viser

SETTLED = 0.6
"""So long [s]."""


class Typed:
    """Lives on viser's event loop.

    Args:
        field: of the page.
        meant: told what was typed, without blanks at its ends.
    """

    def __init__(self, field: viser.GuiTextHandle, meant: Callable[[str], None]) -> None:
        self._field, self._meant = field, meant
        self._waiting: asyncio.TimerHandle | None = None

        @field.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is None:  # the page brings itself up to date
                return
            if self._waiting is not None:
                self._waiting.cancel()
            self._waiting = asyncio.get_running_loop().call_later(SETTLED, self._settle)

    def bring(self, text: str) -> None:
        """Let the field say `text`, unless somebody types; a blank at its end is of what is typed next."""
        if self._waiting is None and self._field.value.strip() != text:
            self._field.value = text

    def _settle(self) -> None:
        self._waiting = None
        if text := self._field.value.strip():  # else it is only emptied
            self._meant(text)
