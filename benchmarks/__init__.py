"""Error versus run time, compared with other programs in one process; see ``fronts bench``."""
