"""Parameters that limits bound, and what resists motion before a limit."""
