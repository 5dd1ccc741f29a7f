"""The runs of a study: which values each has, and a name for its content. Made of numbers when asked for, and never as a list."""

import copy
import hashlib
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import msgspec
import numpy as np

from app.engine.source import source_digest
from app.files.checked import BadInput, convert
from app.session.prepare import prepare
from app.session.session_file import Session
from app.studies.factors import Gridded, Sampled, Value, put
from app.studies.study_file import Study

CHECKED = 200
"""Most values of a factor that are tried before the first run."""


class Case(NamedTuple):
    """One run of a study."""

    number: int
    id: str  # of its content
    seed: int
    values: tuple[tuple[str, Any], ...]  # path of a field, the value that it gets
    factors: tuple[Value, ...]  # as a row has them, in the order of the study


class Plan:
    """All runs of a study: each point of the grid, with each sample, with each seed.

    Args:
        study: what to vary.
        base: the session.
        where: name of the study, for messages.

    Raises:
        BadInput: a factor has no field in the session, or a value does not fit it.
    """

    def __init__(self, study: Study, base: Session, where: str) -> None:
        self.study, self.base = study, base
        self.raw = plain(base)  # of the base session
        self._points = [(each.points(), each.shown()) if isinstance(each, Gridded) else None for each in study.factors]
        self._grid = math.prod(len(each[0]) for each in self._points if each is not None)
        self._samples = self._drawn()
        self.size = self._grid * max(1, len(self._samples)) * study.seeds
        self.key = self._key()
        self._check(where)

    def _drawn(self) -> np.ndarray:
        """(samples, factors with a distribution), the same for the same seed."""
        from scipy.stats import qmc

        factors = [each for each in self.study.sampled if isinstance(each, Sampled)]
        if not factors:
            return np.zeros((0, 0))
        rng = np.random.default_rng(self.base.seed)
        n, d = self.study.samples, len(factors)
        if self.study.sampling == "sobol":
            shares = qmc.Sobol(d, rng=rng).random_base2(max(0, (n - 1).bit_length()))[:n]
        elif self.study.sampling == "latin_hypercube":
            shares = qmc.LatinHypercube(d, rng=rng).random(n)
        else:
            shares = rng.random((n, d))
        shares = np.clip(shares, 1e-12, 1.0 - 1e-12)
        return np.column_stack([factor.at(shares[:, k]) for k, factor in enumerate(factors)])

    def _key(self) -> str:
        """What every row of the study depends on, apart from its factors and its seed."""
        content = [self.study.factors, self.study.measures, self.raw]
        content += [self.study.samples, self.study.sampling, self.study.seeds, source_digest()]
        return hashlib.sha256(msgspec.json.encode(content, order="sorted")).hexdigest()

    def case(self, number: int) -> Case:
        """The run of a number, 0 <= number < size."""
        rest, seed = divmod(number, self.study.seeds)
        point, sample = divmod(rest, max(1, len(self._samples)))
        values: list[tuple[str, Any]] = []
        factors: list[Value] = []
        column = 0
        for factor, points in zip(self.study.factors, self._points, strict=True):
            if points is None:
                value = shown = float(self._samples[sample, column])
                column += 1
            else:
                point, k = divmod(point, len(points[0]))
                value, shown = points[0][k], points[1][k]
            values += [(field, value) for field in factor.fields]
            factors.append(shown)
        seed += self.base.seed
        content = msgspec.json.encode([self.key, values, seed])
        return Case(number, hashlib.sha256(content).hexdigest()[:20], seed, tuple(values), tuple(factors))

    def cases(self) -> Iterator[Case]:
        """All runs, in order."""
        return (self.case(number) for number in range(self.size))

    def _check(self, where: str) -> None:
        """Each factor by itself, at its values."""
        if self.base.seed + self.study.seeds > 2**31:
            raise BadInput(where, "seeds", self.study.seeds, "seeds up to 2147483647")
        prepare(self.base, where)
        column = 0
        for i, (factor, points) in enumerate(zip(self.study.factors, self._points, strict=True)):
            if points is None:
                drawn = self._samples[:, column]
                tried: list[Any] = [float(drawn.min()), float(drawn.max())]
                column += 1
            else:
                tried = points[0][:CHECKED]
            for value in tried:
                session_of(self.raw, [(field, value) for field in factor.fields], self.base.seed, f"{where}: factors[{i}]")


def plain(value: Any) -> Any:
    """As a file has it: dicts, lists, numbers, texts."""
    return msgspec.json.decode(msgspec.json.encode(value))


def session_of(raw: dict[str, Any], values: Any, seed: int, where: str) -> Session:
    """The session with fields set to values.

    Raises:
        BadInput: a field is not there, or a value does not fit.
    """
    changed = copy.deepcopy(raw)
    for path, value in values:
        try:
            put(changed, path, value)
        except KeyError as error:
            allowed = f"a field of the session, such as payload_true.mass or timeline[0].for; there is no {error.args[0]}"
            raise BadInput(where, "field", path, allowed) from None
    changed["seed"] = seed
    session = convert(changed, Session, where)
    prepare(session, where)
    return session


def described(plan: Plan) -> dict[str, Any]:
    """What is written of a study, by which a study is known again."""
    content = plain(plan.study) | {"session": plan.raw}
    return {"runs": plan.size, "digest": source_digest(), "study": content}


def changed_field(old: Any, new: Any, path: str = "") -> str | None:
    """The path of the first difference between two descriptions; None: there is none."""
    if isinstance(old, dict) and isinstance(new, dict):
        for name in [*old, *(name for name in new if name not in old)]:
            below = f"{path}.{name}" if path else name
            if name not in old or name not in new:
                return below
            if (found := changed_field(old[name], new[name], below)) is not None:
                return found
        return None
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        found = (changed_field(a, b, f"{path}[{k}]") for k, (a, b) in enumerate(zip(old, new, strict=True)))
        return next((each for each in found if each is not None), None)
    return None if old == new else path
