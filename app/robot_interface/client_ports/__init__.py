"""The primary, secondary and real-time client interfaces.

Uses robot_interface/controller/, robot_interface/dashboard/, robot_interface/transport/, urscript/language/,
urscript/running/.
"""
