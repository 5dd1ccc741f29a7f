from collections.abc import Callable

import msgspec
import pytest

from app.session.actions import (
    Action,
    Axes,
    Bump,
    ChangeSettings,
    Hold,
    HoldJog,
    Laboratory,
    Lean,
    LoadProgram,
    Press,
    Pushing,
    Release,
    SelectTool,
    SetPayload,
    Tap,
    Twisting,
)
from app.session.profiles import Ramp
from app.session.timeline import Timeline
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.inputs import Button, Command
from pendant.program.jog_move import JogMove
from pendant.program.steps import Program as Steps
from pendant.program.steps import Wait
from pendant.tick.modes import Mode
from sim.arm.scenario import Load
from sim.exchange.desk import Wishes
from sim.plant.changes import DropPayload
from sim.plant.touch import Pull, Push
from tests.app.fakes import JOINTS, decision, happened, snapshot

HELD = frozenset({Button.FREE_DRIVE})


def play(actions: list[Action], count: int, decide: Callable[[int], Decision] = lambda tick: decision()) -> list[Wishes]:
    """The wishes of ticks 1 to `count`, at index tick - 1."""
    timeline = Timeline(actions, JOINTS)
    played = []
    for tick in range(1, count + 1):
        played.append(timeline.wishes(tick, lambda: snapshot(1, (0.5, 0.0, 0.0))))
        timeline.see(tick, decide(tick))
    return played


def test_a_press_is_kept_alive_every_tick_until_the_release() -> None:
    played = play([Press(at=0.004, control="free_drive"), Release(at=0.010, control="free_drive")], 7)
    assert [wishes.inputs.held for wishes in played] == [frozenset(), HELD, HELD, HELD, frozenset(), frozenset(), frozenset()]
    assert [wishes.inputs.released for wishes in played] == [frozenset()] * 4 + [HELD] + [frozenset()] * 2


def test_a_tap_of_a_button_presses_and_lets_go() -> None:
    played = play([Tap(at=0.0, control="free_drive", length=0.006)], 5)
    assert [bool(wishes.inputs.held) for wishes in played] == [True, True, True, False, False]
    assert [bool(wishes.inputs.released) for wishes in played] == [False, False, False, True, False]


def test_commands_act_in_one_tick_only() -> None:
    played = play([Tap(at=0.004, control="emergency_stop"), LoadProgram(at=0.004, command="start")], 4)
    assert [wishes.inputs.commands for wishes in played] == [(), (Command.EMERGENCY_STOP, Command.START_PROGRAM), (), ()]


def test_a_jog_button_is_held_for_its_time_and_then_let_go() -> None:
    move = JogMove(frame="base", axis=2, sign=-1)
    played = play([HoldJog(at=0.002, length=0.004, move=move)], 5)
    assert [wishes.inputs.jog for wishes in played] == [move, move, None, None, None]
    assert [wishes.inputs.jog_released for wishes in played] == [False, False, True, False, False]


def test_settings_and_changes_are_passed_on_once() -> None:
    played = play([ChangeSettings(at=0.0, set={"free_drive.period": 2.0}), Laboratory(at=0.002, change=DropPayload())], 3)
    assert [wishes.inputs.settings for wishes in played] == [{"free_drive.period": 2.0}, {}, {}]
    assert [wishes.changes for wishes in played] == [(DropPayload(),), (), ()]


def test_tool_and_payload_are_passed_on_once() -> None:
    played = play([SelectTool(at=0.0, tool="gripper"), SetPayload(at=0.004, load=Load(mass=2.0))], 3)
    assert [wishes.inputs.tool for wishes in played] == ["gripper", "", ""]
    assert [wishes.inputs.load for wishes in played] == [None, Load(mass=2.0), None]


def test_axes_are_freed_and_locked_by_settings() -> None:
    plane, own = Axes(at=0.0, preset="plane", frame="tool"), Axes(at=0.004, free=["z", "rx"], frame="user", rpy=[0.1, 0.2, 0.3])
    first, second = (wishes.inputs.settings for wishes in play([plane, own], 2))
    free = {"x": True, "y": True, "z": False, "rx": False, "ry": False, "rz": True}
    turned = {"axes.roll": 0.0, "axes.pitch": 0.0, "axes.yaw": 0.0}
    assert first == {**{f"axes.{axis}": value for axis, value in free.items()}, "axes.frame": "tool", **turned}
    assert [axis for axis in free if second[f"axes.{axis}"] is True] == ["z", "rx"]
    assert (second["axes.frame"], second["axes.roll"], second["axes.yaw"]) == ("base", 0.1, 0.3)


