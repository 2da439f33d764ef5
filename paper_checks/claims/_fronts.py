"""Parameters of Figs. 12 and 13."""

A, B, EPS = 4.0, 0.5, 0.01
