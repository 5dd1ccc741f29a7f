"""All functions of the language, for one robot."""

from collections import deque

from app.urscript.calculation.mathematics import of_numbers, of_poses
from app.urscript.calculation.payload_estimate import of_payload_estimate
from app.urscript.calculation.texts import of_texts
from app.urscript.calculation.world_model import of_frames
from app.urscript.functions.beside_the_way import of_conveyors, of_encoders, of_path_offsets
from app.urscript.functions.controller_values import of_controller
from app.urscript.functions.installation import of_installation
from app.urscript.functions.motions import of_moves, of_streams, of_torques
from app.urscript.functions.not_there import of_what_is_not_there
from app.urscript.functions.sensing_values import of_history, of_kinematics, of_measurement
from app.urscript.functions.set_up import of_force, of_free_drive, of_set_up
from app.urscript.functions.signals import of_inputs_and_outputs, of_registers
from app.urscript.functions.time_and_talk import of_talk, of_time
from app.urscript.machine.signature import Builtin, barred
from app.urscript.outside.conversations import of_sockets
from app.urscript.outside.modbus_functions import of_modbus
from app.urscript.outside.remote_calls import of_remote_calls
from app.urscript.robot.robot_side import RobotSide
from sim.arm.frames import rotation_vector

SECONDARY = "it takes time, which a secondary program must not"


def builtins_of(robot: RobotSide, history: deque[tuple[float, ...]], secondary: bool = False) -> dict[str, Builtin]:
    """All functions by name. A `secondary` program must not move the arm or wait (URScript manual, "Secondary programs")."""
    found = [
        *of_numbers(robot.seed),
        *of_poses(),
        *of_texts(),
        *of_time(robot),
        *of_talk(robot),
        *of_registers(robot.record),
        *of_inputs_and_outputs(robot),
        *of_installation(robot),
        *of_controller(robot),
        *of_frames(robot.memory.world),
        *of_payload_estimate(lambda: tuple(rotation_vector(robot.simulation.R_FT)), lambda: tuple(robot.simulation.estimate.g_B)),
        *of_what_is_not_there(),
        *of_sockets(robot.sockets),
        *of_remote_calls(robot.hosts),
        *of_modbus(robot.memory.units, robot.hosts),
        *of_measurement(robot),
        *of_history(robot, history),
        *of_kinematics(robot),
        *of_moves(robot),
        *of_streams(robot),
        *of_torques(robot),
        *of_path_offsets(robot),
        *of_conveyors(robot),
        *of_encoders(robot),
        *of_force(robot),
        *of_free_drive(robot),
        *of_set_up(robot),
    ]
    return {each.name: barred(each.name, SECONDARY) if secondary and each.physical else each for each in found}
