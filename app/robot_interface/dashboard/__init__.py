"""The dashboard server: one line in, one line out. Uses files/, robot_interface/controller/, robot_interface/transport/."""
