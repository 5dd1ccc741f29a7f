"""The report's figures against the log's numbers, computed in another way, and its page against what a browser needs."""

import math
import re
from collections.abc import Sequence
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from app.files.checked import BadInput, convert
from app.log.events_file import EventLine
from app.log.layout import PULL, WORDS
from app.log_reading.reader import Log, read
from app.report.charts import PULL_CAPTION, charts
from app.report.files import write_report
from app.report.gathering import COLUMNS, HELD, POINTS, Column, Gathered, HeldSeen, LineSeen, PeakSeen, Span, SpansSeen, thinned
from app.report.page import page
from app.report.pull_colours import PULL_COLOURS
from app.report.regions import regions
from app.report.summary import NOT_A_VALIDATION, Summary
from app.report.summary import summarise as summary_of
from app.runs.runner import record
from app.session.expectation_watch import Verdict
from app.session.prepare import prepare
from app.session.session_file import Session
from pendant.guided.pull import SHARE_WORDS
from tests.app.log.older_recording import older

SESSION: dict[str, Any] = {
    "title": "A <report> & more",
    "duration": 2.4,
    "seed": 3,
    "settings": {"activation.period": 0.1, "sequence.period": 0.25},
    "timeline": [
        {"at": 0.5, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.1, "do": "push", "for": 0.2, "force": [0.0, 12.0, 0.0]},
        {"after": "mode FREE_DRIVE", "delay": 0.4, "do": "tap", "control": "emergency_stop"},
    ],
}


def recorded(text: dict[str, Any], out: Path) -> Log:
    session = convert(text, Session, "s.yaml")
    record(session, prepare(session, "s.yaml"), out)
    return read(out / "log.mcap")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return recorded(SESSION, tmp_path_factory.mktemp("run"))


def summarise(log: Log, verdicts: Sequence[Verdict] = ()) -> Summary:
    return summary_of(Gathered(log), verdicts)


def pulls(log: Log) -> list[Column]:
    return Gathered(log).pulls.found


RAMP = {"shape": "ramp", "rise": 0.1, "fall": 0.1}
DROP: dict[str, Any] = {
    "title": "A payload falls out of a hand",
    "duration": 2.4,
    "seed": 3,
    "payload_true": {"mass": 2.0},
    "payload_configured": {"mass": 2.0},
    "settings": {"activation.period": 0.1, "sequence.period": 0.25},
    "timeline": [
        {"at": 0.5, "do": "press", "control": "free_drive"},
        {
            "after": "mode FREE_DRIVE",
            "delay": 0.3,
            "do": "push",
            "for": 0.9,
            "part": "flange",
            "force": [0.0, 8.0, 0.0],
            "profile": RAMP,
        },
        {"after": "mode FREE_DRIVE", "delay": 0.6, "do": "change", "change": {"kind": "drop_payload"}},
    ],
}


