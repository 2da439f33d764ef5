"""Truncations and active windows: results with and without them, and bounds on the difference."""
