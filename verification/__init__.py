"""Whether the theory is true: direct numerical integration, compared with the closed forms.

``steppers``
    The compiled integration methods.
``runs``, ``fronts``, ``breathers``, ``thresholds``, ``maps``, ``cells``, ``piecewise``
    What is measured on a chain.
``continuation``
    Newton's method and pseudo-arclength, for breathers, orbits and fronts.
``references``
    Independent methods that share nothing with the steppers.
``quantities``
    The registry of what can be computed, and the robustness table over it; ``work_reduction``.
``pictures``
    One style of pictures, and the numbers behind them as CSV.
``execution``
    How computations are run and stored: files, digests, records, workers, progress, resumption.
"""
