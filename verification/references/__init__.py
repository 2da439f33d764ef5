"""Independent references: other integrators and other formulas, nothing of the engines."""
