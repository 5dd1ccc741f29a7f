"""Protective stops of a robot that does not do what it should, or meets something (RL-1, RL-3)."""
