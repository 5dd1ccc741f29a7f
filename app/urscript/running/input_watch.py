"""The watchdog that a script sets on an input of RTDE: its client must write it often enough."""

from app.robot_interface.controller.cabinet import Cabinet


class InputWatch:
    """Of the script that runs; looked at in its ticks."""

    def __init__(self, cabinet: Cabinet) -> None:
        self._cabinet = cabinet
        self._seen: dict[str, tuple[int, int]] = {}  # of an input: its count of writes, and the tick in which that changed

    def forget(self) -> None:
        """Another script begins."""
        self._seen.clear()

    def silent(self, name: str, longest: int) -> bool:
        """Whether the input was not written for more than so many ticks."""
        count, now = self._cabinet.writes.get(name, 0), self._cabinet.ticks
        seen = self._seen.get(name)
        if seen is None or seen[0] != count:
            self._seen[name] = (count, now)
            return False
        return now - seen[1] > longest
