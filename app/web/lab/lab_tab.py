"""The laboratory: scenarios, the clock, the hand, and changes of the true arm, its payload and its sensors."""

from collections.abc import Callable
from typing import Any

import viser

from app.robot_interface.interfaces import RobotInterfaces
from app.web.lab.scenarios import Scenarios
from app.web.lab.setup import LabSetup
from app.web.lab.wires import Wires
from app.web.running import Running
from app.web.scene.virtual_hand import FORCE, VirtualHand
from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from pendant.tick.modes import TICK_RATE, Mode, Phase
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load
from sim.exchange.snapshot import Snapshot
from sim.plant.changes import AttachPayload, DriveGripper, DropPayload, FrictionChange, SensorFault, Temperature

ROOM = 25.0
"""Temperature of the joints at which the slider starts [°C]."""


def gripped(snapshot: Snapshot) -> list[tuple[str, str]]:
    """State of the gripper: names and texts for the page."""
    state = snapshot.gripper
    if state is None:
        return [("Gripper", "none: choose a tool that has one")]
    share = f", {100.0 * state.taken:.0f} % of what it can hold" if state.held else ""
    found = [("Holds", (state.held or "nothing") + share)]
    return [("Opening", f"{1000.0 * state.opening:.0f} mm, {state.force:.0f} N"), *found] if state.stroke else found


