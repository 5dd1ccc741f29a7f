"""Motion in free-drive that nobody causes: by the work that is done on the free arm (FD-19).

The control law takes at most a share of its friction off a moving arm. The rest is paid by whoever leads it: a hand does

    W = integral of (tau_hand . qd + F . v + tau . w) dt  >=  LEFT * integral of friction . qd dt,

with the torques that the joints feel of a hand on a link and the wrench that the flange sensor feels of one at the flange, each
only as far as it is more than an error may be. Without the sensor the joints tell both. What may be the sensor's drift the
joints feel as a hand that does the opposite: it is subtracted, but not from what they feel for certain, in which it is counted.
An arm that nobody leads pays for that rest with its speed. Half of that rest is asked for: what may be an error hides some of a
hand. Each joint is weighed by its own speed. The torques come from the deflection of the gears, so that an error of the friction
estimate alone pays nothing.
"""

import math

from pendant.events.event import Values
from pendant.guided.bias_follower import SURE, Slack
from pendant.guided.settings import Unexplained
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import EntryValues
from pendant.sensor.hand_model import HALF, KNOWN, LIGHT, NOISE
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, norm

LEFT = 0.15
"""Share of its friction that the control law leaves to whoever leads the arm; `sim.control.free_drive_law` takes the rest off."""

Forces = tuple[Vector, Vector]
"""A force and a torque at the flange, axes of B [N, N·m]."""

NO_WRENCH: Forces = (ORIGIN, ORIGIN)

Shares = tuple[float, float]
"""Of a force and of a torque."""

ALL_SURE: Shares = (1.0, 1.0)


class Work:
    """What was paid of the friction that is left, over one stretch of motion.

    Attributes:
        unpaid: of it, by now [J]; work in advance does not count, for a hand that has gone pays for nothing.
    """

    __slots__ = ("_done", "_energy", "_owed", "_rubbed", "_slower", "_ticks", "unpaid")

    def __init__(self) -> None:
        self._clear(0.0)

    def begin(self, estimate: Estimate) -> None:
        """A stretch begins."""
        self._clear(estimate.whose.energy)

    def _clear(self, energy: float) -> None:
        self._ticks = 0
        self._energy = energy  # kinetic, in the beginning [J]
        self._slower = 0.0  # of it that is gone [J]
        self._done = 0.0  # by a hand [J]
        self._owed = 0.0  # of what it should have done, and what it did against the motion [J]
        self._rubbed = 0.0  # what is asked for of the friction [J]
        self.unpaid = 0.0

    def step(self, estimate: Estimate, wrench: Forces = NO_WRENCH, sure: Shares = ALL_SURE, *, counts: bool = True) -> None:
        """One tick of motion.

        What the joints feel pays only where it `counts`: beside a flange sensor that is not used it may be the sensor's error.

        Args:
            estimate: of this tick.
            wrench: what the flange sensor feels of a hand, axes of B [N, N·m].
            sure: what of its force and of its torque is one; the rest may be the sensor's drift.
            counts: what the joints feel does.
        """
        x, y, z, a, b, c = estimate.v_F.tolist()
        (fx, fy, fz), (tx, ty, tz) = wrench
        pushed, turned = fx * x + fy * y + fz * z, tx * a + ty * b + tz * c  # without calls: in every tick, up to twice
        at_flange = sure[0] * pushed + sure[1] * turned
        done, certain, rubbed = estimate.whose.powers
        if done > 0.0:
            done = max(done + min(pushed + turned - at_flange, 0.0), min(certain, done), 0.0)
        done = (done * counts + at_flange) * TICK
        rubbed *= HALF * LEFT * TICK
        self._ticks += 1
        self._slower = self._energy - estimate.whose.energy
        self._done += done
        self._rubbed += rubbed
        self._owed = max(self._owed + rubbed - done, 0.0)
        self.unpaid = min(self._owed, self._rubbed)

    @property
    def settled(self) -> bool:
        """Nothing is owed, and it is known what the motion costs."""
        return self._rubbed > 0.0 and self.unpaid == 0.0

    @property
    def paid(self) -> bool:
        """Over the whole stretch somebody paid for it."""
        return self._rubbed > 0.0 and self._done >= self._rubbed

    def lasts(self, ticks: int) -> bool:
        """As much is unpaid, and not by the arm's speed either, as the friction of so many ticks of this motion costs."""
        owed = self.unpaid - max(self._slower, 0.0)
        return self._ticks > ticks and not owed * self._ticks < self._rubbed * ticks  # what is not a number lasts


