"""Rigid-body dynamics as the controller believes it. Uses arm/, compiled/."""
