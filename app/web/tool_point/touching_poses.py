"""The tool centre point from four poses of the flange in which the tool's tip touches the same point, from other sides."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from app.web.widgets.svg import Colour
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]

WANTED = 4
"""Poses; more make the point better."""

MOST = 12

FIRMEST = 5.0
"""An error of 1 mm in touching may move the point by so many millimetres; else the poses are turned too little."""

ROUGH = 0.003
"""A touch further from the common point than this is told [m]."""


class FlangePose(NamedTuple):
    """Where the flange was, in B."""

    p: Array  # (3,) [m]
    R: Array  # (3, 3)


class TipPoint(NamedTuple):
    """A tool centre point that was found."""

    tcp: tuple[float, float, float]  # p_FT [m]
    worst: float  # distance of the furthest touch from the common point [m]


def tip_of(poses: Sequence[FlangePose]) -> TipPoint | None:
    """The point of the tool that all flange poses bring to one place, by least squares.

    Each pose says p + R t = c, with t the same in the flange and c the same in the base. What the mean over the poses leaves,
    (R - mean R) t = -(p - mean p), is solved for t; the smallest singular value of the left side over the root of the number of
    poses is how much of an error comes through.

    Returns:
        None where the poses are turned too little, or about one axis only, to tell.
    """
    p, R = np.array([pose.p for pose in poses]), np.array([pose.R for pose in poses])
    turned, moved = (R - R.mean(axis=0)).reshape(-1, 3), (p - p.mean(axis=0)).reshape(-1)
    if float(np.linalg.svd(turned, compute_uv=False)[-1]) < math.sqrt(len(poses)) / FIRMEST:
        return None
    t = np.linalg.lstsq(turned, -moved, rcond=None)[0]
    touched = p + R @ t
    x, y, z = t.tolist()
    return TipPoint((x, y, z), float(np.linalg.norm(touched - touched.mean(axis=0), axis=1).max()))


def flange_of(snapshot: Snapshot) -> FlangePose:
    """Where the flange is, as the controller knows it."""
    return FlangePose(snapshot.estimate.p_BF.copy(), snapshot.estimate.R_BF.copy())


class TouchingPoses:
    """A folder of the tools' tab. Lives on viser's event loop; `show` runs in the painter, which is there, too.

    Args:
        gui: of the page.
        latest: tells the newest snapshot.
        found: told of the tool centre point p_FT [m] that is to be taken.
    """

    def __init__(
        self, gui: viser.GuiApi, latest: Callable[[], Snapshot], found: Callable[[tuple[float, float, float]], None]
    ) -> None:
        self._poses: list[FlangePose] = []
        self._tip: TipPoint | None = None
        with gui.add_folder("TCP from four poses", expand_by_default=False):
            self.take = gui.add_button("Take this pose", color="gray", hint="The tip touches a fixed point")
            self.again = gui.add_button("Forget the poses", color="gray", disabled=True)
            self.use = gui.add_button("Set the tool's TCP", color="gray", disabled=True, hint="Of the tool chosen above")
            self.said = Html(gui)

        @self.take.on_click
        async def _(_: viser.GuiEvent) -> None:
            if len(self._poses) < MOST:
                self._poses.append(flange_of(latest()))
                self._tip = tip_of(self._poses) if len(self._poses) >= WANTED else None

        @self.again.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._poses, self._tip = [], None

        @self.use.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self._tip is not None:
                found(self._tip.tcp)
                self._poses, self._tip = [], None

    def show(self, locked: bool) -> bool:
        """Show what was found; a tool cannot be changed while `locked`. True if anything changed."""
        return any(
            [
                enable(self.take, len(self._poses) < MOST),
                enable(self.again, bool(self._poses)),
                enable(self.use, self._tip is not None and not locked),
                self.said.show(self._told()),
            ]
        )

    def _told(self) -> str:
        count = len(self._poses)
        if count < WANTED:
            what = "Bring the tip to one fixed point, each time with the tool turned otherwise, by 30° or more."
            return svg.fine_print(f"{count} of {WANTED} poses taken. {what}" if count else what)
        if self._tip is None:
            return svg.note("No point found", "The tool was turned too little, or about one axis only: take more.", Colour.AMBER)
        where = ", ".join(f"{1000.0 * way:.1f}" for way in self._tip.tcp) + " mm"
        rough = self._tip.worst > ROUGH
        text = f"{where}. The furthest of {count} touches is {1000.0 * self._tip.worst:.1f} mm off."
        return svg.note("TCP found", text + (" Take them again?" if rough else ""), Colour.AMBER if rough else Colour.GREEN)
