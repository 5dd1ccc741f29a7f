"""Learning with the simulator."""
