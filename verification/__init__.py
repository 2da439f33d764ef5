"""Whether the theory is true: direct numerical integration, compared with the closed forms.

Compiled steppers are in ``integrators``; here is what runs them and what is read from the runs.

Model I, the friction chain (5)
    ``friction_start`` makes starts, ``friction_lane`` holds a run in progress, ``friction_run``
    samples one and gives its error. Read from runs: ``friction_front`` (velocity, Fig. 6),
    ``friction_threshold`` (Fig. 4), ``friction_label`` and ``friction_map`` (Fig. 5). One cell
    (Fig. 2): ``friction_cell_orbits``, ``friction_cell_cycles``, ``friction_cell_continuation``.
    Other integrators to hold it against: ``friction_events``, ``friction_switch`` (the paper's
    own), ``friction_regularised``.

Model II, the Van der Pol chain (8) and its average (43)
    ``vdp_start``, ``vdp_lane``, ``vdp_run`` likewise, with ``stiff_stage`` where (8) is stiff.
    Read from runs: ``vdp_front`` (Figs. 12-14), ``state_label`` and ``state_map`` (Fig. 15).
    One cell: ``vdp_cell``. Both models use ``arrival_fit`` for velocities and ``checkpoint``.

Breathers of Model II (Figs. 7-11)
    ``nucleus`` says which sites and phases. ``envelope_breather`` solves (43), ``orbits`` (8), with
    ``newton`` and ``continuation``; ``breather_run`` integrates; ``orbit_distance`` compares;
    ``periodic_motion`` measures one period. Stability: ``exponents`` and ``floquet``. Thresholds:
    ``breather_threshold`` by continuation; ``nucleation``, ``slow_sweep`` and ``escape_range`` as
    the paper prepared it.

The piecewise-linear chain (44) (Figs. 16-18)
    ``piecewise_simulation`` measures a front; it moves ``piecewise_chain`` within
    ``piecewise_window`` from one ``piecewise_crossing`` to the next; ``piecewise_verdict`` and
    ``piecewise_run`` say what came of it.

For all
    ``sweep``, ``journal``, ``table`` and ``boundary`` make maps; ``compiled`` keeps compiled code;
    ``scenes`` are shared by tests, benchmarks and report; ``extremes`` is ``fronts stress``;
    ``savings`` and ``savings_measured`` are what a scene does not need.
"""
