"""Work reduction: what is truncated or omitted, how the code decides, and what is gained.

Each row states a bound on the change due to the reduction, and names the test that compares the
results with and without it. Both are computed on request, for the same parameters and to the same
accuracy.
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


@dataclass(frozen=True, kw_only=True)
class Reduction:
    """One truncation, active window or omitted computation.

    Attributes
    ----------
    what : str
        What is reduced: roots, tail terms, quadrature points, …
    decided : str
        How the code decides.
    bound : str
        Bound on the change due to the reduction.
    unit : str
        Unit of the two costs and, in parentheses, what is done without the reduction.
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
        """Compute both sides now; return both costs, and the distance between the results."""
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
            "measured": f"{spent:.4g} instead of {whole:.4g} {self.unit}: {times}",
            "changed": str(found),
            "test": self.test,
        }


REDUCTIONS: tuple[Reduction, ...] = (
    Reduction(
        what="roots",
        decided="roots are summed one by one within e^{-2 pi rho} = 10^{-digits} of the "
        "singularities of the term; beyond, Euler-Maclaurin sums them at once",
        bound="30 times its smallest term, in the error returned",
        unit="roots for six digits (one by one until the rest is below 1e-6)",
        compare=few_roots,
        test=_TESTS + "test_roots_left_to_the_tail_change_less_than_the_error_returned",
    ),
    Reduction(
        what="tail terms",
        decided="as many orders of Euler-Maclaurin as the digits asked for need, and none beyond "
        "the smallest term",
        bound="30 times the smallest term, in the error returned",
        unit="ms for a tail to 15 digits (with the 80 orders that 60 digits need)",
        compare=few_tail_terms,
        test=_TESTS + "test_orders_left_out_of_a_tail_change_less_than_30_times_the_smallest",
    ),
    Reduction(
        what="quadrature points",
        decided="the effect of the roots near the path is subtracted in closed form",
        bound="2M/(e^{N sigma} - 1) of what is left, in the error returned",
        unit="points for 200 velocities to 1e-13 (equispaced, none taken away)",
        compare=few_points,
        test=_TESTS + "test_points_left_out_change_less_than_the_error_returned",
    ),
    Reduction(
        what="digits",
        decided="up to 15 digits the roots kept are found and summed in double precision",
        bound="the radius of each root through the slope of its term, in the error returned",
        unit="ms for 15 digits of a sum of a thousand roots (16, all in mpmath)",
        compare=double_precision,
        test=_TESTS + "test_digits_left_out_change_less_than_the_error_returned",
    ),
    Reduction(
        what="points of admissibility",
        decided="a proven tail bound far out; between, cells whose slopes cannot reach the "
        "threshold",
        bound="a violation of (47) by less than 1e-11 of |phi|^2 is passed over",
        unit="values of the shape (so dense that a violation of 1e-11 cannot hide)",
        compare=few_values_of_the_shape,
        test=_TESTS + "test_values_left_out_hide_no_violation_of_1e_11",
    ),
    Reduction(
        what="values of the sum in a search",
        decided="cells whose slopes cannot bring |Sum| to 2r are dropped, others halved",
        bound="none: the same velocities, each in a cell in which a scan finds a change of sign",
        unit="values of the sum just above a fold (a scan that parts the pair)",
        compare=few_values_in_a_search,
        test=_TESTS + "test_values_left_out_of_a_search_lose_no_velocity",
    ),
    Reduction(
        what="sites of the window",
        decided="a window moves with the front of (44), so wide that its images disturb by 1e-14 r",
        bound="truncation_bound over r, in the error of the velocity",
        unit="sites held (the fewest that hold all it passed; compared with twice as many)",
        compare=sites_of_the_window,
        test=_TESTS + "test_sites_outside_the_window_change_less_than_the_truncation_bound",
    ),
    Reduction(
        what="sites at rest",
        decided="runs of (8) and (43) step sites from 4 (8 for c > 3) before the first above the "
        "tolerance",
        bound="a tenth of the tolerance, relative to the largest |Psi|",
        unit="sites stepped, on average (all)",
        compare=sites_at_rest,
        test=_TESTS + "test_sites_at_rest_change_less_than_a_tenth_of_the_tolerance",
    ),
    Reduction(
        what="sites behind a front",
        decided="a front with v > c outruns all waves behind it: 24 sites behind are stepped, no "
        "more",
        bound="the error of the arrival times that the run returns",
        unit="sites stepped, on average (all that were passed)",
        compare=sites_behind,
        test=_TESTS + "test_sites_behind_change_less_than_the_error_of_the_arrivals",
    ),
    Reduction(
        what="events",
        decided="a crossing is sought only where a chord less F h^2/8 reaches the threshold, F a "
        "bound on the second derivative of |phi|^2",
        bound="none: the crossings are the same to the last bit",
        unit="searches for six crossings (every site in every interval)",
        compare=crossings_sought,
        test=_TESTS + "test_searches_left_out_lose_no_crossing_and_move_none",
    ),
    Reduction(
        what="time steps between events",
        decided="between crossings (44) is linear, and is propagated exactly",
        bound="rounding over the steepness of each crossing (jitter), in the error of the velocity",
        unit="ms for six crossings (Runge-Kutta steps at 1e-13)",
        compare=steps_between_crossings,
        test=_TESTS + "test_steps_left_out_between_crossings_move_them_by_rounding_only",
    ),
    Reduction(
        what="time steps of an orbit",
        decided="from eps max|damping| on the cycle, which sets how far a Taylor step reaches",
        bound="the change that a halved step asks for, in the error returned",
        unit="steps a period (as many as would do for every chain accepted)",
        compare=fewer_steps,
        test=_TESTS + "test_steps_left_out_of_a_period_change_less_than_the_error_of_the_orbit",
    ),
    Reduction(
        what="harmonics",
        decided="orbits are found by shooting, whose unknowns are one state and the period",
        bound="the error of the orbit: all harmonics are contained nevertheless",
        unit="unknowns (harmonic balance with every harmonic above that error)",
        compare=harmonics_not_solved_for,
        test=_TESTS + "test_harmonics_not_solved_for_change_less_than_the_error_of_the_orbit",
    ),
)
