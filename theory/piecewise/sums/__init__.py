"""Σ(v, c) of (53), by a contour integral, the root series, a Bessel series, and quadrature."""
