"""The environment: a hand pushes the flange of an arm in free-drive to a point."""

import math
from typing import TYPE_CHECKING, Any

import gymnasium
import msgspec
import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import BadInput
from app.files.checked import convert
from app.learning.quantities import QuantityBox, even
from app.runs.runner import BROKEN, simulate
from app.session.prepare import prepare
from app.session.session_file import Setup
from pendant.inputs import NOTHING, Button, Inputs
from pendant.tick.modes import TICK, TICK_RATE, Mode
from sim.arm.frames import joint_frames, rotation_from_rpy
from sim.exchange.desk import Wishes
from sim.plant.touch import ZERO, Push
from sim.simulation import Simulation

if TYPE_CHECKING:
    from app.learning.camera import ArmCamera

Array = NDArray[np.float64]

STEP_TICKS = TICK_RATE // 20
"""Ticks of a step, 0.05 s: a human arm is softer and slower than this hand, but also feels forces between two steps."""

FORCE = 25.0
"""Largest force of the hand along each axis [N]: with so much a person leads an arm without effort."""

RESPONSE = 0.03
"""Time constant with which the hand's force follows the action [s]: no human arm changes its force in a step."""

NEAR, SLOW = 0.03, 0.05
"""The flange is at the point if its distance [m] and its speed [m/s] are at most these at the end of a step."""

SPREAD = 0.3
"""Largest distance of each joint from its home angle at the start [rad]."""

REACH = (0.10, 0.35)
"""Least and largest distance of the point from the flange at the start [m]."""

TURN = 0.5
"""The point is where the flange would be if each of the first three joints were turned by at most this [rad], so the arm can
reach it."""

TRIES = 20
"""Largest number of starts in a row that the pendant may refuse."""

WAIT = 5 * TICK_RATE
"""Ticks after which a start without free-drive counts as refused."""

QUICK: dict[str, float | bool | str] = {"activation.period": 0.2, "sequence.period": 0.25}
"""Settings of the shortest activation of free-drive that the pendant allows without a confirmation; each episode uses them."""

PIXELS = (480, 640)
"""Height and width of a picture."""

_FOLLOWS = 1.0 - math.exp(-TICK / RESPONSE)
_FREEING = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())
_LETTING_GO = Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ())


