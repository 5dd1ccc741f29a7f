"""Free-drive as a state machine: activation, periods, leaving. Uses guided/, limits/, sensor/, signals/, walls/."""
