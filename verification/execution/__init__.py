"""How computations are run: sweep, worker pool, journal, checkpoint, compiled code."""
