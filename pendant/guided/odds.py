"""How likely is enough: the odds at which a payload has changed, or the flange sensor has stepped, and at which it may have (FD-19)."""

import math

from pendant.settings.schema import ticks

TOUCHES = 2000.0
"""Of so many grabs and let-goes at most one may be taken for a payload that falls, or a sensor that steps (bench `observer`, `drop`)."""

TOUCH = ticks(0.5)
"""Ticks that one lasts."""

KNOWN = math.log(TOUCHES * TOUCH)
"""Log of the odds from which on it is known [nats]: else odds of K come up in one of K trials at most (Ville)."""

SUSPECTED = math.log(20.0)
"""And from which on nothing helps a hand, for a payload that falls and a sensor that steps seem to be one: the help may be gone
in one tick of 20."""
