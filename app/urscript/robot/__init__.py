"""The robot as the functions of the language see it, and what it keeps from one program to the next.

Uses robot_interface/controller/, urscript/calculation/, urscript/language/, urscript/machine/,
urscript/outside/.
"""
