"""Programs for those who work on the project: they read it and write pages about it."""
