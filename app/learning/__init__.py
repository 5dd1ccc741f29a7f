"""For learning: an environment of Gymnasium, and guided demonstrations as data sets of LeRobot.

Uses engine/, files/, log/, log_reading/, session/, runs/.
"""
