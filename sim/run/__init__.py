"""The paced loop: a simulation in a thread of its own. Uses arm/, exchange/."""
