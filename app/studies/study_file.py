"""Study files: a session, what is varied, what is measured, and what the report shows. The schema; `plan` checks and uses it."""

from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from app.files.checked import ABSENT, BadInput, load
from app.files.library import ASSETS
from app.files.regular_file import is_something
from app.session.session_file import Session, find, opened
from app.studies.factors import AnyFactor, Name, Sampled
from app.studies.study_measures import AnyMeasure
from pendant.settings.bounds import Text

Count = Annotated[int, Meta(ge=1, le=1_000_000)]


class Shown(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="show"):
    """Base of what the report shows."""

    of: Name  # a measure
    caption: Text = ""

    def factors(self) -> list[str]:
        """Names of the factors that it needs."""
        return []


class ResponseCurve(Shown, tag="curve", frozen=True, kw_only=True):
    """A measure's mean over a factor, with a confidence band; a line for each value of `by`."""

    over: Name
    by: Name | None = None

    def factors(self) -> list[str]:
        """See `Shown.factors`."""
        return [self.over] if self.by is None else [self.over, self.by]


class HeatMap(Shown, tag="heat_map", frozen=True, kw_only=True):
    """A measure's mean over two factors."""

    over: Annotated[list[Name], Meta(min_length=2, max_length=2)]

    def factors(self) -> list[str]:
        """See `Shown.factors`."""
        return self.over


class Roc(Shown, tag="roc", frozen=True, kw_only=True):
    """True refusals against false ones: a point for each value of `over`, the limit.

    A run ought to be refused when the size of factor `right` less `zero` is at least `at_least`; up to `at_most` not.
    """

    over: Name
    right: Name
    at_least: float
    at_most: float = 0.0
    zero: float = 0.0

    def __post_init__(self) -> None:
        """Check that no run ought both."""
        if not self.at_most < self.at_least:
            raise ValueError(f"at_most = {self.at_most:g} must be below at_least = {self.at_least:g}")

    def factors(self) -> list[str]:
        """See `Shown.factors`."""
        return [self.over, self.right]


class Sensitivity(Shown, tag="sensitivity", frozen=True, kw_only=True):
    """How much of a measure's variance each factor explains by itself (first-order index, RBD-FAST)."""


AnyShown = ResponseCurve | HeatMap | Roc | Sensitivity


class Worst(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Which runs are the worst: those whose measure is `largest` or `smallest`. Runs with an error come first."""

    of: Name
    first: Literal["largest", "smallest"] = "largest"


class Quick(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What `--quick` replaces: fewer seeds, fewer samples, fewer points of a factor."""

    seeds: Count | None = None
    samples: Count | None = None
    factors: dict[Name, AnyFactor] = {}


class Study(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A study."""

    title: Text
    text: Text = ""  # what it asks, in two sentences
    session: Text | dict[str, Any]  # the base: the name of a bundled session, a file, or its fields
    factors: Annotated[list[AnyFactor], Meta(min_length=1, max_length=50)]
    samples: Count = 64  # of the factors with a distribution, together
    sampling: Literal["random", "sobol", "latin_hypercube"] = "sobol"
    seeds: Count = 1  # runs of each point, with the session's seed and those after it
    measures: Annotated[list[AnyMeasure], Meta(min_length=1, max_length=50)]
    show: Annotated[list[AnyShown], Meta(max_length=50)] = []
    worst: Worst | None = None
    quick: Quick = Quick()

    def __post_init__(self) -> None:
        """Check that names are told apart, and that what is shown is there."""
        factors, measures = [each.name for each in self.factors], [each.name for each in self.measures]
        names = [*factors, *measures, *RESERVED]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"the name {twice} is there twice, or a row has it anyhow ({', '.join(RESERVED)})")
        for name in [each.of for each in (*self.show, *((self.worst,) if self.worst is not None else ()))]:
            if name not in measures:
                raise ValueError(f"no measure is called {name}; there are {', '.join(measures)}")
        for name in [name for each in self.show for name in each.factors()] + [*self.quick.factors]:
            if name not in factors:
                raise ValueError(f"no factor is called {name}; there are {', '.join(factors)}")

    @property
    def sampled(self) -> list[AnyFactor]:
        """Factors with a distribution."""
        return [each for each in self.factors if isinstance(each, Sampled)]


RESERVED = ("run", "id", "seed", "exit", "error", "commit", "digest")
"""Columns of a row that are neither factors nor measures."""


def studies() -> list[str]:
    """Names of the bundled studies, sorted."""
    return sorted(path.stem for path in (ASSETS / "studies").glob("*.yaml"))


def open_study(name: str, *, quick: bool = False, seed: int | None = None, anywhere: bool = False) -> tuple[Study, Session]:
    """A study and its base session, with the options of the command line in them.

    Args:
        name: of a bundled study, or a file.
        quick: take what the file says under `quick`.
        seed: of the first run of each point, in place of the session's.
        anywhere: arms and tools that the session names may be anywhere on this machine.

    Raises:
        BadInput: it is not there, or does not make a study.
    """
    path = Path(name)
    if not is_something(path):
        if name not in studies():
            raise BadInput(name, "", ABSENT, f"no such file; bundled studies: {', '.join(studies())}")
        path = ASSETS / "studies" / f"{name}.yaml"
    study = load(path, Study)
    if isinstance(study.session, dict):
        from app.files.checked import convert

        base = convert(study.session, Session, f"{path.name}: session")
    else:
        beside = path.parent / study.session
        base = opened(beside if beside.is_file() else find(study.session), Session, anywhere)
    if seed is not None:
        base = msgspec.structs.replace(base, seed=seed)
    if quick:
        fewer = study.quick
        factors = [fewer.factors.get(each.name, each) for each in study.factors]
        study = msgspec.structs.replace(
            study, factors=factors, seeds=fewer.seeds or study.seeds, samples=fewer.samples or study.samples
        )
    return study, base
