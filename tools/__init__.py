"""Generators of pages and pictures, and the mutation run."""
