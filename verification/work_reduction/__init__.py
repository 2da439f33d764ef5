"""Truncation and active windows: computed with and without, and the bound on the difference."""
