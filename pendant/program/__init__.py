"""Programs: their steps, and running them. Uses contact/."""
