"""Faults on command: the HTTP control channel of a served robot.

Uses files/, log/, robot_interface/controller/, robot_interface/transport/, runs/, session/.
"""