class Lab:
    """The laboratory's tab."""

    def __init__(
        self,
        gui: viser.GuiApi,
        loop: Running,
        hand: VirtualHand,
        arm: Arm,
        *,
        setup: LabSetup,
        interfaces: RobotInterfaces | None = None,
    ) -> None:
        self._gui, self._loop, self._hand, self._arm = gui, loop, hand, arm
        self._shown: object = None
        self._number = 0  # of the last change of tool or payload
        self.scenarios = Scenarios(gui, loop, arm)
        self.clock = gui.add_button_group("Clock", ("Go on", "Freeze", "Step"))
        self.speed = gui.add_slider("Speed", min=0.1, max=1.0, step=0.1, initial_value=1.0)
        self.restart = gui.add_button("Start over", color="gray")
        self.rates = Html(gui)
        self.force = gui.add_slider("Hand [N]", min=FORCE[0], max=FORCE[2], step=5.0, initial_value=FORCE[1])
        self._payload()
        self._faults()
        self.wires = Wires(gui, loop, interfaces)
        self.setup = setup
        self.start_over: Callable[[], object] = loop.reset
        self._connect()
        self._connect_gripper()

    def show(self, snapshot: Snapshot) -> bool:
        """Show a snapshot; True if anything changed."""
        state = "paused" if self._loop.paused else f"{self._loop.actual_rate:.2f} ×"
        pairs = [
            ("Time", f"{snapshot.tick / TICK_RATE:.1f} s"),
            ("Rate asked, real", f"{self._loop.speed:.1f} ×, {state}"),
            ("Time dropped", f"{self._loop.dropped:.1f} s"),
            ("Seed", f"{self._loop.seed}"),
        ]
        decision = snapshot.decision
        locked = decision.mode in (Mode.FREE_DRIVE, Mode.RUN) or decision.phase is Phase.SEQUENCE
        if self._loop.scenario is not self._shown:
            self._shown = self._loop.scenario
            self._back(snapshot)
        fitting = decision.estimator.fitting
        if fitting is not None and fitting.number != self._number and fitting.share == 1.0:
            self._number = fitting.number
            self._tell(self.configured, min(fitting.mass, self._arm.payload))
        changed = [
            self.wires.show(snapshot),
            self.rates.show(svg.facts(pairs)),
            self.grip.show(svg.facts(gripped(snapshot))),
            self.loads.show(svg.loads(snapshot.truth_payload_mass, snapshot.configured_mass)),
            enable(self.configured, not locked),
            enable(self.drop, snapshot.truth_payload_mass > 0.0),
        ]
        return any(changed)

    def _payload(self) -> None:
        gui, most = self._gui, self._arm.payload
        with gui.add_folder("Payload"):
            self.loads = Html(gui)
            self.true = gui.add_slider("True [kg]", min=0.0, max=most, step=0.1, initial_value=0.0)
            self.configured = gui.add_slider("Configured", min=0.0, max=most, step=0.1, initial_value=0.0, hint="kg")
            self.drop = gui.add_button("Drop it", color="gray", disabled=True)
        with gui.add_folder("Gripper"):
            self.gripper = gui.add_button_group("Fingers or cup", ("Close", "Open"))
            self.grip = Html(gui)

    def _faults(self) -> None:
        gui = self._gui
        with gui.add_folder("Force sensor", expand_by_default=False):
            self.drift = gui.add_slider("Drift [N/s]", min=-2.0, max=2.0, step=0.1, initial_value=0.0)
            self.noise = gui.add_slider("Noise ×", min=1.0, max=10.0, step=0.5, initial_value=1.0)
            self.outage = gui.add_checkbox("Outage", False)
        with gui.add_folder("Joints", expand_by_default=False):
            self.celsius = gui.add_slider("Warmth [°C]", min=5.0, max=60.0, step=1.0, initial_value=ROOM)
            self.wear = gui.add_slider("Friction ×", min=0.3, max=3.0, step=0.1, initial_value=1.0)

    def _back(self, snapshot: Snapshot) -> None:
        """Another scenario began: every control shows the scenario's first value."""
        starts: list[tuple[Any, float | bool]] = [
            (self.true, min(snapshot.truth_payload_mass, self._arm.payload)),
            (self.configured, min(snapshot.configured_mass, self._arm.payload)),
            (self.drift, 0.0),
            (self.noise, 1.0),
            (self.outage, False),
            (self.celsius, ROOM),
            (self.wear, 1.0),
        ]
        for control, value in starts:
            self._tell(control, value)

    def _tell(self, control: Any, value: float | bool) -> None:
        if control.value != value:
            control.value = value

    def _connect(self) -> None:
        desk = self._loop.desk

        @self.force.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._hand.cap = float(self.force.value)

        @self.clock.on_click
        async def _(_: viser.GuiEvent) -> None:
            if self.clock.value == "Step":
                self._loop.paused = True
                self._loop.step_once()
            else:
                self._loop.paused = self.clock.value == "Freeze"

        @self.speed.on_update
        async def _(_: viser.GuiEvent) -> None:
            self._loop.speed = float(self.speed.value)

        @self.restart.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._shown = None
            self.start_over()

        @self.drop.on_click
        async def _(_: viser.GuiEvent) -> None:
            desk.change(DropPayload())
            self.true.value = 0.0

        def by_hand(control: Any, act: Callable[[], None]) -> None:
            @control.on_update
            async def _(event: viser.GuiEvent) -> None:
                if event.client_id is not None:  # a person, not an update by the page itself
                    act()

        by_hand(self.true, lambda: desk.change(AttachPayload(load=Load(mass=float(self.true.value)))))
        by_hand(self.configured, lambda: desk.configure(Load(mass=float(self.configured.value))))
        by_hand(self.celsius, lambda: desk.change(Temperature(celsius=float(self.celsius.value))))
        by_hand(self.wear, lambda: desk.change(FrictionChange(factor=float(self.wear.value))))
        for control in (self.drift, self.noise, self.outage):
            by_hand(control, self._fault)

    def _connect_gripper(self) -> None:
        @self.gripper.on_click
        async def _(_: viser.GuiEvent) -> None:
            tool = self._loop.scenario.tool
            if tool is not None and tool.gripper is not None:
                self._loop.desk.change(DriveGripper(command="close" if self.gripper.value == "Close" else "open"))

    def _fault(self) -> None:
        """Set the sensor's faults: its force along z drifts; all of its channels get noisier or fail."""
        noise, outage = float(self.noise.value), bool(self.outage.value)
        for channel, drift in ((None, 0.0), (2, float(self.drift.value))):
            fault = SensorFault(sensor="force_torque", channel=channel, drift=drift, noise_factor=noise, outage=outage)
            self._loop.desk.change(fault)
