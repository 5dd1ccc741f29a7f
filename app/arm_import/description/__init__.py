"""Descriptions of arms, URDF and MJCF: read safely, to the chain, bodies and shapes that they mean. Uses files/."""
