"""What all tests share."""

from hypothesis import settings

# A deadline an example would time the machine, not the code. The examples are the same in every run, so that a test that passed
# passes again; `--hypothesis-profile=default` looks for new ones.
settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")
