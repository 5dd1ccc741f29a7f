"""What bench `blocked` has an arm do."""