class GuideToPoint(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Bring the flange of an arm in free-drive to a point, by pushing it.

    In each episode the arm starts in another posture, with other errors of calibration and other noise. The free-drive button is
    held, without a hand on the arm, until the pendant frees the arm, and is then released. From there on a step is 0.05 s, the
    action is the hand's force, and pendant, sensors and control law work as in every session of the product. Free-drive ends by
    itself when the arm stands for 3 s, or when a limit is exceeded; then the episode ends, too.

    Action, (3,) float32: force of the hand on the middle of the flange, axes of W [N]; see `FORCE` and `RESPONSE`.

    Observation, (2 n + 12,) float32 for n joints: what sensors measure, and what a person beside the arm sees. It does not
    contain the truth. Names, units and bounds are in `observation_space.quantities`:

        joint_angle     n  rad  from the encoders
        joint_speed     n  rad/s
        flange_position 3  m    of the flange in W, from the measured angles
        flange_velocity 3  m/s  in W
        way             3  m    from the flange to the point, in W
        felt_force      3  N    the hand's force as the controller estimates it, in W, with the sensor's offset and noise

    Reward: metres by which the measured distance to the point got shorter, times 10; 1 more when the flange has come to rest at
    the point, 1 less when free-drive has ended.

    `terminated`: the flange is at the point (`NEAR`, `SLOW`, as measured), or free-drive has ended. An environment
    that is made by its registered id is also truncated after `STEPS` steps.

    `info`: the truth. `distance` [m] of the flange from the point, `position` (3,) and `target` (3,) in W [m]; `is_success`: the
    episode ended at the point, and the true distance is within `NEAR`; `mode`; `events`: their kinds, in one text.

    Args:
        setup: the simulated cell, in the fields of a session's header: robot, mounting, payload, settings, ...
        render_mode: "rgb_array", or None.

    Raises:
        BadInput: `setup` makes no sense.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": TICK_RATE // STEP_TICKS}  # noqa: RUF012 - as the base has it

    def __init__(self, setup: dict[str, Any] | None = None, render_mode: str | None = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise BadInput("GuideToPoint", "render_mode", render_mode, "rgb_array, or None")
        asked = convert(setup or {}, Setup, "setup")
        asked = msgspec.structs.replace(asked, settings={**QUICK, **asked.settings})
        self._prepared = prepare(asked, "setup")
        self.render_mode = render_mode
        arm, scenario = self._prepared.arm, self._prepared.scenario
        self._R_WB = rotation_from_rpy(scenario.mounting)
        self._home = np.array(scenario.posture if scenario.posture is not None else arm.chain.home)
        self._low, self._high = np.array(arm.limits.ends).T
        everywhere = (2.0 * arm.reach,) * 3
        self.observation_space = self._seen = QuantityBox(
            (
                even("joint_angle", tuple(arm.limits.farthest), "rad", "output encoders"),
                even("joint_speed", tuple(2.0 * speed for speed in arm.limits.speed), "rad/s", "from the encoders"),
                even("flange_position", everywhere, "m", "of the flange in W, from the measured angles"),
                even("flange_velocity", (5.0,) * 3, "m/s", "of the flange in W, from the measured angles"),
                even("way", everywhere, "m", "from the flange to the point, in W"),
                even("felt_force", (200.0,) * 3, "N", "the hand's force as the controller takes it to be, in W"),
            )
        )
        self.action_space = QuantityBox((even("hand_force", (FORCE,) * 3, "N", "of the hand on the flange, in W"),))
        self._simulation: Simulation | None = None
        self._camera: ArmCamera | None = None
        self._target = np.zeros(3)
        self._force = np.zeros(3)
        self._way = 0.0
        self._mode = Mode.TEACH

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start the arm in a new posture, choose a point, and enter free-drive; a refused start is drawn anew.

        Args:
            seed: of the random numbers, as Gymnasium has it; postures, points, calibration and noise follow from it.
            options: "posture" (n,) [rad] and "target" (3,) in W [m], in place of drawn ones.

        Raises:
            BadInput: a posture or a target that makes no sense.
            RuntimeError: the pendant refused `TRIES` starts, so `setup` is wrong; the message has the last reason.
        """
        super().reset(seed=seed)
        given = options or {}
        reason = ""
        for _ in range(TRIES):
            posture, self._target = self._draw(given)
            try:
                reason = self._free(posture)
            except (BadInput, *BROKEN) as error:  # the arm starts inside an object, or is thrown away by one
                reason = str(error)
            if not reason:
                self._force = np.zeros(3)
                self._way = self._measured()[0]
                return self._observation(), self._info("")
        raise RuntimeError(f"the pendant refused {TRIES} starts, the last with {reason}")

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Push with a force for 0.05 s; as `gymnasium.Env.step`.

        Raises:
            RuntimeError: before the first `reset`.
        """
        simulation = self._running()
        wanted = np.clip(np.asarray(action, dtype=np.float64), -FORCE, FORCE)
        if not np.isfinite(wanted).all():
            raise BadInput("GuideToPoint", "action", np.asarray(action).tolist(), "three finite forces [N]")
        events: list[str] = []
        for _ in range(STEP_TICKS):
            self._force += _FOLLOWS * (wanted - self._force)
            x, y, z = self._force.tolist()
            decision = simulation.tick(Wishes(NOTHING, (Push("flange", ZERO, (x, y, z)),), ()))
            events += [event.kind.value for event in decision.events]
            self._mode = decision.mode
            if self._mode is not Mode.FREE_DRIVE:
                break
        free = self._mode is Mode.FREE_DRIVE
        way, speed = self._measured()
        there = free and way <= NEAR and speed <= SLOW
        reward = 10.0 * (self._way - way) + 1.0 * there - 1.0 * (not free)
        self._way = way
        info = self._info(" ".join(events))
        info["is_success"] = there and info["distance"] <= NEAR
        return self._observation(), float(reward), there or not free, False, info

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override] - the base allows more
        """The arm, the point and the hand's force, (480, 640, 3); None without `render_mode`."""
        if self.render_mode is None:
            return None
        from app.learning.camera import ArmCamera, Marker  # slow to import

        snapshot = self._running().snapshot()
        if self._camera is None:
            self._camera = ArmCamera(self._prepared.arm, self._prepared.scenario, *PIXELS)
        return self._camera.picture(snapshot, [Marker(self._target, NEAR)], arrows=True)

    def close(self) -> None:
        """Free the camera."""
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    def _draw(self, given: dict[str, Any]) -> tuple[Array, Array]:
        """The first posture, and a point in W."""
        arm, rng = self._prepared.arm, self.np_random
        while True:
            if "posture" in given:
                posture = np.array(convert(list(given["posture"]), list[float], "options"))
                if posture.shape != self._home.shape or ((posture < self._low) | (posture > self._high)).any():
                    raise BadInput("options", "posture", given["posture"], f"{arm.n} joint angles within their limits [rad]")
            else:
                posture = self._within(self._home + rng.uniform(-SPREAD, SPREAD, arm.n))
            if "target" in given:
                target = np.array(convert(list(given["target"]), list[float], "options"))
                if target.shape != (3,) or float(np.linalg.norm(target)) > 2.0 * arm.reach:
                    raise BadInput("options", "target", given["target"], "x, y and z of a point in W that the arm reaches [m]")
                return posture, target
            turned = posture.copy()
            turned[: min(3, arm.n)] += rng.uniform(-TURN, TURN, min(3, arm.n))
            start, target = (self._R_WB @ joint_frames(arm, q)[-1, :3, 3] for q in (posture, self._within(turned)))
            if REACH[0] <= float(np.linalg.norm(target - start)) <= REACH[1]:
                return posture, target

    def _within(self, posture: Array) -> Array:
        """A posture with each joint well within its range."""
        middle, half = 0.5 * (self._low + self._high), 0.5 * (self._high - self._low)
        return np.clip(posture, middle - 0.9 * half, middle + 0.9 * half)

    def _free(self, posture: Array) -> str:
        """Start the arm and enter free-drive. Returns why this was refused, or "" if it was not."""
        prepared = self._prepared
        seed = int(self.np_random.integers(2**31))
        scenario = msgspec.structs.replace(prepared.scenario, posture=posture.tolist(), seed=seed)
        self._simulation = simulation = simulate(prepared._replace(scenario=scenario))
        for _ in range(WAIT):
            decision = simulation.tick(_FREEING)
            if decision.mode is Mode.FREE_DRIVE:
                self._mode = simulation.tick(_LETTING_GO).mode
                return ""
            refused = [event.kind.value for event in decision.events if event.kind.value.startswith("refused")]
            if refused:
                return refused[0]
        return "no free-drive in time"

    def _running(self) -> Simulation:
        if self._simulation is None:
            raise RuntimeError("an episode begins with reset()")
        return self._simulation

    def _measured(self) -> tuple[float, float]:
        """Distance of the flange from the point [m] and its speed [m/s], as measured."""
        estimate = self._running().estimate
        way = self._target - self._R_WB @ estimate.p_BF
        return float(np.linalg.norm(way)), float(np.linalg.norm(estimate.v_F[:3]))

    def _observation(self) -> NDArray[np.float32]:
        e, R = self._running().estimate, self._R_WB
        position = R @ e.p_BF
        return self._seen.within(e.q, e.qd, position, R @ e.v_F[:3], self._target - position, R @ e.F_user[:3])

    def _info(self, events: str) -> dict[str, Any]:
        simulation = self._running()
        position = simulation.plant.poses()[-1, :3].copy()
        distance = float(np.linalg.norm(self._target - position))
        return {
            "distance": distance,
            "position": position,
            "target": self._target.copy(),
            "is_success": False,
            "mode": self._mode.value,
            "events": events,
        }
