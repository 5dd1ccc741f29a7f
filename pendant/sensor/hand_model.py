"""Model of a hand's force, and how sure is sure enough that a force is none of a hand's (FD-3, FD-19).

The rules and hypotheses that decide whose force it is use these numbers and the setting `unexplained.force`. The benches
`guided`, `use`, `drop` and `drift` check them.
"""

import math

from pendant.settings.schema import ticks

LARGEST = 50.0
"""Largest force of a hand [N]: as `free_drive.force_cap` ships (FD-3)."""

RISE = 5.0
"""Least number of ticks in which a hand's force rises from 0 to `LARGEST`: 10 ms."""

RISES = (1.0, 0.1, 0.01)
"""Assumed speeds at which a hand's force rises, as shares of the fastest (`RISE`). The true speed is unknown, so each order of
magnitude is equally likely. Bench `drop` checks them."""

DEGREE = 4
"""Degree of the polynomial that describes a hand's force over some hundredths of a second: the force may rise, change its sign
and fall. Bench `drop` checks it."""

TREMOR = 0.5
"""Typical deviation of a hand's force from a straight line between ticks, and from a constant force within some windows [N]."""

LIGHT = 5.0
"""The work of a measured force below this counts as that of a light hand [N]. A larger force that lasts may be the weight of
something that hangs at the flange."""

GRIP_LEVER = 0.1
"""Lever of a hand's force about the flange [m]: the torque is the force times this."""

SLOWEST = 3.0
"""Slowest change of force by a hand that leads the arm [N/s]; a slower change may be a sensor's drift."""

TOUCH = ticks(0.5)
"""Ticks in which a hand takes hold of the arm or lets it go."""

KEEPS = 1.5
"""Time constant with which a lasting change of force along gravity is counted as payload [s]: with it a sensor that drifts by
2 N/s shows less than 3 N."""

LASTS = ticks(KEEPS)
"""Ticks for which a hand that was felt may still be there: while a hand changes its direction it is not felt. Bench `guided`
checks it."""

STEADY = 5.0
"""No hand keeps its force constant, within `TREMOR`, for longer than this [s]. Nor does a hand lead a moving arm gently up or
down for longer."""

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
