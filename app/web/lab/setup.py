"""Set-up of the laboratory, made before the arm is switched on: arm, mounting, tool, world, seed, mismatch."""

import math
from collections.abc import Awaitable, Callable

import msgspec
import viser

from app.files.checked import BadInput, load
from app.files.library import load_tool, tools
from app.runs.runner import simulate
from app.session.prepare import MOUNTINGS, Prepared
from app.session.session_file import WorldSection, bundled, folder
from app.web.running import Running
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, ToolModel

AS_IS = "as it is"
NOTHING = "nothing"


class LabSetup:
    """A folder of the cell's tab: takes effect when the simulation begins again."""

    def __init__(self, gui: viser.GuiApi, loop: Running, arm: Arm) -> None:
        self._loop, self._arm = loop, arm
        self._change_arm: Callable[[str], Awaitable[None]] | None = None
        with gui.add_folder("Robot and world"):
            self.arm = gui.add_dropdown("Arm", (arm.name,), hint="Another one begins as it was kept, or as shipped")
            self.mounting = gui.add_dropdown("Mounting", (AS_IS, *MOUNTINGS))
            self.tilt = gui.add_slider("Tilt [°]", min=-90, max=90, step=5, initial_value=0)
            self.tool = gui.add_dropdown("Tool", (AS_IS, *tools()))
            self.world = gui.add_dropdown("World", (AS_IS, NOTHING, *bundled("worlds")))
            self.seed = gui.add_number("Seed", 0, min=0, max=2**31 - 1, step=1)
            self.mismatch = gui.add_checkbox("Controller mismatch", True)
            self.begin = gui.add_button("Restart with this set-up", color="gray")
            self.message = Html(gui)

        @self.begin.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self.arm.value != self._arm.name and self._change_arm is not None:
                await self._change_arm(self.arm.value)
                return
            self._begin(Prepared(self._arm, self.chosen(), self._loop.settings, None, "the page"))

    def offer_arms(self, names: tuple[str, ...], change: Callable[[str], Awaitable[None]]) -> None:
        """Offer these arms; `change` changes to the chosen arm."""
        self._change_arm = change
        self.arm.options = names if self._arm.name in names else (self._arm.name, *names)
        self.arm.value = self._arm.name

    def _begin(self, prepared: Prepared) -> None:
        try:
            simulate(prepared)
        except BadInput as refusal:
            self.message.show(svg.note("Refused", str(refusal), Colour.AMBER))
            return
        self.message.show(svg.note("Restarted", f"With the set-up of {prepared.where}.", Colour.GREEN))
        self._loop.begin(lambda: simulate(prepared))

    def chosen(self) -> Scenario:
        """The scenario that the controls ask for. What no control changes stays as in the running scenario."""
        now, fitting = self._loop.scenario, self._loop.latest().decision.estimator.fitting
        mounting = now.mounting if self.mounting.value == AS_IS else MOUNTINGS[self.mounting.value]
        tilt = math.radians(float(self.tilt.value))
        world = now.world
        if self.world.value == NOTHING:
            world = []
        elif self.world.value != AS_IS:
            world = load(folder("worlds") / f"{self.world.value}.yaml", WorldSection).objects
        return msgspec.structs.replace(
            now,
            mounting=[mounting[0], mounting[1] + tilt, mounting[2]],
            tool=now.tool if self.tool.value == AS_IS else load_tool(self.tool.value),
            tools=[
                tool for tool in self._loop.tools if isinstance(tool, ToolModel)
            ],  # as they were edited; the app has no others
            payload_true=self._loop.payload_true,
            payload_configured=now.payload_configured if fitting is None else fitting.load,
            world=world,
            walls=list(self._loop.walls),
            seed=int(self.seed.value),
            mismatch="nominal" if not self.mismatch.value else "on" if now.mismatch == "nominal" else now.mismatch,
        )
