"""What an arm is: its numbers, its chain of bodies, what it carries and where it stands."""
