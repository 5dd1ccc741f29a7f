"""The robot on the network, as UR's clients know it.

Uses files/, log/, robot_interface/client_ports/, robot_interface/controller/, robot_interface/dashboard/,
robot_interface/faults/, robot_interface/gripper/, robot_interface/rtde/, robot_interface/transport/, session/, urscript/running/.
"""
