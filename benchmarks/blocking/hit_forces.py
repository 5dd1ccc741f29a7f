"""The picture of the forces of hits: over the speed, with the protective stop and without it."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple


class HitForces(NamedTuple):
    """One hit."""

    speed: float  # [m/s]
    stiffness: float  # [N/m]
    stopped: float  # largest force with the protective stop [N]
    free: float  # and without it [N]


def draw(hits: Sequence[HitForces], edges: Sequence[float], path: Path) -> None:
    """Write the picture: the largest force of each hit over its speed, a colour for each range of stiffness [N/m]."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    for axes, title, of in zip(
        figure.subplots(1, 2, sharey=True), ("with the protective stop", "without it"), ("stopped", "free"), strict=True
    ):
        for soft, stiff in pairwise(edges):
            some = [hit for hit in hits if soft <= hit.stiffness < stiff]
            forces = [getattr(hit, of) for hit in some]
            axes.plot([1e3 * hit.speed for hit in some], forces, ".", label=f"{soft:g} to {stiff:g} N/m")
        axes.set(xscale="log", yscale="log", xlabel="speed at the touch [mm/s]", title=title)
        axes.grid(visible=True, which="both", alpha=0.2)
    figure.axes[0].set_ylabel("largest force [N]")
    figure.axes[1].legend(loc="lower right", fontsize=8)
    figure.savefig(path, dpi=110, pil_kwargs={"quality": 80})
