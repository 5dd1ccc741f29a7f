"""How sure is sure enough: that a payload has changed, that the flange sensor has stepped, that it may have (FD-19)."""

import math

from pendant.sensor.hand_model import TOUCH

TOUCHES = 2000.0
"""Of so many grabs and let-goes at most one may be taken for a payload that falls (bench `observer`, `drop`)."""

KNOWN = math.log(TOUCHES * TOUCH)
"""Log of the odds from which on it is known [nats]: else odds of K come up in one of K trials at most (Ville)."""

SUSPECTED = math.log(20.0)
"""From here on a payload may have changed, and nothing helps a hand: the help may be gone in one tick of 20. A sensor may have
stepped until a hand is as much likelier, for the help for a step moves an arm that nobody touches."""

NOISE = 0.1
"""Share of the ticks in which noise may make something else of a fall, as the joints feel it. Bench `guided` guards it."""

RARELY = 3.29
"""Standard deviations that an error exceeds once in a thousand times."""

HALF = 0.5
"""Of what is asked for, or allowed, this share decides where no model says how much of it is to be expected."""
