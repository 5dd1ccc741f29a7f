"""What a real controller could measure, and what it believes of its own arm. Uses arm/, compiled/, plant/."""