@pytest.mark.parametrize(
    "fields", [{}, {"preset": "all", "free": ["x"]}, {"free": [], "rpy": [0.1, 0.0, 0.0]}, {"preset": "all", "frame": "world"}]
)
def test_axes_say_what_is_free_once_and_turn_the_users_frame_alone(fields: dict[str, object]) -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"do": "axes", "at": 0.0, **fields}, Axes)


def test_the_program_is_loaded_in_the_first_tick() -> None:
    steps = Steps(steps=(Wait(duration=1.0),))
    timeline = Timeline([], JOINTS, steps)
    assert [timeline.wishes(tick, lambda: snapshot(1)).inputs.program for tick in (1, 2)] == [steps, None]


def test_a_push_lasts_its_time_and_follows_its_profile() -> None:
    push = Pushing(
        at=0.002, length=0.008, part="elbow", point=[0.0, 0.1, 0.0], force=[0.0, 40.0, 0.0], profile=Ramp(rise=0.004, fall=0.0)
    )
    played = play([push], 6)
    assert [touch.force[1] for wishes in played for touch in wishes.touches if isinstance(touch, Push)] == [0.0, 20.0, 40.0, 40.0]
    assert played[0].touches == (Push("elbow", (0.0, 0.1, 0.0), (0.0, 0.0, 0.0)),)
    assert played[4].touches == ()


def test_each_kind_of_effort_gives_its_touch() -> None:
    efforts: list[Action] = [
        Twisting(at=0.0, length=0.01, torque=[0.0, 0.0, 2.0]),
        Bump(at=0.0, length=0.004, force=[10.0, 0.0, 0.0]),
        Lean(at=0.0, length=2.0, force=[0.0, 0.0, -30.0]),
    ]
    second = play(efforts, 2)[1].touches
    assert second[0] == Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    assert second[1] == Push("flange", (0.0, 0.0, 0.0), (pytest.approx(10.0), 0.0, 0.0))
    assert second[2] == Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, pytest.approx(-30.0 * 0.002 / 0.5)))


def test_a_hold_takes_the_place_it_finds_and_carries_it() -> None:
    played = play([Hold(at=0.0, length=0.008, point=[0.0, 0.0, 0.1], carry=[0.0, 0.0, 0.04], cap=20.0)], 6)
    assert played[0].touches == ()  # nothing is known of the arm before the first tick
    pulls = [touch for wishes in played for touch in wishes.touches if isinstance(touch, Pull)]
    assert [pull.target for pull in pulls] == [pytest.approx((0.5, 0.0, 0.1 + 0.01 * i)) for i in range(4)]
    assert {pull.cap for pull in pulls} == {20.0}


def test_after_counts_from_what_the_robot_did() -> None:
    actions: list[Action] = [
        Tap(after="mode FREE_DRIVE", delay=0.004, control="reset"),
        Tap(after="event entered", control="teach"),
        Tap(after="event entered", nth=2, control="normal"),
    ]

    def decide(tick: int) -> Decision:
        return happened(Kind.ENTERED, tick) if tick in (2, 5) else decision(Mode.FREE_DRIVE if tick >= 4 else Mode.TEACH)

    commands = {tick: wishes.inputs.commands for tick, wishes in enumerate(play(actions, 9, decide), 1) if wishes.inputs.commands}
    assert commands == {3: (Command.TEACH,), 6: (Command.RESET, Command.NORMAL)}


def test_what_never_came_is_told() -> None:
    actions: list[Action] = [Tap(at=0.0, control="reset"), Tap(after="mode RUN", control="teach")]
    timeline = Timeline(actions, JOINTS)
    for tick in range(1, 4):
        timeline.wishes(tick, lambda: snapshot(1))
        timeline.see(tick, decision())
    assert [place for place, _ in timeline.unstarted()] == [1]
