"""The functions that come with the language.

Uses robot_interface/controller/, urscript/calculation/, urscript/language/, urscript/machine/,
urscript/outside/, urscript/robot/.
"""
