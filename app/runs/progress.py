"""Output of `pendant run`: progress while it runs, then the modes over time and the expectations."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from app.runs.runner import RunOutcome
from app.runs.seed_runs import SessionAtSeeds
from app.session.session_file import Session
from pendant.tick.modes import Mode

COLOURS = {Mode.NORMAL: "green", Mode.TEACH: "green", Mode.RUN: "cyan", Mode.FREE_DRIVE: "blue", Mode.STOP: "red"}


@contextmanager
def progress(session: Session) -> Iterator[Callable[[float], None]]:
    """A bar over the simulated seconds, only on a terminal; gives a function that takes the seconds done."""
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed:.1f} s"), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(escape(session.title), total=session.duration)
        yield lambda seconds: bar.update(task, completed=seconds)


@contextmanager
def counting(what: str) -> Iterator[Callable[[int, int], None]]:
    """A bar over runs done, only on a terminal; gives a function that takes the number done and the number of all."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed} of {task.total}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, of: bar.update(task, completed=done, total=of)


def show(session: Session, outcome: RunOutcome, out: Path) -> None:
    """Print the result of a session."""
    console = Console()
    speed = outcome.seconds / outcome.took if outcome.took > 0 else 0.0
    console.print(
        f"[bold]{escape(session.title)}[/bold]: {outcome.seconds:g} s simulated in {outcome.took:.1f} s ({speed:.1f} x real time)"
    )
    line = [f"{time:.2f} s [{COLOURS.get(mode, 'default')}]{mode.value}[/]" for time, mode in outcome.modes]
    console.print("Modes: " + "  ".join(line))
    if outcome.verdicts:
        table = Table("", "expected", "seen", box=None, pad_edge=False)
        for verdict in outcome.verdicts:
            mark = "[green]pass[/green]" if verdict.passed else "[bold red]FAIL[/bold red]"
            table.add_row(mark, escape(verdict.expected), escape(verdict.seen))
        console.print(table)
    failed = sum(not verdict.passed for verdict in outcome.verdicts)
    console.print(f"{len(outcome.verdicts) - failed} expectations met, {failed} not")
    console.print(f"{len(outcome.events)} events; all is in {escape(str(out))}")


def show_all(names: list[str], outcomes: list[RunOutcome], out: Path) -> None:
    """Print the results of several sessions: a line for each, and under it the expectations that were not met."""
    table = Table("", "session", "met", "simulated [s]", "took [s]", "events", box=None, pad_edge=False)
    for column in (2, 3, 4, 5):
        table.columns[column].justify = "right"
    for name, outcome in zip(names, outcomes, strict=True):
        mark = "[green]pass[/green]" if outcome.passed else "[bold red]FAIL[/bold red]"
        met = sum(verdict.passed for verdict in outcome.verdicts)
        numbers = (f"{outcome.seconds:g}", f"{outcome.took:.1f}", str(len(outcome.events)))
        table.add_row(mark, escape(name), f"{met} of {len(outcome.verdicts)}", *numbers)
        for verdict in outcome.verdicts:
            if not verdict.passed:
                table.add_row("", escape(f"  expected {verdict.expected}; seen: {verdict.seen}"))
    console = Console()
    console.print(table)
    failed = sum(not outcome.passed for outcome in outcomes)
    console.print(f"{len(outcomes) - failed} sessions passed, {failed} not; results in {escape(str(out))}")


def show_seeds(found: list[SessionAtSeeds], out: Path) -> None:
    """Print the results of sessions at many seeds: a line for each, under it the expectations not met, and the nearest one."""
    table = Table("", "session", "passed", box=None, pad_edge=False)
    for each in found:
        mark = "[bold red]FAIL[/bold red]" if each.failed else "[green]pass[/green]"
        table.add_row(mark, escape(each.name), f"{each.runs - len(each.failed)} of {each.runs}")
        for missed in each.missed:
            seeds = f"seed{'s' if len(missed.seeds) > 1 else ''} {', '.join(map(str, missed.seeds))}"
            table.add_row("", escape(f"  {seeds}: expected {missed.expected}; seen: {missed.seen}"))
        if each.nearest is not None:
            expected, seed, seen, margin = each.nearest
            table.add_row("", escape(f"  nearest to its bound, by {margin:.1%}: {expected}; seen: {seen}, at seed {seed}"))
    console = Console()
    console.print(table)
    runs, failed = sum(each.runs for each in found), sum(len(each.failed) for each in found)
    whole = sum(not each.failed for each in found)
    console.print(
        f"{whole} of {len(found)} sessions passed at every seed, {runs - failed} of {runs} runs; results in {escape(str(out))}"
    )
