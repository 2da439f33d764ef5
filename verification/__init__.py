"""Tests of the theory: direct numerical integration, compared with the closed forms.

``steppers``
    The compiled integration methods.
``runs``, ``fronts``, ``breathers``, ``thresholds``, ``maps``, ``cells``, ``piecewise``
    Measurements on a chain.
``continuation``
    Newton's method and pseudo-arclength continuation, for breathers, orbits and fronts.
``references``
    Independent methods that share no code with the steppers.
``quantities``
    The registry of what can be computed, and its robustness table; ``work_reduction``.
``pictures``
    A uniform style of pictures, with the numbers behind them as CSV.
``execution``
    How computations are run and stored: files, digests, records, workers, progress, resumption.
"""
