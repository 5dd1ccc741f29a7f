"""The arm and its control: description, physics, sensors, estimates, control law, one tick of all of it, the paced loop."""
