"""What is taken for a hand's force: the numbers that tell it from a payload's weight and from a sensor's drift (FD-3, FD-19).

Rules and hypotheses of whose force it is know a hand by these, and by the setting `unexplained.force`; benches `guided`, `use`,
`drop` and `drift` hold them.
"""

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
