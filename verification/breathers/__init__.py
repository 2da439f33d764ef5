"""Breathers of Model II (Figs. 7-11): ``breather`` finds one by any of four methods.

``result`` defines the results. ``envelope`` solves (43), ``orbits`` (8), and ``own`` user-defined
chains, by one contract (``family``) and with ``verification.continuation``; ``run`` integrates (8)
or (43); ``periodic_motion`` analyses one period. Stability is computed in ``exponents`` and
``floquet``, thresholds in ``verification/thresholds``. ``outcome`` follows a nucleus that does not
settle on a breather: to what size it grows, and whether it stops, creeps or becomes a front.
"""
