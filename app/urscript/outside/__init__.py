"""What leaves a script for other machines, and which of them it may call: sockets, XML-RPC, Modbus.

Uses robot_interface/gripper/, urscript/language/, urscript/machine/.
"""
