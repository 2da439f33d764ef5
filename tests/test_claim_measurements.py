"""What claims make of their runs: on made-up runs, whose answer is known by hand.

The runs themselves, at smaller sizes, are those of `tests.test_claim_evidence`. Here nothing is
run: velocities lie on a line or a power law, thresholds are given, a cell sticks beyond a known
edge. The numbers that the texts of claims give in words are those of the code.
"""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields, replace
from itertools import pairwise, product
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypeVar

import numpy as np
import pytest
from scipy.integrate import RK45, cumulative_trapezoid, solve_ivp
from scipy.linalg import expm

from paper_checks.claims import (
    _breathers,
    _closed_form,
    _friction,
    _fronts,
    _maps,
    _orbits,
    equations,
    fig02,
    fig03,
    fig04,
    fig05,
    fig06,
    fig07,
    fig08,
    fig09,
    fig10,
    fig11,
    fig12,
    fig13,
    fig14,
    fig15,
    fig16,
    fig17,
    fig18,
    text_friction,
    text_nuclei,
    text_simplified,
    text_vdp,
)
from paper_checks.claims._friction import SITES
from paper_checks.discover import find_entries
from paper_checks.prose import template, words
from theory.averaged.breather import Reading, solve_breather
from theory.averaged.front import strong_coupling_front
from theory.cells.friction import FrictionCell
from theory.cells.vdp import eta_from_damping
from theory.chains.nucleus import Nucleus, outward_pattern
from theory.chains.vdp import VdpChain
from theory.piecewise.folds import fold_eta
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.limits import pinning_eta
from verification.breathers.outcome import Evolution, NucleusOutcome
from verification.execution.table import Table
from verification.references.equations import averaged_rate, full_rate
from verification.references.pace import last_state
from verification.runs.excite import excite
from verification.runs.simulate import simulate

Patch = pytest.MonkeyPatch
Held = TypeVar("Held")


def evidence(of: type[Held], **known: Any) -> Held:
    """Return evidence of which only some is known."""
    held: Any = of
    return of(**dict.fromkeys((each.name for each in fields(held)), None) | known)


def table(**columns: Any) -> Table:
    """Return a table of points."""
    return Table(arrays={name: np.asarray(cells) for name, cells in columns.items()})


# ------------------------------------------------------------------------- where claims are sampled


@pytest.mark.parametrize(
    "sampled",
    [fig02.VELOCITIES, fig03.TIMES_A, fig03.TIMES_B, fig04.SIZES, fig05.COUPLINGS, fig05.VELOCITIES,
     fig05.LASTING, fig06.COUPLINGS, fig06.BELOW, fig06.LARGE, fig08.COUPLINGS,
     fig08.EPSILONS[::-1], fig09.ALONG, fig09.EXACT, fig10.TIMES, fig11.ODD, fig11.RANGE,
     fig11.FAMILY, fig11.MIRRORED_AT, fig12.TIMES, fig13.AVERAGED, fig13.FULL, fig13.CHECKED,
     fig13.BELTS, fig13.LAW_ETAS, fig13.LAW_COUPLINGS, fig14.ETAS, fig14.FULL, fig15.ETAS,
     fig15.COUPLINGS, fig15.EMPTIED_AT, fig17.RUNS, fig18.ETAS, fig18.CROSSING,
     text_friction.FRICTION,
     *text_friction.PATTERNS, text_nuclei.COUPLINGS, text_nuclei.DRAWN, text_nuclei.SEEDS],
)  # fmt: skip
def test_what_a_curve_is_sampled_at_increases(sampled: Any) -> None:
    assert all(low < high for low, high in pairwise(sampled))


def test_maps_are_sampled_evenly_and_checked_at_their_own_points() -> None:
    for grid in (fig05.COUPLINGS, fig05.VELOCITIES, fig15.ETAS, fig15.COUPLINGS):
        assert np.ptp(np.diff(grid)) == pytest.approx(0.0, abs=1e-12)
    assert {c for c, _, _ in fig05.CHECKED} <= set(fig05.COUPLINGS)
    assert {v_d for _, v_d, _ in fig05.CHECKED} <= set(fig05.VELOCITIES)
    assert max(fig05.COUPLINGS) == fig05.STRONG
    assert min(fig05.VELOCITIES) < min(fig05.LASTING) < max(fig05.LASTING) < max(fig05.VELOCITIES)
    assert set(fig15.CHECKED) <= {(eta, c) for eta in fig15.ETAS for c in fig15.COUPLINGS}
    assert set(fig13.CHECKED) <= set(fig13.AVERAGED)
    assert set(fig14.FULL) <= set(fig14.ETAS)
    assert set(text_nuclei.DRAWN) <= set(text_nuclei.COUPLINGS)


def test_nuclei_are_enumerated_size_by_size_and_a_family_has_even_ones_beyond() -> None:
    assert list(fig11.RANGE) == list(range(1, len(fig11.RANGE) + 1))
    assert all(n % 2 == 0 and n > fig11.RANGE[-1] for n in fig11.FAMILY)
    assert list(fig11.ODD) == list(range(1, fig11.ODD[-1] + 1, 2))
    assert set(fig11.PRINTED) <= set(fig11.ODD)


def test_the_phases_are_followed_up_to_the_end_at_which_they_are_judged() -> None:
    assert (fig10.TIMES[0], fig10.TIMES[-1]) == (0.0, fig10.END)
    assert np.diff(fig10.TIMES).max() <= 5.0


def test_the_curves_of_fig_9_cross_it_and_are_finer_where_multipliers_leave_the_circle() -> None:
    for curve in (fig09.ALONG, fig09.EXACT):  # of an axis from 0 to 0.2
        assert 0.0 < curve[0] < 0.05
        assert np.diff(curve).max() < 0.05
    last = [c for c in fig09.ALONG if c > float(fig09.PRINTED)]
    assert np.diff(last).max() < 0.1 * fig09.TOGETHER
    assert last[-1] < 0.2


def test_the_sinusoids_of_fig_9_are_followed_to_just_below_their_end() -> None:
    chain = VdpChain(a=_breathers.A, b=_breathers.B, c=fig09.ALONG[-1], sites=_orbits.SITES)
    fold = solve_breather(chain).fold
    assert fold is not None
    assert 0.0 < fold.c - fig09.ALONG[-1] < 1e-4


def test_the_hysteresis_of_fig_18_is_run_at_eta_below_pinning_and_up_to_the_fold() -> None:
    pin, fold = pinning_eta(fig18.C), fold_eta(fig18.C).value
    assert 0.95 * pin < fig18.CROSSING[0] < pin  # within what is drawn beside it
    assert pin < fig18.CROSSING[-1] < 1.005 * fold


def test_the_chain_of_figs_7_to_9_has_a_site_in_the_middle() -> None:
    assert _orbits.SITES == 2 * _orbits.CENTRE + 1


def test_breathers_of_figs_7_to_9_are_of_the_middle_site_and_solve_their_equations() -> None:
    c, sites = 0.12, _orbits.SITES
    known = {"a": _breathers.A, "b": _breathers.B, "c": c, "sites": sites}
    averaged = _orbits.averaged_of.__wrapped__(c)
    phi = averaged.unknowns[:sites] + 1j * averaged.unknowns[sites:-1]
    turning = 1j * averaged.unknowns[-1] * phi
    assert averaged_rate(VdpChain(**known))(0.0, phi) == pytest.approx(turning, abs=1e-10)
    orbits = {eps: _orbits.orbit_of.__wrapped__(c, eps) for eps in (_breathers.EPS, 0.02)}
    for eps, orbit in orbits.items():
        rate = full_rate(VdpChain(**known, eps=eps))
        end = last_state(rate, orbit.period, orbit.state, 1e-11, 1e-11)
        assert end == pytest.approx(orbit.state, abs=1e-9)
    for size in (np.abs(phi), *(orbit.amplitudes for orbit in orbits.values())):
        excited = np.flatnonzero(size > VdpChain(**known).unstable_amplitude)
        assert excited.tolist() == [_orbits.CENTRE]


def test_the_derivative_of_a_flow_is_that_of_a_map_that_is_known(monkeypatch: Patch) -> None:
    known = np.array([[2.0, -1.0], [0.5, 1.5]])

    def flow(states: Any, c: float, period: float, _: float) -> Any:
        assert (c, period) == (0.12, 6.5)
        return np.sin(known @ states)

    monkeypatch.setattr(_breathers, "flow", flow)
    state = np.array([0.3, -0.8])
    found = _breathers.monodromy_by_differences(state, 0.12, 6.5)
    exact = np.cos(known @ state)[:, None] * known
    # The square of a step of 1e-6, and rounding over it.
    assert found == pytest.approx(exact, abs=1e-9)


def test_figs_7_and_8_are_judged_where_their_texts_say() -> None:
    assert (fig07.C, fig07.STRONGER, fig07.SEEN) == (0.1, 0.19, 0.01)
    assert (fig08.C, fig08.EPSILONS[2]) == (0.1, 0.01)
    assert all(eps == 2.0 * half for eps, half in pairwise(fig08.EPSILONS))


def test_figures_of_a_and_b_are_at_the_eta_of_these() -> None:
    for module in (fig13, fig17, text_simplified):
        assert eta_from_damping(module.A, module.B) == module.ETA == 1.0 / 32.0


def test_one_site_of_the_simplified_chain_goes_where_an_integration_of_it_goes() -> None:
    found = text_simplified.equilibria()
    root = math.sqrt(1.0 - 8.0 * text_simplified.ETA)
    cycle, edge = (
        math.sqrt(text_simplified.A / text_simplified.B * (1.0 + sign * root)) for sign in (1, -1)
    )
    for goal, side, rest in ((0.0, 0.999, found.rest), (cycle, 1.001, found.cycle)):
        run = solve_ivp(
            lambda _, left: -0.5 * left, (0.0, 40.0), [side * edge - goal], rtol=1e-10, atol=1e-16
        )
        assert abs(run.y[0, -1]) / cycle == pytest.approx(rest, rel=1e-6)
    assert found.rates == pytest.approx((0.5, 0.5))


# ------------------------------------------------------------------------- what the texts say of it


def plain(number: float) -> str:
    """Return a number as the texts write it: 1e-8, 0.05, 60000."""
    text = f"{number:g}" if number >= 0.005 else f"{number:.0e}"
    return text.replace("e-0", "e-")


def listed(numbers: Iterable[float], last: str = ", ") -> str:
    *some, end = map(plain, numbers)
    return last.join([", ".join(some), end]) if some else end


def percent(share: float) -> str:
    return f"{plain(100.0 * share)} %"


def grid(across: Sequence[float]) -> str:
    return f"{plain(across[0])}:{plain(across[-1])}:{len(across)}"


STATED: dict[str, Callable[[], Sequence[str]]] = {
    "fig02-states": lambda: (
        f"{plain(fig02.AGREE)} in period and stick time", f"At v_d = {fig02.V_D} the",
        f"--v-d {fig02.V_D}\n",
    ),
    "fig02-regions": lambda: (f"each of {2 * len(fig02.VELOCITIES)} runs",),
    "fig03-breather": lambda: (
        f"at τ = {listed(fig03.TIMES_A)} differ", f"tolerance: {percent(fig03.LINE)} of the axis",
        f"only sites {listed(fig03.CORE)} may stick",
        f"--excite {fig03.CORE[0]}:{fig03.CORE[-1]} --t-end {plain(fig03.TIMES_A[-1])}",
    ),
    "fig03-vanishing": lambda: (f"tolerance: {percent(fig03.VANISHING)} of the amplitude",),
    "fig03-front": lambda: (
        f"by τ = {listed(fig03.TIMES_B)}:", f"--t-end {plain(fig03.TIMES_B[-1])}",
    ),
    "fig04-edge": lambda: (
        f"--accuracy {plain(fig04.ACCURACY)}", f"(sizes {listed(fig04.SIZES[1:])})",
        f"from {plain(fig04.PRINTED - fig04.ABOUT)} to {plain(fig04.PRINTED + fig04.ABOUT)} %",
    ),
    "fig04-bulk": lambda: (
        f"--accuracy {plain(fig04.ACCURACY)}", f"for sizes {listed(fig04.SIZES)}\n",
        f"N_dof = {SITES}\n",
    ),
    "fig04-divides": lambda: (
        f"error: {plain(fig04.ACCURACY)} in c", f"--final-time {plain(fig04.LONG)}",
        f"value: {percent(fig04.ASIDE)} below", f"; {percent(fig04.ASIDE)} above",
    ),
    "fig05-regions": lambda: (
        f"--c {grid(fig05.COUPLINGS)} --v-d {grid(fig05.VELOCITIES)} --refine {fig05.REFINED}",
        f"at most {percent(_maps.FEW)} of the points",
    ),
    "fig05-after-front": lambda: (
        f"--c {fig05.STRONG} ", f"at c = {fig05.STRONG}, τ = {plain(fig05.LATE)}:",
        "v_d = {:.2f} and {:.2f},".format(*fig05.WIDE_AT),
    ),
    "fig06-linear": lambda: (
        f"at c = {listed((c for c, _ in fig06.SCIPY), ' and ')}\n",
        f"for c from {fig06.LINEAR_FROM} to {fig06.COUPLINGS[-1]},",
        f"residuals of {percent(fig06.RESIDUAL)}",
        f"{fig06.FAST_SITES} sites are used from c = {fig06.LINEAR_FROM} on",
        f"--c {fig06.COUPLINGS[-1]} --n {fig06.FAST_SITES};",
        f"--c {plain(fig06.LARGE[-1])} --n {fig06.LARGE_SITES}\n",
        f"printed: at N_dof = {SITES}, N_size = 1, v_d = {_friction.V_D}\n",
    ),
    "fig06-threshold": lambda: (f"at c = {', '.join(map(str, fig06.BELOW))} no other site",),
    "fig06-rapid": lambda: (
        f"from c = {fig06.COUPLINGS[0]} to {fig06.COUPLINGS[1]},",
        f"from c = {fig06.LINEAR_FROM} to {fig06.COUPLINGS[-1]}\n",
        f"a slope of {fig06.STEEPER} times", f"--c {fig06.COUPLINGS[1]} ",
    ),
    "fig07-localised": lambda: (
        f"{plain(fig07.AGREE)} between run and orbit", f"--c {fig07.C} ", f"at c = {fig07.C},",
    ),
    "fig07-decay": lambda: (
        f"{percent(fig07.SEEN)} of the largest", f"--c {fig07.C} ", f"At c = {fig07.C} the two",
        f"at c = {fig07.STRONGER}, near",
    ),
    "fig08-amplitudes": lambda: (
        f"for c up to {fig08.COUPLINGS[-1]} the", f"tolerance: {fig08.MARK},",
    ),
    "fig08-assumptions": lambda: (f"at c = {fig08.C}, ε =", f"--c {fig08.C} "),
    "fig08-neglected": lambda: (f"--c {fig08.C} ",),
    "fig09-multipliers": lambda: (f"printed: {fig09.PRINTED}\n",),
    "fig10-in-phase": lambda: (
        f"{fig10.IN_PHASE} π for \"in phase\", {fig10.STEADY} π for \"steady\"",
        f"Nuclei of {listed(fig10.SIZES, ' and ')} sites",
        f"breathers of nucleus sizes {listed(fig10.SIZES, ' and ')} at c = {fig10.C},",
        f"a perturbation of {plain(fig10.NOISE)} the", f"by εt = {plain(fig10.END)};",
        f"--c {fig10.C} ",
    ),
    "fig11-values": lambda: (
        f"within a factor of {fig11.SAME_RATE}", f"printed: {', '.join(fig11.PRINTED.values())}\n",
    ),
    "fig11-converged": lambda: (
        f"tolerance: {plain(fig11.CONVERGED)},", f"over sizes {listed(fig11.ODD[2:])}\n",
    ),
    "fig11-stable": lambda: (
        f"up to c = {fig11.MIRRORED_AT[-1]}:", f"sizes {fig11.RANGE[0]} to {fig11.RANGE[-1]} with",
        f"for sizes {listed(fig11.FAMILY, ' and ')} the family",
    ),
    "fig11-all-lost": lambda: (
        f"tolerance: {plain(fig11.CONVERGED)},", f"sizes {fig11.RANGE[0]} to {fig11.RANGE[-1]}, "
        f"{listed(fig11.FAMILY, ' and ')}. As ε → 0 all of them lose their stability below "
        f"{fig11.LAST}.",
    ),
    "fig12-steady": lambda: (
        f"the first {fig12.COMPARED} arrivals", f"{plain(fig12.STEADY)} between",
        f"{percent(fig12.DELAY)} in the delay", f"the last of {fig12.SITES} sites",
        f"c = {fig12.C}, ε = {fig12.EPS}; t = {', '.join(f'{t:.0f}' for t in fig12.TIMES)}\n",
    ),
    "fig13-scaling": lambda: (
        f"for c = {listed(fig13.CHECKED, ' and ')}\n",
        f"from c = {fig13.FULL[0]} to {plain(fig13.FULL[-1])},",
        f"between c = {listed(fig13.AVERAGED[-2:], ' and ')}\n",
        f"residuals of {percent(fig13.MARK)} of", f"{fig13.LINEAR} in the exponent",
        f"v̂({plain(fig13.AVERAGED[-1])})",
    ),
    "fig13-similar": lambda: (
        f"tolerance: {plain(fig13.LAW)} between law and run", f"velocities to {plain(fig13.LAW)};",
        f"at η = {fig13.LAW_ETAS[0]}, 1/{1.0 / fig13.LAW_ETAS[1]:g} and {fig13.LAW_ETAS[2]}, ",
        f"at c = {fig13.BELT_COUPLING}, divided", f"--c {plain(fig13.ONE)} ",
        f"v_d = {fig13.BELTS[1]} of Figs. 3, 4 and 6",
    ),
    "fig14-collapse": lambda: (
        f"for a = {listed(fig14.SHARES, ' and ')} agree", f"tolerance: {plain(fig14.AGREE)},",
        f"to {plain(fig14.ACCURACY)} of itself", f"at c = {fig14.C}:",
        f"at {['four', 'five', 'six'][len(fig14.FULL) - 4]} η the",
    ),
    "fig15-regions": lambda: (
        f"--eta {grid(fig15.ETAS)} --c {grid(fig15.COUPLINGS)} ",
        f"counted at εt = {plain(fig15.SCIPY_END)} ", f"up to εt = {plain(fig15.WATCHED)}.",
        f"At η = {fig15.EMPTIED}, next", f"at most {percent(_maps.FEW)} of",
        f"at most a {'tenth' if fig15.LARGEST_SHARE == 0.1 else fig15.LARGEST_SHARE} may",
    ),
    "fig15-alike": lambda: (
        f"counted at εt = {plain(fig15.SCIPY_END)} ",
        f"{len(fig15.ETAS) * len(fig15.COUPLINGS)} points (II)",
    ),
    "fig16-admissible": lambda: (
        f"tolerance: {plain(fig16.AGREE)} between",
        f"printed: at a = {plain(fig16.A)}, b = {fig16.B}, c = {fig16.C}\n",
    ),
    "fig16-limits": lambda: (
        f"value: {fig16.FAR} sites", f"--from -{fig16.FAR} --to {fig16.FAR} ",
        f"{plain(fig16.AGREE)} for the chain",
    ),
    "fig17-linear": lambda: (
        f"{fig17.WINDOW} in the exponent", f"for c up to {plain(fig17.RUNS[-1])}\n",
        f"--c {plain(fig17.LAST)} ",
    ),
    "fig17-implicit": lambda: (f"tolerance: {plain(fig17.AGREE)} in v̂",),
    "fig17-condition": lambda: (f"tolerance: {plain(fig17.AGREE)} in v̂",),
    "fig18-alike": lambda: (
        f"grows from {fig18.ETAS[0]} to {fig18.ETAS[-1]} v̂", f"printed: at c = {fig18.C}\n",
    ),
    "fig18-any": lambda: (f"tolerance: {plain(fig18.AGREE)} in v̂",),
    "text-patterns": lambda: (
        f"--c {text_friction.WEAK} --excite {listed(text_friction.PATTERNS[3]).replace(' ', '')} ",
        f"of {len(text_friction.PATTERNS)} patterns persist at v_d = {text_friction.BISTABLE};",
        f"ends[{text_friction.SLOW}] }}}} at v_d = {text_friction.SLOW}",
        f"ends[{text_friction.FAST}] }}}} at {text_friction.FAST}",
        f"from τ = {plain(text_friction.LATE)} to", f"At c = {text_friction.WEAK} every",
    ),
    "text-nucleation": lambda: (
        f"displaced by {text_friction.PUSH}:", f"at c = {text_friction.SMOOTH} among",
        f"at most {plain(text_friction.PAUSE)} between", f"--t-end {plain(text_friction.END)}\n",
    ),
    "text-spring": lambda: (f"tolerance: {plain(text_friction.EXACT)}, rounding",),
    "text-ends": lambda: (f"tolerance: {plain(text_friction.EXACT)}, rounding",),
    "text-topology": lambda: tuple(f"a = {a:g}" for a, _ in text_vdp.SETS),
    "text-to-larger": lambda: (
        f"--n {text_nuclei.CHAIN_SITES} ", f"With noise of {text_nuclei.NOISE} ",
    ),
}  # fmt: skip
"""By claim, what its text says of where it was tried and of the tolerance of its rule."""


