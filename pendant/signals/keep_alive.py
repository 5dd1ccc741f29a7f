"""A held control as a keep-alive (FD-23)."""


class KeepAlive:
    """Held from its first refresh until it is let go, at once, or silent for longer than allowed."""

    __slots__ = ("held", "silent")

    def __init__(self) -> None:
        self.held = False
        self.silent = 0  # ticks since the last refresh, while held

    def step(self, refreshed: bool, released: bool, silence: int) -> bool:
        """One tick.

        Args:
            refreshed: the hold was refreshed in this tick.
            released: the control was let go in this tick; this wins.
            silence: longest silence [ticks].

        Returns:
            True when the hold ends in this tick because of silence.
        """
        if released:
            self.held = False
        elif refreshed:
            self.held = True
            self.silent = 0
        elif self.held:
            self.silent += 1
            if self.silent > silence:
                self.held = False
                return True
        return False
