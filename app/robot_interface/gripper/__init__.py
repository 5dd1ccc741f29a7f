"""The text protocol of a two-finger gripper, as programs and clients know it.

Uses robot_interface/transport/.
"""