@pytest.mark.parametrize("key", STATED)
def test_the_text_of_a_claim_gives_the_numbers_that_it_was_tried_and_judged_with(key: str) -> None:
    (module,) = (entry.claim.rule.__module__ for entry in find_entries() if entry.claim.key == key)
    head = [f"{name}: {line}" for name, line in words(module, key)]
    text = "\n".join([*head, template(module, key)])
    assert not [each for each in STATED[key]() if each not in text]


def test_tolerances_that_no_text_gives_in_figures_are_not_wider_than_their_reasons() -> None:
    assert fig04.INSENSITIVE <= 0.25 * fig04.PRINTED / 100.0  # a quarter of the fall at the edge
    assert fig04.BEFORE_END <= 2
    assert _orbits.SMALL <= 0.1  # "a tenth, for much smaller in every claim"
    assert fig09.TOGETHER <= 0.01 * 0.2  # a hundredth of the axis of Fig. 9, c from 0 to 0.2
    assert fig11.SOLVERS <= 1e-5  # ten times the effect of the ends
    assert fig12.AGREE <= 1e-4 * 140.0  # of the time from site to site
    assert max(fig03.AGREE, text_friction.APART) <= 1e-3  # of arrivals, as in Figs. 4 to 6
    assert equations.ROUNDING <= 1e-10


def test_the_text_names_the_coupling_at_which_the_exponent_is_taken() -> None:
    power = str(round(math.log10(fig17.LAST))).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    assert 10.0 ** round(math.log10(fig17.LAST)) == fig17.LAST
    assert f"at c = 10{power}\n" in template(fig17.__name__, "fig17-linear")


# ------------------------------------------------------------------ two states of the friction cell


EDGE = 1.5
"""From farther up than this the made-up cell sticks for ever, from nearer it slides in the end."""


def made_up_run(_: Any, y: float, end: float, samples: int = 3, **__: Any) -> Any:
    """Return a run that sticks to its end from beyond the edge, and once at first below it."""
    times = np.linspace(0.0, end, samples)
    at = (0.5, end) if y > EDGE else (0.5,)
    log = np.array([[time, 0.0, 0.0] for time in at]).reshape(-1, 3)
    slides = 1.0 if y <= EDGE else 3.0
    return SimpleNamespace(
        log=log, times=times, last_cycle=(7.0, 2.0), end=end, start=y,
        y=np.full((samples, 1), slides), velocity=np.zeros((samples, 1)),
    )  # fmt: skip


def made_up_orbits(edge: float) -> Any:
    cycle = SimpleNamespace(min=-1.0, max=3.0, period=7.0, stick_time=2.0, amplitude=2.0)
    inner = SimpleNamespace(min=-0.5, max=edge, period=6.0)
    cell = SimpleNamespace(steady_sliding=1.0)
    return SimpleNamespace(
        cell=cell, stable_cycle=cycle, unstable_cycle=inner, basin=(-0.5, edge), error=1e-9
    )


