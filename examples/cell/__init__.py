"""A program for a UR robot, its tests against the simulated one, and a configuration for continuous integration."""
