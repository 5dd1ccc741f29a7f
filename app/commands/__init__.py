"""Commands of the command line, the options that they share, and how a command ends. Uses arm_import/, files/, learning/,
real_logs/, report/, robot_interface/, runs/, session/, studies/.
"""
