"""Work reduction: what is truncated or not computed, how the code decides, and what that gains.

Each row states the bound on what the reduction changes, and names the test that holds the result
with the reduction against the result without it. Both are computed when they are asked for, for the
same parameters and to the same accuracy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from verification.work_reduction.comparison import Comparison
from verification.work_reduction.orbits import fewer_steps, harmonics_not_solved_for
from verification.work_reduction.runs import (
    crossings_sought,
    sites_at_rest,
    sites_behind,
    sites_of_the_window,
    steps_between_crossings,
)
from verification.work_reduction.sums import (
    double_precision,
    few_points,
    few_roots,
    few_tail_terms,
    few_values_in_a_search,
    few_values_of_the_shape,
)

_TESTS = "tests/test_work_reduction.py::"


@dataclass(frozen=True)
class Reduction:
    """One truncation, active window or computation that is not made.

    Attributes
    ----------
    what : str
        Roots, tail terms, quadrature points, …
    decided : str
        How the code decides.
    bound : str
        What the reduction can change at most.
    unit : str
        Of the two costs, and in parentheses what is done when nothing is left out.
    compare : callable
        Computes the result with the reduction and without it.
    test : str
        ``file::function`` of the test that asserts the bound.
    """

    what: str
    decided: str
    bound: str
    unit: str
    compare: Callable[[], Comparison]
    test: str

    def measured(self) -> dict[str, Any]:
        """Compute both sides now; return both costs, and how far the results are apart."""
        found = self.compare()
        spent, whole = found.spent, found.whole
        times = f"{whole / spent:.3g} times"
        return {
            "what": self.what,
            "decided": self.decided,
            "bound": self.bound,
            "unit": self.unit,
            "spent": spent,
            "whole": whole,
            "difference": found.changed,
            "difference_allowed": found.bound,
            "holds": found.holds,
            "measured": f"{spent:.4g} in place of {whole:.4g} {self.unit}: {times}",
            "changed": str(found),
            "test": self.test,
        }


REDUCTIONS: tuple[Reduction, ...] = (
    Reduction(
        "roots",
        "roots are summed one by one within e^{-2 pi rho} = 10^{-digits} of the singularities of "
        "the term; beyond, Euler-Maclaurin sums them at once",
        "30 times its smallest term, in the error returned",
        "roots for six digits (one by one until the rest is below 1e-6)",
        few_roots,
        _TESTS + "test_roots_left_to_the_tail_change_less_than_the_error_returned",
    ),
    Reduction(
        "tail terms",
        "as many orders of Euler-Maclaurin as the digits asked for need, and none beyond the "
        "smallest term",
        "30 times the smallest term, in the error returned",
        "ms for a tail to 15 digits (with the 80 orders that 60 digits need)",
        few_tail_terms,
        _TESTS + "test_orders_left_out_of_a_tail_change_less_than_30_times_the_smallest",
    ),
    Reduction(
        "quadrature points",
        "the effect of the roots beside the path is taken away in closed form",
        "2M/(e^{N sigma} - 1) of what is left, in the error returned",
        "points for 200 velocities to 1e-13 (equispaced, none taken away)",
        few_points,
        _TESTS + "test_points_left_out_change_less_than_the_error_returned",
    ),
    Reduction(
        "digits",
        "up to 15 digits the roots kept are found and summed in double precision",
        "the radius of each root through the slope of its term, in the error returned",
        "ms for 15 digits of a sum of a thousand roots (16, all in mpmath)",
        double_precision,
        _TESTS + "test_digits_left_out_change_less_than_the_error_returned",
    ),
    Reduction(
        "points of admissibility",
        "a proven tail bound far out; between, cells whose slopes cannot reach the threshold",
        "a violation of (47) by less than 1e-11 of |phi|^2 is passed over",
        "values of the shape (so dense that a violation of 1e-11 cannot hide)",
        few_values_of_the_shape,
        _TESTS + "test_values_left_out_hide_no_violation_of_1e_11",
    ),
    Reduction(
        "values of the sum in a search",
        "cells whose slopes cannot bring |Sum| to 2r are dropped, others halved",
        "nothing: the same velocities, each in a cell in which a scan sees a change of sign",
        "values of the sum just above a fold (a scan that parts the pair)",
        few_values_in_a_search,
        _TESTS + "test_values_left_out_of_a_search_lose_no_velocity",
    ),
    Reduction(
        "sites of the window",
        "a window moves with the front of (44), so wide that its images disturb by 1e-14 r",
        "truncation_bound over r, in the error of the velocity",
        "sites held (the fewest that hold all it passed; compared with twice as many)",
        sites_of_the_window,
        _TESTS + "test_sites_outside_the_window_change_less_than_the_truncation_bound",
    ),
    Reduction(
        "sites at rest",
        "runs of (8) and (43) step sites from 4 (8 for c > 3) before the first above the tolerance",
        "a tenth of the tolerance, relative to the largest |Psi|",
        "sites stepped, on average (all)",
        sites_at_rest,
        _TESTS + "test_sites_at_rest_change_less_than_a_tenth_of_the_tolerance",
    ),
    Reduction(
        "sites behind a front",
        "a front with v > c outruns all waves behind it: 24 sites behind are stepped, no more",
        "the error of the arrival times that the run returns",
        "sites stepped, on average (all that were passed)",
        sites_behind,
        _TESTS + "test_sites_behind_change_less_than_the_error_of_the_arrivals",
    ),
    Reduction(
        "events",
        "a crossing is sought only where a chord less F h^2/8 reaches the threshold, F a bound on "
        "the second derivative of |phi|^2",
        "nothing: the same crossings to the last bit",
        "searches for six crossings (every site in every interval)",
        crossings_sought,
        _TESTS + "test_searches_left_out_lose_no_crossing_and_move_none",
    ),
    Reduction(
        "time steps between events",
        "between crossings (44) is linear, and is propagated exactly",
        "rounding over the steepness of each crossing (jitter), in the error of the velocity",
        "ms for six crossings (Runge-Kutta steps at 1e-13)",
        steps_between_crossings,
        _TESTS + "test_steps_left_out_between_crossings_move_them_by_rounding_only",
    ),
    Reduction(
        "time steps of an orbit",
        "from eps max|damping| on the cycle, which sets how far a Taylor step reaches",
        "the change that a halved step asks for, in the error returned",
        "steps a period (as many as would do for every chain accepted)",
        fewer_steps,
        _TESTS + "test_steps_left_out_of_a_period_change_less_than_the_error_of_the_orbit",
    ),
    Reduction(
        "harmonics",
        "orbits are found by shooting, whose unknowns are one state and the period",
        "the error of the orbit: it has every harmonic all the same",
        "unknowns (harmonic balance with every harmonic above that error)",
        harmonics_not_solved_for,
        _TESTS + "test_harmonics_not_solved_for_change_less_than_the_error_of_the_orbit",
    ),
)
