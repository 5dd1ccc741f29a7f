"""Sessions that run without a window: one, many, for claims, and what is told of them.

Uses engine/, files/, log/, log_reading/, report/, robot_interface/controller/, robot_interface/dashboard/, session/,
urscript/language/, urscript/running/.
"""
