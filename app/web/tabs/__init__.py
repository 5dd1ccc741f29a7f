"""The docks on the left side. Uses files/, report/, robot_interface/, robot_interface/controller/,
robot_interface/transport/, runs/, urscript/language/, urscript/running/, web/access/, web/scene/, web/tool_point/, web/tuning/,
web/widgets/.
"""
