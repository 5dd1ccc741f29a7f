"""RTDE, versions 1 and 2: recipes, packages of every tick, inputs.

Uses robot_interface/controller/, robot_interface/transport/.
"""
