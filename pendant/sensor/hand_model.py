"""What is taken for a hand's force, and how sure is sure enough that it is none (FD-3, FD-19).

Rules and hypotheses of whose force it is know a hand by these numbers, and by the setting `unexplained.force`; benches `guided`,
`use`, `drop` and `drift` hold them.
"""

import math

from pendant.settings.schema import ticks

LARGEST = 50.0
"""A hand's largest force [N]: from here on the activation sequence takes a hand for what hinders the arm (FD-3)."""

RISE = 5.0
"""Ticks that it takes at least to get there: 10 ms."""

RISES = (1.0, 0.1, 0.01)
"""Of the fastest, shares of which a hand's rise may be: how fast one is nobody knows, so each order of magnitude is as likely.
Bench `drop` guards it."""

DEGREE = 4
"""Of the polynomial that its force is over some hundredths of a second: it may come, turn round, go. Bench `drop` guards it."""

TREMOR = 0.5
"""What it is off a straight line from tick to tick, and off a constant force within some windows, about [N]."""

LIGHT = 5.0
"""What the flange sensor feels may hang there; the work of a force below this [N] is a light hand's."""

GRIP_LEVER = 0.1
"""Lever of a hand's force about the flange [m]: its torques are so many times its forces."""

SLOWEST = 3.0
"""A hand that wants something changes its force faster [N/s]; what is slower may be a sensor's drift."""

TOUCH = ticks(0.5)
"""Ticks that a grab or a let-go lasts."""

KEEPS = 1.5
"""Time constant with which a change along gravity that stays becomes a payload's [s]: a sensor that drifts by 2 N/s stays below
3 N."""

LASTS = ticks(KEEPS)
"""Ticks for which who was felt may be there still: a hand that turns round is not felt for a while. Bench `guided` guards it."""

STEADY = 5.0
"""So long no hand holds still to within its tremor [s]; and so long it may lead a moving arm gently up or down."""

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
