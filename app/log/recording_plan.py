"""What of a run is recorded: how often each topic, and how long a file of it is."""

from typing import NamedTuple

from app.files.bad_input import BadInput
from pendant.tick.modes import TICK, TICK_RATE
from sim.run.loop import SNAPSHOT_TICKS

LONGEST_SPLIT = 24 * 60.0
"""Of a file of a recording in parts [min]."""


class RecordingPlan(NamedTuple):
    """Ticks from one message to the next. Between them nothing is kept, and so no peak that lies there."""

    state: int = 1
    truth: int = 1
    pictures: int = SNAPSHOT_TICKS
    split: int = 0  # ticks of a file; 0: all is in one

    @property
    def thinned(self) -> dict[str, int]:
        """The topics that have fewer messages than there could be, with the ticks from one to the next."""
        most = RecordingPlan()
        found = {"state": (self.state, most.state), "truth": (self.truth, most.truth), "pictures": (self.pictures, most.pictures)}
        return {topic: ticks for topic, (ticks, least) in found.items() if ticks != least}


ALL = RecordingPlan()
"""All that there is, in one file."""


def recording_plan(rates: str | None, split: float | None) -> RecordingPlan:
    """What the options of a command ask for.

    Args:
        rates: such as "state=50,truth=10,pictures=5", messages a second; a topic that is not named has all.
        split: minutes of a file; None: all is in one.

    Raises:
        BadInput: a topic does not exist, or a rate is none that there can be.
    """
    ticks: dict[str, int] = {}
    for part in (rates or "").split(",") if rates else ():
        topic, equals, number = part.strip().partition("=")
        if topic not in ("state", "truth", "pictures") or not equals:
            raise BadInput("--record-rates", "", part, "state=RATE, truth=RATE or pictures=RATE, with commas between")
        ticks[topic] = _ticks(topic, number)
    if split is not None and not TICK <= split <= LONGEST_SPLIT:
        raise BadInput("--record-split", "", split, f"minutes, up to {LONGEST_SPLIT:g}")
    return RecordingPlan(**ticks, split=0 if split is None else round(60.0 * split * TICK_RATE))


def _ticks(topic: str, number: str) -> int:
    """From one message to the next."""
    unit = SNAPSHOT_TICKS if topic == "pictures" else 1
    most = TICK_RATE / unit
    try:
        rate = float(number)
    except ValueError:
        rate = 0.0
    if not 0.01 <= rate <= most:
        raise BadInput("--record-rates", topic, number, f"0.01 to {most:g} a second")
    return unit * round(most / rate)
