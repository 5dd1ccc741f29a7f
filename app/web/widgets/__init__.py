"""Pieces of the page that know nothing of the robot."""
