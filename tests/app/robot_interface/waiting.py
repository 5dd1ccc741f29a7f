"""Waiting for a served robot: a busy machine is late."""

import time
from collections.abc import Callable

import numpy as np
from rtde_receive import RTDEReceiveInterface

HOME = [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]
ASIDE = [0.2, *HOME[1:]]


def at(seen: RTDEReceiveInterface) -> np.ndarray:
    return np.array(seen.getActualQ())


def until(true: Callable[[], bool], patience: float = 20.0) -> None:
    """Wait for it: a busy machine is late."""
    end = time.monotonic() + patience
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def settled(seen: RTDEReceiveInterface, patience: float = 20.0) -> np.ndarray:
    """Joint angles when the arm stands."""
    until = time.monotonic() + patience
    while time.monotonic() < until:
        time.sleep(0.05)
        if np.abs(seen.getActualQd()).max() < 2e-3:
            return at(seen)
    raise AssertionError("the arm goes on moving")
