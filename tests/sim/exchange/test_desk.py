"""The desk: latest values, queues, touches that last, any thread."""

import threading

from pendant.inputs import Button, Command, Inputs
from pendant.program.steps import Program, Wait
from sim.arm.scenario import BARE, Load, ToolModel
from sim.exchange.desk import Desk, Wishes
from sim.plant.changes import DropPayload, Temperature
from sim.plant.touch import Push

EMPTY = Wishes(Inputs(), (), ())
FIRST = Push("flange", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
SECOND = Push("elbow", (0.0, 0.0, 0.0), (0.0, 2.0, 0.0))
HOOK = ToolModel(name="hook", mass=0.3, com=[0.0, 0.0, 0.02], tcp=[0.0, 0.0, 0.08])
PROGRAM = Program(steps=(Wait(duration=1.0),))


def full() -> Desk:
    desk = Desk()
    desk.hold(Button.FREE_DRIVE)
    desk.command(Command.RESET)
    desk.set({"free_drive.period": 5.0})
    desk.load(PROGRAM)
    desk.change(DropPayload())
    desk.touch("anna", FIRST)
    return desk


def test_an_untouched_desk_wishes_nothing() -> None:
    assert Desk().take() == EMPTY


def test_everything_but_touches_is_taken_once() -> None:
    desk = full()
    inputs = Inputs(frozenset({Button.FREE_DRIVE}), frozenset(), (Command.RESET,), {"free_drive.period": 5.0}, PROGRAM)
    assert desk.take() == Wishes(inputs, (FIRST,), (DropPayload(),))
    assert desk.take() == Wishes(Inputs(), (FIRST,), ())


def test_what_was_taken_never_changes_afterwards() -> None:
    desk = full()
    taken = desk.take()
    desk.set({"free_drive.period": 9.0})
    desk.command(Command.TEACH)
    assert taken.inputs.settings == {"free_drive.period": 5.0}
    assert taken.inputs.commands == (Command.RESET,)


def test_commands_and_changes_queue_in_order() -> None:
    desk = Desk()
    warm = Temperature(celsius=50.0)
    for command in (Command.RESET, Command.NORMAL, Command.RESET):
        desk.command(command)
    for change in (warm, DropPayload(), warm):
        desk.change(change)
    wishes = desk.take()
    assert wishes.inputs.commands == (Command.RESET, Command.NORMAL, Command.RESET)
    assert wishes.changes == (warm, DropPayload(), warm)


def test_the_latest_value_of_a_setting_and_the_latest_program_count() -> None:
    desk, other = Desk(), Program(name="other", steps=(Wait(duration=2.0),))
    desk.set({"free_drive.period": 5.0, "free_drive.gain": 0.5})
    desk.set({"free_drive.period": 7.0})
    desk.load(PROGRAM)
    desk.load(other)
    inputs = desk.take().inputs
    assert inputs.settings == {"free_drive.period": 7.0, "free_drive.gain": 0.5}
    assert inputs.program == other


def test_the_last_of_hold_and_release_counts() -> None:
    desk = Desk()
    desk.hold(Button.FREE_DRIVE)
    desk.release(Button.FREE_DRIVE)
    assert desk.take().inputs == Inputs(released=frozenset({Button.FREE_DRIVE}))
    desk.release(Button.FREE_DRIVE)
    desk.hold(Button.FREE_DRIVE)
    assert desk.take().inputs == Inputs(held=frozenset({Button.FREE_DRIVE}))


def test_a_touch_moves_with_its_owner_and_ends_with_him() -> None:
    desk = Desk()
    desk.touch("anna", FIRST)
    desk.touch("ben", FIRST)
    desk.touch("anna", SECOND)
    assert desk.take().touches == (SECOND, FIRST)
    desk.let_go("anna")
    desk.let_go("anna")
    desk.let_go("nobody")
    assert desk.take().touches == (FIRST,)
    desk.let_go("ben")
    assert desk.take() == EMPTY


def test_clear_forgets_all() -> None:
    desk = full()
    desk.release(Button.FREE_DRIVE)
    desk.clear()
    assert desk.take() == EMPTY


def test_no_command_is_lost_or_doubled_between_threads() -> None:
    desk, count, writers = Desk(), 2000, 4
    done = threading.Event()
    taken: list[Command] = []
    touches: set[int] = set()

    def write() -> None:
        for k in range(count):
            desk.command(Command.RESET)
            desk.touch(f"hand {k % 3}", FIRST)
            desk.let_go(f"hand {k % 3}")

    def take() -> None:
        while not done.is_set():
            wishes = desk.take()
            taken.extend(wishes.inputs.commands)
            touches.add(len(wishes.touches))

    reader = threading.Thread(target=take)
    threads = [threading.Thread(target=write) for _ in range(writers)]
    for thread in (reader, *threads):
        thread.start()
    for thread in threads:
        thread.join()
    done.set()
    reader.join()
    wishes = desk.take()
    assert len(taken) + len(wishes.inputs.commands) == count * writers
    assert max(touches) <= 3
    assert wishes.touches == ()


def test_a_configured_payload_is_taken_once() -> None:
    desk = Desk()
    desk.configure(Load(mass=1.0))
    desk.configure(Load(mass=2.0))
    assert desk.take().inputs.load == Load(mass=2.0)
    assert desk.take() == EMPTY


def test_a_chosen_tool_is_taken_once() -> None:
    desk = Desk()
    desk.choose("sphere")
    desk.choose("gripper")
    assert desk.take().inputs.tool == "gripper"
    assert desk.take() == EMPTY


def test_a_table_of_tools_is_taken_once() -> None:
    desk = Desk()
    desk.tabulate((BARE,))
    desk.tabulate((BARE, HOOK))
    assert desk.take().inputs.tools == (BARE, HOOK)
    assert desk.take() == EMPTY


def test_digital_inputs_keep_their_level() -> None:
    desk = Desk()
    desk.wire(3, True)
    desk.wire(5, True)
    desk.wire(3, True)
    assert desk.take().inputs.high == {3, 5}
    desk.wire(5, False)
    desk.wire(0, False)
    assert desk.take().inputs.high == desk.high == {3}
    desk.clear()
    assert desk.high == frozenset()
    assert desk.take() == EMPTY


def test_a_cleared_desk_configures_nothing() -> None:
    desk = Desk()
    desk.tabulate((BARE,))
    desk.configure(Load(mass=1.0))
    desk.choose("gripper")
    desk.clear()
    assert desk.take() == EMPTY


def test_the_wishes_of_two_are_joined() -> None:
    other = Wishes(
        Inputs(
            frozenset(),
            frozenset({Button.FREE_DRIVE}),
            (Command.TEACH,),
            {"a": 1.0, "free_drive.period": 2.0},
            high=frozenset({2}),
            tool="gripper",
            load=Load(mass=1.0),
            tools=(BARE, HOOK),
        ),
        (SECOND,),
        (Temperature(celsius=50.0),),
    )
    desk = full()
    desk.wire(1, True)
    joined = desk.take().joined(other)
    settings = {"free_drive.period": 2.0, "a": 1.0}
    commands = (Command.RESET, Command.TEACH)
    button = frozenset({Button.FREE_DRIVE})
    inputs = Inputs(button, button, commands, settings, PROGRAM, frozenset({1, 2}), "gripper", Load(mass=1.0), (BARE, HOOK))
    assert joined == Wishes(inputs, (FIRST, SECOND), (DropPayload(), Temperature(celsius=50.0)))
    assert EMPTY.joined(EMPTY) == EMPTY
