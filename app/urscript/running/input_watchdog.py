"""rtde_set_watchdog(): whether a client still writes an input as often as the program said."""

from app.robot_interface.controller.cabinet import Cabinet


class InputWatchdog:
    """Of one program.

    Args:
        cabinet: the robot.
    """

    def __init__(self, cabinet: Cabinet) -> None:
        self._cabinet = cabinet
        self._seen: dict[str, tuple[int, int]] = {}  # of an input: its count of writes, and when it changed [ticks]

    def late(self, name: str, silent: int, action: str) -> str:
        """That an input was not written in time, in words, or "".

        Args:
            name: of the input.
            silent: ticks that it may be so.
            action: that follows.
        """
        count, now = self._cabinet.writes.get(name, 0), self._cabinet.ticks
        seen = self._seen.get(name)
        if seen is None or seen[0] != count:
            self._seen[name] = (count, now)
            return ""
        return f"RTDE watchdog: {name} was not written in time; {action}" if now - seen[1] > silent else ""
