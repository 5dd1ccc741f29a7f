"""Wall motions: programs, scripts and jogging towards borders of drawn areas, and past them, by the true arm.

Each motion runs twice: first without walls, and an area is laid where that way comes to its border, passes it, or begins beyond;
then with this area and up to two others that it passes. Four arms, four mountings, tools, payloads that are a little wrong,
every shape, areas that move with the tool, sizes that follow the posture. Truth is read for scoring alone.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from app.files.library import load_arm
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.hold import ARMS, MOUNTINGS
from benchmarks.postures import posture
from benchmarks.walled.borders import WANTED, Lay, lay
from benchmarks.walled.course import Track, run, settled
from benchmarks.walled.motions import KINDS, LONGEST, Drawing
from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.tick.pose import HERE
from pendant.walls.definitions import Area
from pendant.walls.workspace import Workspace
from sim.arm.scenario import BoxObject, Load, Scenario, ToolModel
from sim.simulation import Simulation, known_frames

BEYOND = 5.0  # [mm] that tool and elbow may come beyond a border at most
SETTINGS = apply(Settings(), {"walls.tether": False})
WAYS = tuple(WANTED)
SHARES = (0.5, 0.25, 0.1, 0.075, 0.075)
"""How often each of `WAYS` is drawn."""
COME = ("comes to it", "begins beyond, goes on")
AS_WITHOUT = {"passes at 50 mm or more": "passes it", "comes back": "begins beyond, comes back"}
TIMED = ("script: speedj", "script: speedl")
"""Motions of a script that end by their time, be it that they have slowed down before a border in it."""
TRIES = 12
MOVES = 0.06  # [m] that a motion goes at least


class Case(NamedTuple):
    """One motion and its area."""

    seed: int
    number: int
    what: str
    way: str


class Result(NamedTuple):
    """What came of it."""

    case: Case
    arm: str
    area: Area | None  # None: none was found
    beyond: float  # the furthest beyond its border, or beyond its place at the begin, of any area's part [mm]
    rests: float  # where the area's part stood in the end, before its border [mm]
    same: bool  # as without walls, tick by tick
    told: bool  # why it ended: the area and the part
    slowed: float  # how much earlier it would have ended, as a share
    text: str


def scenario(rng: np.random.Generator, case: Case) -> tuple[str, Scenario]:
    """An arm, and what it carries."""
    name = ARMS[int(rng.integers(len(ARMS)))]
    arm = load_arm(name)
    tool = ToolModel(name="drawn", mass=0.5, com=[0.0, 0.0, 0.05], tcp=[0.02, 0.0, float(rng.uniform(0.05, 0.2))])
    mass = float(rng.uniform(0.0, arm.payload - 0.5))
    centre = rng.uniform([-0.03, -0.03, 0.05], [0.03, 0.03, 0.15])
    mounting = MOUNTINGS[str(rng.choice(list(MOUNTINGS)))]
    made = Scenario(
        mounting=list(mounting),
        tool=tool if rng.random() < 0.6 else None,
        payload_true=Load(mass=mass, com=centre.tolist()),
        payload_configured=Load(mass=mass * float(rng.uniform(0.95, 1.05)), com=(centre + 0.005 * rng.normal(size=3)).tolist()),
        world=[BoxObject(name="cart", position=[5.0, 3.0, 0.4], rpy=[0.0, 0.0, 0.7], size=[0.2, 0.2, 0.2])],
        seed=case.seed + case.number,
    )
    probe = Simulation(arm, made, SETTINGS)
    return name, replace(made, posture=posture(rng, probe)[0])


def begins_twice(case: Case) -> Result:
    """Run the motion without walls, lay the areas, run it with them."""
    for attempt in range(TRIES):
        rng = np.random.default_rng([case.seed, case.number, attempt, 61])
        arm, made = scenario(rng, case)
        device = settled(Simulation(load_arm(arm), made, SETTINGS))
        asked = Drawing(device, rng).draw(case.what)
        free = run(device, asked)
        if free.way < MOVES:
            continue  # it was refused, or hardly moved
        by = Lay(rng, {"base": HERE, **known_frames(made)}, free)
        area = lay(by, case.way)
        if area is None:
            continue
        others = [lay(by, "passes it") for _ in range(int(rng.integers(3)))]
        areas = [area, *(replace(each, name=f"other {k}") for k, each in enumerate(others) if each is not None)]
        if case.way in COME:
            asked = asked._replace(held=LONGEST)  # whoever jogs there holds the button until it ends
        walled = run(settled(Simulation(load_arm(arm), replace(made, walls=areas), SETTINGS)), asked)
        return scored(case, arm, Workspace(tuple(areas), by.frames), (free, walled))
    return Result(case, "", None, 0.0, 0.0, True, True, 0.0, "")


def scored(case: Case, arm: str, space: Workspace, tracks: tuple[Track, Track]) -> Result:
    """What the same motion without walls and with them comes to."""
    free, walled = tracks
    area, distances = space.areas[0], walled.distances(space)
    begin = np.maximum(distances[0], 0.0)
    beyond = 1000.0 * float((distances - begin).max())
    same = free.q.shape == walled.q.shape and bool((free.q == walled.q).all())
    at_wall = next((event for event in walled.events if event.kind is Kind.MOTION_AT_WALL), None)
    reason = "" if walled.ended is None else str(walled.ended.values.get("reason", ""))
    told = at_wall is not None and _names(at_wall, area) and area.name in reason and area.part in reason
    slowed = len(walled.q) / len(free.q) - 1.0
    return Result(case, arm, area, beyond, -1000.0 * float(distances[-1, 0]), same, told, slowed, reason)


def _names(event: Event, area: Area) -> bool:
    return event.values["wall"] == area.name and event.values["part"] == area.part


def draw(report: Report, count: int) -> list[Case]:
    """Every kind of motion as often as every other; ways by `SHARES`."""
    rng = np.random.default_rng([report.options.seed, 61])
    kinds = list(KINDS)
    seed = report.options.seed
    return [Case(seed, k, kinds[k % len(kinds)], str(rng.choice(WAYS, p=SHARES))) for k in range(count)]


def measure(report: Report) -> None:
    """Fill the report."""
    found = spread(begins_twice, draw(report, 200 if report.options.full else 40))
    results = [each for each in found if each.area is not None]
    report.row("motions with an area", len(results), "", n=len(found))
    outside = [r for r in results if r.case.way.startswith("begins beyond")]
    inside = [r for r in results if r not in outside]
    report.row("beyond a border, at most", largest(r.beyond for r in inside), "mm", at_most=BEYOND, n=len(inside))
    report.row("begun beyond: further out, at most", largest(r.beyond for r in outside), "mm", at_most=BEYOND, n=len(outside))
    for what, way in AS_WITHOUT.items():
        these = [r for r in results if r.case.way == way]
        report.share(f"{what}: as without walls", sum(r.same for r in these), len(these), at_least=1.0)
    near = [r for r in results if r.case.way == "passes near"]
    report.share("passes nearer: as without walls", sum(r.same for r in near), len(near))
    come = [r for r in results if r.case.way in COME and r.case.what not in TIMED]
    report.share("comes to the border: the end names area and part", sum(r.told for r in come), len(come), at_least=1.0)
    for kind in ("program", "script", "jog"):
        rests = [r.rests for r in come if r.case.way == COME[0] and r.case.what.startswith(kind)]
        report.row(f"{kind}: stands before the border, median", float(np.median(rests)) if rests else NO_CASE, "mm", n=len(rests))
        report.row(f"{kind}: stands before the border, at most", largest(rests), "mm", n=len(rests))
    for r in sorted(results, key=lambda r: -r.beyond)[:5]:
        report.notes.append(f"{r.beyond:.2f} mm beyond: {told_of(r)}")
    for r in [r for r in results if not r.same and r.case.way in AS_WITHOUT.values()][:8]:
        report.notes.append(f"slowed by {100.0 * r.slowed:.1f} %: {told_of(r)}")
    for r in [r for r in come if not r.told][:8]:
        report.notes.append(f"not told: {told_of(r)}")


def largest(values: Iterable[float]) -> float | str:
    """The largest of any values."""
    return max(values, default=NO_CASE)  # pyright: ignore[reportArgumentType]


def told_of(r: Result) -> str:
    """A case in a note."""
    return f"case {r.case.number}, {r.arm}, {r.case.what}, {r.case.way}: {r.text}"


if __name__ == "__main__":
    main("wall_motions", measure)
