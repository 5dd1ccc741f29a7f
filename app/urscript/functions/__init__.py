"""The functions that come with the language.

Uses robot_interface/controller/, urscript/language/, urscript/machine/.
"""
