"""All functions of the language, for one robot."""

from collections import deque

from app.urscript.functions.conversations import of_sockets
from app.urscript.functions.mathematics import of_numbers, of_poses
from app.urscript.functions.motions import of_moves, of_streams, of_torques
from app.urscript.functions.robot_side import RobotSide
from app.urscript.functions.sensing_values import of_history, of_kinematics, of_measurement
from app.urscript.functions.set_up import of_force, of_free_drive, of_set_up
from app.urscript.functions.signals import of_inputs_and_outputs, of_registers
from app.urscript.functions.texts import of_texts
from app.urscript.functions.time_and_talk import of_talk, of_time
from app.urscript.machine.signature import Builtin

CALM = frozenset({"sync"})
"""What a secondary program may do although it takes time."""


def builtins_of(robot: RobotSide, history: deque[tuple[float, ...]], secondary: bool = False) -> dict[str, Builtin]:
    """By name; a secondary program has none that take time."""
    found = [
        *of_numbers(robot.seed),
        *of_poses(),
        *of_texts(),
        *of_time(robot),
        *of_talk(robot),
        *of_registers(robot.record),
        *of_inputs_and_outputs(robot),
        *of_sockets(robot.sockets),
        *of_measurement(robot),
        *of_history(robot, history),
        *of_kinematics(robot),
        *of_moves(robot),
        *of_streams(robot),
        *of_torques(robot),
        *of_force(robot),
        *of_free_drive(robot),
        *of_set_up(robot),
    ]
    return {each.name: each for each in found if not (secondary and each.takes_time and each.name not in CALM)}
