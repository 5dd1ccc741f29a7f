"""Sessions that run without a window: one, many, for claims; and their results as text.

Uses engine/, files/, log/, log_reading/, report/, robot_interface/controller/, robot_interface/dashboard/, session/,
urscript/language/, urscript/running/.
"""
