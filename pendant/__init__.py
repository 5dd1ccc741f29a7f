"""What the robot controller decides: modes, free-drive, limits, programs. Pure: values in, values out, time in ticks."""
