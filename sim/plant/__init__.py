"""The truth: the arm in its world, in MuJoCo. Uses arm/, compiled/, gripping/."""
