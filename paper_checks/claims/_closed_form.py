"""All solutions of (29) and (37) at one site, by scipy from random starts."""

from __future__ import annotations

import math

import numpy as np

from paper_checks.claims._breathers import A, B


def solutions(site: int, c: float, starts: np.ndarray) -> list[tuple[float, float]]:
    """Return the solutions of (29) and (37) with 0 < e^{k_1} < 1 that Newton's method finds."""
    from scipy.optimize import root

    def equations(x: np.ndarray) -> list[float]:
        alpha, z = x
        near = alpha * z**site
        gain = (-B * alpha**4 + 2 * A * alpha**2 - 8) / (16 * c)
        return [gain - z, 0.5 - A * near**2 / 8 + B * near**4 / 16 - 0.5 * c * (1 / z - z)]

    found: list[tuple[float, float]] = []
    for start in starts:
        trial = root(equations, start, tol=1e-13)
        alpha, z = (float(value) for value in trial.x)
        fits = max(map(abs, equations(trial.x))) < 1e-10 and 0 < z < 1 and alpha > 0
        if fits and all(math.hypot(alpha - a, z - b) > 1e-6 for a, b in found):
            found.append((alpha, z))
    return sorted(found, reverse=True)
