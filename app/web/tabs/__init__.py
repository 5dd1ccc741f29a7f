"""The docks on the left side. Uses files/, learning/, log/, robot_interface/, robot_interface/controller/,
robot_interface/transport/, runs/, web/scene/, web/tuning/, web/widgets/.
"""
