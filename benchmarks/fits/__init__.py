"""Arms that are drawn, and what a fit makes of their logs."""
