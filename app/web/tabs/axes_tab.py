"""The axes tab: what is free in free-drive, axis by axis and joint by joint, and how near a singularity is (FD-4)."""

from collections.abc import Callable
from typing import Any

import viser

from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings
from pendant.limits.axis_locks import AXES, JOINTS, PRESETS, freeing, freeing_joints
from pendant.limits.nearness import Nearness
from pendant.limits.settings import LockFrame
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot

NAMES = {name.capitalize(): name for name in PRESETS}
"""Presets by what is written on their buttons."""

EVERY = {"All free": True, "All locked": False}
"""What becomes of all joints at once."""

TOLD = {
    Nearness.OK: ("Away from singularities", "Locked axes hold.", Colour.GREEN),
    Nearness.NEAR: ("Near a singularity", "With a lock, further in is resisted.", Colour.AMBER),
    Nearness.TOO_NEAR: ("Too near a singularity", "Locks may give way. Turn back, or free them.", Colour.RED),
}


class AxesTab:
    """The tab. Its controls run on viser's event loop; `show` runs in the painter."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop = loop
        self._names = tuple(name.replace("_", " ").capitalize() for name in arm.chain.joints)
        self._settings: Settings | None = None
        self.now = Html(gui)
        self.preset = gui.add_button_group("Free", tuple(NAMES))
        self.free = {axis: gui.add_checkbox(_label(axis), True) for axis in AXES}
        self.tool = gui.add_checkbox("Axes of the tool", False)
        self.all = gui.add_button_group("Joints", tuple(EVERY))
        self._each = dict(zip(JOINTS, self._names, strict=False))
        self.joints = {joint: gui.add_checkbox(name, True, hint="Free in free-drive") for joint, name in self._each.items()}
        self.singularity = Html(gui)

        @self.preset.on_click
        async def _(_: viser.GuiEvent) -> None:
            loop.desk.set(freeing(PRESETS[NAMES[self.preset.value]]))

        @self.all.on_click
        async def _(_: viser.GuiEvent) -> None:
            count = len(self.joints)
            loop.desk.set(freeing_joints(frozenset(range(count)) if EVERY[self.all.value] else frozenset(), count))

        for axis, control in self.free.items():
            control.on_update(self._sets(f"axes.{axis}", control))
        for joint, control in self.joints.items():
            control.on_update(self._sets(f"joints.{joint}", control))

        @self.tool.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                loop.desk.set({"axes.frame": LockFrame.TOOL if self.tool.value else LockFrame.BASE})

    def show(self, snapshot: Snapshot) -> bool:
        """Show what is free and the nearness; True if anything changed."""
        settings = self._loop.settings
        fresh = settings is not self._settings
        if fresh:
            self._settings = settings
            for axis, control in self.free.items():
                _bring(control, getattr(settings.axes, axis))
            for joint, control in self.joints.items():
                _bring(control, getattr(settings.joints, joint))
            _bring(self.tool, settings.axes.frame is LockFrame.TOOL)
        return any([fresh, self.now.show(svg.facts(self._facts(settings, snapshot))), self.singularity.show(_told(snapshot))])

    def _facts(self, settings: Settings, snapshot: Snapshot) -> list[tuple[str, str]]:
        axes, joints = settings.axes, settings.joints
        locked = [axis for axis in AXES if not getattr(axes, axis)]
        if axes.frame is LockFrame.TOOL:
            frame = "tool, as it stands when locked"
        else:
            frame = "base, turned" if any((axes.roll, axes.pitch, axes.yaw)) else "base"
        held = [name for joint, name in self._each.items() if not getattr(joints, joint)]
        off = (bool(locked) and not axes.on) or (bool(held) and not joints.on)
        state = "switched off" if off else "hold" if snapshot.decision.locks is not None else "hold in free-drive"
        return [
            ("Axes locked", ", ".join(locked) or "none"),
            ("Axes of", frame),
            ("Joints locked", _many(held, len(self._names))),
            ("Locks", state if locked or held else "none"),
        ]

    def _sets(self, name: str, control: viser.GuiCheckboxHandle) -> Callable[[viser.GuiEvent], Any]:
        async def update(event: viser.GuiEvent) -> None:
            if event.client_id is not None:  # a person, and not the page bringing itself up to date
                self._loop.desk.set({name: control.value})

        return update


def _bring(control: viser.GuiCheckboxHandle, value: bool) -> None:
    if control.value != value:
        control.value = value


def _label(axis: str) -> str:
    return f"Turn about {axis[1].upper()}" if axis.startswith("r") else f"Move along {axis.upper()}"


def _many(held: list[str], count: int) -> str:
    """Locked joints in a line that is short enough."""
    if len(held) in (0, count):
        return "all" if held else "none"
    return ", ".join(held) if len(held) <= 2 else f"{len(held)} of {count}"


def _told(snapshot: Snapshot) -> str:
    nearness = snapshot.decision.singularity
    if nearness is None:
        return svg.note("Singularities", "Shown during free-drive.", Colour.GREY)
    return svg.note(*TOLD[nearness])
