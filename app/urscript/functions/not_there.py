"""Functions of the language that this robot does not have, each with the reason. A program that calls one ends there."""

from collections.abc import Iterator

from app.urscript.machine.signature import Builtin, absent

NO_SCREWDRIVER = "this robot has no screwdriver; force_mode() pushes along an axis"
NO_EIP = "this robot has no EtherNet/IP; Modbus, XML-RPC, sockets and RTDE registers exchange data"
NO_ROS = "this robot runs no ROS 2 of its own; UR's ROS 2 driver talks to it"
NO_INTERPRETER = "this robot serves no interpreter (port 30020); send programs to the ports 30001 to 30003"
NO_EUROMAP = "this robot has no Euromap67 interface"
NO_AXES = "this robot has no external axes"

NOT_THERE = {
    "screw_driving": NO_SCREWDRIVER,
    "end_screw_driving": NO_SCREWDRIVER,
    "tool_wrench_limit_set": "this robot's motions are not limited by the wrench on the tool; give the motions less acceleration",
    "set_pos": "it places the arm of UR's own simulator; use movej()",
    **dict.fromkeys(("eip_reader_factory", "eip_writer_factory"), NO_EIP),
    **{f"ros_{name}_factory": NO_ROS for name in ("publisher", "subscriber", "service_client", "action_client")},
    **dict.fromkeys(("interpreter_mode", "end_interpreter", "clear_interpreter"), NO_INTERPRETER),
    **dict.fromkeys(("set_euromap_output", "set_euromap_runstate_dependent_choice"), NO_EUROMAP),
    **dict.fromkeys(
        ("frame_tracking_enable", "frame_tracking_disable"), "this robot tracks conveyors alone: track_conveyor_linear()"
    ),
    **{f"axis_group_{name}": NO_AXES for name in ("add", "add_axis", "delete", "get_target_positions", "moveJ", "moveL")},
    "set_mass_properties": "frames have no mass here; use set_target_payload()",
    "set_payload_from_attached_frames": "frames have no mass here; use set_target_payload()",
}
"""Why a program cannot call a function, by the function's name."""


def of_what_is_not_there() -> Iterator[Builtin]:
    """All of them."""
    for name, why in NOT_THERE.items():
        yield absent(name, why)
