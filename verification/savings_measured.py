"""The two costs of each row of `verification.savings`: as decided, and with nothing left out."""

from __future__ import annotations

import math
import time


def roots() -> tuple[float, float]:
    """Count roots with the tail summed, and cut off at the same error."""
    import numpy as np

    from theory.roots import nearest_roots
    from theory.sum_integral import sum_by_integral
    from theory.sum_series import sum_by_roots

    count = 20_000
    k = nearest_roots(0.3, 0.5, count, upper=True).k
    cut_off = complex(np.sum(1.0 / (-1j * k * (0.3 + 0.5 * np.sin(k)))))
    missed = abs(cut_off - sum_by_integral(0.3, 0.5).value)
    digits = math.ceil(-math.log10(missed))
    return float(sum_by_roots(0.3, 0.5, digits).terms), float(count)


def tail_terms() -> tuple[float, float]:
    """Time one tail at the orders of 15 and of 60 digits."""
    import mpmath as mp

    from theory.sum_series import SeriesScene, tail_sum

    times = []
    with mp.workdps(30):
        scene = SeriesScene(mp.mpf(0.3), mp.mpf(0.5), 1)
        for order in (25, 80):
            begin = time.perf_counter()
            tail_sum(scene, 8, 1, order)
            times.append(1e3 * (time.perf_counter() - begin))
    return times[0], times[1]


def quadrature_points() -> tuple[float, float]:
    """Count points at a loose and at the tightest tolerance."""
    from theory.sum_integral import sum_by_integral

    loose, tight = (sum_by_integral(0.3, 0.5, tolerance).terms for tolerance in (1e-6, 1e-15))
    return float(loose), float(tight)


def digits() -> tuple[float, float]:
    """Time the series at 15 and at 50 digits."""
    from theory.sum_series import sum_by_roots

    sum_by_roots(0.3, 0.5, 15)
    return sum_by_roots(0.3, 0.5, 15).seconds * 1e3, sum_by_roots(0.3, 0.5, 50).seconds * 1e3


def admissibility() -> tuple[float, float]:
    """Count values of the shape, and those of sampling as fine everywhere."""
    from theory.admissibility import check_admissible
    from theory.kinetic_relation import kinetic_relation
    from theory.unit_cell import threshold_ratio

    v = kinetic_relation(0.5, 0.03125).branches[0].v
    found = check_admissible(v, 0.5, threshold_ratio(0.03125))
    left, right = found.proven_beyond
    # Sampling to the resolution that finds a grazing of 1e-11 everywhere, with no slope bound.
    return float(found.points), (left + right) / 1e-5


def search() -> tuple[float, float]:
    """Count values of the sum, and those of a plain scan."""
    from theory.kinetic_relation import kinetic_relation

    # Ten units of ln v, parted at 1e-4; the search parts velocities 1e-10 apart.
    return float(kinetic_relation(0.45, 0.03125).terms), 10.0 / 1e-4


def sites() -> tuple[float, float]:
    """Count sites in the window and sites passed."""
    from verification.piecewise.simulation import simulate_front

    found = simulate_front(0.5, 0.03125)
    return float(found.window), float(found.crossing_times.size + found.window)


def sites_at_rest() -> tuple[float, float]:
    """Count sites stepped and all sites, on the chain of the benchmark."""
    from theory.vdp_chain import VdpChain
    from verification.vdp.run import run_vdp
    from verification.vdp.start import displaced

    chain = VdpChain(a=4, b=0.5, c=0.6, sites=31)
    run = run_vdp(chain, displaced(chain, [1]), 1000.0, samples=2, companion=False)
    return run.mean_active, float(chain.sites)


def sites_behind() -> tuple[float, float]:
    """Count sites stepped with few and with all sites kept behind a front."""
    from theory.vdp_chain import VdpChain
    from verification.vdp.run import Model, run_vdp
    from verification.vdp.start import staggered_front

    chain = VdpChain(a=4, b=0.5, c=0.6, sites=300)
    few, whole = (
        run_vdp(
            chain, staggered_front(chain, 24), 3.7e4, model=Model.ENVELOPE, samples=2,
            behind=behind, companion=False,
        )
        for behind in (24, 0)
    )  # fmt: skip
    return few.mean_active, whole.mean_active


def events() -> tuple[float, float]:
    """Count events, and the fixed second-order steps for the same error."""
    from verification.piecewise.simulation import simulate_front

    found = simulate_front(0.5, 0.03125)
    # A fixed step as exact: the error of an event is second order in the step, 1e-12 wants 1e-6.
    return float(found.events), float(found.crossing_times[-1]) / 1e-6


def harmonics() -> tuple[float, float]:
    """Count unknowns a site of shooting and of harmonic balance."""
    import numpy as np

    from theory.vdp_chain import VdpChain
    from verification.breathers.nucleus import Nucleus
    from verification.breathers.orbits import solve_orbit
    from verification.integrators.variational import integrate_variations

    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=11)
    orbit = solve_orbit(chain, Nucleus(1))
    samples = integrate_variations(chain, orbit.state, orbit.period, 64).samples
    size = np.abs(np.fft.rfft(samples, axis=0) / len(samples)).max(axis=1)
    highest = int(np.flatnonzero(size > 1e-12)[-1])
    return 2.0, 2.0 * highest + 1.0


def time_steps() -> tuple[float, float]:
    """Count steps of a gentle and of a steep cycle."""
    from theory.vdp_chain import VdpChain
    from verification.breathers.orbits import steps_for

    gentle, steep = VdpChain(a=2.5, b=0.5, c=0.1), VdpChain(a=2.5, b=0.02, c=0.1)
    return float(steps_for(gentle)), float(steps_for(steep))


def workers() -> tuple[float, float]:
    """Time a short sweep in this process and in two others."""
    from verification.extremes.judging import StressTask
    from verification.extremes.table import stress_points
    from verification.sweeps.sweep import sweep

    times = []
    for workers in (1, 2):
        begin = time.perf_counter()
        sweep(StressTask(), stress_points(["c-pin"], 4), workers=workers)
        times.append(time.perf_counter() - begin)
    return times[0], times[1]


def imports() -> tuple[float, float]:
    """Time the start of the command line alone and with every library."""
    alone = seconds_of("import fronts.cli")
    return alone, seconds_of("import fronts.cli, scipy.integrate, sympy, matplotlib.pyplot, numba")


def seconds_of(statement: str) -> float:
    """Return the shortest of three times of a fresh Python process."""
    import subprocess
    import sys

    times = []
    for _ in range(3):
        begin = time.perf_counter()
        subprocess.run([sys.executable, "-c", statement], check=True)
        times.append(time.perf_counter() - begin)
    return min(times)


def saved_output() -> tuple[float, float]:
    """Count numbers kept and numbers computed."""
    from verification.piecewise.simulation import simulate_front

    found = simulate_front(0.5, 0.03125)
    kept = found.crossing_times.size
    return float(kept), float(found.events * found.window)
