"""The served cell as a test sees it: waiting for states, projecting points to pixels, measuring motion of the true arm."""

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Page

from app.web.scene.arm_picture import frames_of
from app.web.server import Served
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.tick.modes import TICK_RATE
from sim.arm.frames import matrix_from_quaternion
from sim.run.loop import Loop
from tests.e2e.finger import pointer

Array = NDArray[np.float64]

SETTINGS = apply(
    Settings(),
    {"free_drive.period": 30.0, "free_drive.restart_period": 30.0, "free_drive.cool_down": 0.3, "hold.silence": 1.0},
)
"""Software rendering takes seconds for what a hand does at once: from the button to the arm within the shipped 3 s is luck, and a
page that stalls for the shipped half second has let go of a button that is held (FD-23). The pause after a leaving is shorter."""


class Cell:
    """A running loop and its web app."""

    def __init__(self, loop: Loop, served: Served) -> None:
        self.loop = loop
        self.served = served
        self._frames = frames_of(loop.simulation.arm)

    def wait(self, true: Callable[[], bool], what: str, seconds: float = 20.0) -> None:
        """Wait for a state."""
        end = time.monotonic() + seconds
        while not true():
            assert time.monotonic() < end, f"waited {seconds} s in vain: {what}; {self.told()}"
            time.sleep(0.01)

    def pass_time(self, seconds: float) -> None:
        """Wait for simulated time to pass."""
        end = self.loop.latest().tick + round(seconds * TICK_RATE)
        self.wait(lambda: self.loop.latest().tick >= end, f"{seconds} s of simulated time", 20.0 + 5 * seconds)

    def happened(self, kind: Kind) -> bool:
        """Whether an event of that kind has happened."""
        return any(event.kind is kind for event in self.loop.events(0))

    def told(self) -> str:
        """The last events, for a test that fails."""
        return ", ".join(f"{event.tick} {event.kind} {event.values}" for event in self.loop.events(0)[-8:])

    def position(self, part: str, point: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Array:
        """Where a point of a part truly is now, in W [m]."""
        pose = self.loop.latest().truth_links[self._frames[part]]
        return pose[:3] + matrix_from_quaternion(pose[3:]) @ np.array(point)

    def grip(self) -> tuple[str, tuple[float, float, float]]:
        """Part and point of the one hand that holds the arm; waits for it."""
        grips = self.served.hand._grips
        self.wait(lambda: len(grips) == 1, "one hand holds the arm")
        grip = next(iter(grips.values()))
        return grip.part, grip.point

    def pixel(self, page: Page, client: int, point: Array) -> tuple[float, float]:
        """Where a point of W is in the window."""
        camera = self.served.server.get_clients()[client].camera
        seen = matrix_from_quaternion(camera.wxyz).T @ (point - camera.position)
        box = page.locator("canvas").first.bounding_box()
        assert box is not None
        focal = box["height"] / 2 / math.tan(camera.fov / 2)
        return box["x"] + box["width"] / 2 + focal * seen[0] / seen[2], box["y"] + box["height"] / 2 + focal * seen[1] / seen[2]

    def drag(self, page: Page, client: int, point: Array, by: tuple[float, float]) -> None:
        """Press on a point of the arm in W and move the pointer by so many pixels, without letting go.

        The page draws late what it is told: a press before it shows that the pointer is on the arm would turn the camera.
        """
        x, y = self.pixel(page, client, point)
        hand = pointer(page)
        if not hand.touches:  # a finger hovers over nothing: it turns the camera then, and the drag is tried again
            self.wait(lambda: self._on_the_arm(page, x, y), "the pointer is on the arm")
        hand.down((x, y))
        hand.move((x + by[0] / 4, y + by[1] / 4))
        hand.move((x + by[0], y + by[1]), steps=6)

    def _on_the_arm(self, page: Page, x: float, y: float) -> bool:
        page.mouse.move(x + 1.0, y)
        page.mouse.move(x, y)
        page.wait_for_timeout(100)
        return bool(page.evaluate("[...document.querySelectorAll('canvas')].some(canvas => canvas.style.cursor === 'pointer')"))
