"""Whether the theory is true: direct numerical integration, compared with the closed forms.

``steppers``
    The compiled integration methods.
``runs``, ``fronts``, ``breathers``, ``thresholds``, ``maps``, ``cells``, ``piecewise``
    What is measured on a chain.
``references``
    Independent methods that share nothing with the steppers.
``quantities``
    The registry of what can be computed, and the stability table over it; ``work_reduction``.
``execution``
    Sweeps, worker pool, journal, checkpoint, compiled code.
"""
