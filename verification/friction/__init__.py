"""Model I: runs of the friction chain (5), and what is read from them.

``start`` makes starts, ``lane`` holds a run in progress, ``run`` samples one and gives its error.
Read from runs: ``front`` (velocity, Fig. 6), ``threshold`` (Fig. 4), ``label`` and ``map``
(Fig. 5). One cell (Fig. 2): ``cell_cycles`` shoots once, ``cell_orbits`` gives the cycles and their
errors, ``cell_continuation`` follows them. Other integrators to hold it against: ``events``,
``switch`` (the paper's own), ``regularised``.
"""
