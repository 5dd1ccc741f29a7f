"""Protective stops of a robot that does not do what it should: following error (RL-1)."""
