"""Error against run time, beside peers, in one process; run with ``fronts bench``."""
