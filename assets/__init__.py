"""Data that the product ships: robots, meshes, tools, worlds, sessions."""
