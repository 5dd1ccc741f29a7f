"""URScript, the language of UR robots: reading it, running it, and what its functions do to the simulated arm."""
