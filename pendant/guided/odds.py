"""The odds at which a payload has changed, or the flange sensor has stepped; and at which it may have (FD-19)."""

import math

from pendant.settings.schema import ticks

TOUCHES = 2000.0
"""Of so many grabs and let-goes at most one may be taken for a payload that falls (bench `observer`, `drop`)."""

TOUCH = ticks(0.5)
"""Ticks that one lasts."""

KNOWN = math.log(TOUCHES * TOUCH)
"""Log of the odds from which on it is known [nats]: else odds of K come up in one of K trials at most (Ville)."""

SUSPECTED = math.log(20.0)
"""From here on a payload may have changed, and nothing helps a hand: the help may be gone in one tick of 20. A sensor may have
stepped until a hand is as much likelier, for the help for a step moves an arm that nobody touches."""