FELT, UNFELT = math.log(HALF / NOISE), math.log(HALF / (1.0 - NOISE))
"""What a tick says against a fall, and one in which a fall is felt [nats]: what is none is felt in half of the ticks at least."""


class Way:
    """From where an arm goes on its own, and the work that is done on it meanwhile.

    Attributes:
        work: since then; to be stepped while the arm moves.
    """

    __slots__ = ("_began", "work")

    def __init__(self, since: EntryValues) -> None:
        """
        Args:
            since: what held at entry; the way begins there.
        """
        self._began = since.position
        self.work = Work()

    def begin(self, estimate: Estimate) -> None:
        """It begins here."""
        self._began = tuple(estimate.p_BF.tolist())
        self.work.begin(estimate)

    def length(self, estimate: Estimate) -> float:
        """From there to where the flange is [m]."""
        return math.dist(self._began, estimate.p_BF.tolist())


class UnintendedMotion:
    """Counts for how long, and how far, the arm moves and nobody moves it.

    Attributes:
        led: somebody pays for the motion.
        moves: the flange does.
        doubtful: half of what is allowed has gone by: nothing helps the motion on, so that who leads it pushes, and else it ends.

    A stretch of motion in which no hand is felt begins afresh whenever all of it was paid for. Without
    the flange sensor a hand is what the joints feel and neither their errors nor a fall of the payload explain.
    """

    __slots__ = (
        "_allowed",
        "_at_rest",
        "_caused",
        "_doubted",
        "_helped",
        "_no_fall",
        "_on",
        "_stretch",
        "_ticks",
        "_whole",
        "doubtful",
        "led",
        "moves",
    )

    def __init__(self, on: Unexplained, since: EntryValues) -> None:
        """
        Args:
            on: settings.
            since: what held at entry.
        """
        self._on, self._allowed = on, ticks(on.time)
        self._ticks = 0  # of the stretch
        self._caused = False  # a hand is felt in it, or a wall or another device drives the arm
        self._doubted = 0  # ticks of the doubt
        self._stretch = Way(since)
        self._at_rest = True  # before; nobody let it go while it moved
        self._whole = Way(since)  # since it has been at rest; without the flange sensor, since the payload may have fallen
        self._helped = 0.0  # so much of it was not doubtful [m]
        self._no_fall = KNOWN  # log of the odds that what is felt is no fall, against noise [nats]
        self.led = self.doubtful = self.moves = False

    def step(
        self,
        estimate: Estimate,
        hand: UserForce,
        *,
        use_wrench: bool,
        driven: bool,
        slack: Slack = SURE,
        torque: Vector = ORIGIN,
    ) -> Values | None:
        """One tick; its joint values are finite. Returns what is told of a motion that has lasted too long, or None.

        Args:
            estimate: of this tick.
            hand: after its step.
            use_wrench: the flange sensor is used.
            driven: a wall or another device moves the arm, or holds it.
            slack: what may be the sensor's drift.
            torque: of the hand at the flange, axes of B [N·m].
        """
        x, y, z = hand.user
        least = self._on.force + slack.force
        if use_wrench:
            there = x * x + y * y + z * z >= least * least and hand.surely(least)
        else:
            there = estimate.whose.joints_feel is JointsFeel.HAND
        wrench, usual = NOTHING_FELT, norm(hand.usual)
        if use_wrench and usual < LIGHT + slack.force:
            wrench = (hand.usual, torque), (_certain(usual, slack.force), _certain(norm(torque), slack.torque))
        vx, vy, vz = estimate.v_F.tolist()[:3]
        speed = norm((vx, vy, vz))
        way = self._too_long(estimate, wrench, speed=speed, caused=driven or there, use_wrench=use_wrench)
        if way is None:
            return None
        return {"distance": 1000.0 * way.length(estimate), "time": self._ticks * TICK, "limit": self._on.speed}

    def _too_long(
        self, estimate: Estimate, wrench: tuple[Forces, Shares], *, speed: float, caused: bool, use_wrench: bool
    ) -> Way | None:
        """One tick with this wrench of a hand at the flange [N, N·m], and what of it is sure; the flange has this speed [m/s].

        Returns which way is too long.
        """
        stretch, whole = self._stretch, self._whole
        self.moves = moves = speed >= self._on.speed
        if caused is not self._caused or not moves:
            self._caused, self._ticks = caused, 0
        if moves:
            if self._ticks == 0:
                stretch.begin(estimate)
            self._ticks += 1
            stretch.work.step(estimate, *wrench, counts=use_wrench or caused)
        if not use_wrench and not self._may_fall(estimate.whose.joints_feel):
            whole.begin(estimate)
        if caused:
            self._at_rest = False
            self.led = moves and stretch.work.settled
            self._end_doubt()
            return None
        if not (moves or self._at_rest):
            self._at_rest, self._helped = True, 0.0
            if use_wrench:
                self._begin(estimate)
        too_long, far = self._since_rest(estimate, wrench) if use_wrench else self._unfelt(estimate, moves)
        if too_long is not None:
            return too_long
        if moves:
            self.led = stretch.work.settled
        if self.led or not moves:
            self._ticks, self.doubtful = 0, False
        elif self._lasts(HALF):
            self.doubtful = True
        self.doubtful = self.doubtful or far
        self._doubted = self._doubted + 1 if self.doubtful else 0
        # Without help an arm that nobody leads may come to rest first.
        waits = self._doubted < HALF * self._allowed
        return stretch if moves and not (self.led or waits) and self._lasts(1.0) else None

    def _since_rest(self, estimate: Estimate, wrench: tuple[Forces, Shares]) -> tuple[Way | None, bool]:
        """The way of an arm that was at rest, if it is too long, and whether it is more than half of what is allowed."""
        whole, away = self._whole, self._on.distance
        if not self._at_rest:
            return None, False
        whole.work.step(estimate, *wrench)
        length = whole.length(estimate)
        paid = whole.work.paid
        if length > max(away, self._helped + HALF * away) and not paid:
            return whole, False
        self._at_rest = not (paid and length > away)
        far = not paid and length > HALF * away
        if not far:
            self._helped = length
        self.led = paid and whole.work.settled
        return None, far

    def _unfelt(self, estimate: Estimate, moves: bool) -> tuple[Way | None, bool]:
        """The same without the flange sensor: since the payload may have fallen, however slowly; else of an arm that was at rest,
        since it moves.

        A fall would be helped on as a hand is, so that it is doubtful at once.
        """
        self.led = False
        fallen = estimate.whose.joints_feel is JointsFeel.FALL
        if not (fallen or (moves and self._at_rest)):
            return None, False
        way = self._whole if fallen else self._stretch
        length, away = way.length(estimate), self._on.distance
        return (way if length > away else None), fallen or length > HALF * away

    def _may_fall(self, feel: JointsFeel) -> bool:
        """A fall is felt, or was, and what else is felt now and then may be noise (Page's test)."""
        if feel is JointsFeel.FALL:
            self._no_fall = max(self._no_fall + UNFELT, 0.0) if self._no_fall < KNOWN else 0.0
        else:
            self._no_fall = min(self._no_fall + FELT, KNOWN)
        return self._no_fall < KNOWN

    def _begin(self, estimate: Estimate) -> None:
        """From here on an arm that was at rest goes on its own, if nobody leads it."""
        self._helped = 0.0
        self._whole.begin(estimate)

    def _lasts(self, share: float) -> bool:
        """Nobody has led the arm for this share of the time that it has."""
        return self._stretch.work.lasts(round(share * self._allowed))

    def _end_doubt(self) -> None:
        self.doubtful = False
        self._doubted = 0


NOTHING_FELT = (NO_WRENCH, ALL_SURE)


def _certain(size: float, slack: float) -> float:
    """The share of a value of this size that is more than may be drift."""
    return max(1.0 - slack / size, 0.0) if size > 0.0 else 0.0
