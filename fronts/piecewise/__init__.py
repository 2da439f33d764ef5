"""Public functions of the closed solution of the piecewise-linear chain (44)."""
