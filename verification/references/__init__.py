"""Independent references: other integrators and other formulas, without code of the steppers."""
