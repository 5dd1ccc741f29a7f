"""What all tests share."""

from hypothesis import settings

# A deadline an example would time the machine, not the code.
settings.register_profile("steady", deadline=None)
settings.load_profile("steady")
