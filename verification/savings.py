"""What a scene does not need: how the code decides what to leave out, and what that saves.

Each row names the bound on what the omission changes and the test that holds it. The saving is
measured when it is asked for: the cost as decided beside the cost with nothing left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from verification.savings_measured import (
    admissibility,
    digits,
    events,
    harmonics,
    imports,
    quadrature_points,
    roots,
    saved_output,
    search,
    sites,
    sites_at_rest,
    sites_behind,
    tail_terms,
    time_steps,
    workers,
)


@dataclass(frozen=True)
class Saving:
    """One thing that is left out.

    Attributes
    ----------
    what : str
        Roots, tail terms, quadrature points, …
    decided : str
        How the code decides.
    bound : str
        What the omission can change at most.
    unit : str
        Of the two costs.
    measure : callable
        Returns the cost as decided and the cost with nothing left out.
    test : str
        ``file::function`` of the test that holds the bound.
    estimated : bool
        The cost with nothing left out is not measured but reckoned from the one that is.
    """

    what: str
    decided: str
    bound: str
    unit: str
    measure: Callable[[], tuple[float, float]]
    test: str
    estimated: bool = False


@dataclass(frozen=True)
class MeasuredSaving:
    """A saving and its two costs."""

    saving: Saving
    spent: float
    whole: float

    @property
    def text(self) -> str:
        """Both costs and their ratio, in words."""
        ratio = self.whole / self.spent if self.spent else float("inf")
        about = "about " if self.saving.estimated else ""
        return (
            f"{self.spent:.4g} in place of {about}{self.whole:.4g} {self.saving.unit}: "
            f"{about}{ratio:.3g} times"
        )

    def as_dict(self) -> dict[str, object]:
        """Return all of it as plain values."""
        return {
            "what": self.saving.what,
            "decided": self.saving.decided,
            "bound": self.saving.bound,
            "unit": self.saving.unit,
            "spent": self.spent,
            "whole": self.whole,
            "estimated": self.saving.estimated,
            "measured": self.text,
            "test": self.saving.test,
        }


SAVINGS: tuple[Saving, ...] = (
    Saving(
        "roots",
        "those within e^{-2 pi rho} = 10^{-digits} of the singularities of the tail are summed",
        "30 times the smallest term of Euler-Maclaurin, in the error returned",
        "roots at equal error (the series cut off)",
        roots,
        "tests/test_theory_sums.py::test_sixty_roots_are_enough_for_twelve_digits",
    ),
    Saving(
        "tail terms",
        "orders in proportion to the digits; Euler-Maclaurin stops at its smallest term",
        "30 times the smallest term, in the error returned",
        "ms of one tail, orders as for 15 digits (as for 60)",
        tail_terms,
        "tests/test_theory_sums.py::test_few_digits_have_an_honest_error_too",
    ),
    Saving(
        "quadrature points",
        "from the root-free strip and the tolerance, before the first point is computed",
        "2M/(e^{N sigma} - 1), in the error returned",
        "points at 1e-6 (at 1e-15)",
        quadrature_points,
        "tests/test_theory_sums.py::test_no_error_bound_of_the_array_is_exceeded_at_any_tolerance",
    ),
    Saving(
        "digits",
        "up to 15 the roots kept are summed in double precision, beyond in mpmath",
        "the rounding of every term by the radius of its root, in the error returned",
        "ms at 15 digits (at 50)",
        digits,
        "tests/test_theory_sums.py::test_integral_and_series_agree_to_fifty_digits",
    ),
    Saving(
        "points of admissibility",
        "a proven tail bound far out; between, cells whose slopes cannot reach the threshold",
        "a violation of less than 1e-11",
        "values of the shape (dense sampling)",
        admissibility,
        "tests/test_theory_profile.py::test_the_verdict_on_admissibility_is_that_of_dense_sampling",
        estimated=True,
    ),
    Saving(
        "values of the sum in a search",
        "cells whose slopes cannot bring g to zero are dropped, others halved",
        "no pair of velocities farther apart than 1e-10 of each other is lost",
        "values of the sum (a scan that parts velocities 1e-4 apart)",
        search,
        "tests/test_theory_kinetic.py::test_no_branch_is_lost_by_a_plain_scan_of_the_sign",
        estimated=True,
    ),
    Saving(
        "sites",
        "a window that moves with the front; sites far behind and ahead are dropped",
        "the truncation, in the error of the velocity",
        "sites held (all that were passed)",
        sites,
        "tests/test_piecewise_simulation.py::test_the_truncation_bound_bounds_the_window_error",
    ),
    Saving(
        "sites at rest",
        "runs of (8) and (43) step sites from 4 (8 for c > 3) before the first above the tolerance",
        "a tenth of the tolerance",
        "sites stepped (all)",
        sites_at_rest,
        "tests/test_vdp_runs.py::test_sites_left_out_do_not_change_the_run",
    ),
    Saving(
        "sites behind a front",
        "a front with v > c outruns all waves behind it: 24 sites behind are stepped, no more",
        "1e-4 of the arrival times",
        "sites stepped (all that were passed)",
        sites_behind,
        "tests/test_vdp_fronts.py::test_all_sites_kept_give_the_front_measured_with_few",
    ),
    Saving(
        "events",
        "between crossings the chain is propagated exactly, so nothing is computed there",
        "rounding of the exact propagator",
        "events (fixed steps as exact)",
        events,
        "tests/test_piecewise_simulation.py::test_crossings_agree_with_a_runge_kutta_integration",
        estimated=True,
    ),
    Saving(
        "harmonics",
        "orbits are found by shooting, which has none; harmonics are read off afterwards",
        "the change that a halved step asks for, in the error returned",
        "unknowns a site (harmonics above 1e-12)",
        harmonics,
        "tests/test_breather_orbits.py::test_harmonic_balance_finds_the_same_orbit",
    ),
    Saving(
        "time steps",
        "from eps max|damping| on the cycle; a gentle cycle takes fewer",
        "the change that a halved step asks for, in the error returned",
        "steps a period at eta = 0.08 (at eta = 0.0032)",
        time_steps,
        "tests/test_breather_orbits.py::test_the_orbit_closes_in_scipy",
    ),
    Saving(
        "saved output",
        "a run keeps the times of threshold crossings and its last state",
        "nothing: a run is repeated exactly from its start",
        "numbers kept (every state at every event)",
        saved_output,
        "tests/test_piecewise_simulation.py::test_a_run_goes_on_from_the_end_of_another",
        estimated=True,
    ),
    Saving(
        "workers",
        "one worker, or one point, is computed in this process; a pool is started for more",
        "nothing: the same bytes",
        "s for four quick points (with two processes)",
        workers,
        "tests/test_sweep.py::test_one_worker_two_workers_and_any_executor_give_the_same_bytes",
    ),
    Saving(
        "imports",
        "a command imports what it uses, inside its own function",
        "nothing",
        "s to start (with every library)",
        imports,
        "tests/test_command_line.py::test_one_point_imports_nothing_it_does_not_use",
    ),
)


def measured_savings() -> tuple[MeasuredSaving, ...]:
    """Measure every row now."""
    return tuple(MeasuredSaving(saving, *saving.measure()) for saving in SAVINGS)
