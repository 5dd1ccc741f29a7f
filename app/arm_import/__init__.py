"""Arms from URDF and MJCF files: completed by rules of size, checked by two parsers, written as arm files.

Uses arm_import/description/, files/.
"""
