"""Whether the theory is true: direct numerical integration, compared with the closed forms.

``friction``
    Model I, the friction chain (5), and its one cell.
``vdp``
    Model II, the Van der Pol chain (8) and its average (43), and its one cell.
``breathers``
    Localised oscillations of Model II: orbits, their stability, their thresholds.
``piecewise``
    The chain (44), moved exactly from switching to switching.
``integrators``
    The compiled steppers that all of them use; ``compiled`` keeps the compiled code.
``sweeps``
    Maps over parameters: points, workers, tables, boundaries.
``extremes``
    ``fronts stress``: every quantity over all decades of its parameters.
``savings``
    What a scene does not need: each omission run against the same computation without it.

Shared by both models are ``companions`` (the error of a run), ``front_watch`` (a front until it
has passed or stopped), ``arrival_fit`` (its velocity), ``checkpoint`` (runs that go on after a
stop) and ``label`` (the names of states). ``scenes`` are shared by tests, benchmarks and report.
"""
