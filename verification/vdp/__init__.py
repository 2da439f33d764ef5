"""Model II: runs of the Van der Pol chain (8) and of its average (43), and what is read from them.

``start`` makes starts, ``lane`` holds a run in progress, with ``stiff_stage`` where (8) is stiff,
``run`` samples one and gives its error. Read from runs: ``front`` (velocity, Figs. 12-14),
``label`` and ``map`` (Fig. 15). One cell: ``cell``.
"""
