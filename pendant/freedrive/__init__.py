"""Free-drive as a state machine: activation, periods, leaving. Uses guided/, limits/, signals/, walls/."""
