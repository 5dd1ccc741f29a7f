"""Jogging: a motion of one joint, or of the tool along or about one axis, for as long as a button is held."""

import math
from typing import Literal

from pendant.program.steps import Move

LONGEST = 1.0
"""Of a single step [m or rad]."""

TURNS = 3
"""Axes from here on are turned about: x, y, z along, then x, y, z about."""


class JogMove(Move, tag="jog", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One joint, or the tool centre point along (0, 1, 2) or about (3, 4, 5) an axis of the base or of the tool."""

    frame: Literal["joint", "base", "tool"]
    axis: int  # from 0: of the joint, or of x, y, z along, then x, y, z about
    sign: Literal[-1, 1]
    length: float = 0.0  # after which it ends by itself [m or rad]; 0: it goes on while the button is held

    @property
    def what(self) -> str:
        """The motion in words."""
        sign = "+" if self.sign > 0 else "-"
        if self.frame == "joint":
            return f"joint {self.axis + 1} {sign}"
        return f"{self.frame} {('x', 'y', 'z', 'rx', 'ry', 'rz')[self.axis]} {sign}"


def unfit(move: JogMove, n_joints: int) -> str | None:
    """Why an arm of `n_joints` cannot be jogged like that, or None."""
    count = n_joints if move.frame == "joint" else 2 * TURNS
    if not 0 <= move.axis < count:
        return f"axis {move.axis}, allowed: 0 .. {count - 1}"
    if not (math.isfinite(move.length) and 0.0 <= move.length <= LONGEST):
        return f"length {move.length:g}, allowed: 0 .. {LONGEST:g}"
    return None
