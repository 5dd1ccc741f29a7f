"""What a study measures in each run: of events, of values as they pass (the truth too), and of the recording."""

import fnmatch
from typing import Annotated, Literal

from msgspec import Meta

from app.log.layout import STATE, TRUTH
from app.session.expectations import OF_A_JOINT, During, Quantity
from app.studies.factors import Name
from pendant.events.event import Kind
from pendant.settings.bounds import Text
from sim.arm.scenario import Vector

Statistic = Literal["largest", "smallest", "mean", "rms", "last"]


class StudyMeasure(During, frozen=True, kw_only=True):
    """Base of all measures: a number, true or false, or nothing where a run has none. Its interval is as in expectations."""

    name: Name
    unit: Text = ""

    @property
    def shares(self) -> bool:
        """Whether it is true or false."""
        return False


class OfKinds(StudyMeasure, frozen=True, kw_only=True):
    """Base of measures of events: of some kinds, by name or by pattern (`refused_*`)."""

    kinds: Annotated[list[Text], Meta(min_length=1, max_length=50)]

    def __post_init__(self) -> None:
        """Check that there are such kinds."""
        super().__post_init__()
        for pattern in self.kinds:
            if not any(fnmatch.fnmatchcase(kind.value, pattern) for kind in Kind):
                raise ValueError(f"kinds: no event is called {pattern}")

    def matching(self) -> frozenset[str]:
        """The kinds, by name."""
        return frozenset(kind.value for kind in Kind if any(fnmatch.fnmatchcase(kind.value, each) for each in self.kinds))


class HasHappened(OfKinds, tag="happens", tag_field="measure", frozen=True, kw_only=True):
    """Whether such an event happens."""

    @property
    def shares(self) -> bool:
        """See `StudyMeasure.shares`."""
        return True


class EventCount(OfKinds, tag="count", tag_field="measure", frozen=True, kw_only=True):
    """How many such events happen."""


class EventTime(OfKinds, tag="time", tag_field="measure", frozen=True, kw_only=True):
    """When the first such event happens [s], counted from `after`."""


class QuantityStatistic(StudyMeasure, tag="value", tag_field="measure", frozen=True, kw_only=True):
    """A quantity as expectations know it, the truth's among them, over the interval."""

    of: Quantity
    joint: str | None = None
    statistic: Statistic = "largest"

    def __post_init__(self) -> None:
        """Check that a joint is named where one is needed."""
        super().__post_init__()
        if (self.of in OF_A_JOINT) != (self.joint is not None):
            raise ValueError(f"joint goes with {' and '.join(OF_A_JOINT)}, and only with these; of = {self.of}")


class WayMeasure(StudyMeasure, tag="displacement", tag_field="measure", frozen=True, kw_only=True):
    """How far a part truly is from its place at the interval's begin [m]: the largest in the interval, or that at its end."""

    part: str = "flange"
    statistic: Literal["largest", "last"] = "largest"
    along: Vector | None = None  # direction in W to count along, with its sign; None: the distance


class PeriodLength(StudyMeasure, tag="period", tag_field="measure", frozen=True, kw_only=True):
    """How long the `run`-th run of a period lasts [s]."""

    period: Text
    run: Annotated[int, Meta(ge=1)] = 1


class MeasuredDelay(StudyMeasure, tag="contact_delay", tag_field="measure", frozen=True, kw_only=True):
    """Time from the true beginning of the first contact until the robot acts on it [ms]; nothing where it does not."""

    kinds: tuple[Kind, ...] = (Kind.CONTACT_GAINED, Kind.CONTACT_RESISTANCE, Kind.CONTACT_CLAMPING)


class ContactForce(StudyMeasure, tag="contact_force", tag_field="measure", frozen=True, kw_only=True):
    """Largest true normal force between the arm and what it touches [N]."""


class Passed(StudyMeasure, tag="passed", tag_field="measure", frozen=True, kw_only=True):
    """Whether the session's expectations are met."""

    @property
    def shares(self) -> bool:
        """See `StudyMeasure.shares`."""
        return True


class OfLog(StudyMeasure, tag="log", tag_field="measure", frozen=True, kw_only=True):
    """A statistic of a recorded array, `state.NAME` or `truth.NAME`; the run is recorded for it."""

    of: Text
    index: Annotated[int, Meta(ge=0)] | None = None  # of a vector; None: its size
    statistic: Statistic = "largest"

    def __post_init__(self) -> None:
        """Check that recordings have it."""
        super().__post_init__()
        names = [f"state.{each.name}" for each in STATE] + [f"truth.{each.name}" for each in TRUTH]
        if self.of not in names:
            raise ValueError(
                f"of: recordings have no {self.of}; they have {', '.join(names[:6])} and more (docs/guide/recordings.md)"
            )


AnyMeasure = (
    HasHappened
    | EventCount
    | EventTime
    | QuantityStatistic
    | WayMeasure
    | PeriodLength
    | MeasuredDelay
    | ContactForce
    | Passed
    | OfLog
)
