"""The torque of the motors as a linear function of an arm's numbers, and what is known of these beforehand."""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.chain import NOTHING, chain, plate_body
from sim.arm.scenario import Vector
from sim.identification.body_parameters import PARAMETERS, distance, moved, parameters_of
from sim.identification.motion_samples import Samples
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

# Standard deviations before a log is seen; each says what a published number of an arm is worth, and gives way to a log. Those of
# masses, centres and torque constants are what the arm's file states.
EVENLY = 3.0**-0.5
"""Standard deviation of what is spread evenly, of its bound."""
BODY_PRIOR = 0.25  # of a link's pseudo-inertia, relative: published moments are of cylinders
ROTOR_PRIOR = 0.6  # of a rotor inertia: it is not published
FRICTION_PRIOR = 0.6  # of a joint's whole friction: grease and wear
SHAPE_PRIOR = 0.15  # of one point of its curve beside the others
LOAD_PRIOR = 0.03  # of the friction's rise with load [N·m per N·m]
OFFSET_PRIOR = 0.01  # of the difference of both directions, of the torque limit
KNOWN_MASS = 0.002  # of a load that was weighed [kg]
UNKNOWN_MASS = 8.0  # of a load that was not [kg]
LOAD_REACH = 0.15  # of a load's centre from the flange, each axis [m]
LOAD_TENSOR = 0.05  # of its moments about the flange [kg·m²]


@dataclass(frozen=True, slots=True)
class LoggedRun:
    """Samples of a log, and what hung on the flange."""

    name: str
    samples: Samples
    loaded: bool = False  # the load that all loaded runs carry


@dataclass(frozen=True, slots=True)
class FitPlaces:
    """Where each number stands in the vector of all, for n joints and a friction curve of m points."""

    n: int
    m: int
    links: slice = field(init=False)  # per link its ten numbers, as a difference to the file's
    rotor: slice = field(init=False)
    friction: slice = field(init=False)  # per joint m points
    load_friction: slice = field(init=False)
    offset: slice = field(init=False)
    constant: slice = field(init=False)  # relative error of the torque constants
    load: slice = field(init=False)
    size: int = field(init=False)

    def __post_init__(self) -> None:
        at = 0
        widths = {"links": PARAMETERS * self.n, "rotor": self.n, "friction": self.n * self.m}
        widths |= dict.fromkeys(("load_friction", "offset", "constant"), self.n) | {"load": PARAMETERS}
        for name, width in widths.items():
            object.__setattr__(self, name, slice(at, at + width))
            at += width
        object.__setattr__(self, "size", at)

    @property
    def filed(self) -> NDArray[np.bool_]:
        """Numbers (p,) that stay as filed where no run tells them; others are told together: links, curves, torque constants."""
        out = np.zeros(self.size, dtype=bool)
        for part in (self.rotor, self.load_friction, self.offset):
            out[part] = True
        return out

    def curve(self, joint: int) -> slice:
        """Of one joint's friction."""
        start = self.friction.start + joint * self.m
        return slice(start, start + self.m)

    def link(self, k: int) -> slice:
        """Of one link."""
        return slice(self.links.start + PARAMETERS * k, self.links.start + PARAMETERS * (k + 1))


