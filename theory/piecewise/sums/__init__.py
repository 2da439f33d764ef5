"""Σ(v, c) of (53), four ways: contour integral, root series, Bessel series, quadrature."""
