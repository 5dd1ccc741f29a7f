"""Fuzzers: files and messages that fit their types, with extreme but legal numbers, and files with damaged bytes."""
