"""What a scene does not need: each omission run against the same computation without it.

``table`` has one row an omission; ``sums``, ``runs``, ``orbits`` and ``process`` compute both
sides. ``fronts stress --savings`` prints them.
"""
