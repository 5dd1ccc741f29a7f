"""A script in the robot: where it comes from, what it asks of the arm, how it ends.

Uses robot_interface/controller/, robot_interface/gripper/, urscript/calculation/, urscript/functions/,
urscript/language/, urscript/machine/, urscript/outside/, urscript/robot/.
"""
