"""The laboratory: what its controls ask for, and scenarios."""

from collections.abc import Callable
from html import escape
from pathlib import Path

import pytest

from app.files.checked import load
from app.files.library import load_tool
from app.kept_setup import Keeper
from app.session.session_file import Session, bundled, folder
from app.web.lab.scenarios import TOPICS, scenarios
from app.web.server import Served, serve
from pendant.tick.modes import Mode
from pendant.tooling.tool_in_use import Fitting
from sim.arm.scenario import Load, Scenario
from sim.plant.changes import AnyChange, AttachPayload, DropPayload, FrictionChange, SensorFault, Temperature
from tests.app.web.fake_loop import ARM, FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


@pytest.mark.parametrize(
    ("name", "value", "changes"),
    [
        ("true", 2.0, [AttachPayload(load=Load(mass=2.0))]),
        ("celsius", 40.0, [Temperature(celsius=40.0)]),
        ("wear", 1.5, [FrictionChange(factor=1.5)]),
        (
            "outage",
            True,
            [SensorFault(sensor="force_torque", outage=True), SensorFault(sensor="force_torque", channel=2, outage=True)],
        ),
        ("drift", 0.5, [SensorFault(sensor="force_torque"), SensorFault(sensor="force_torque", channel=2, drift=0.5)]),
    ],
)
def test_a_control_changes_the_true_arm(
    served: Served, join: Join, loop: FakeLoop, name: str, value: object, changes: list[AnyChange]
) -> None:
    client = join()
    client.set(getattr(served.lab, name)._impl.uuid, value=value)
    # A control that asks for two changes may be between them when the loop reads the desk.
    until(lambda: loop.advance() is None and [each for wish in loop.wishes for each in wish.changes] == changes, "the change")


def test_the_controller_is_told_of_a_payload_and_the_difference_is_shown(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.set(served.lab.configured._impl.uuid, value=1.5)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.load == Load(mass=1.5), "configured")
    loop.payload, loop.configured = 3.5, 1.5
    until(lambda: "+2.0 kg wrong" in served.lab.loads.shown, "the difference")
    loop.configured = 3.5
    until(lambda: "as configured" in served.lab.loads.shown, "none")


def test_a_payload_that_was_led_over_is_on_the_slider(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    loop.fitting = Fitting(1, load_tool("flange"), Load(mass=1.992), 0.5, 1.0)
    until(lambda: "1.00 kg" in served.docks.tools.now.shown, "on its way")
    assert served.lab.configured.value == 0.0, "a slider that somebody drags is left alone"
    loop.fitting = Fitting(1, load_tool("flange"), Load(mass=1.992), 1.0, 1.992)
    until(lambda: served.lab.configured.value == 1.992, "done")


def test_the_configured_payload_is_locked_while_the_arm_is_free(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    loop.mode = Mode.FREE_DRIVE
    until(lambda: served.lab.configured.disabled, "locked")


def test_what_hangs_can_be_dropped(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    assert served.lab.drop.disabled
    loop.payload = 2.0
    until(lambda: not served.lab.drop.disabled, "something hangs")
    client.set(served.lab.drop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].changes == (DropPayload(),), "dropped")


def test_another_scenario_sets_the_controls_to_what_it_starts_with(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.set(served.lab.wear._impl.uuid, value=2.0)
    until(lambda: served.lab.wear.value == 2.0, "set")
    loop.payload = 3.0
    loop.scenario = Scenario(seed=3)
    until(lambda: (served.lab.wear.value, served.lab.true.value) == (1.0, 3.0), "set back")


def test_a_set_up_begins_with_what_was_chosen(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    setup = served.lab.setup
    for control, value in ((setup.mounting, "ceiling"), (setup.tool, "gripper"), (setup.world, "table"), (setup.seed, 9)):
        client.set(control._impl.uuid, value=value)
        until(lambda control=control, value=value: control.value == value, "chosen")
    client.set(setup.mismatch._impl.uuid, value=False)
    client.set(setup.begin._impl.uuid, value=True)
    until(lambda: len(loop.begun) == 1, "begun")
    scenario = setup.chosen()
    assert scenario.mounting == pytest.approx([3.141592653589793, 0.0, 0.0])
    assert scenario.tool is not None
    assert (scenario.tool.name, scenario.seed, scenario.mismatch) == ("gripper", 9, "nominal")
    assert [thing.name for thing in scenario.world] == ["floor", "table"]


def test_there_are_twelve_scenarios_each_with_two_sentences() -> None:
    assert len(scenarios()) >= 12
    for session in scenarios().values():
        assert session.watch.count(".") - session.watch.count("0.") >= 2, session.title
        assert len(session.watch) < 260
        assert session.expectations
    assert len({session.title for session in scenarios().values()}) == len(scenarios())
    assert set(scenarios()) <= set(bundled("sessions"))


def test_a_scenario_is_set_up_and_played(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    part = served.lab.scenarios
    session = load(folder("sessions") / "wrong-payload.yaml", Session)
    client.set(part.choice._impl.uuid, value=session.title)
    until(lambda: "2 kg that it was not told of" in part.text.shown, "told")
    client.set(part.begin._impl.uuid, value="Play")
    until(lambda: len(loop.begun) == 1, "begun")
    make, write = loop.begun[0]
    assert make().scenario.payload_true == Load(mass=2.0)
    assert len(write().unstarted()) == len(session.timeline)
    client.set(part.begin._impl.uuid, value="Set up")
    until(lambda: len(loop.begun) == 2, "begun")
    assert loop.begun[1][1]().unstarted() == []


def test_each_scenario_has_one_topic_and_its_whole_title_on_a_card(still: Served) -> None:
    listed = [name for names in TOPICS.values() for name in names]
    assert sorted(listed) == sorted(scenarios())
    shown = still.lab.scenarios.cards.shown
    for session in scenarios().values():
        assert (f">{escape(session.title)}</div>" in shown) == (session.robot == "ur5e")


def test_scenarios_are_found_by_words_and_by_topic(served: Served, join: Join) -> None:
    client = join()
    picker = served.lab.scenarios
    client.set(picker.search._impl.uuid, value="table touches")
    until(lambda: picker.cards.shown.count("data-pd-pick") == 1, "one")
    client.set(picker.search._impl.uuid, value="nothing like this")
    until(lambda: "Nothing has these words" in picker.cards.shown, "none")
    client.set(picker.search._impl.uuid, value="")
    client.set(picker.topic._impl.uuid, value="Free-drive ends")
    until(lambda: picker.cards.shown.count("data-pd-pick") == len(TOPICS["Free-drive ends"]), "those of the topic")


def test_what_is_taught_is_kept_for_the_next_start(loop: FakeLoop, tmp_path: Path) -> None:
    keeper = Keeper(tmp_path, "ur5e")
    served = serve(loop, ARM, Scenario(), keeper=keeper)
    until(lambda: keeper._seen is not None, "seen")
    served.docks.teach.mark()
    served.close()
    kept = keeper.read()
    assert kept is not None
    assert [waypoint.name for waypoint in kept.taught.waypoints] == ["P1"]
    again = serve(loop, ARM, Scenario(), cell=kept)
    assert [step.text for step in again.docks.teach.lesson.plan] == ["Move to P1"]
    assert again.docks.teach.choice.options == ("P1",)
    again.close()
