"""Sessions that run without a window: one, many, for claims, and what is told of them.

Uses engine/, files/, log/, report/, robot_interface/controller/, robot_interface/dashboard/, session/, urscript/language/,
urscript/running/.
"""