class TorqueModel:
    """Motor torques of an arm, linear in its numbers x:

        tau (1 + e) = Y(q, q', q'') pi + J q'' + sign(q') (sum_k L_k(sqrt |q'|) f_k + c |tau_J|) + o

    with link and load parameters pi, rotor inertia J, the friction curve through its points f_k (L_k: polynomials of Lagrange, as
    the plant's), its rise c with the load, offset o of both directions, and the error e of the torque constant.

    Args:
        arm: the file's numbers.
        mounting: roll, pitch, yaw of B in W [rad]; None: it stands on a floor.
    """

    def __init__(self, arm: Arm, mounting: Vector | None = None) -> None:
        self.arm, self.places = arm, FitPlaces(arm.n, len(arm.frictions.speed))
        rigid = chain(arm)
        whole = Dynamics(
            rigid, rigid.links, plate_body(arm) + NOTHING, mounting=mounting or [0.0, 0.0, 0.0], elbow=arm.chain.elbow
        )
        self._model, self._data = whole.model, whole.model.createData()
        self.links = np.array([parameters_of(body) for body in rigid.links])  # (n, 10) as filed
        self._filed = np.concatenate([body.toDynamicParameters() for body in whole.model.inertias.tolist()[1:]])  # with the plate
        self._to_joint = np.column_stack([moved(unit, rigid.R_flange, rigid.p_flange) for unit in np.eye(PARAMETERS)])
        self._lagrange = np.linalg.inv(np.vander(np.sqrt(np.array(arm.frictions.speed))))  # (m, m): powers to points

    def prior(self, mass: float | None, nearness: Array, spread: float) -> tuple[Array, Array]:
        """Expectation (p,) and precision (p, p) of all numbers before a log is seen.

        Args:
            mass: of the load, weighed [kg]; None: unknown.
            nearness: how many times closer than `BODY_PRIOR` each link is expected to the file's (n,).
            spread: of the torque constants, standard deviation.
        """
        arm, at = self.arm, self.places
        x, deviation = np.zeros(at.size), np.ones(at.size)
        x[at.rotor] = arm.motors.rotor_inertia
        deviation[at.rotor] = ROTOR_PRIOR * x[at.rotor]
        x[at.load_friction], deviation[at.load_friction] = arm.frictions.load, LOAD_PRIOR
        deviation[at.offset] = OFFSET_PRIOR * np.array(arm.limits.torque)
        deviation[at.constant] = spread
        x[at.load.start] = mass or 0.0
        moment = LOAD_REACH * (UNKNOWN_MASS if mass is None else max(mass, 0.1))
        deviation[at.load] = [UNKNOWN_MASS if mass is None else KNOWN_MASS] + [moment] * 3 + [LOAD_TENSOR] * 6
        known = np.diag(deviation**-2)
        for k, link in enumerate(self.links):
            known[at.link(k), at.link(k)] = distance(link) * (nearness[k] / BODY_PRIOR) ** 2
            # A change of mass alone leaves the centre; the first moment less its share is the change of the centre.
            mass_, centre = EVENLY * arm.accuracy.link_mass, EVENLY * arm.accuracy.link_centre
            step = np.zeros((4, PARAMETERS))
            step[0, 0] = 1.0 / (mass_ * link[0])
            step[1:, 1:4] = np.eye(3) / (centre * link[0])
            step[1:, 0] = -link[1:4] / (centre * link[0] ** 2)
            known[at.link(k), at.link(k)] += step.T @ step
        for i, curve in enumerate(arm.frictions.torque):
            x[at.curve(i)] = curve
            whole = FRICTION_PRIOR * np.array(curve)
            known[at.curve(i), at.curve(i)] = np.linalg.inv(
                np.outer(whole, whole) + np.diag((SHAPE_PRIOR * np.array(curve)) ** 2)
            )
        return x, known

    def rigid(self, run: LoggedRun) -> Array:
        """What the file's links take of the torque (n, k) [N·m].

        Args:
            run: k samples.
        """
        s = run.samples
        return np.array([pin.rnea(self._model, self._data, *row) for row in zip(s.q, s.qd, s.qdd, strict=True)]).T

    def lowest(self) -> Array:
        """Lower bounds (p,): friction never drives, rotors and loads have no negative inertia."""
        at = self.places
        low = np.full(at.size, -np.inf)
        for part in (at.rotor, at.friction, at.load_friction):
            low[part] = 0.0
        low[at.load.start] = 0.0
        return low

    def rows(self, run: LoggedRun) -> tuple[Array, Array]:
        """A (n, k, p) and y (n, k) [N·m] of a run, so that A x = y; without the columns that `linearise` fills.

        Args:
            run: k samples.
        """
        at, s, n = self.places, run.samples, self.arm.n
        k = len(s.t)
        A = np.zeros((n, k, at.size))
        y = s.torque.T.copy()
        for row in range(k):
            Y = pin.computeJointTorqueRegressor(self._model, self._data, s.q[row], s.qd[row], s.qdd[row])
            A[:, row, at.links] = Y
            y[:, row] -= Y @ self._filed
            if run.loaded:
                A[:, row, at.load] = Y[:, -PARAMETERS:] @ self._to_joint
        for i in range(n):
            A[i, :, at.rotor.start + i] = s.qdd[:, i]
            A[i, :, at.curve(i)] = s.slip[:, i] @ self._lagrange
            A[i, :, at.offset.start + i] = 1.0
        return A, y

    def linearise(self, A: Array, run: LoggedRun, y: Array, x: Array) -> tuple[Array, Array]:
        """Put the columns of the load's friction and of the torque constants, at the numbers x, into A.

        Only the measured torque is noisy: the constants multiply the torque that the numbers predict, tau^ = (A x) / (1 + e). As
        factors of the measured torque they would come out too small, as each factor of what has noise does.

        Returns:
            y (n, k) so that A x = y, and the torque that is predicted (n, k) [N·m].
        """
        at, s = self.places, run.samples
        measured = s.torque.T
        links = measured - y + A[:, :, at.links] @ x[at.links] + A[:, :, at.load] @ x[at.load]
        predicted = np.zeros_like(y)
        for i, error in enumerate(x[at.constant]):
            A[i, :, at.load_friction.start + i] = s.slip[:, i, -1] * np.abs(links[i])
            A[i, :, at.constant.start + i] = 0.0
            predicted[i] = (measured[i] - y[i] + A[i] @ x) / (1.0 + error)
            A[i, :, at.constant.start + i] = -predicted[i]
        return y + x[at.constant][:, None] * (measured - predicted), predicted

    def link(self, x: Array, k: int) -> Array:
        """Link k's ten numbers in its joint frame; of the last one without the plate of its sensor."""
        return self.links[k] + x[self.places.link(k)]

    def link_of_file(self, x: Array, k: int) -> Array:
        """The same, as a file has it: of the last one with that plate."""
        plate = self._to_joint @ parameters_of(plate_body(self.arm))
        return self.link(x, k) + plate if k == self.arm.n - 1 else self.link(x, k)
