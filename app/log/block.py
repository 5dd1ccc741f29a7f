"""What goes from the simulation's thread to the recorder's own: a block of ticks."""

from typing import Any, NamedTuple

import numpy as np

from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Event


class Picture(NamedTuple):
    """What is drawn of a tick. Poses are (7,): position [m], then quaternion wxyz, in W."""

    tick: int
    decision: Decision
    links: np.ndarray[Any, Any]  # (n + 2, 7)
    objects: np.ndarray[Any, Any]  # (m, 7)
    payload: np.ndarray[Any, Any] | None
    payload_mass: float  # [kg]
    touches: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...]


class Block(NamedTuple):
    """Ticks on their way to the file."""

    ticks: np.ndarray[Any, Any]  # (k,)
    numbers: np.ndarray[Any, Any]  # (k, ...) of /state
    codes: list[tuple[int, ...]]  # of each tick
    truth: np.ndarray[Any, Any]  # (k, ...) of /truth
    pictures: list[Picture]
    events: list[tuple[int, Event]]
    settings: list[tuple[int, Settings]]
