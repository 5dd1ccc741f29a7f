"""What a study varies: a factor sets fields of the session to values of a list, a range, or a distribution."""

import math
import re
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from pendant.settings.bounds import Text

Value = float | bool | str
Steps = Annotated[int, Meta(ge=2, le=10_000)]
Fields = Annotated[list[Text], Meta(min_length=1, max_length=20)]
Name = Annotated[str, Meta(pattern="^[a-z][a-z0-9_]{0,39}$")]


class Factor(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all factors.

    `field` is a path into the session file, such as `payload_true.mass`, `timeline[2].force[1]` or `settings.sequence.period`;
    several get the same value.
    """

    name: Name
    field: Text | Fields
    unit: Text = ""

    @property
    def fields(self) -> list[str]:
        """All paths."""
        return [self.field] if isinstance(self.field, str) else self.field


class Gridded(Factor, frozen=True, kw_only=True):
    """Base of factors with points: each is met with each point of the others."""

    def points(self) -> list[Any]:
        """The values that the fields get."""
        raise NotImplementedError

    def shown(self) -> list[Value]:
        """What stands in a row for each of the points: a number, true or false, or a text."""
        return self.points()


class Listed(Gridded, tag="list", frozen=True, kw_only=True):
    """Given values. Those that are no number, text, true or false have `labels`, by which rows and pictures name them."""

    values: Annotated[list[Any], Meta(min_length=1, max_length=10_000)]
    labels: list[Text] | None = None

    def __post_init__(self) -> None:
        """Check that rows can name the values."""
        if self.labels is None and any(not isinstance(value, float | int | str) for value in self.values):
            raise ValueError("values that are neither numbers nor texts need labels, one each")
        if self.labels is not None and len(self.labels) != len(self.values):
            raise ValueError(f"{len(self.values)} values but {len(self.labels)} labels: one label a value is needed")
        if len(set(map(str, self.shown()))) < len(self.values):
            raise ValueError("a value or a label stands there twice")

    def points(self) -> list[Any]:
        """See `Gridded.points`."""
        return self.values

    def shown(self) -> list[Value]:
        """See `Gridded.shown`."""
        if self.labels is not None:
            return [*self.labels]
        if all(isinstance(value, bool) for value in self.values) or all(isinstance(value, str) for value in self.values):
            return self.values
        if any(isinstance(value, bool | str) for value in self.values):
            return [str(value) for value in self.values]
        return [float(value) for value in self.values]


class Spanned(Factor, frozen=True, kw_only=True):
    """Base of factors between two numbers."""

    begin: float = msgspec.field(name="from")
    end: float = msgspec.field(name="to")

    def __post_init__(self) -> None:
        """Check the order."""
        if not self.begin < self.end:
            raise ValueError(f"to = {self.end:g} must be above from = {self.begin:g}")


class Range(Spanned, Gridded, tag="range", frozen=True, kw_only=True):
    """Evenly spaced numbers, both ends among them."""

    steps: Steps

    def points(self) -> list[Any]:
        """See `Gridded.points`."""
        return [round(value, 12) for value in np.linspace(self.begin, self.end, self.steps).tolist()]


class LogRange(Spanned, Gridded, tag="log_range", frozen=True, kw_only=True):
    """Numbers of a constant ratio, both ends among them."""

    steps: Steps

    def __post_init__(self) -> None:
        """Check that there are logarithms."""
        Spanned.__post_init__(self)
        _positive(self.begin)

    def points(self) -> list[Any]:
        """See `Gridded.points`."""
        return [float(f"{value:.12g}") for value in np.geomspace(self.begin, self.end, self.steps).tolist()]


class Sampled(Factor, frozen=True, kw_only=True):
    """Base of factors with a distribution: all of them are drawn together, `samples` times."""

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values below which lie these shares of the distribution, 0 < share < 1."""
        raise NotImplementedError


class Uniform(Spanned, Sampled, tag="uniform", frozen=True, kw_only=True):
    """Every value between two numbers alike."""

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """See `Sampled.at`."""
        return self.begin + share * (self.end - self.begin)


class LogUniform(Spanned, Sampled, tag="log_uniform", frozen=True, kw_only=True):
    """Every order of magnitude between two numbers alike."""

    def __post_init__(self) -> None:
        """Check that there are logarithms."""
        Spanned.__post_init__(self)
        _positive(self.begin)

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """See `Sampled.at`."""
        return np.exp(math.log(self.begin) + share * math.log(self.end / self.begin))


class Normal(Sampled, tag="normal", frozen=True, kw_only=True):
    """Normally distributed."""

    mean: float
    deviation: Annotated[float, Meta(gt=0.0)]

    def at(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """See `Sampled.at`."""
        from scipy.special import ndtri

        return self.mean + self.deviation * ndtri(share)


AnyFactor = Listed | Range | LogRange | Uniform | LogUniform | Normal

STEP = re.compile(r"([A-Za-z_][A-Za-z_0-9]*)((?:\[\d+\])*)")


def put(raw: dict[str, Any], path: str, value: Any) -> None:
    """Set the field at `path` of a session as plain values.

    Raises KeyError: the path leads nowhere.
    """
    head, _, rest = path.partition(".")
    if head in ("settings", "features") and rest:
        raw.setdefault(head, {})[rest] = value  # their names have points themselves
        return
    steps: list[str | int] = []
    for part in path.split("."):
        match = STEP.fullmatch(part)
        if match is None:
            raise KeyError(part)
        steps += [match[1], *(int(index) for index in re.findall(r"\d+", match[2]))]
    place: Any = raw
    for step, following in zip(steps, [*steps[1:], None], strict=True):
        if isinstance(step, int) != isinstance(place, list) or not isinstance(place, list | dict):
            raise KeyError(step)
        if isinstance(place, list) and not step < len(place):  # type: ignore[operator]
            raise KeyError(step)
        if following is None:
            place[step] = value  # type: ignore[index]
        elif isinstance(place, dict) and step not in place:
            raise KeyError(step)
        else:
            place = place[step]  # type: ignore[index]


def _positive(begin: float) -> None:
    if begin <= 0.0:
        raise ValueError(f"from = {begin:g} must be above 0 for a logarithmic scale")