@pytest.fixture(scope="module")
def dropped(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return recorded(DROP, tmp_path_factory.mktemp("drop"))


def painted(svg: str, colour: str) -> list[tuple[float, float]]:
    """Begin and end of the areas of that colour, each, in units of the picture; the legend's are left out."""
    found: list[tuple[float, float]] = []
    for path in re.findall(rf'<path (?:id="\w+" )?d="([^"]*)"[^>]*style="[^"]*stroke: {colour}; stroke-width: 0\.3"', svg):
        x = [float(each) for each in re.findall(r"[ML] ([\d.]+)", path)]
        found.append((min(x), max(x)))
    return sorted(found)


def test_the_report_shows_what_pulls_and_when_the_payload_fell(dropped: Log) -> None:
    """FD-19: a bar while the arm is free, with the payload in it at the time of the drop alone."""
    free = dropped.t[dropped.state["mode"] == WORDS["mode"].index("FREE_DRIVE")]
    columns = pulls(dropped)
    width = 2.4 / COLUMNS + 0.002
    assert free[0] - width <= columns[0].begin <= free[0]
    (stop,) = [event for event in dropped.events if event.kind == "stopped_payload"]
    assert stop.t <= columns[-1].end + 1e-9 < stop.t + width
    held = [column for column in columns if free[0] + 0.4 < column.begin < free[0] + 0.59]
    assert held
    assert all(column.pull.words == "A hand" for column in held)
    fell = [column for column in columns if column.pull.shares.payload > 0.99]
    assert columns[-1] in fell
    assert all(stop.t - 0.02 < column.end for column in fell)
    assert fell[-1].pull.words == "The payload fell: over 99.9 %"
    (picture,) = [svg for caption, svg in charts(Gathered(dropped), summarise(dropped)) if caption == PULL_CAPTION]
    areas = {name: painted(picture, colour) for name, colour in zip(SHARE_WORDS, PULL_COLOURS, strict=True)}
    assert areas["A hand"]
    assert areas["Payload changed"][-1][1] == max(end for each in areas.values() for _, end in each)
    assert all(end - begin > 0.5 for begin, end in areas["Payload changed"][-1:])
    assert set(re.findall(r">([A-Z][a-z ]+)</text>", picture)) >= set(SHARE_WORDS)


def test_without_free_drive_or_in_an_older_recording_there_is_no_bar(dropped: Log, tmp_path: Path) -> None:
    older(dropped.path, tmp_path / "older.mcap", set(PULL))
    before = read(tmp_path / "older.mcap")
    assert pulls(before) == []
    assert PULL_CAPTION not in dict(charts(Gathered(before), summarise(before)))


@pytest.fixture(scope="module")
def summary(log: Log) -> Summary:
    return summarise(log, [Verdict(True, "mode RUN", "at 1 s"), Verdict(False, "mode <STOP>", "never")])


def test_the_figures_are_those_of_the_log(log: Log, summary: Summary) -> None:
    assert summary.duration == pytest.approx(2.4)
    assert summary.tcp_speed.value == max(log.state["v_tcp"].tolist())
    assert log.state["v_elbow"][round(summary.elbow_speed.t * 500) - 1] == summary.elbow_speed.value
    assert summary.told_tool.value == pytest.approx(max(math.hypot(*row[:3]) for row in log.state["F_user"].tolist()), rel=1e-12)
    forces = np.maximum(log.truth["contact_tool"], log.truth["contact_link"]).tolist()
    assert summary.force_peak.value == pytest.approx(max(forces), rel=1e-12)
    assert summary.force_held.value == pytest.approx(max(min(forces[k : k + 250]) for k in range(len(forces) - 249)), rel=1e-12)
    assert [span.name for span in summary.modes] == ["TEACH", "FREE_DRIVE", "STOP"]
    assert [span.name for span in summary.phases] == ["ACTIVATION", "SEQUENCE", "HELD"]
    assert summary.phases[1].end - summary.phases[1].begin == pytest.approx(0.25)
    assert [event.kind for event in summary.messages] == ["emergency_stop"]
    assert not summary.passed


def test_margins_are_the_worst_share(log: Log, summary: Summary) -> None:
    found = {margin.parameter: margin for margin in summary.margins}
    pairs = zip(log.state["monitored_flange_speed"].tolist(), log.state["limit_flange_speed"].tolist(), strict=True)
    worst = max(value / limit for value, limit in pairs if limit == limit)
    assert found["flange speed"].share == pytest.approx(worst)
    assert [margin.share for margin in summary.margins] == sorted((m.share for m in summary.margins), reverse=True)
    assert len(summary.margins) >= 8


def test_what_ended_a_check_at_once_is_a_margin_too(log: Log) -> None:
    def told(value: float, t: float) -> EventLine:
        values: dict[str, Any] = {"parameter": "payload-like force", "part": "flange", "value": value, "limit": -5.3, "unit": "N"}
        return EventLine(tick=1, t=t, kind="entry_prevented", severity="WARNING", headline="", guidance="", values=values)

    before = {margin.parameter: margin for margin in summarise(log).margins}
    log.events += [told(-0.001, 0.5), told(-19.6, 0.7), told(-10.0, 0.8)]
    after = {margin.parameter: margin for margin in summarise(log).margins}
    del log.events[-3:]
    found = after.pop("payload-like force")
    assert (found.value, found.limit, found.unit, found.t) == (-19.6, -5.3, "N", 0.7)
    assert found.share == pytest.approx(19.6 / 5.3)
    del before["payload-like force"]
    assert after == before


def test_a_contact_is_timed_from_its_true_onset(log: Log) -> None:
    """CD-16: the push begins and ends the only touch."""
    touched = log.truth["touched"]
    assert set(touched) == {0.0, 1.0}
    begin, end = (float(log.t[1:][np.diff(touched) == way][0]) for way in (1.0, -1.0))
    assert end - begin == pytest.approx(0.2)

    def told(kind: str, t: float) -> EventLine:
        return EventLine(tick=1, t=t, kind=kind, severity="NOTICE", headline="", guidance="", values={"steps": 3})

    events = [
        told("contact_gained", begin - 0.002),
        told("contact_gained", begin),
        told("contact_clamping", begin + 0.01),
        told("contact_lost", begin + 0.1),
        told("contact_lost", end + 0.004),
        told("contact_resistance", end),
    ]
    log.events += events
    summary = summarise(log)
    text = page(summary, [])
    del log.events[-len(events) :]
    assert summary.onset_delays == [None, 0.0, pytest.approx(0.01), None, pytest.approx(0.004), None]
    assert re.search(r"<td[^>]*>6</td><td[^>]*>10</td>", text)


def test_a_stop_is_timed_until_the_arm_stands(log: Log, summary: Summary) -> None:
    (stop,) = summary.stops
    assert stop.time is not None
    begin = round(stop.t * 500) - 1
    end = begin + round(stop.time * 500)
    speeds = np.abs(log.truth["qd"]).max(axis=1)
    assert np.all(speeds[end : end + 50] <= 0.01)
    assert np.any(speeds[end - 1 : end + 49] > 0.01)
    way = sum(math.dist(log.truth["flange"][k, :3], log.truth["flange"][k + 1, :3]) for k in range(begin, end))
    assert stop.distance == pytest.approx(way)
    assert 0.001 < way < 0.5


def test_forces_are_held_against_every_body_region(summary: Summary) -> None:
    table = {each.region: each for each in regions().regions}
    assert {each.region for each in summary.forces} == set(table)
    for each in summary.forces:
        row = table[each.region]
        peak = summary.force_peak.value / (row.transient if row.transient is not None else row.quasi_static)
        assert each.share == pytest.approx(max(peak, summary.force_held.value / row.quasi_static))
        assert each.within == (each.share <= 1.0)
        assert each.source
    skull = next(each for each in summary.forces if each.region.startswith("skull"))
    assert skull.transient is None


def test_the_safety_checksum_is_of_what_concerns_safety_alone(log: Log, summary: Summary) -> None:
    values = dict(log.settings[0][1])
    values["program.speed"] = 0.5
    log.settings.append((9, values))
    assert summarise(log).limits == summary.limits
    log.settings.append((9, {**values, "limits.activation.flange_speed.max": 0.03}))
    assert summarise(log).limits != summary.limits
    del log.settings[1:]


def test_spans_are_runs_of_equal_codes() -> None:
    t, codes = np.arange(1, 7) * 0.5, np.array([0, 0, 1, 1, 1, 0])
    for cuts in ([], [3], [2, 5], [1, 2, 3, 4, 5]):
        seen = SpansSeen(("A", "B"))
        for part, times in zip(np.split(codes, cuts), np.split(t, cuts), strict=True):
            seen.see(part, times)
        assert seen.found == [Span("A", 0.5, 1.5), Span("B", 1.5, 3.0), Span("A", 3.0, 3.0)]
    assert SpansSeen(("A",)).found == []


def test_what_is_gathered_in_parts_is_what_is_gathered_at_once() -> None:
    """Against the plain formulas on the whole, for cuts that lie anywhere."""
    chance = np.random.default_rng(5)
    for length in (1, HELD - 1, HELD, 3 * HELD + 7, 2 * POINTS + 3):
        t, values = np.arange(1, length + 1) * 0.002, chance.normal(size=length)
        values[chance.integers(0, length, 3)] = np.nan
        peak, held, line = PeakSeen(), HeldSeen(), LineSeen(length)
        for part in np.split(np.arange(length), np.sort(chance.integers(0, length, 4))):
            for seen in (peak, held, line):
                seen.see(values[part], t[part])
        k = int(np.argmax(np.nan_to_num(values, nan=-np.inf)))
        np.testing.assert_equal((peak.found.value, peak.found.t), (values[k], t[k]))
        windows = [values[k : k + HELD].min() for k in range(length - HELD + 1)]
        best = int(np.argmax(np.nan_to_num(windows, nan=-np.inf))) if windows else 0
        np.testing.assert_equal((held.found.value, held.found.t), (windows[best], t[best]) if windows else (0.0, 0.0))
        np.testing.assert_array_equal(line.found, thinned(t, values))


def test_a_report_of_parts_is_that_of_the_whole(dropped: Log, log: Log, monkeypatch: pytest.MonkeyPatch) -> None:
    """A recording of a day is gone through in parts: its figures are the same as if it were looked at as a whole."""
    for each in (dropped, log):
        whole, drawn = summarise(each), charts(Gathered(each), summarise(each))
        for seconds in (0.06, 0.34, 1.0):
            monkeypatch.setattr("app.report.gathering.STRETCH", seconds)
            parts = summarise(each)
            for name in Summary.__struct_fields__:
                if name != "stops":
                    assert getattr(parts, name) == getattr(whole, name), name
            assert [stop.time for stop in parts.stops] == [stop.time for stop in whole.stops]
            assert charts(Gathered(each), parts) == drawn
        monkeypatch.undo()


def test_thinning_keeps_every_peak() -> None:
    t = np.linspace(0.0, 1.0, 10 * POINTS + 7)
    values = np.zeros_like(t)
    values[[3, 4321, len(t) - 1]] = 7.0
    few, kept = thinned(t, values)
    assert len(few) <= POINTS + 20
    assert np.sum(kept == 7.0) == 3
    assert np.all(np.diff(few) > 0)
    assert thinned(t[:5], values[:5])[0].tolist() == t[:5].tolist()


class Page(HTMLParser):
    """Open elements, and whatever would be loaded from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.foreign: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "br"):
            self.open.append(tag)
        self.foreign += [value for name, value in attrs if name in ("src", "href") and value and not value.startswith("#")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_the_page_stands_alone_and_says_what_it_is(log: Log, summary: Summary, tmp_path: Path) -> None:
    contact = EventLine(
        tick=500,
        t=1.0,
        kind="contact_gained",
        severity="NOTICE",
        headline="Touched at 8 N: tool",
        guidance="",
        values={"rule": "rise", "steps": 4, "action": "none"},
    )
    text = page(msgspec.structs.replace(summary, contacts=[contact], onset_delays=[0.004]), charts(Gathered(log), summary))
    parser = Page()
    parser.feed(text)
    assert parser.open == []
    assert parser.foreign == []
    assert "http" not in re.sub(r'xmlns(:xlink)?="[^"]*"|<!DOCTYPE[^>]*>|<rdf:RDF.*?</rdf:RDF>', "", text, flags=re.S)
    assert text.count("<svg") == 6
    assert "at\u00a01\u00a0s" not in text
    assert "at 1\u00a0s" in text  # a number stays with its unit
    assert "A &lt;report&gt; &amp; more" in text
    assert NOT_A_VALIDATION.split(":")[0] in text
    assert "1 of 2 expectations not met" in text
    assert "mode &lt;STOP&gt;" in text
    assert re.search(r"8</td><td[^>]*>4</td><td>none", text)  # 4 ticks are 8 ms; 4 ms after the true onset
    assert f"{1000 * summary.tcp_speed.value:.4g}" in text
    assert "@media print" in text


def test_an_empty_log_gives_a_report_too(log: Log, tmp_path: Path) -> None:
    empty = log.between(100.0, 200.0)
    assert len(empty) == 0
    assert write_report(empty, tmp_path / "new").duration == 0.0
    assert "No expectations were given" in (tmp_path / "new" / "report.html").read_text()
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput):
        write_report(empty, tmp_path / "file")


def test_the_same_log_gives_the_same_bytes(log: Log, tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_report(log, tmp_path / name)
    for name in ("summary.json", "report.html"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def pushed(folder: Path, part: str, force: list[float], **fields: Any) -> Log:
    """A standing arm that a hand pushes at a part."""
    push = {"at": 0.3, "do": "push", "for": 0.6, "part": part, "force": force}
    return recorded({"title": "pushed", "duration": 1.2, "seed": 3, "timeline": [push], **fields}, folder)


def test_the_true_force_counts_where_the_flange_sensor_ends(tmp_path: Path) -> None:
    found = summarise(pushed(tmp_path, "flange", [0.0, 0.0, -500.0]))
    assert found.on_tool.value == pytest.approx(500.0)
    assert found.force_peak == found.on_tool
    assert found.force_held.value == pytest.approx(500.0)
    assert found.told_tool.value < 180.0
    (clip,) = found.clips
    assert re.match(r"the flange sensor ends at 100 N an axis: 500 N true, 1\d\d N sensed", clip)
    assert not any(each.within for each in found.forces if (each.transient or each.quasi_static) < 500.0)
    assert "500 N true" in page(found, [])


def test_a_force_on_a_link_counts(tmp_path: Path) -> None:
    found = summarise(pushed(tmp_path, "wrist_1", [0.0, 0.0, -220.0]))
    assert found.on_link.value == pytest.approx(220.0)
    assert found.on_tool.value == 0.0
    assert found.force_peak.value == pytest.approx(220.0)
    assert 0.0 < found.told_link.value < 400.0
    assert found.told_tool.value < 20.0


def test_what_the_table_bears_is_a_true_force(tmp_path: Path) -> None:
    """The rod stands on a block of 20 N/mm that is pressed by 2 mm when the session begins: 40 N."""
    rod = {"name": "rod", "mass": 0.3, "com": [0.0, 0.0, 0.05], "tcp": [0.0, 0.0, 0.15], "length": 0.15, "radius": 0.02}
    press = {"at": 0.3, "do": "jog", "for": 0.5, "move": {"kind": "jog", "frame": "base", "axis": 2, "sign": -1, "length": 0.012}}
    block = {"kind": "box", "name": "block", "position": [-0.6283, -0.1334, 0.091], "size": [0.2, 0.2, 0.2], "stiffness": 2.0e3}
    about = {"title": "pressed", "duration": 1.4, "seed": 3, "tool": rod, "world": [block], "timeline": [press]}
    log = recorded(about, tmp_path)
    found = summarise(log)
    deep = 0.191 - (log.truth["flange"][-1, 2] - 0.15)
    assert found.on_link.value == 0.0
    assert log.truth["contact_tool"][-1] == pytest.approx(2.0e3 * deep, rel=0.1)
    assert found.clips == []


def test_an_older_recording_says_that_it_has_no_true_force(log: Log, tmp_path: Path) -> None:
    older(log.path, tmp_path / "older.mcap", {"contact_tool", "contact_link", "link_force"})
    found = summarise(read(tmp_path / "older.mcap"))
    assert not found.truth_known
    assert found.force_peak == found.told_tool
    assert "this recording has no true one" in page(found, [])