def test_the_two_sides_of_the_edge_of_the_basin_are_both_run(monkeypatch: Patch) -> None:
    runs = []

    def run(*given: Any, **options: Any) -> Any:
        runs.append(made_up_run(*given, **options))
        far = runs[-1].log if runs[-1].start > EDGE else np.empty((0, 3))
        runs[-1].y[: len(runs[-1].y) // 2] = 9.0  # it is read for where it settles in the end
        runs[-1].log = far
        return runs[-1]

    monkeypatch.setattr(fig02, "_scipy", run)
    for edge, inside, outside in ((EDGE, True, True), (1.6, False, True), (1.4, True, False)):
        monkeypatch.setattr(fig02, "_orbits", lambda edge=edge: made_up_orbits(edge))
        runs.clear()
        found = fig02.two_states()
        assert {edge - 5e-3, edge + 5e-3} <= {one.start for one in runs}
        assert (found.inside_slides, found.outside_sticks) == (inside, outside)
        assert found.settles
        assert (found.gap, found.error) == (0.0, 1e-9)
        assert (found.cycle.start, found.rest.start) == (2.0, 1.0)  # as the picture says
        assert found.unstable.end == 6.0


def test_the_switch_model_is_judged_at_the_band_of_the_paper_and_at_either_tolerance(
    monkeypatch: Patch,
) -> None:
    orbits = made_up_orbits(EDGE)
    orbits.cell = FrictionCell(v_d=fig02.V_D)
    period = orbits.stable_cycle.period
    tolerances: set[tuple[float, float]] = set()

    def run(chain: Any, start: Any, end: float, *, band: float, relative: float, absolute: float,
            samples: int) -> Any:  # fmt: skip
        assert start.tolist() == [[orbits.stable_cycle.max], [0.0]]
        assert chain.sites == 1  # the cell alone
        assert end == 2.0 * 20.0 * period  # the second half is read: 20 periods, as the text says
        tolerances.add((relative, absolute))
        return SimpleNamespace(period=period * (1.0 + 3.0 * band**2 + relative))

    monkeypatch.setattr(fig02, "_orbits", lambda: orbits)
    monkeypatch.setattr("verification.references.switch_model.run_switch", run)
    found = fig02.switch_model()
    # |v_rel| < 1e-4 sticks in the paper.
    assert found.defaults == pytest.approx(3.0 * 1e-4**2 + 1e-3, rel=1e-9)
    assert found.tight == pytest.approx(3.0 * 1e-4**2 + 1e-9)
    assert found.order == pytest.approx(2.0, abs=1e-3)
    # scipy has the defaults of the solvers that the paper used; the others are far below both.
    defaults = inspect.signature(RK45).parameters
    assert max(tolerances) == (defaults["rtol"].default, defaults["atol"].default)
    assert all(each < 1e-8 for each in min(tolerances))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("off", [0.25, -0.25])
def test_the_force_at_release_is_off_by_as_much_below_as_above(
    off: float, side: float, monkeypatch: Patch
) -> None:
    """At one of two releases of one of two runs, which stick from 1 to 3 and from 5 to 7.

    Of a force in either direction the size counts, and of times that of a stick.
    """
    cell = FrictionCell(v_d=fig02.V_D, mu_st=1.25)
    log = np.array([[1.0, 0, 0], [3.0, 0, 1], [5.0, 0, 0], [7.0, 0, 1]])
    longer = np.array([[1.0, 0, 0], [3.0, 0, 1], [5.125, 0, 0], [7.5, 0, 1]])

    def run(release: float = 0.0, last: float = 7.0) -> Any:
        def made(chain: Any, start: Any, end: float, *, times: Any = None, **_: Any) -> Any:
            assert chain is None or chain.sites == 1
            assert np.array_equal(start, [[2.0], [0.0]])
            assert end == 40.0 or end == times[-1]
            at = np.arange(0.0, 8.0) if times is None else np.asarray(times)
            sticks = ((at >= 1) & (at <= 3)) | (at >= 5)
            force = (0.75 if release == 0.0 else 0.5) * cell.mu_st * np.where(at == 2.0, 1.0, 0.5)
            if times is not None:
                assert at.tolist() == [3.0, last]  # the releases of the same run
                force = cell.mu_st + release * (at == 3.0)
            y = np.where(sticks, side * force - 2.0 * cell.xi * fig02.V_D, -9.0)
            velocity = np.where(sticks, fig02.V_D, 0.0)
            return SimpleNamespace(
                y=y[:, None], velocity=velocity[:, None], log=log, event_log=longer
            )

        return made

    monkeypatch.setattr(fig02, "_orbits", lambda: SimpleNamespace(cell=cell))
    monkeypatch.setattr(fig02, "_scipy", lambda _, y, end: run()(None, [[y], [0.0]], end))
    for first, second in ((off, 0.0), (0.0, off)):
        monkeypatch.setattr("verification.references.friction_events.run_events", run(first))
        monkeypatch.setattr("verification.runs.simulate.simulate", run(second, 7.5))
        found = fig02.stick()
        assert found.at_release == pytest.approx(0.25)
        assert found.largest == pytest.approx(0.75)
        assert found.releases == 2
        assert found.gap == pytest.approx(0.375)


def test_the_cell_of_fig_2_is_run_from_rest(monkeypatch: Patch) -> None:
    def run(
        chain: Any, start: Any, end: float, *, times: Any, tolerance: float, longest_step: float
    ) -> Any:
        assert tolerance <= 1e-3 * fig02.AGREE  # of which a run may make many steps
        assert longest_step < 0.1 * 2.0 * math.pi  # so that no stick begins and ends within one
        return chain.sites, start.tolist(), end, times.tolist()

    monkeypatch.setattr("verification.references.friction_events.run_events", run)
    assert fig02._scipy(FrictionCell(), 1.75, 8.0, 3) == (1, [[1.75], [0.0]], 8.0, [0.0, 4.0, 8.0])


def test_thresholds_of_fig_4_are_searched_for_from_below_all_of_them(monkeypatch: Patch) -> None:
    folder = Path(fig04.__file__).parents[1] / "findings"
    known = json.loads((folder / "fig04.long_runs.json").read_text())
    found = known["evidence"]["object"]["thresholds"]["tuple"]
    monkeypatch.setattr(
        "verification.thresholds.spreading.spreading_threshold",
        lambda *_, lowest, **__: SimpleNamespace(c_crit=lowest),
    )
    assert 0.0 < fig04._threshold(1, "edge") < 0.9 * min(found)


def test_figs_3_to_5_are_computed_where_the_paper_or_the_text_says() -> None:
    assert (fig03.TIMES_A, fig03.TIMES_B) == ((200.0, 400.0, 600.0), (400.0, 700.0, 1000.0))
    assert fig03.CORE == (15, 16, 17)
    assert fig04.SIZES == (1, 3, 5, 7, 9)
    assert (fig04.ACCURACY, fig04.ASIDE) == (2e-5, 0.02)
    # Both falls that are told are from one site to three.
    assert fig04.KINDS == (("edge", 1), ("edge", 3), ("bulk", 1), ("bulk", 3), ("bulk", 7))
    assert fig05.WIDE_AT == (1.38, 1.4)  # of which the claim tells
    assert fig05.REFINED == 1.0 / 8.0  # "an eighth of the spacing"


def test_the_chains_of_figs_7_to_13_are_those_of_their_captions() -> None:
    assert (_breathers.A, _breathers.B, _breathers.EPS) == (2.5, 0.5, 0.01)
    assert (_fronts.A, _fronts.B, _fronts.EPS) == (4.0, 0.5, 0.01)


@pytest.mark.parametrize(("period", "stick"), [(7.25, 2.0), (6.75, 2.0), (7.0, 2.25), (7.0, 1.75)])
def test_the_gap_of_the_cycle_is_of_its_period_or_of_its_stick(
    period: float, stick: float, monkeypatch: Patch
) -> None:
    def run(*given: Any, **options: Any) -> Any:
        held = made_up_run(*given, **options)
        held.last_cycle = (period, stick)
        return held

    monkeypatch.setattr(fig02, "_scipy", run)
    monkeypatch.setattr(fig02, "_orbits", lambda: made_up_orbits(EDGE))
    assert fig02.two_states().gap == 0.25


@pytest.mark.parametrize(
    ("off", "sticks", "settles"),
    [(0.0, False, True), (0.03, False, False), (-0.03, False, False), (0.0, True, False)],
)
def test_a_run_settles_that_does_not_stick_and_ends_beside_steady_sliding(
    off: float, sticks: bool, settles: bool, monkeypatch: Patch
) -> None:
    def run(*given: Any, **options: Any) -> Any:
        held = made_up_run(*given, **options)
        held.y[-2] += off
        held.log = held.log[: int(sticks)]
        return held

    monkeypatch.setattr(fig02, "_scipy", run)
    monkeypatch.setattr(fig02, "_orbits", lambda: made_up_orbits(EDGE))
    assert fig02.two_states().settles is settles


def test_a_start_that_stuck_once_and_then_slides_slides(monkeypatch: Patch) -> None:
    drawn = []

    def diagram(_: Any, v_d: Any) -> None:
        drawn.extend(v_d)

    def slope(cell: Any) -> Any:
        return SimpleNamespace(amplitude=1.0, stick_time=cell.v_d)

    def run(cell: Any, y: float, *given: Any, **options: Any) -> Any:
        assert y > EDGE or 0.05 < abs(y - cell.steady_sliding) < 0.2  # to depart from it
        held = made_up_run(cell, y, *given, **options)
        if y <= EDGE and cell.v_d == fig02.VELOCITIES[0]:
            held.log = held.log[:0]  # one that has not stuck at all
        return held

    monkeypatch.setattr(fig02, "_scipy", run)
    monkeypatch.setattr("verification.cells.diagram.cell_diagram", diagram)
    monkeypatch.setattr("verification.cells.friction.stick_slip_cycle", slope)
    orbits = SimpleNamespace(cycle_end_velocity=1.8, cycle_end_error=1e-9)
    monkeypatch.setattr(fig02, "_orbits", lambda: orbits)
    found = fig02.regions()
    # Steady sliding lies below 1 at every velocity, and 2.5 beyond the edge.
    assert found.seen == ((True, True),) * len(fig02.VELOCITIES)
    assert found.stick_at_end == pytest.approx(1.8, rel=1e-5)
    assert found.stick_at_end < 1.8
    assert all(low < high for low, high in pairwise(drawn))
    assert drawn[0] < found.hopf < found.end < drawn[-1]  # all three regions are drawn
    assert (found.hopf, found.error) == (FrictionCell(v_d=fig02.V_D).hopf_velocity, 1e-9)


def test_sliding_is_expected_above_hopf_and_sticking_below_the_end() -> None:
    velocities = fig02.VELOCITIES
    at = evidence(fig02.Regions, hopf=velocities[1], end=velocities[3]).expected
    assert at == tuple((k > 1, k < 3) for k in range(len(velocities)))


def test_the_unstable_cycle_repels_if_runs_from_both_sides_leave_it(monkeypatch: Patch) -> None:
    cycle = SimpleNamespace(amplitude=2.0, max=EDGE)
    monkeypatch.setattr("verification.cells.friction.unstable_cycle", lambda _: cycle)

    def leaving(growth: Callable[[float], float]) -> Any:
        def run(_: Any, y: float, end: float, samples: int, **__: Any) -> Any:
            starts.append(y)
            times = np.linspace(0.0, end, samples)
            height = np.exp(growth(y) * times / end) * np.cos(0.3 * times)
            return SimpleNamespace(y=height[:, None])

        return run

    for growth, repels in (
        (lambda y: y - EDGE, (True, True)), (lambda y: EDGE - y, (False, False)),
        (lambda _: 1.0, (False, True)), (lambda _: -1.0, (True, False)),
    ):  # fmt: skip
        monkeypatch.setattr(fig02, "_scipy", leaving(growth))
        starts: list[float] = []
        assert fig02.subcritical().repels == repels
        # Of the largest of three distances, 5 % inside and outside, as the text says.
        assert starts == pytest.approx([EDGE - 0.05 * 2.0, EDGE + 0.05 * 2.0])


def test_the_unstable_cycle_is_held_against_its_expansion_beside_the_hopf_velocity(
    monkeypatch: Patch,
) -> None:
    """At 0.01, 0.001 and 0.0001 above it, as the text says."""
    mu_st, mu_d, v0, xi = 1.0, 0.5, 0.5, 0.05  # (7)
    hopf = v0 * math.log((mu_st - mu_d) / (2.0 * xi * v0))
    distances = []

    def cycle(cell: FrictionCell) -> Any:
        distances.append(cell.v_d - hopf)
        delta = 2.0 * xi * (1.0 - math.exp(-distances[-1] / v0))
        third = 2.0 * xi * math.exp(-distances[-1] / v0) / v0**2
        amplitude = math.sqrt(8.0 * delta / third)
        return SimpleNamespace(amplitude=len(distances) * amplitude, max=EDGE)

    monkeypatch.setattr("verification.cells.friction.unstable_cycle", cycle)
    run = SimpleNamespace(y=np.ones((4001, 1)))
    monkeypatch.setattr(fig02, "_scipy", lambda *_, **__: run)
    assert fig02.subcritical().ratios == pytest.approx((1.0, 2.0, 3.0))
    assert distances == pytest.approx([1e-2, 1e-3, 1e-4])


def test_the_gaps_of_the_friction_law_are_of_its_slope_and_the_largest_of_its_values(
    monkeypatch: Patch,
) -> None:
    cell = FrictionCell(v_d=fig02.V_D)
    with monkeypatch.context() as patch:
        patch.setattr("theory.cells.friction.friction_coefficient", lambda *_: cell.mu_d)
        slope = (cell.mu_st - cell.mu_d) / cell.v0 * math.exp(-fig02.V_D / cell.v0)
        assert fig02.friction_law().slope_gap == pytest.approx(slope, rel=1e-8)
    exact = fig02.friction_law()
    assert exact.slope_gap < 1e-9
    ends = {0.0: cell.mu_st, 1e3: cell.mu_d}

    def law_off_at(place: float) -> Callable[[float, FrictionCell], float]:
        def law(v: float, _: FrictionCell) -> float:
            between = cell.mu_d + (cell.mu_st - cell.mu_d) * math.exp(-v / cell.v0)
            return ends.get(v, between) + 0.25 * (v == place)

        return law

    for place in (0.0, 0.3, fig02.V_D, 1e3):
        patched = "verification.references.equations.dynamic_friction"
        monkeypatch.setattr(patched, law_off_at(place))
        assert fig02.friction_law().reference_gap == pytest.approx(0.25)


# ------------------------------------------------------------ thresholds and fronts of the friction


@pytest.mark.parametrize(("gap", "agree"), [(0.99e-3, True), (1.01e-3, False), (math.nan, False)])
def test_arrivals_by_two_methods_that_are_apart_are_no_evidence(
    gap: float, agree: bool, monkeypatch: Patch
) -> None:
    arrivals = {"arrivals_by_scipy": np.zeros(3), "arrivals_compiled": np.full(3, gap)}
    for name, found in arrivals.items():
        monkeypatch.setattr(_friction, name, lambda *_, found=found: found)
    monkeypatch.setattr("verification.runs.comparison.difference", lambda one, two: max(two - one))
    chain: Any = None
    if agree:
        assert _friction.disagreement(chain, (1,), 9.0) == gap
        return
    with pytest.raises(ArithmeticError, match="by scipy and by Taylor steps differ by"):
        _friction.disagreement(chain, (1,), 9.0)


def test_falls_are_from_the_smallest_nucleus() -> None:
    found = evidence(fig04.Thresholds, edge=(0.02, 0.01, 0.005), bulk=(0.04, 0.03, 0.02, 0.025),
                     bulk_of_two=0.025)  # fmt: skip
    assert found.falls == (50.0, 75.0)
    assert found.bulk_fall == pytest.approx(0.25)
    assert found.bulk_rest == pytest.approx(1.0 / 3.0)
    other = replace(found, bulk=(0.04, 0.02, 0.03, 0.025))
    assert (other.bulk_fall, other.bulk_rest) == pytest.approx((0.5, 1.0 / 3.0))
    assert found.apart == pytest.approx(0.005)
    assert replace(found, bulk_of_two=0.015).apart == pytest.approx(0.005)


def threshold_of(size: int, place: str, ends: str = "free", **_: Any) -> float:
    """Return another threshold for each size, place and kind of ends."""
    return 0.01 * size + {"edge": 0.001, "bulk": 0.002}[place] + 0.0001 * (ends != "free")


def test_thresholds_are_checked_beside_that_of_one_site_and_of_three(monkeypatch: Patch) -> None:
    checked = []

    def disagreement(chain: Any, excited: tuple[int, ...], end: float) -> float:
        assert (chain.sites, end) == (5, 400.0)  # as the text says
        checked.append((excited, chain.c / threshold_of(len(excited), "edge")))
        return 1e-6 * len(checked)

    monkeypatch.setattr(fig04, "_threshold", threshold_of)
    monkeypatch.setattr(fig04, "disagreement", disagreement)
    found = fig04.thresholds.__wrapped__()
    assert {excited for excited, _ in checked} == {(1,), (1, 2, 3)}
    ones = sorted(part for excited, part in checked if excited == (1,))
    threes = sorted(part for excited, part in checked if excited == (1, 2, 3))
    assert ones == pytest.approx([0.98, 1.02])  # 2 % aside, as the text says
    # Just above this threshold a new site takes longer than a run by scipy lasts.
    assert 0.95 < threes[0] < 1.0
    assert threes[-1] > 1.2
    assert found.gap == pytest.approx(4e-6)
    assert found.edge == tuple(threshold_of(n, "edge") for n in fig04.SIZES)
    assert found.bulk == tuple(threshold_of(n, "bulk") for n in fig04.SIZES)
    assert found.bulk_of_two == threshold_of(2, "bulk")
    assert found.literal == tuple(threshold_of(n, "edge", "literal") for n in (1, 3))


@pytest.mark.parametrize(("before", "farther"), [(2, 1), (1, 2)])
def test_a_front_that_does_not_fill_the_chain_is_run_in_one_twice_as_long(
    before: int, farther: int, monkeypatch: Patch
) -> None:
    stops = ("bulk", 3)
    short = {SITES: before, 2 * SITES: farther}

    def reached(c: float, size: int, place: str, sites: int, _: float) -> int:
        side = c / threshold_of(size, place) - 1.0
        assert abs(side) == pytest.approx(fig04.ASIDE)
        return size if side < 0.0 else sites - short[sites] * ((place, size) == stops)

    def disagreement(chain: Any, excited: tuple[int, ...], _: float) -> float:
        assert excited == (1,)  # of the first threshold, one site at the edge
        return float(chain.c)

    monkeypatch.setattr(fig04, "_threshold", threshold_of)
    monkeypatch.setattr(fig04, "_reached", reached)
    monkeypatch.setattr(fig04, "disagreement", disagreement)
    found = fig04.long_runs()
    assert found.below == tuple(size for _, size in fig04.KINDS)
    assert found.above == tuple(SITES - before * (kind == stops) for kind in fig04.KINDS)
    assert found.longer == {"bulk 3": 2 * SITES - farther}
    assert found.left == 2
    assert found.gap == pytest.approx((1.0 + fig04.ASIDE) * threshold_of(1, "edge"))


@pytest.mark.parametrize(
    ("pauses", "reached"),
    [([0.9] * 5, 6), ([0.9, 0.9, 1.6, 0.1, 0.1], 3), ([1.6] * 5, 1), ([0.01] * 5, 6)],
)
def test_sites_are_counted_until_all_have_stuck_or_none_does_for_the_stall_time(
    pauses: list[float], reached: int, monkeypatch: Patch
) -> None:
    stall = 40.0
    at = np.array([0.0, *np.cumsum(pauses)]) * stall

    class Running:
        def __init__(self, chain: Any, state: Any, **_: Any) -> None:
            assert chain.sites == at.size
            assert np.shape(state)[-1] == at.size
            self.time = 0.0

        @property
        def arrivals(self) -> Any:
            return np.where(at <= self.time, at, np.nan)

        def advance_to(self, time: float) -> None:
            assert time > self.time
            self.time = time

    monkeypatch.setattr("verification.runs.friction_integration.FrictionIntegration", Running)
    monkeypatch.setattr("verification.runs.excite._turning_points", lambda _: (0.0, 1.0))
    assert fig04._reached(0.01, 1, "edge", at.size, stall) == reached


def test_the_breather_of_fig_3_is_told_by_its_sites_and_by_the_spread_of_its_envelopes(
    monkeypatch: Patch,
) -> None:
    """That is largest at site 18, where the amplitude falls from 0.5 to a quarter."""
    envelope = np.zeros((3, SITES))
    envelope[:, 14:20] = (
        [1.0, 2.0, 1.0, 0.5, 0.3, 0.1], [1.0, 2.0, 1.1, 0.4, 0.2, 0.1],
        [1.0, 1.9, 1.0, 0.25, 0.125, 0.0625],
    )  # fmt: skip

    def run(chain: Any, start: Any, end: float, *, times: Any) -> Any:
        assert (chain.c, start, end, times) == (0.004, (15, 16, 17), 600.0, fig03.TIMES_A)
        arrivals = np.full(chain.sites, np.nan)
        arrivals[14:17] = (0.0, 1.0, 0.0)
        return SimpleNamespace(arrivals=arrivals, amplitude=envelope)

    def disagreement(chain: Any, excited: tuple[int, ...], end: float) -> float:
        assert (chain.c, chain.sites) == (0.004, 7)  # as the text says
        assert (excited, end) == ((3, 4, 5), 60.0)
        return 1e-6

    monkeypatch.setattr("verification.runs.excite.excite", lambda _, excited: excited)
    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    monkeypatch.setattr(fig03, "disagreement", disagreement)
    found = fig03.breather.__wrapped__()
    assert (found.stuck, found.gap) == ((15, 16, 17), 1e-6)
    assert (found.apart, found.where, found.own) == (0.125, 18, 1.0)
    assert (found.core, found.beside) == (1.9, (0.25, 0.125, 0.0625))


def test_amplitudes_of_fig_3_are_compared_behind_the_front_and_well_ahead_of_it(
    monkeypatch: Patch,
) -> None:
    def run(chain: Any, start: Any, end: float, *, times: Any) -> Any:
        assert (chain.c, start, end, times) == (0.02, [1], fig03.TIMES_B[-1], fig03.TIMES_B)
        sites = np.arange(chain.sites)
        amplitude = 100.0 * np.arange(1.0, 4.0)[:, None] - sites
        return SimpleNamespace(arrivals=100.0 * sites, amplitude=amplitude, arrival_error=1e-9)

    def disagreement(chain: Any, excited: tuple[int, ...], end: float) -> float:
        assert (chain.c, chain.sites, excited, end) == (0.02, 8, (1,), 180.0)  # as the text says
        return 1e-6

    monkeypatch.setattr("verification.runs.excite.excite", lambda _, excited: excited)
    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    monkeypatch.setattr(fig03, "disagreement", disagreement)
    found = fig03.front()
    assert found.arrived == (5, 8, 11)  # at the time itself, too
    assert (found.trailing, found.ahead) == ((97.0, 194.0, 291.0), (90.0, 187.0, 284.0))
    assert (found.arrival_error, found.gap) == (1e-9, 1e-6)


@pytest.mark.parametrize(("at_rest", "last"), [(False, 1), (True, 0)])
def test_what_lasts_is_what_sticks_in_the_last_window(
    at_rest: bool, last: int, monkeypatch: Patch
) -> None:
    """At first a few sites have stuck, and then another one."""
    ends = []

    class Run:
        def __init__(self, chain: Any, *_: Any, **__: Any) -> None:
            self.arrivals = np.zeros(chain.sites)

        def advance_to(self, time: float) -> None:
            assert np.isnan(self.arrivals).all()
            ends.append(time)
            self.arrivals[slice(2, 5) if len(ends) == 1 else 7] = time

        def going_to_rest(self) -> bool:
            return at_rest and len(ends) == 2

    monkeypatch.setattr("verification.runs.friction_integration.FrictionIntegration", Run)
    monkeypatch.setattr("verification.runs.excite.excite", lambda *_: None)
    assert fig05._lasting(1.25, 3) == (4, last)
    assert ends == [fig05.LATE - fig05.WINDOW, fig05.LATE]


@pytest.mark.parametrize("worst", range(3))
def test_the_checks_of_fig_5_are_off_by_the_worst_of_their_comparisons(
    worst: int, monkeypatch: Patch
) -> None:
    """On seven sites, of which the middle is excited, as the text says."""
    compared: list[tuple[float, float]] = []

    def apart(chain: Any, excited: tuple[int, ...], end: float) -> float:
        assert (chain.sites, excited, end) == (7, (4,), 80.0)
        compared.append((chain.c, chain.v_d))
        return 1e-6 * (1 + (len(compared) == 1 + worst))

    def arrivals(chain: Any, excited: tuple[int, ...], end: float) -> Any:
        assert (chain.sites, excited, end) == (7, (4,), 80.0)
        return np.where(np.arange(7) < 7 * (chain.c > 0.05), 0.0, np.nan)

    monkeypatch.setattr(fig05, "disagreement", apart)
    monkeypatch.setattr(fig05, "arrivals_by_scipy", arrivals)
    monkeypatch.setattr(fig05, "_lasting", lambda v_d, size: (10 * size, size))
    monkeypatch.setattr("verification.execution.sweep.sweep", lambda *given, **_: given)
    monkeypatch.setattr("verification.maps.boundary.boundary_lines", lambda *given: given)
    monkeypatch.setattr("verification.cells.friction.cycle_end_velocity", lambda cell: cell.v_d)
    found: Any = fig05.state_map()
    assert (found.gap, found.seen, found.cycle_end) == (2e-6, (7, 7, 0), 1.25)
    task, points = found.states
    assert (task.chain.sites, task.chain.v_d) == (SITES, 1.25)
    places = [(point["c"], point["v_d"]) for point in points]
    assert places == list(product(fig05.COUPLINGS, fig05.VELOCITIES))
    bisection, (states, axes) = found.boundary
    assert (bisection.tolerance, bisection.task.chain) == (fig05.REFINED, task.chain)
    assert (states, axes) == (found.states, ("c", "v_d"))
    assert compared == [(c, v_d) for c, v_d, _ in fig05.CHECKED]
    compared.clear()
    if worst < 2:
        lasting = fig05.lasting()
        assert lasting.gap == 2e-6
        assert compared == [(fig05.STRONG, v_d) for v_d in (1.1, 1.45)]
        assert set(lasting.active) == {1}  # from one site
        assert set(zip(lasting.wide_reached, lasting.wide_active, strict=True)) == {(90, 9)}


def friction_velocities(
    v: Callable[[float], float], error: float = 0.0
) -> fig06.FrictionVelocities:
    c = (*fig06.COUPLINGS, *fig06.LARGE)
    return evidence(
        fig06.FrictionVelocities, c=c, v=tuple(v(each) for each in c), error=(error,) * len(c),
        waves=c, gap=0.0, threshold=0.0106,
    )  # fmt: skip


def test_on_a_line_the_residual_is_zero_and_the_slopes_are_one() -> None:
    found = friction_velocities(lambda c: 0.5 + 3.0 * c)
    assert found.line == pytest.approx((0.5, 3.0))
    assert found.residual == pytest.approx(0.0, abs=1e-12)
    assert found.slopes == pytest.approx((3.0, 3.0))


def test_beyond_the_figure_velocities_stand_beside_waves_and_the_line() -> None:
    found = friction_velocities(lambda c: 0.5 + 3.0 * c)
    found = replace(found, waves=tuple(2.0 * c for c in found.c))
    assert found.beyond.split("; ") == [
        f"c = {c:g}: {0.5 + 3.0 * c:.3f}, waves {2.0 * c:.3f}, line {0.5 + 3.0 * c:.3f}"
        for c in fig06.LARGE
    ]


def test_errors_lower_the_slope_that_must_be_large_and_raise_the_other() -> None:
    first, line = friction_velocities(lambda c: 0.5 + 3.0 * c, 1e-4).slopes
    near = fig06.COUPLINGS[1] - fig06.COUPLINGS[0]
    far = fig06.COUPLINGS[-1] - fig06.LINEAR_FROM
    assert (first, line) == pytest.approx((3.0 - 2e-4 / near, 3.0 + 2e-4 / far))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_residual_is_the_largest_on_either_side_over_the_largest_velocity(side: float) -> None:
    steep = friction_velocities(lambda c: 1.0 + side * (c - 0.06) ** 2)
    c = np.array([c for c in fig06.COUPLINGS if c >= fig06.LINEAR_FROM])
    v = 1.0 + side * (c - 0.06) ** 2
    # By hand: the least-squares line through these, by its normal equations.
    mean, deviation = v.mean(), c - c.mean()
    line = mean + (deviation @ v) / (deviation @ deviation) * deviation
    assert steep.residual == pytest.approx(np.abs(line - v).max() / v.max())
    assert steep.residual > 0.0


def test_of_the_errors_the_largest_in_the_range_of_the_figure_is_stated() -> None:
    errors = (1e-4,) * (len(fig06.COUPLINGS) - 1) + (2e-4,) + (1e-3,) * len(fig06.LARGE)
    c = (*fig06.COUPLINGS, *fig06.LARGE)
    assert evidence(fig06.FrictionVelocities, c=c, error=errors).worst == 2e-4


def test_a_front_without_velocity_or_error_is_refused(monkeypatch: Patch) -> None:
    known = SimpleNamespace(c=0.3, largest_group_velocity=0.1)
    monkeypatch.setattr(fig06, "no_propagation", lambda: SimpleNamespace(threshold=0.0106))
    monkeypatch.setattr("verification.references.friction_cell.averaged_front", lambda _: 1.5)

    def apart(chain: Any, excited: tuple[int, ...], end: float) -> float:
        assert (chain.sites, excited) == (6, (1,))
        return 1e-6 * end

    def measure(chain: Any, *, max_sites: int, **_: Any) -> Any:
        sizes.append((chain.sites, max_sites))
        return SimpleNamespace(v=v, error=error, chain=known, status="lost")

    monkeypatch.setattr(fig06, "disagreement", apart)
    monkeypatch.setattr("verification.fronts.measure.measure_front", measure)
    for v, error in ((0.5, 1e-3), (None, 1e-3), (0.5, None)):
        sizes: list[tuple[int, int]] = []
        if v and error:
            found = fig06.velocities.__wrapped__()
            assert found.c == (*fig06.COUPLINGS, *fig06.LARGE)
            assert (set(found.v), set(found.error)) == ({v}, {error})
            assert found.gap == 1e-6 * max(end for _, end in fig06.SCIPY)
            small = sum(c < fig06.LINEAR_FROM for c in fig06.COUPLINGS)
            fast = len(fig06.COUPLINGS) - small
            assert sizes == [(SITES, 2 * SITES)] * small + [(61, 122)] * fast + [(101, 202)] * 2
            assert fig13._belt(1.25) == pytest.approx((1.25, 5.0, 0.01, 1.5))
            continue
        missing = "velocity" if v is None else "error"
        with pytest.raises(ArithmeticError, match=f"there is no {missing}"):
            fig06.velocities.__wrapped__()
        with pytest.raises(ArithmeticError, match=f"there is no {missing}"):
            fig13._belt(1.25)


def test_below_the_threshold_sites_are_counted_and_the_worse_comparison_counts(
    monkeypatch: Patch,
) -> None:
    single, wide = 0.0106, 0.008

    def threshold(_: Any, spreading: Any, *, lowest: float, accuracy: float, **__: Any) -> Any:
        c = {1: single, 6: wide}[spreading.size]  # six, as the text says
        assert (lowest < c, accuracy) == (True, 2e-5)  # which it says too
        return SimpleNamespace(c_crit=c)

    def run(chain: Any, start: Any, end: float, **__: Any) -> Any:
        assert end == 4000.0  # as the evidence states
        assert np.array_equal(start, excite(chain, [1]))
        joined = np.full(chain.sites, np.nan)
        joined[: 1 + fig06.BELOW.index(chain.c)] = 0.0
        return SimpleNamespace(arrivals=joined)

    def disagreement(chain: Any, *_: Any) -> float:
        compared.append(chain.c / single)
        return gaps.pop()

    monkeypatch.setattr("verification.thresholds.spreading.spreading_threshold", threshold)
    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    monkeypatch.setattr(fig06, "disagreement", disagreement)
    for order in ([1e-9, 1e-3], [1e-3, 1e-9]):
        compared: list[float] = []
        gaps = list(order)
        found = fig06.no_propagation.__wrapped__()
        assert found.gap == 1e-3
        assert compared == pytest.approx([0.98, 1.02])
    assert found.arrived == tuple(range(1, 1 + len(fig06.BELOW)))
    assert (found.threshold, found.wide_threshold) == (single, wide)


def test_patterns_that_persist_are_those_that_are_as_they_were() -> None:
    assert all(text_friction.PATTERNS)  # each excites some site
    kept = list(text_friction.PATTERNS)
    kept[1] = (15, 16)
    late = {text_friction.BISTABLE: tuple(kept), 1.05: ((1,), (1,)), 1.95: ((), (2,))}
    found = evidence(text_friction.Patterns, late=late)
    assert found.kept == len(kept) - 1
    assert found.ends == {text_friction.BISTABLE: len(set(kept)), 1.05: 1, 1.95: 2}


def test_sites_of_a_late_pattern_are_those_that_stick_after_the_long_run(
    monkeypatch: Patch,
) -> None:
    """At first all stick, and later one."""

    class Run:
        def __init__(self, *_: Any, **__: Any) -> None:
            self.arrivals, self.ran = np.full(SITES, np.nan), 0

        def advance_to(self, time: float) -> None:
            self.arrivals[2 if self.ran else slice(None)] = time
            self.ran += 1

    monkeypatch.setattr("verification.runs.friction_integration.FrictionIntegration", Run)
    monkeypatch.setattr("verification.runs.excite.excite", lambda *_: None)
    monkeypatch.setattr(text_friction, "disagreement", lambda *_: 0.0)
    assert {*text_friction.patterns().late.values()} == {((3,),) * len(text_friction.PATTERNS)}


def test_a_uniform_chain_is_pulled_by_its_literal_ends_only() -> None:
    """There the missing neighbour counts as zero, so that all of the coupling pulls."""
    found = text_friction.ends()
    assert found.free < 1e-15
    assert found.literal == pytest.approx(0.02 * FrictionCell(v_d=1.25).steady_sliding)


def test_a_velocity_is_off_by_as_much_below_as_above(monkeypatch: Patch) -> None:
    for slope in (0.0, 2.0):
        monkeypatch.setattr(text_friction, "math", SimpleNamespace(sin=lambda x, s=slope: s * x))
        found = text_friction.length()
        assert (found.right > 0.1, found.printed > 0.0) == (True, True)
    turned = iter([0.0] * 8 + [1.0, -1.0])  # two sines each, of which the last are off
    monkeypatch.setattr(
        text_friction, "math", SimpleNamespace(sin=lambda x: math.sin(x) + next(turned))
    )
    assert text_friction.length().right > 0.1  # of five velocities the worst counts


def test_the_trapezoidal_rule_is_followed_for_two_hundred_turns(monkeypatch: Patch) -> None:
    """A rule that damps by a part in 1e7 a step has lost that part in each step of 0.1."""

    def solve(after: Any, before: Any) -> Any:
        turn = (before - before.T) / 2.0
        step = 2.0 * turn[0, 1]
        assert np.array_equal(turn, 0.5 * step * np.array([[0.0, 1.0], [-1.0, 0.0]]))
        assert np.array_equal(after, np.eye(2) - turn)
        steps.append(step)
        return (1.0 - (1e-7 if step == 0.1 else 1e-6)) * np.eye(2)

    monkeypatch.setattr(np.linalg, "solve", solve)
    steps: list[float] = []
    found = text_friction.trapezoid()
    count = 200.0 * 2.0 * math.pi / steps[0]
    assert found.drift == pytest.approx(1.0 - math.exp(-1e-7 * count), rel=1e-3)
    assert found.factor == pytest.approx(1e-6)
    assert (min(steps) < 0.01, max(steps) > 100.0) == (True, True)


AWAY = np.abs(np.arange(SITES) - SITES // 2).astype(float)
"""Distance of each site from the one in the middle."""


@pytest.mark.parametrize("late", [None, SITES // 2 - 1, SITES // 2 + 1, 2, SITES - 3])
def test_a_front_is_one_in_which_every_site_joins_after_the_one_before(
    late: int | None, monkeypatch: Patch
) -> None:
    arrivals = AWAY.copy()
    if late is not None:
        arrivals[late] += 1.5

    class Running:
        def __init__(self, chain: Any, *_: Any, **__: Any) -> None:
            self.arrivals = np.where(AWAY > 0.0, arrivals, np.nan)

        def advance_to(self, _: float) -> None: ...

    def run(chain: Any, _: Any, end: float, **__: Any) -> Any:
        assert chain.eps * end == pytest.approx(text_friction.SLOW_END)
        return SimpleNamespace(arrivals=np.where(AWAY > 0.0, AWAY, np.nan))

    def evolution(joined: Any, *_: Any) -> Evolution:
        assert joined[SITES // 2] == 0.0  # the one that is excited is there from the start
        return Evolution(outcome=NucleusOutcome.FRONT, size=1, sizes=(1,), longest_pause=0.0)

    monkeypatch.setattr("verification.runs.friction_integration.FrictionIntegration", Running)
    monkeypatch.setattr("verification.runs.excite._turning_points", lambda _: (0.0, 1.0))
    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    monkeypatch.setattr("verification.breathers.outcome.evolution", evolution)
    monkeypatch.setattr(text_friction, "disagreement", lambda *_: 0.0)
    found = text_friction.nucleation.__wrapped__()
    fronts = 2 * len(text_friction.FRICTION)
    assert found.outward == (*(late is None,) * fronts, True)
    assert found.ends == {"front"}


@pytest.mark.parametrize(
    ("left", "right", "outward"),
    [
        ([1.0, 2.0], [1.5, 2.0], True), ([1.0], [1.0, 2.0, 3.0], False), ([1.0], [1.0], False),
        ([1.0, 1.0], [1.0, 2.0], False), ([1.0, 2.0], [2.0, 1.0], False),
    ],
)  # fmt: skip
def test_a_front_runs_outwards_that_takes_in_two_sites_or_more_on_either_side(
    left: list[float], right: list[float], outward: bool
) -> None:
    never = [np.nan] * 3
    arrivals = np.array([*never, *left[::-1], 0.0, *right, *never])
    assert text_friction._outward(arrivals, 3 + len(left)) is outward


@pytest.mark.parametrize(("part", "growth"), [(0.9, 1.25), (1.05, 0.75)])
def test_cycles_are_fixed_points_of_a_turn_and_multipliers_their_slopes(
    part: float, growth: float, monkeypatch: Patch
) -> None:
    def turn(a: float, b: float, height: float) -> float:
        """Return the next height, with fixed points at a part of those of the averaged cell."""
        root = math.sqrt(1.0 - 8.0 * b / a**2)
        inner, outer = (part * math.sqrt(a / b * (1.0 + sign * root)) for sign in (-1.0, 1.0))
        return height - 0.25 * height * (height - inner) * (height - outer) / (inner * outer)

    centre, slip = text_vdp_centre(), 0.625

    def run(_: Any, end: float, start: list[float]) -> Any:
        then = slip + growth * (start[1] - slip)  # at the centre, and different beside it
        return lambda time: np.array([centre + 6.0 - time, then + time - 6.0])

    monkeypatch.setattr(text_vdp, "_turn", turn)
    monkeypatch.setattr(text_vdp, "_trajectory", run)
    monkeypatch.setattr("verification.references.friction_cell.highest_after_slip", lambda _: 0.0)
    found = text_vdp.cells.__wrapped__()
    assert found.predicted == pytest.approx(abs(part - 1.0))
    assert found.friction_inner == pytest.approx((slip, growth))
    leaves = growth > 1.0
    assert (found.friction_inside, found.friction_outside, found.sticks) == (leaves, leaves, True)
    for inner, outer, rest in zip(found.inner, found.outer, found.rest, strict=True):
        ratio = outer[0] / inner[0]
        # By hand: the slope of the cubic at its roots.
        assert (inner[1], outer[1]) == pytest.approx(
            (1.0 + 0.25 * (ratio - 1.0) / ratio, 1.0 - 0.25 * (ratio - 1.0))
        )
        assert rest == pytest.approx(0.75, abs=0.01)


def test_a_turn_of_a_linear_cell_ends_at_the_height_of_a_damped_oscillator() -> None:
    damped = math.exp(-math.pi * text_vdp.EPS / math.sqrt(1.0 - text_vdp.EPS**2 / 4.0))
    for height in (1.0, 2.5):
        assert text_vdp._turn(0.0, 0.0, height) == pytest.approx(height * damped, rel=1e-9)


def test_a_turn_of_a_cell_changes_its_height_as_the_averaged_one(monkeypatch: Patch) -> None:
    """By -2π ε times half of R (1 - a R²/4 + b R⁴/8), as ε becomes small."""
    eps, (a, b) = 1e-5, text_vdp.SETS[0]
    monkeypatch.setattr(text_vdp, "EPS", eps)
    for r in (0.5, 1.5, 2.5):
        change = -math.pi * eps * r * (1.0 - a * r**2 / 4.0 + b * r**4 / 8.0)
        assert text_vdp._turn(a, b, r) - r == pytest.approx(change, rel=1e-3)


def test_the_ripple_of_a_cycle_is_that_of_the_first_order_in_epsilon(monkeypatch: Patch) -> None:
    """On y = R sin t it is ε times the variation of -∫cos²t (1 - a y² + b y⁴) dt."""
    sets, eps = ((2.5, 0.5), (2.0, 0.45)), 0.1
    monkeypatch.setattr(text_vdp, "EPS", eps)
    monkeypatch.setattr(text_vdp, "SETS", sets)
    found = text_vdp.small()
    assert found.orders == pytest.approx((1.0, 1.0), abs=1e-3)
    t = np.linspace(0.0, math.pi, 2001)
    for (a, b), ripple, effective in zip(sets, found.ripple, found.effective, strict=True):
        y = math.sqrt(a / b * (1.0 + math.sqrt(1.0 - 8.0 * b / a**2))) * np.sin(t)
        damping = 1.0 - a * y**2 + b * y**4
        size = cumulative_trapezoid(-(np.cos(t) ** 2) * damping, t)
        assert ripple == pytest.approx(eps * np.ptp(size), rel=1e-3)
        assert effective == pytest.approx(eps * np.abs(damping).max(), rel=1e-3)


def text_vdp_centre() -> float:
    """Return where the belt cell slides steadily."""
    from verification.references.friction_cell import CELL

    return CELL.steady_sliding


def test_a_solution_solves_both_equations_decays_and_is_listed_once(monkeypatch: Patch) -> None:
    alpha, z = _closed_form.solutions(1, 0.1, np.array([[2.77, 0.2]]))[0]
    monkeypatch.setattr("scipy.optimize.root", lambda _, start, tol: SimpleNamespace(x=start))
    near = alpha + 0.01
    gain = (-_closed_form.B * near**4 + 2.0 * _closed_form.A * near**2 - 8.0) / 1.6
    assert 0.0 < gain < 1.0
    tried = [(alpha, z), (near, gain), (-alpha, z), (alpha, z), (alpha, 0.9 * z)]
    assert _closed_form.solutions(1, 0.1, np.array(tried)) == [(alpha, z)]


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("name", ["sin", "exp"])
def test_a_display_that_fails_at_one_of_its_random_values_fails(
    name: str, side: float, monkeypatch: Patch
) -> None:
    """With a sine, or powers of e, that are wrong at one of the numbers that are asked for."""

    def wrong(x: Any) -> Any:
        found = getattr(np, name)(x)
        found[7] += 0.25 * side
        return found

    right = text_vdp.displays()
    monkeypatch.setattr(text_vdp, "np", SimpleNamespace(**{**vars(np), name: wrong}))
    found = text_vdp.displays()
    assert (right.wave, right.envelope) == pytest.approx((0.0, 0.0), abs=1e-8)
    assert found.wave > 0.1
    assert found.envelope > 0.01 if name == "exp" else found.envelope == right.envelope


# ------------------------------------------------------------------- breathers and their thresholds


def test_a_run_by_scipy_is_right_to_far_less_than_that_to_which_an_orbit_must_close() -> None:
    """That is 1e-8; the other run is by another method and to a tighter tolerance."""
    chain = VdpChain(a=_breathers.A, b=_breathers.B, c=0.1, eps=_breathers.EPS, sites=3)
    start = np.array([[0.3, 1.4, -0.7], [1.2, -0.9, 2.0]])
    other = simulate(chain, start, 6.25, samples=2, tolerance=1e-13)
    end = _breathers.flow(start.ravel(), 0.1, 6.25)
    assert np.abs(end - [*other.y[-1], *other.velocity[-1]]).max() < 1e-9


def test_differences_of_the_flow_at_rest_are_those_of_the_linear_chain() -> None:
    sites, c, time = 3, 0.1, 6.25
    stretch = np.diff(np.eye(sites), axis=0)
    eye, eps = np.eye(sites), _breathers.EPS
    springs = eye + eps * c * stretch.T @ stretch
    exact = expm(time * np.block([[0.0 * eye, eye], [-springs, -eps * eye]]))
    found = _breathers.monodromy_by_differences(np.zeros(2 * sites), c, time)
    assert found == pytest.approx(exact, abs=1e-5)


AVERAGED_CYCLE = math.sqrt(
    _breathers.A / _breathers.B * (1.0 + math.sqrt(1.0 - 8.0 * _breathers.B / _breathers.A**2))
)


def test_the_breather_of_a_run_is_its_first_harmonic_and_its_error_that_of_the_orbit(
    monkeypatch: Patch,
) -> None:
    period, sizes = 6.5, 3.0 * 0.25 ** np.abs(np.arange(fig07.SITES) - fig07.CENTRE)
    waves = sizes * np.exp(0.7j)
    clock = [0.0]

    def orbit(c: float) -> Any:
        steep = 1.0 if c == fig07.C else 0.5
        return SimpleNamespace(amplitudes=sizes**steep, waves=-waves, frequency=c, error=3e-9,
                               period=period, stable=c == fig07.C)  # fmt: skip

    def flow(state: Any, c: float, duration: float, tolerance: float) -> Any:
        assert tolerance < 1e-3 * fig07.AGREE
        if not clock[0]:
            # From one site, on the cycle of the averaged cell, until all else has decayed.
            assert np.flatnonzero(state).tolist() == [fig07.SITES + fig07.CENTRE]
            assert state.shape == (2 * fig07.SITES,)
            assert state.max() == pytest.approx(AVERAGED_CYCLE)
            assert duration * fig07.EPS > 30.0
        assert c == fig07.C
        clock[0] += duration
        turn = 2.0 * np.pi * clock[0] / period
        y = (waves * np.exp(1j * turn)).imag + 0.01 * sizes * np.cos(2.0 * turn + 0.4)
        return np.concatenate([y, np.zeros(fig07.SITES)])

    monkeypatch.setattr(fig07, "orbit_of", orbit)
    monkeypatch.setattr(fig07, "flow", flow)
    found = fig07.localised.__wrapped__()
    assert found.run == pytest.approx(sizes)
    assert found.gap == pytest.approx(0.0, abs=1e-12)
    assert found.orbit == pytest.approx(sizes)
    assert (found.stable, found.frequency, found.error) == (True, fig07.C, 3e-9)
    # In the tail of a chain of springs c every wave below its band has 2c sinh k = -1.
    first, tail = found.stronger
    assert first == pytest.approx(0.5)
    assert fig07.STRONGER * (1.0 / tail - tail) == pytest.approx(1.0)


def test_phase_steps_are_followed_along_the_run_and_shapes_are_those_without_noise(
    monkeypatch: Patch,
) -> None:
    """In a chain in which each site turns faster than the one before, by half a turn in 1000."""
    from verification.thresholds.preparation import NucleusPreparation

    starts = {}

    def run(chain: Any, phi: Any, time: float) -> Any:
        return SimpleNamespace(phi=phi * np.exp(1j * np.pi * np.arange(phi.size) * time / 1000.0))

    def held(_: Any, preparation: Any, __: float, time: float) -> Any:
        starts.setdefault((preparation.size, preparation.perturbation), time)
        return SimpleNamespace(escaped=preparation.perturbation > 0.0 and lost)

    monkeypatch.setattr("verification.runs.envelope_run.run_envelope", run)
    monkeypatch.setattr("verification.thresholds.preparation.hold", held)
    steps = np.array([0.5, -0.25])
    monkeypatch.setattr("verification.thresholds.preparation.phase_steps", lambda *_: steps)
    monkeypatch.setattr(fig10, "flow", lambda state, *_: state)
    for lost in (False, True):
        found = fig10.in_phase.__wrapped__()
        assert found.localised is not lost
    for (size, noise), rows in found.steps.items():
        off = np.abs(rows - fig10.TIMES[:, None] / 1000.0)
        assert rows.shape == (fig10.TIMES.size, size - 1)
        assert off.max() < (1e-4 if noise else 1e-12)
        assert bool(off.max() > 1e-9) is bool(noise)
    for size, shape in found.shapes.items():
        preparation = NucleusPreparation(size)
        chain = preparation.chain(VdpChain(a=fig10.A, b=fig10.B, c=fig10.C, eps=fig10.EPS), fig10.C)
        assert shape == pytest.approx(np.abs(preparation.start(chain)), abs=1e-13)
    assert found.gap == 0.5  # all in phase at first, as the start is


def test_the_closed_form_is_that_of_figs_7_to_9_read_as_is_asked(monkeypatch: Patch) -> None:
    def solved(chain: Any, reading: Any) -> Any:
        assert (chain.a, chain.b, chain.eps) == (fig08.A, fig08.B, fig08.EPS)
        far = {Reading.NEIGHBOUR: 1.0, Reading.TAIL: 2.0}[reading]
        return SimpleNamespace(amplitudes=lambda count: far + chain.c * np.arange(count))

    monkeypatch.setattr("theory.averaged.breather.solve_breather", solved)
    places = np.array([0.125, 0.25])
    assert fig08.closed_form(Reading.NEIGHBOUR, places).tolist() == [[1.0, 1.125], [1.0, 1.25]]
    assert fig08.closed_form(Reading.TAIL, places).tolist() == [[2.0, 2.125], [2.0, 2.25]]


def test_of_two_orbits_the_one_that_closes_worse_counts(monkeypatch: Patch) -> None:
    def orbit(c: float) -> Any:
        return SimpleNamespace(
            amplitudes=c + np.arange(11.0), error=c, state=np.ones(4), period=64.0 * c
        )

    def flow(state: Any, c: float, period: float) -> Any:
        assert period == 64.0 * c
        return state + slack[c == fig08.COUPLINGS[-1]] * (np.arange(4) == 2)  # in one number

    slack = [0.25, -0.5]

    monkeypatch.setattr(fig08, "orbit_of", orbit)
    monkeypatch.setattr(fig08, "flow", flow)

    def solved(chain: Any, reading: Any) -> Any:
        assert (chain.a, chain.b, chain.c, chain.eps) == (fig08.A, fig08.B, fig08.C, fig08.EPS)
        return SimpleNamespace(
            status=SimpleNamespace(value="none" if reading is Reading.CENTRE else "found")
        )

    monkeypatch.setattr("theory.averaged.breather.solve_breather", solved)
    monkeypatch.setattr(
        fig08, "closed_form",  # below the orbit: by c/2 at n = 0, and in the tail by c at n = 1
        lambda reading, c: np.stack([5 + 0.5 * c, 6 + c * (reading is not Reading.TAIL)], 1),
    )  # fmt: skip
    assert fig08.amplitudes().closing == pytest.approx(0.5)
    slack.reverse()
    found = fig08.amplitudes()
    assert found.closing == pytest.approx(0.5)
    assert found.off == pytest.approx((0.5 * max(fig08.COUPLINGS), 0.0))
    assert found.off_tail == pytest.approx(max(fig08.COUPLINGS))
    assert found.error == max(fig08.COUPLINGS)
    assert found.centre_has_none


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_both_assumptions_are_measured_on_orbits_and_in_the_averaged_chain(
    side: float, monkeypatch: Patch
) -> None:
    def orbit(c: float, eps: float) -> Any:
        waves = np.full(2 * fig08.CENTRE + 1, 2.0 * np.exp(0.7j))
        waves[fig08.CENTRE + 1] *= 25.0 * eps * np.exp(1j * (side * eps - 0.5 * np.pi))
        period = 2.0 * np.pi / (1.0 + eps * (c - 3.0 * side * eps**2))
        return SimpleNamespace(waves=waves, amplitudes=np.abs(waves), period=period)

    def averaged(c: float) -> Any:
        return SimpleNamespace(unknowns=[9.0, 7.0, c + 0.25 * side])

    monkeypatch.setattr(fig08, "orbit_of", orbit)
    monkeypatch.setattr(fig08, "averaged_of", averaged)
    found = fig08.assumptions.__wrapped__()
    eps = np.array(fig08.EPSILONS)
    assert found.detuning == pytest.approx(-3.0 * side * eps**2)
    assert found.turns == pytest.approx(side * eps)
    assert (found.averaged, found.ratio) == pytest.approx((0.25, 0.25))
    assert found.orders == pytest.approx((2.0, 1.0))
    # At ε = 0.01, where δ = -3e-4 at c = 0.1.
    assert (found.share, found.needed) == pytest.approx((3e-3, 12e-3))
    assert (found.neglected, found.turn) == pytest.approx((144e-6, 0.01 * side))
    last = replace(found, detuning=(1.0, 1.0, -0.5, 0.125), turns=(1.0, 1.0, 0.25, -0.125))
    assert last.orders == pytest.approx((2.0, 1.0))  # of sizes


def test_a_crossing_is_where_the_growth_of_its_own_parity_changes_sign(monkeypatch: Patch) -> None:
    def along(c: float, *, misprinted: bool = False) -> Any:
        assert c <= fig09.ALONG[-1]  # just beyond which the closed form ends
        at = (0.196, 0.197) if misprinted else (0.194, 0.195)
        growth = [math.tanh(300.0 * (c - each)) for each in at]
        return SimpleNamespace(symmetric=growth[0], antisymmetric=growth[1])

    monkeypatch.setattr(fig09, "_approximate", along)
    found = [fig09._crossing(parity, **wrong)
             for wrong in ({}, {"misprinted": True})
             for parity in ("symmetric", "antisymmetric")]  # fmt: skip
    assert found == pytest.approx([0.194, 0.195, 0.196, 0.197], abs=1e-8)


def test_a_run_in_phase_is_judged_by_its_end_and_a_perturbed_one_by_its_second_half() -> None:
    times = np.linspace(0.0, fig10.END, 9)
    exact, noisy = np.full((9, 2), 0.5), np.full((9, 2), -0.5)
    exact[:3] = 0.0
    exact[6, 1], exact[7, 1], exact[-1] = 0.54, 0.52, (0.5, -0.5)
    noisy[:5], noisy[6, 0] = 0.0, -0.75
    later = exact.copy()
    later[3, 0] = 0.0
    steps = {(n, noise): noisy if noise else exact if n == 3 else later
             for n in fig10.SIZES for noise in (0.0, fig10.NOISE)}  # fmt: skip
    found = evidence(fig10.InPhase, times=times, steps=steps)
    assert found.end_steps.tolist() == [0.5, 0.5]
    assert found.locked_from == times[3]  # every step, of either size
    held = {pair: np.full_like(rows, 0.5) for pair, rows in steps.items()}
    assert evidence(fig10.InPhase, times=times, steps=held).locked_from == 0.0
    assert found.symmetric_change == pytest.approx(1.02)
    assert found.wandering == pytest.approx(0.25)


def test_folds_agree_with_runs_up_to_the_brackets_of_these_and_rounding() -> None:
    def folds(gap: float, run_error: float) -> fig11.Folds:
        return evidence(fig11.Folds, averaged={1: 0.0, 3: 0.0, 5: 0.0}, runs={1: -gap, 3: 0.0},
                        run_error=run_error)  # fmt: skip

    assert folds(0.9e-4, 1e-4).agree
    assert folds(0.0, 0.0).agree
    assert folds(5e-9, 0.0).agree
    assert not folds(1.1e-4, 1e-4).agree
    assert not folds(2e-8, 0.0).agree


@pytest.mark.parametrize("stable", [None, 0.125])
def test_a_breather_that_does_not_lose_stability_is_stable_up_to_its_fold(
    stable: float | None, monkeypatch: Patch
) -> None:
    def threshold(_: Any, nucleus: Any, by: Any) -> Any:
        c = 0.5 + nucleus.size / 64 + (by.value == "envelope")
        return SimpleNamespace(c_crit=c, stable_to=stable, error=nucleus.size / 64)

    def escape(_: Any, preparation: Any, tolerance: float) -> Any:
        size = preparation.size
        return SimpleNamespace(c_crit=1.5 + size / 64 - (size == 3) / 32, error=tolerance * size)

    monkeypatch.setattr("verification.thresholds.continuation.breather_threshold", threshold)
    monkeypatch.setattr("verification.thresholds.escape.escape_threshold", escape)
    found = fig11.folds.__wrapped__()
    assert found.stable_to == (0.5 + 1 / 64 if stable is None else stable)
    assert found.orbit == {n: 0.5 + n / 64 for n in fig11.ODD}
    assert found.averaged == {n: 1.5 + n / 64 for n in fig11.ODD}
    assert found.error == 9 / 64
    assert found.gap == 1 / 32
    assert found.run_error == pytest.approx(5e-4)


@pytest.mark.parametrize(("other", "own"), [(-1.25, 1.0), (1.0, -1.25)])
@pytest.mark.parametrize("stable", [None, 0.125])
def test_multipliers_are_apart_by_their_moduli_and_cross_by_parity_and_print(
    stable: float | None, other: float, own: float, monkeypatch: Patch
) -> None:
    def orbit(c: float) -> Any:
        assert 0.0 < c < 0.1916  # at which the breather ends
        values = np.array([0.5, 0.625, 1.0, own])
        return SimpleNamespace(
            state=np.full(4, c), period=8.0 * c, stability=SimpleNamespace(values=values)
        )

    def differences(state: Any, c: float, period: float) -> Any:
        assert (state.tolist(), c, period) == ([0.19] * 4, 0.19, 8.0 * 0.19)
        return np.diag([0.5, 0.625, 1.0, other])

    def known(chain: Any, nucleus: Any, by: Any) -> Any:
        assert (chain.a, chain.b, chain.eps) == (_breathers.A, _breathers.B, _breathers.EPS)
        assert (chain.sites, nucleus.size, by.value) == (_orbits.SITES, 1, "orbit")
        return SimpleNamespace(c_crit=0.5, stable_to=stable)

    def crossing(parity: str, *, misprinted: bool = False) -> float:
        return {"symmetric": 0.196, "antisymmetric": 0.197}[parity] + misprinted

    monkeypatch.setattr("verification.thresholds.continuation.breather_threshold", known)
    monkeypatch.setattr(fig09, "orbit_of", orbit)
    monkeypatch.setattr(fig09, "monodromy_by_differences", differences)
    monkeypatch.setattr(fig09, "_crossing", crossing)
    along = SimpleNamespace(values=np.ones(4), trivial=0.0)
    monkeypatch.setattr(fig09, "_approximate", lambda _: along)
    found = fig09.multipliers()
    assert (found.true_odd, found.true_fold) == (0.5 if stable is None else stable, 0.5)
    assert found.gap == 0.25
    assert (found.even, found.odd, found.odd_misprinted) == (0.196, 0.197, 1.197)


def test_the_jacobian_is_the_misprinted_one_only_where_this_is_asked_for(
    monkeypatch: Patch,
) -> None:
    def along(chain: Any, breather: Any, *, misprinted: bool) -> Any:
        assert (chain.a, chain.b, chain.eps) == (_breathers.A, _breathers.B, _breathers.EPS)
        return chain.c, chain.sites, breather, misprinted

    monkeypatch.setattr("theory.averaged.breather.solve_breather", lambda chain: chain.c)
    monkeypatch.setattr("verification.breathers.floquet.approximate_multipliers", along)
    assert fig09._approximate(0.125) == (0.125, _orbits.SITES, 0.125, False)
    assert fig09._approximate(0.125, misprinted=True) == (0.125, _orbits.SITES, 0.125, True)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_perturbation_along_the_leading_vector_changes_by_its_multiplier(
    sign: float, monkeypatch: Patch
) -> None:
    """In made-up linear flows, with a multiplier of one and one that is the nearest to it."""
    state, period = np.array([0.5, -1.0, 2.0]), 2.5
    vectors = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 3.0], [1.0, 0.0, 1.0]])
    leading = {1: sign * 0.96, 3: sign * 1.04}
    sizes: list[int] = []

    def power(turns: float) -> Any:
        each = np.array([1.0, leading[sizes[-1]], 0.5]) ** turns
        return vectors @ np.diag(each) @ np.linalg.inv(vectors)

    def orbit(chain: Any, nucleus: Any) -> Any:
        assert (chain.a, chain.b, chain.eps) == (_breathers.A, _breathers.B, _breathers.EPS)
        assert chain.c == 0.15  # as the text says
        assert nucleus == Nucleus(nucleus.size, outward_pattern(nucleus.size))
        sizes.append(nucleus.size)
        values = np.array([0.5, 1.0, 1.01 * leading[nucleus.size]])
        return SimpleNamespace(state=state, period=period, stability=SimpleNamespace(values=values))

    def differences(start: Any, c: float, time: float) -> Any:
        assert (start.tolist(), c, time) == (state.tolist(), 0.15, period)
        return power(1.0)

    def flow(starts: Any, c: float, time: float) -> Any:
        assert c == 0.15
        turns = round(time / period)
        assert time == turns * period
        return state[:, None] + power(turns) @ (starts - state[:, None])

    monkeypatch.setattr("verification.breathers.orbits.solve_orbit", orbit)
    monkeypatch.setattr(fig09, "monodromy_by_differences", differences)
    monkeypatch.setattr(fig09, "flow", flow)
    found = fig09.escape()
    assert sizes == [1, 3]
    assert found.inside == pytest.approx((1.01 * 0.96, 0.96))
    assert found.outside == pytest.approx((1.01 * 1.04, 1.04))


def test_nuclei_are_followed_without_noise_and_with_that_of_each_seed(monkeypatch: Patch) -> None:
    asked = []

    def follow(chain: Any, *, perturbation: float, seed: int) -> Any:
        asked.append((chain.c, perturbation, seed))
        evolution = SimpleNamespace(outcome=SimpleNamespace(value="larger nucleus"), size=seed + 3,
                                    size_at=lambda at: seed + at)  # fmt: skip
        run = SimpleNamespace(chain=chain)
        return SimpleNamespace(evolution=evolution, confirmed=chain.c != bad, run=run, c=chain.c)

    def distance(found: Any) -> Any:
        return SimpleNamespace(gap=found.c)

    monkeypatch.setattr("verification.breathers.outcome.follow_nucleus", follow)
    monkeypatch.setattr("verification.breathers.outcome.distance_from_breather", distance)
    for bad in (None, text_nuclei.COUPLINGS[3]):
        asked.clear()
        found = text_nuclei.to_larger()
        assert found.confirmed is (bad is None)
    runs = [(0.0, 0), *((text_nuclei.NOISE, seed) for seed in text_nuclei.SEEDS)]
    assert sorted(asked) == sorted((c, *run) for c in text_nuclei.COUPLINGS for run in runs)
    assert found.gap == max(text_nuclei.COUPLINGS)
    for seed in (None, *text_nuclei.SEEDS):
        assert set(found.sizes[seed].values()) == {(seed or 0) + 3}
    assert found.histories[None, text_nuclei.DRAWN[0]][-1] == 1000.0


def test_the_spread_of_folds_is_of_the_larger_sizes_and_the_step_between_three_and_five() -> None:
    orbit = {1: 0.1, 3: 0.4, 5: 0.3125, 7: 0.25, 9: 0.28125}
    found = evidence(fig11.Folds, orbit=orbit)
    assert (found.spread, found.step) == (0.0625, 0.4 - 0.3125)


def test_the_rate_that_a_printed_value_implies_is_found_again() -> None:
    rate, folds = {1: 3e-5, 3: 1.2e-4}, {1: 0.19, 3: 0.2}
    own = {n: float(text) - folds[n] for n, text in fig11.PRINTED.items()}
    delay = {n: late / rate[n] ** (2.0 / 3.0) for n, late in own.items()}
    rates = (4e-5, 1e-5)
    found = evidence(
        fig11.Sweeps, rates=rates,
        folds=evidence(fig11.Folds, orbit=folds, averaged={1: 0.18, 3: 0.19}),
        escapes={n: tuple(c + delay[n] * each ** (2.0 / 3.0) for each in rates)
                 for n, c in ((1, 0.18), (3, 0.19))},
    )  # fmt: skip
    assert found.late == pytest.approx(own)
    assert found.implied == pytest.approx(rate)
    assert found.ratio == pytest.approx(4.0)
    beyond = replace(found.folds, orbit=folds | {1: 1.0})  # a printed value that is not late
    assert replace(found, folds=beyond).ratio == math.inf


def ended(c: float, *stable: tuple[float, float]) -> fig11.Ended:
    return fig11.Ended(c_end=c, stable=stable)


def test_of_many_breathers_the_largest_couplings_count() -> None:
    found = evidence(
        fig11.Nuclei,
        branches={1: (ended(0.19, (0.0, 0.18)),), 2: (ended(0.195, (0.0, 0.1), (0.15, 0.16)),),
                  3: (ended(0.2), ended(0.1)), 5: (ended(0.199), ended(0.15, (0.1, 0.12)))},
        growth_here={1: 0.1, 3: 0.3}, growth_by_envelope={1: 0.2, 3: 0.25}, left=(),
    )  # fmt: skip
    assert found.stable == {1: 0.18, 2: 0.16, 5: 0.12}
    assert found.odd_stable == (5,)
    assert found.last == (3, 0.2)
    assert found.last_stable == (1, 0.18)
    left = ((8, 0.203, 0.2), (10, 0.202, -0.1), (12, 0.201, 0.0), (10, 0.2015, -0.2))
    some = replace(found, left=tuple(fig11.Left(size=n, end=c, growth=x) for n, c, x in left))
    assert some.unstable_left == (0.2,)
    assert some.stable_left == {10: 0.202, 12: 0.201}
    assert found.solvers_apart == pytest.approx(0.1)


def test_of_each_nucleus_with_random_phases_the_sites_in_the_cycle_are_counted(
    monkeypatch: Patch,
) -> None:
    seen = []

    def run(chain: Any, phi: Any, _: float) -> Any:
        size = np.abs(phi)
        excited = np.flatnonzero(size)
        assert np.allclose(size[excited], chain.stable_amplitude)
        assert excited.tolist() == list(range(excited[0], excited[-1] + 1))
        assert abs(excited[0] + excited[-1] - (chain.sites - 1)) <= 1
        seen.append((excited.size, np.angle(phi[excited])))
        joined = np.full(phi.size, 0.99 * chain.unstable_amplitude)
        joined[: excited.size + 2] = 1.01 * chain.unstable_amplitude
        return SimpleNamespace(phi=joined * np.exp(1j))

    monkeypatch.setattr("verification.runs.envelope_run.run_envelope", run)
    assert fig11._seeded_runs() == tuple(n + 2 for n in fig11.RANGE)
    assert [n for n, _ in seen] == list(fig11.RANGE)
    assert len({angles[0] for _, angles in seen}) == len(seen)


def test_every_sign_is_tried_of_small_nuclei_and_a_family_of_large_ones(
    monkeypatch: Patch,
) -> None:

    def at_the_damping_of_the_figures(name: str, function: Callable[..., Any]) -> None:
        def made(*given: Any, **options: Any) -> Any:
            assert given[-2:] == (fig11.A, fig11.B)
            return function(*given[:-2], **options)

        monkeypatch.setattr(f"verification.references.phase_locked.{name}", made)

    made = {"locked_breathers": ("every",), "family": ("some", "few")}
    for name, found in made.items():
        at_the_damping_of_the_figures(name, lambda n, found=found: [(n, x) for x in found])
    ends = {"every": 0.1, "some": 0.3 - 0.9 * fig11.NEAR, "few": 0.3}
    at_the_damping_of_the_figures("follow", lambda each: ended(ends[each[1]]))
    at_the_damping_of_the_figures("outward_breather", lambda n, c: (n, c))
    at_the_damping_of_the_figures(
        "growth_rate",
        lambda u, c, mirrored=False: -u[0] - abs(c - 0.15) if mirrored else u[0] + c,
    )
    other = "verification.breathers.envelope.solve_envelope_breather"
    monkeypatch.setattr(other, lambda chain, nucleus: SimpleNamespace(growth=nucleus.size + 0.3))
    monkeypatch.setattr(fig11, "_orbit_growth", lambda found: tuple(each.c_end for each in found))
    monkeypatch.setattr(fig11, "_seeded_runs", tuple)
    growth = {ends["some"]: 0.02, ends["few"]: None}
    monkeypatch.setattr(fig11, "_orbit_end", lambda each: (2.0 * each.c_end, growth[each.c_end]))
    found = fig11.nuclei.__wrapped__()
    counts = {n: [each.c_end for each in some] for n, some in found.branches.items()}
    large = [ends["some"], ends["few"]]
    assert counts == {n: [0.1] for n in fig11.RANGE} | dict.fromkeys(fig11.FAMILY, large)
    assert found.orbit_end == 0.6  # of those that end near the last
    assert found.left == tuple(
        fig11.Left(size=n, end=2.0 * ends["some"], growth=0.02) for n in fig11.FAMILY
    )
    assert found.orbit_growth == (0.1,)
    assert found.solvers_apart == pytest.approx(0.2)
    assert 0.15 in fig11.MIRRORED_AT[1:-1]  # where the largest of each is
    assert found.growth_mirrored == {3: -3.0, 5: -5.0, 7: -7.0}


def test_a_breather_is_followed_beyond_its_end_and_its_growth_is_that_at_the_last_coupling(
    monkeypatch: Patch,
) -> None:
    branch: Any = SimpleNamespace(c_end=0.2)

    def orbit(of: Any, c: float) -> tuple[str, str]:
        assert of is branch
        assert 0.9 * of.c_end < c < of.c_end
        return "system", "start"

    def trace(system: str, start: str, c: float) -> Any:
        assert (system, start) == ("system", "start")
        assert branch.c_end < c < 1.5 * branch.c_end
        return SimpleNamespace(fold=fold)

    def arrive(system: str, followed: Any, c: float) -> Any:
        assert (system, followed.fold) == ("system", fold)
        return SimpleNamespace(u=c + 0.25)

    monkeypatch.setattr(fig11, "_orbit", orbit)
    monkeypatch.setattr(fig11, "_growth", lambda u, c: u - c)
    monkeypatch.setattr("verification.continuation.branch.trace", trace)
    monkeypatch.setattr("verification.continuation.branch.arrive", arrive)
    fold: Any = SimpleNamespace(parameter=0.9 * fig11.LAST)
    assert fig11._orbit_end(branch) == (fold.parameter, None)
    fold = SimpleNamespace(parameter=1.1 * fig11.LAST)
    assert fig11._orbit_end(branch) == (fold.parameter, pytest.approx(0.25))
    fold = None
    with pytest.raises(ArithmeticError, match=r"fold near 0\.2000"):
        fig11._orbit_end(branch)


@pytest.mark.parametrize("growth", [0.125, -0.125])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_stable_breather_is_shot_at_from_its_averaged_wave_with_its_middle_at_rest(
    side: float, growth: float, monkeypatch: Patch
) -> None:
    """And its growth rate is that of the largest multiplier but the trivial one."""
    frequency, period = 0.25, 6.5
    waves = np.array([0.5, 2.0 * np.exp(2.75j), 0.5j, 0.0])
    eps, seen = fig11.EPS, []

    def follow_to(*given: Any) -> Any:
        assert given == ("first", fig11.ORBIT_AT, fig11.A, fig11.B)
        return SimpleNamespace(phi=waves, omega=frequency)

    def solve_at(system: int, guess: Any, c: float) -> Any:
        assert (system, c) == (1, fig11.ORBIT_AT)  # the site of the largest amplitude
        seen.append(guess)
        return SimpleNamespace(u=np.array([*guess[:-1], period]))

    def monodromy(state: Any, c: float, time: float) -> Any:
        assert (state.size, c, time) == (2 * waves.size, fig11.ORBIT_AT, period)
        return np.diag([0.5, 1.0, side * np.exp(growth * eps * period)])

    class Shooting:
        def __init__(self, chain: Any, nucleus: Any) -> None:
            assert (chain.sites, nucleus.size) == (waves.size, 1)

        def system(self, *, centre: int) -> int:
            return centre

    monkeypatch.setattr("verification.references.phase_locked.follow_to", follow_to)
    monkeypatch.setattr("verification.continuation.newton.solve_at", solve_at)
    monkeypatch.setattr("verification.breathers.orbits.Orbits", Shooting)
    monkeypatch.setattr(fig11, "monodromy_by_differences", monodromy)
    stable, lost = ((0.0, fig11.ORBIT_AT + 0.001),), ((0.0, fig11.ORBIT_AT - 0.001),)
    every = (stable, stable, lost, ())
    branches: Any = [SimpleNamespace(stable=each, first="first") for each in every]
    assert fig11._orbit_growth(branches) == pytest.approx((growth, growth))
    (*state, time), _ = seen
    start = np.array(state[4:]) + 1j * np.array(state[:4])
    assert start == pytest.approx(waves * np.exp(-2.75j))
    # One turn of a wave that gains ε times its frequency.
    assert (1.0 + eps * frequency) * time == pytest.approx(2.0 * math.pi)


@pytest.mark.parametrize(
    ("ends", "follow"),
    [
        ({0.1: "held", 0.2: "larger nucleus", 0.3: "larger nucleus", 0.4: "front", 0.5: "front"},
         True),
        ({0.2: "larger nucleus", 0.3: "front", 0.4: "larger nucleus", 0.5: "front"}, False),
        ({0.2: "larger nucleus"}, False),
        ({0.5: "front"}, False),
    ],
)  # fmt: skip
def test_fronts_follow_larger_nuclei_if_none_runs_below(
    ends: dict[float, str], follow: bool
) -> None:
    assert text_nuclei.succession(ends) is follow


# -------------------------------------------------------------------------- fronts of smooth chains


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_the_local_exponent_of_a_power_law_is_its_power(power: float) -> None:
    c = np.array([1.0, 4.0, 9.0, 25.0])
    middle, exponent = fig13.local_exponents(c.tolist(), (7.0 * c**power).tolist())
    assert middle == pytest.approx([2.0, 6.0, 15.0])
    assert exponent == pytest.approx([power] * 3)


def test_of_the_velocities_by_scipy_the_one_farthest_from_its_run_counts(
    monkeypatch: Patch,
) -> None:
    """On either side, wherever it is among those that are checked."""
    assert len(fig13.CHECKED) == 3

    def front(chain: Any, **_: Any) -> Any:
        return SimpleNamespace(chain=chain, v=2.0 * chain.c, error=1e-3, status="steady")

    monkeypatch.setattr("verification.fronts.measure.measure_front", front)
    monkeypatch.setattr("theory.averaged.front.strong_coupling_front",
                        lambda _: SimpleNamespace(kappa=1.0))  # fmt: skip
    for ratios in ((1.5, 1.25, 1.0), (1.0, 1.5, 1.25), (0.5, 1.25, 1.0)):
        off = dict(zip(fig13.CHECKED, ratios, strict=True))

        def by_scipy(a: float, b: float, c: float, off: dict[float, float] = off) -> float:
            assert (a, b) == (fig13.A, fig13.B)
            return 2.0 * c / off[c]

        monkeypatch.setattr("verification.references.passages.quarter_turn_velocity", by_scipy)
        assert fig13.scaling.__wrapped__().gap == pytest.approx(0.5)


def test_the_exponent_of_a_curve_is_that_of_its_last_two_couplings() -> None:
    v = (1.0, 2.0, 4.0, 16.0)
    found = evidence(fig13.AveragedScaling, c=(1.0, 2.0, 4.0, 8.0), v=v)
    assert found.exponent == pytest.approx(2.0)


def test_velocities_are_held_against_a_line_and_the_law_at_the_last_coupling() -> None:
    c = (1.0, 2.0, 48.0)  # of which a sixth has the cube root 2
    found = evidence(
        fig13.AveragedScaling, c=c, v=(1.0, 2.0, 1152.0), kappa=0.5, full_c=c,
        full_v=(3.0, 5.0, 97.0), full_error=(0.3, 1.0, 9.7),
    )  # fmt: skip
    assert found.line == pytest.approx((1.0, 2.0))
    assert found.residual == pytest.approx(0.0, abs=1e-12)
    assert found.exponent == pytest.approx(2.0)
    assert found.last == pytest.approx((1152.0, 49.0))
    assert found.worst == pytest.approx(0.2)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_largest_residual_of_a_line_counts_on_either_side(side: float) -> None:
    c = np.arange(3.0)
    v = 1.0 + 2.0 * c + 0.125 * side * np.array([1.0, -2.0, 1.0])  # by which no line is changed
    found = evidence(fig13.AveragedScaling, full_c=tuple(c), full_v=tuple(v))
    assert found.line == pytest.approx((1.0, 2.0))
    assert found.residual == pytest.approx(0.25 / v[-1])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_law_is_off_by_what_the_error_of_the_run_does_not_explain(side: float) -> None:
    rows = (
        (0.01, 10.0, 2.0, 0.0, 3.0, 1.0), (0.01, 100.0, 4.0, 0.5, 4.0 + side, 3.0),
        (0.08, 300.0, 5.0, 0.0, 5.0, 6.0), (0.08, 1000.0, None, 0.0, 9.0, 6.0),
    )  # fmt: skip
    found = evidence(fig13.Law, rows=rows, turning=0.05)
    assert found.worst == pytest.approx(0.125)
    assert len(found.settled) == 3
    assert found.outrun
    assert not evidence(fig13.Law, rows=rows, turning=0.005).outrun
    assert not evidence(fig13.Law, rows=rows, turning=0.09).outrun
    unknown = (*rows, (0.08, 2000.0, 5.0, None, 5.0, 6.0))
    with pytest.raises(ArithmeticError, match="there is no error at c = 2000"):
        _ = evidence(fig13.Law, rows=unknown).worst


def _bend(c: float) -> tuple[float, float]:
    """Return what `fig13.fastest_waves` returns, from differences of the frequency itself."""
    k, step = np.linspace(0.0, math.pi, 200_001, retstep=True)
    frequency = np.sqrt(1.0 + 2.0 * fig13.EPS * c * (1.0 - np.cos(k)))
    velocity = np.gradient(frequency, step)
    top, wide = int(velocity.argmax()), 500
    third = np.diff(velocity[top - wide : top + 2 * wide : wide], 2)[0] / (wide * step) ** 2
    return velocity[top] / fig13.EPS, float((-third / (6.0 * fig13.EPS)) ** (1.0 / 3.0))


@pytest.mark.parametrize("c", fig13.LAW_COUPLINGS)
def test_the_fastest_waves_are_those_of_the_dispersion_relation(c: float) -> None:
    assert fig13.fastest_waves(c) == pytest.approx(_bend(c), rel=1e-4)


def test_a_front_of_the_law_has_a_velocity_if_it_is_steady(monkeypatch: Patch) -> None:
    run = SimpleNamespace(v=1.0, error=0.1, steady=False)
    at: list[tuple[float, float]] = []

    def measure(chain: Any, **_: Any) -> Any:
        at.append((chain.b / chain.a**2, chain.c))
        return run

    monkeypatch.setattr("verification.fronts.measure.measure_front", measure)
    passages = "verification.references.passages.velocity_on_few_sites"
    monkeypatch.setattr(passages, lambda chain: (chain.b / chain.a**2, chain.c))
    monkeypatch.setattr(fig13, "_belt", lambda v_d: (v_d, 1.0, 0.1, 1.0))
    for run.steady, v in ((False, None), (True, 1.0)):
        at.clear()
        law: Any = fig13.velocity_law()
        rows = law.rows
        assert {(found, error) for _, _, found, error, *_ in rows} == {(v, 0.1)}
        assert at == [*((eta, c) for eta, c, *_ in rows), (fig13.ETA, fig13.ONE)]
        assert (law.one, law.one_error, law.by_scipy) == (1.0, 0.1, (fig13.ETA, 100.0))
        assert [v_d for v_d, *_ in law.belt] == list(fig13.BELTS)
        assert strong_coupling_front(law.turning).kappa == pytest.approx(0.0, abs=1e-9)
    kappa = {eta: (law - waves) / _bend(c)[1] for eta, c, _, _, law, waves in rows}
    assert kappa == pytest.approx({eta: strong_coupling_front(eta).kappa for eta in kappa}, 1e-4)
    for name in ("error", "v"):
        setattr(run, name, None)
        with pytest.raises(ArithmeticError, match=r"front of \(8\) at c = 1$"):
            fig13.velocity_law()


def test_averaged_cells_agree_if_they_are_on_the_same_side_of_one() -> None:
    rows = ((1.2, 1.5, 0.01, 1.1), (1.25, 0.9, 0.01, 0.5))
    assert evidence(fig13.Law, belt=rows).belt_agrees
    assert not evidence(fig13.Law, belt=(*rows, (1.3, 0.9, 0.01, 1.1))).belt_agrees


def test_the_velocities_of_a_front_are_between_its_places() -> None:
    times = np.array(fig12.TIMES)
    early, late = np.diff(times)
    places = (10.0, 10.0 + 0.5 * fig12.EPS * early, 10.0 + fig12.EPS * (0.5 * early + 0.75 * late))
    assert evidence(fig12.Steady, places=places).velocities == pytest.approx((0.5, 0.75))


def test_a_front_is_steady_by_its_arrivals_and_apart_from_scipy_by_the_worst(
    monkeypatch: Patch,
) -> None:
    delay, last = 100.0, fig12.TIMES[-1] + fig12.BEYOND
    reached = int(last / delay)
    apart = np.zeros(fig12.COMPARED + 4)

    def run(chain: Any, _: Any, end: float, **__: Any) -> Any:
        assert end >= last
        arrivals = np.full(chain.sites, np.nan)
        arrivals[:reached] = delay * np.arange(min(reached, chain.sites))
        arrivals[list(moved)] = list(moved.values())
        times = np.linspace(0.0, end, 206)
        ones = np.ones((206, chain.sites))
        return SimpleNamespace(
            arrivals=arrivals,
            times=times,
            level=1.0,
            arrival_error=1e-6,
            psi=1j * times[:, None] * ones,
            amplitude=2 * times[:, None] * ones,
        )

    def by_scipy(chain: Any, end: float, level: float, excited: float) -> Any:
        assert (level, excited) == (1.0, chain.stable_amplitude)
        assert end > delay * fig12.COMPARED
        return delay * np.arange(chain.sites) + apart

    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    monkeypatch.setattr("verification.references.passages.arrivals_of_chain", by_scipy)
    moved: dict[int, float] = {}
    monkeypatch.setattr(fig12, "SITES", reached + 20)
    for apart[3] in (0.25, -0.25):
        assert fig12.steady().gap == pytest.approx(0.25)
    apart[fig12.COMPARED + 1] = 9.0  # beyond what is compared
    found = fig12.steady()
    assert found.gap == pytest.approx(0.25)
    assert found.places == pytest.approx([1.0 + time / delay for time in fig12.TIMES])
    assert (found.delay, found.spread, found.in_order) == pytest.approx((delay, 0.0, True))
    assert found.arrival_error == 1e-6
    shown = [shape[0] for shape in found.shapes]
    assert shown == pytest.approx(fig12.TIMES, abs=0.5 * last / 205)
    assert found.amplitudes[0][0] == pytest.approx(2.0 * shown[0])
    moved[reached - 1] = (reached - 1 + 0.3) * delay
    late = reached - reached // 2 - 1  # delays in the second half, of which one is longer
    assert fig12.steady().spread == pytest.approx(0.3 / (1.0 + 0.3 / late))
    moved.clear()
    for time, in_order in ((8.005, True), (8.0, False), (7.5, False), (np.nan, False)):
        moved[9] = time * delay
        assert fig12.steady().in_order is in_order


def test_fronts_that_must_collapse_have_the_same_ratio_of_other_parameters(
    monkeypatch: Patch,
) -> None:
    def front(chain: Any, **_: Any) -> Any:
        assert chain.c == fig14.C
        key = round(chain.b / chain.a**2, 12)
        return SimpleNamespace(v=key if chain.model == "averaged" else (chain.a, key))

    monkeypatch.setattr("verification.fronts.measure.measure_front", front)
    velocity = "verification.references.passages.quarter_turn_velocity"
    monkeypatch.setattr(velocity, lambda a, b, c, _: (a, round(b / a**2, 12), c))
    found: Any = fig14.collapse()
    assert found.full == {a: tuple((a, eta) for eta in fig14.FULL) for a in fig14.SHARES}
    assert found.averaged == fig14.ETAS
    for a, rows in found.scipy.items():  # at the two η that the text names
        assert rows == ((a, 0.01, fig14.C), (a, 0.03, fig14.C))


def test_of_a_collapsed_curve_the_range_of_velocities_and_of_fast_fronts_are_stated() -> None:
    averaged = [2.0 * fig14.C] * len(fig14.ETAS)
    averaged[4:] = [fig14.C, *[0.25 * fig14.C] * (len(averaged) - 5)]
    found = evidence(fig14.Collapse, averaged=tuple(averaged))
    assert (found.fast_to, found.varies) == (fig14.ETAS[4], 8.0)


# ----------------------------------------------------------------------------------- maps of states


MET = table(
    c=[0.3, 0.1, 0.2, 0.4, 0.1, 0.2, 0.3, 0.4], v_d=[1.0] * 4 + [2.0] * 4,
    label=["front", "breather", "breather", "front", "breather", "undecided", "breather", "rest"],
)  # fmt: skip


def test_the_undecided_points_of_a_map_are_counted() -> None:
    met = _maps.LabelledMap(states=MET, boundary=MET)
    assert met.undecided == 1
    decided = table(label=["front", "breather"], c=[0.3, 0.1])
    assert replace(met, states=decided).undecided == 0


def test_a_sequence_has_each_state_once_with_growing_coupling() -> None:
    assert fig15.sequence(MET, "v_d", 1.0) == ("breather", "front")
    assert fig15.sequence(MET, "v_d", 2.0) == ("breather", "rest")
    assert fig15.sequences(MET, "v_d") == {("breather", "front"), ("breather", "rest")}


def test_maps_are_alike_by_their_columns_and_the_first_forcing_of_each(monkeypatch: Patch) -> None:
    """Both maps have the core sequences in one order, at forcings that the labels decide."""
    asked = []

    def labels(c: float, forcing: float) -> str:
        return "fixed point" if forcing > 2 else "breather" if c < 0.3 else (
            "front" if forcing < 1 else "fixed point")  # fmt: skip

    def sweep(task: Any, points: Any, **_: Any) -> Table:
        name = "v_d" if "v_d" in points[0] else "eta"
        forcings = list(dict.fromkeys(point[name] for point in points))
        asked.append((name, forcings))
        rank = {x: 3.0 * k / len(forcings) for k, x in enumerate(forcings)}
        couplings = list(dict.fromkeys(point["c"] for point in points))
        assert all(grid == sorted(grid) for grid in (forcings, couplings))
        middle = couplings[len(couplings) // 2]
        return table(
            **{name: [point[name] for point in points], "c": [point["c"] for point in points]},
            label=[labels(0.3 * (point["c"] >= middle), rank[point[name]]) for point in points],
        )

    monkeypatch.setattr("verification.execution.sweep.sweep", sweep)
    monkeypatch.setattr(fig15, "labels_by_scipy", lambda: ("front", "breather", "fixed point"))
    monkeypatch.setattr(fig15, "labels_at_checked", lambda _: ("front", "breather", "front"))
    found = fig15.alike()
    assert not found.confirmed
    assert found.one == found.two == frozenset(fig15.CORE)
    for (name, forcings), model in zip(asked, ("I", "II"), strict=True):
        assert (name == "v_d") == (model == "I")
        rank = [3.0 * k / len(forcings) for k in range(len(forcings))]
        first = [next(x for x, r in zip(forcings, rank, strict=True) if low(r)) for low in
                 (lambda r: r < 1, lambda r: 1 <= r <= 2, lambda r: r > 2)]  # fmt: skip
        assert found.first_at[model] == tuple(first)
    assert asked[0][1][0] > 1.0
    assert asked[0][1][-1] < 2.0  # the range of Fig. 5


def test_sites_on_the_cycle_by_scipy_are_those_beyond_the_inner_one(monkeypatch: Patch) -> None:
    counts, checked = iter((16, 3, 0)), iter(fig15.CHECKED)

    def last_state(rate: Any, end: float, start: Any, *_: float) -> Any:
        n, sites = next(counts), start.size // 2
        assert chains[0].eps * end == pytest.approx(fig15.SCIPY_END)  # in slow time
        assert (chains[0].b / chains[0].a ** 2, chains[0].c) == pytest.approx(next(checked))
        assert np.flatnonzero(start).tolist() == [sites - 1]
        a = chains[0].a
        root = math.sqrt(max(1.0 - 8.0 * chains[0].b / a**2, 0.0))
        outer, inner = (math.sqrt(a / chains[0].b * (1.0 + sign * root)) for sign in (1.0, -1.0))
        size = np.where(np.arange(sites) < n, outer, inner if n else 0.0)
        return np.concatenate([0.6 * size, 0.8 * size])

    def rate(chain: Any) -> None:
        chains[:] = [chain]

    chains: list[Any] = []
    monkeypatch.setattr("verification.references.equations.full_rate", rate)
    monkeypatch.setattr("verification.references.pace.last_state", last_state)
    assert fig15.labels_by_scipy.__wrapped__() == ("front", "breather", "fixed point")


def test_the_map_is_of_both_equations_and_its_boundaries_are_of_the_averaged_one(
    monkeypatch: Patch,
) -> None:
    def sweep(task: Any, points: Any, *, workers: int) -> Any:
        assert len(points) in (len(fig15.ETAS) * len(fig15.COUPLINGS), 3)
        if len(points) == 3:  # the boundaries, bisected
            return points
        return task.chain.model, task.chain.a, task.held

    maps = "verification.maps."
    monkeypatch.setattr("verification.execution.sweep.sweep", sweep)
    monkeypatch.setattr(maps + "boundary.boundary_lines", lambda *of: ("lines", *of))
    monkeypatch.setattr(maps + "state_map.compare", lambda *of: SimpleNamespace(same=of))
    monkeypatch.setattr(fig15, "labels_by_scipy", tuple)
    monkeypatch.setattr(fig15, "_least_after_filling", lambda eta, c: (eta, c))
    found: Any = fig15.state_map()
    assert found.least == {c: (fig15.EMPTIED, c) for c in fig15.EMPTIED_AT}
    full, averaged = found.same
    assert (full[0], averaged[0], found.states) == ("vdp", "averaged", full)
    assert found.boundary == ("lines", averaged, ("eta", "c"))
    assert found.other_reading == (averaged, ("averaged", 4.0, "a"))


def test_a_chain_is_watched_after_the_front_has_filled_it(monkeypatch: Patch) -> None:
    counts = [1, 9, 16, 16, 12, 7, 11]

    def run(chain: Any, start: Any, end: float, samples: int, **_: Any) -> Any:
        assert (chain.b / chain.a**2, chain.c) == pytest.approx((0.09, 0.5))
        assert chain.eps * end == fig15.WATCHED  # in slow time, and a sample in each unit of it
        assert samples >= fig15.WATCHED
        assert np.argwhere(start).tolist() == [[0, chain.sites - 1]]
        on, off = chain.stable_amplitude, 1.01 * chain.unstable_amplitude
        rows = [np.where(np.arange(chain.sites) < n, on, off) for n in counts]
        return SimpleNamespace(amplitude=np.array(rows))

    monkeypatch.setattr("verification.runs.simulate.simulate", run)
    assert fig15._least_after_filling(0.09, 0.5) == 7
    counts[2:4] = [15, 15]
    with pytest.raises(ArithmeticError, match="no front fills"):
        fig15._least_after_filling(0.09, 0.5)


# ----------------------------------------------------------------------- the piecewise-linear chain


def run_of(v: float | None, steady: bool = True) -> Any:
    return SimpleNamespace(v=v, steady=steady)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_steady_run_counts_and_the_worst_of_them(side: float) -> None:
    runs = (run_of(1.0), run_of(2.0), run_of(9.0, steady=False))
    found = evidence(fig17.PiecewiseScaling, runs=runs, theory=(1.0 + 0.25 * side, 2.0, 3.0))
    assert found.gap == 0.25
    pairs = tuple(zip(fig18.ETAS, (runs[1], runs[0], runs[2], runs[0], runs[0]), strict=True))
    alike = evidence(
        fig18.VelocityAgreement, runs=pairs, simplified=(2.0, 1.0 + 0.25 * side, 1.0, 1.0, 1.0)
    )
    assert alike.gap == 0.25


@pytest.mark.parametrize(("v", "gap"), [(2.75, 0.25), (3.25, 0.25), (None, math.inf)])
def test_the_moving_chain_is_held_against_the_fastest_solution_at_its_coupling(
    v: float | None, gap: float, monkeypatch: Patch
) -> None:
    def branches(c: float, eta: float) -> Any:
        assert eta == fig17.ETA
        found = [run_of(1.0), run_of(2.0), run_of(3.0)][: 3 if c < 0.45 else 1]
        return SimpleNamespace(branches=found, c_fold=c, c_pin=c + 0.1)

    def states(eta: float, couplings: Sequence[float]) -> Any:
        at = couplings.index(0.445)
        runs = [SimpleNamespace(v=9.0, status=SimpleNamespace(value="x")) for _ in couplings]
        runs[at] = SimpleNamespace(v=v, status=SimpleNamespace(value="here"))
        return SimpleNamespace(moving=runs, resting=runs)

    monkeypatch.setattr("theory.piecewise.kinetic_relation.kinetic_relation", branches)
    monkeypatch.setattr("verification.piecewise.simulation.hysteresis", states)
    found = fig17.implicit()
    assert (found.gap, found.below, found.above, found.resting) == (gap, 3, 1, "here")
    assert (found.c_fold, found.c_pin) == (0.445, 0.545)


def test_of_several_steady_runs_the_one_farthest_from_a_solution_counts() -> None:
    assert evidence(fig17.AdmissibilityRuns, nearest=(0.1, 0.3, 0.2)).gap == 0.3


@pytest.mark.parametrize(
    ("v", "steady", "gap", "reached"),
    [
        (2.0, True, 0.0, (False, False)),  # the admissible solution
        (1.0, True, 1.0, (True, False)),  # one that is not
        (-3.0, True, 5.0, (False, True)),
        (2.25, True, 0.25, (False, False)),
        (1.0, False, None, (False, False)),  # not steady: no front
        (None, True, None, (False, False)),
    ],
)
def test_a_chain_that_moves_at_an_inadmissible_velocity_is_told(
    v: float | None, steady: bool, gap: float | None, reached: tuple[bool, ...], monkeypatch: Patch
) -> None:
    kinds = {1.0: False, 2.0: True, -3.0: False, 7.0: None, 12.0: True}
    branches = [SimpleNamespace(v=each, admissible=kind) for each, kind in kinds.items()]
    solved, run = [], []

    def relation(c: float, eta: float) -> Any:
        solved.append((c, eta))
        return SimpleNamespace(branches=branches)

    def simulated(c: float, eta: float) -> Any:
        run.append((c, eta))
        return run_of(v, steady)

    monkeypatch.setattr("theory.piecewise.kinetic_relation.kinetic_relation", relation)
    monkeypatch.setattr("verification.piecewise.simulation.simulate_front", simulated)
    found = fig17.admissibility()
    assert run == solved
    sets = len(found.reached) // 2
    assert found.reached == reached * sets
    assert [each for *_, each in found.inadmissible] == [1.0, -3.0] * sets
    assert len({(c, eta) for c, eta, _ in found.inadmissible}) == sets
    assert found.runs == (0 if gap is None else sets)
    if gap is not None:
        assert found.gap == pytest.approx(gap)


@pytest.mark.parametrize("power", [0.25, -0.25])
def test_the_range_of_a_nearly_linear_velocity_is_below_the_resonances(power: float) -> None:
    """To the digits that are told, of an exponent that is a power of the coupling."""
    for c in (np.geomspace(0.2, 50.0, 400), np.geomspace(0.2, 50.0, 401)):
        exponent = np.where(c < 4.0, c**power, np.where(c > 7.0, 1.0, 0.5))
        found = evidence(fig17.PiecewiseScaling, c=tuple(c), exponent=tuple(exponent))
        ends = sorted((0.9 ** (1.0 / power), 1.1 ** (1.0 / power)))
        assert found.linear_range == pytest.approx(ends, rel=1e-3)
    few = replace(found, c=(1.0, 2.0, 3.0, 4.0, 7.0), exponent=(0.5, 1.0, 1.0, 0.5, 1.0))
    assert few.linear_range == pytest.approx((1.8, 3.2))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_last_exponent_is_off_by_as_much_above_as_below(side: float) -> None:
    found = evidence(fig17.PiecewiseScaling, exponent=(1.0, 2.0, 0.5), by_series=0.5 + 0.25 * side)
    assert found.series_gap == 0.25
    assert found.last == 0.5


def test_the_exponent_from_sums_is_that_of_the_curve_on_which_they_are_constant(
    monkeypatch: Patch,
) -> None:
    for power in (0.5, 1.0, 3.0):

        def total(v: float, c: float, power: float = power) -> Any:
            return SimpleNamespace(value=-2.0 * (c**power / v) ** 1.5 * 1j)

        monkeypatch.setattr("theory.piecewise.sums.series.sum_by_roots", total)
        assert fig17._exponent_by_series(4.0, 0.7) == pytest.approx(power, rel=1e-6)


def test_the_exponent_is_that_of_the_fastest_solution_and_the_curve_shows_its_thresholds(
    monkeypatch: Patch,
) -> None:
    """Of the law v = 3 c^(3/4), the fastest and not admissible one of four solutions."""
    ends = kinetic_relation(0.5, fig17.ETA)
    fold, pin = ends.c_fold, ends.c_pin
    assert fold is not None
    assert pin is not None
    law: list[float | None] = [2.5]

    def relation(c: float, eta: float) -> Any:
        assert eta == fig17.ETA
        v = 3.0 * c**0.75
        found = [
            SimpleNamespace(v=part * v, admissible=part < 1.0, by_c=0.75 * part**2 * v / c)
            for part in (0.125, 0.25, 0.5, 1.0)
        ]
        return SimpleNamespace(c=c, branches=found, c_fold=fold, c_pin=pin)

    def trace(c: Any, eta: float, admissibility: bool = True) -> list[Any]:
        assert np.all(np.diff(c) > 0.0)
        return [relation(x, eta) for x in c]

    at = "theory.piecewise."
    monkeypatch.setattr(at + "kinetic_relation.kinetic_relation", relation)
    monkeypatch.setattr(at + "kinetic_relation.trace_kinetic_relation", trace)
    monkeypatch.setattr(at + "limits.strong_coupling_velocity", lambda eta: law[eta != fig17.ETA])
    simulation = "verification.piecewise.simulation."
    monkeypatch.setattr(simulation + "hysteresis", lambda *given: given)
    monkeypatch.setattr(simulation + "simulate_front", lambda *given: given)
    monkeypatch.setattr(fig17, "_exponent_by_series", lambda *given: given)
    found: Any = fig17.scaling.__wrapped__()
    c = np.array(found.c)
    assert found.v == pytest.approx(3.0 * c**0.75)
    assert found.exponent == pytest.approx(np.full(c.size, 0.75))
    assert found.by_series == (found.c[-1], found.v[-1])
    assert found.theory == pytest.approx([1.5 * x**0.75 for x in fig17.RUNS])
    assert found.runs == tuple((x, fig17.ETA) for x in fig17.RUNS)
    assert (found.limit, found.c_fold, found.c_pin) == (2.5, fold, pin)
    # From just above depinning up to the last coupling, and closer where there are resonances.
    assert pin < c[0] < 1.02 * pin
    assert c[-1] == pytest.approx(fig17.LAST)
    steps = c[1:] / c[:-1]
    assert steps.max() < 1.1
    assert steps[(c[:-1] > 3.0) & (c[:-1] < 99.0)].max() < 1.0125
    # The curve is drawn from below its fold to the end of the figure, and beside its thresholds.
    assert found.solutions.x[0] < fold
    assert found.solutions.x[-1] == fig17.RUNS[-1]
    kinds = (True, True, True, False)
    assert found.solutions.admissible[:4] == found.near.admissible[:4] == kinds
    assert 0.99 * fold < found.near.x[0] < fold
    assert pin < found.near.x[-1] < 1.1 * pin
    eta, couplings = found.hysteresis
    assert eta == fig17.ETA
    assert couplings[0] < fold
    assert pin < couplings[-1] < found.near.x[-1]
    assert sum(fold < each < pin for each in couplings) > 2
    law[0] = None
    with pytest.raises(ArithmeticError, match="no law for strong coupling"):
        fig17.scaling.__wrapped__()


def test_any_set_is_off_by_the_worst_of_its_runs(monkeypatch: Patch) -> None:
    one = SimpleNamespace(branches=[SimpleNamespace(v=1.0), SimpleNamespace(v=-9.0)])
    monkeypatch.setattr("theory.piecewise.kinetic_relation.kinetic_relation", lambda *_: one)

    def run(c: float, _: float) -> Any:
        return SimpleNamespace(v=1.0 + c / 8.0, steady=True, status=SimpleNamespace(value="x"))

    monkeypatch.setattr("verification.piecewise.simulation.simulate_front", run)
    found = fig18.any_set()
    assert found.gap == max(c for c, *_ in found.rows) / 8.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_sum_without_roots_is_off_by_as_much_above_as_below(
    side: float, monkeypatch: Patch
) -> None:
    """As is the condition at rest; the two limits of the velocity are ratios of velocities."""
    eta, twice_r = 1.0 / 32.0, 2.0 * (2.0 - math.sqrt(3.0))

    def branches(c: float, eta: float) -> Any:
        return SimpleNamespace(branches=[run_of(0.0), run_of(0.5), run_of(c / eta)])

    def total(v: float, c: float) -> Any:
        assert v in (0.3, 1e-3)
        return SimpleNamespace(value=(twice_r + 0.25 * side) * 1j, error=0.5, terms=int(4 * c))

    at = "theory.piecewise."
    monkeypatch.setattr(at + "sums.integral.sum_by_integral", total)
    monkeypatch.setattr(at + "kinetic_relation.kinetic_relation", branches)
    monkeypatch.setattr(at + "limits.weak_threshold_velocity", lambda c, eta: 2.0 * c / eta)
    line = "verification.references.piecewise.sum_on_the_line"
    monkeypatch.setattr(line, lambda v, c: ((twice_r + 0.5 * side) * 1j, c))
    found = fig18.explicit()
    assert (found.terms, found.gap, found.bound) == (2, pytest.approx(0.25), 1.0)
    assert found.rest == pytest.approx(0.25)
    assert (found.strong[0], found.weak) == (1e6 / eta / math.sqrt(1e6), 0.5)


def test_fronts_of_the_averaged_chain_must_run_up_to_the_last_eta_and_may_stop_beyond_the_fold(
    monkeypatch: Patch,
) -> None:
    fold, pin = 0.0625, 0.03125

    def front(chain: Any, **_: Any) -> Any:
        eta = chain.b / chain.a**2
        return SimpleNamespace(v=None if eta > end["eta"] else 0.5 + eta)

    def branches(c: float, eta: Any) -> Any:
        assert c == fig18.C
        found = [SimpleNamespace(v=0.25, admissible=True)]
        return SimpleNamespace(c=c, eta=eta, branches=found)

    def trace(c: float, etas: Any) -> list[Any]:
        assert np.all(np.diff(etas) > 0.0)
        return [branches(c, eta) for eta in etas]

    def run(c: float, eta: float, start: str = "") -> Any:
        assert c == fig18.C
        assert eta in (fig18.CROSSING if start else fig18.ETAS)
        return SimpleNamespace(v={"": 0.5, "moving": 0.75, "resting": None}[start], steady=True)

    monkeypatch.setattr("verification.fronts.measure.measure_front", front)
    monkeypatch.setattr("theory.piecewise.folds.fold_eta", lambda _: SimpleNamespace(value=fold))
    monkeypatch.setattr("theory.piecewise.limits.pinning_eta", lambda _: pin)
    monkeypatch.setattr("theory.piecewise.kinetic_relation.kinetic_relation", branches)
    monkeypatch.setattr("theory.piecewise.kinetic_relation.trace_kinetic_relation", trace)
    monkeypatch.setattr("verification.piecewise.simulation.simulate_front", run)
    velocity = "verification.references.passages.quarter_turn_velocity"
    expected = (1.0, fig18.ETAS[0], fig18.C)  # a = 1: the velocity depends on η alone
    first = 0.5 + fig18.ETAS[0]
    monkeypatch.setattr(velocity, lambda *of: off * first if of[:3] == expected else math.inf)
    off, end = 0.75, {"eta": fig18.ETAS[-2]}
    with pytest.raises(ArithmeticError, match=rf"no front of \(43\) at η = {fig18.ETAS[-1]:g}"):
        fig18.alike()
    for end["eta"], reaches in ((fig18.ETAS[-1], fold), (fold, fold), (9.0, 2.0 * fold)):
        found = fig18.alike()
        assert found.averaged == tuple(0.5 + eta for eta in fig18.ETAS)
        assert found.averaged_reaches == reaches
        assert found.scipy_gap == pytest.approx(0.25)  # on either side
        off = 1.25
    assert found.gap == 0.25
    assert (found.fold, found.pin) == (fold, pin)
    assert set(found.moving) == {0.75}
    assert set(found.resting) == {None}
    # Every solution is drawn up to beyond the fold, and near the thresholds from below pinning.
    assert found.solutions.x[0] < fig18.ETAS[0]
    assert fold < found.solutions.x[-1] == found.near.x[-1] < 1.1 * fold
    assert 0.9 * pin < found.near.x[0] < pin
    assert np.diff(found.solutions.x).max() < 0.01 * fold


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_profiles_of_three_methods_are_apart_by_their_largest_difference(
    side: float, monkeypatch: Patch
) -> None:
    """Of a wave 1/(1 + e^ζ) that moves over a chain, with one site and one sum off."""

    def wave(zeta: Any) -> Any:
        return 1.0 / (1.0 + np.exp(np.asarray(zeta, dtype=float))) + 0j

    def by_roots(zeta: Any, v: float, c: float, terms: int) -> Any:
        assert (v, c) == (0.25, fig16.C)
        assert terms >= 1000
        phi = wave(zeta)
        phi[3] -= 0.125 * side
        return SimpleNamespace(phi=phi, error=1e-6)

    def simulated(c: float, eta: float) -> Any:
        assert (c, eta) == (fig16.C, eta_from_damping(fig16.A, fig16.B))
        phi = wave(np.arange(101) - latest)
        phi[latest + 4] += 0.25 * side
        phi[latest + 15] += 9.0  # beyond what is compared
        return SimpleNamespace(final=SimpleNamespace(latest=latest, phi=phi))

    latest = 60
    branch = SimpleNamespace(v=0.25, error=1e-12)
    at = "theory.piecewise."
    monkeypatch.setattr(
        at + "kinetic_relation.kinetic_relation", lambda *_: SimpleNamespace(branches=(branch,))
    )

    def integral(zeta: Any, v: float, c: float) -> Any:
        assert (v, c) == (0.25, fig16.C)
        return SimpleNamespace(phi=wave(zeta), error=2e-12)

    monkeypatch.setattr(at + "profile.front_profile", integral)
    monkeypatch.setattr(at + "profile.front_profile_by_roots", by_roots)
    monkeypatch.setattr(at + "profile.tail_bound", lambda v, c, way: (2.0 if way else 1.0, 3.0))
    verdict = SimpleNamespace(admissible=True, proven_beyond=(-9.0, 9.0))
    monkeypatch.setattr(at + "admissibility.check_admissible", lambda *_: verdict)
    monkeypatch.setattr("verification.piecewise.simulation.simulate_front", simulated)
    found = fig16.profile.__wrapped__()
    assert (found.chain_gap, found.series_gap) == pytest.approx((0.25, 0.125))
    assert (found.v_error, found.error, found.series_error) == (1e-12, 2e-12, 1e-6)
    far = fig16.FAR
    assert found.bounds == pytest.approx((3.0 * math.exp(-far), 3.0 * math.exp(-2.0 * far)))
    # Such a wave is as far from one behind as it is from zero ahead.
    assert found.behind == pytest.approx(found.ahead, abs=1e-15)
    assert found.chain_behind == pytest.approx(math.exp(-far), rel=1e-3)
    assert found.chain[found.sites == 0.0] == pytest.approx(0.5)
    # |φ_s| and |φ_us| are the roots of the damping of the averaged cell: 1 - a R²/4 + b R⁴/8.
    for amplitude in (found.amplitude, found.amplitude * found.threshold):
        r2 = amplitude**2
        assert 1.0 - fig16.A * r2 / 4.0 + fig16.B * r2**2 / 8.0 == pytest.approx(0.0, abs=1e-12)


def test_slopes_of_both_chains_are_told_from_one_eta_to_the_next() -> None:
    eta = np.array(fig18.ETAS)
    found = evidence(
        fig18.VelocityAgreement, averaged=tuple(eta**-0.5), simplified=tuple(3.0 * eta**-1.25)
    )
    assert found.slopes == ", ".join(["-0.50 and -1.25"] * (eta.size - 1))


def test_the_decay_of_a_chain_with_one_rate_is_that_rate_and_off_by_nothing() -> None:
    place = np.abs(np.arange(fig07.SITES) - fig07.CENTRE)
    tail = math.exp(-math.asinh(0.5 / fig07.C))
    orbit = 3.0 * tail**place
    found = evidence(fig07.Localised, orbit=orbit, run=orbit, harmonics=orbit + 0.25 * (place > 3))
    assert found.ratios == pytest.approx([tail] * 4)
    assert found.rate == pytest.approx(math.log(tail))
    assert found.off == pytest.approx(0.0, abs=1e-12)
    assert found.first_off == pytest.approx(0.0, abs=1e-12)
    assert found.gap == 0.25
    for off in (0.6, -0.6):  # a fifth of the largest, at one end and not in what is fitted
        uneven = orbit + off * (np.arange(fig07.SITES) == 0)
        assert replace(found, orbit=uneven).off == pytest.approx(0.2)
    lower = orbit * np.where(place == 0, 0.8, 1.0)
    assert replace(found, orbit=lower).first_off == pytest.approx(0.25)
