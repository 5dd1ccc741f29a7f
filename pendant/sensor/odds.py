"""Odds from which a change of payload, or a step of the flange sensor's zero, counts as known or as possible (FD-19)."""

import math

from pendant.sensor.hand_model import TOUCH

TOUCHES = 2000.0
"""Number of times that a hand takes hold or lets go, of which at most one may count as a falling payload (benches `observer`,
`drop`)."""

KNOWN = math.log(TOUCHES * TOUCH)
"""Log of the odds from which a change counts as known [nats]. Without a change, odds of K are reached in at most one of K trials
(Ville's inequality)."""

SUSPECTED = math.log(20.0)
"""Log of the odds from which a payload may have changed [nats]. Then the hand gets no help from the motors: in at most one of 20
ticks by mistake. A step of the sensor is possible until a hand is 20 times likelier, because help for a step would move an arm
that nobody touches."""

NOISE = 0.1
"""Share of the ticks in which a payload has fallen, and noise lets the joints feel something else. Bench `guided` checks it."""

RARELY = 3.29
"""Standard deviations that an error exceeds once in a thousand times."""

HALF = 0.5
"""Share of a required or allowed value that is the threshold, where no model gives the expected value."""
