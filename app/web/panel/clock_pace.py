"""Whether this machine keeps up with the clock, as a state and not as a row of events."""

from app.web.running import Running
from app.web.widgets.svg import Colour, PaceWord

KEPT_UP = 0.95
"""From this share of the wanted rate on, the machine keeps up."""


def pace(loop: Running) -> PaceWord:
    """The state of the loop's clock."""
    if loop.paused:
        return PaceWord("Paused", Colour.AMBER, "The simulation's clock stands still.")
    wanted, actual = loop.speed, loop.actual_rate
    if actual >= KEPT_UP * wanted:
        word = "On time" if wanted == 1.0 else f"{wanted:.1f} ×"
        return PaceWord(word, Colour.GREEN, f"Simulated time runs at {wanted:.1f} of real time, as wanted.")
    line = (
        f"Simulated time runs at {actual:.1f} of real time, wanted is {wanted:.1f}: the machine is busy. "
        f"In all {loop.dropped:.0f} s were dropped. What is simulated stays exact."
    )
    return PaceWord(f"Late: {actual:.1f} ×", Colour.AMBER, line)
