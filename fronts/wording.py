"""Results in words, for people at a terminal: lines by the name of the result's class."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from theory.result import Result


def in_words(result: Result) -> str:
    """Return what the command line prints of a result.

    Examples
    --------
    >>> from fronts.piecewise.roots import Root
    >>> print(in_words(Root(label=0, re=0.1, im=0.2, residual=0.0, radius=1e-15)))
    label: 0
    re: 0.1
    im: 0.2
    residual: 0
    radius: 1e-15
    """
    for each in type(result).__mro__:
        if each.__name__ in WORDS:
            return "\n".join(WORDS[each.__name__](result))
    return "\n".join(
        f"{name}: {f'{value:.12g}' if isinstance(value, float) else value}"
        for name, value in result.to_dict().items()
        if not isinstance(value, (list, dict))
    )


def _said(status: Any) -> str:
    """Return a member of an enum with its sentence."""
    return f"{status.value}: {status.sentence}"


def _uncertain(value: float, error: float, digits: int) -> str:
    return f"{value:.{digits}g}, uncertain by {error:.1e}"


def _kinetic_relation(answer: Any) -> Iterator[str]:
    yield f"{answer.status.value}: {answer.reason}"
    if answer.branches:
        yield "  v                    error    slope  dv/dc       dv/deta     admissible"
    for branch in answer.branches:
        yield (
            f"  {branch.v:<19.15g}  {branch.error:.1e}  {branch.slope:+5d}  "
            f"{branch.by_coupling:<10.5g}  {branch.by_eta:<10.5g}  {_verdict(branch)}"
        )
    if answer.branches:
        by_c = max(branch.by_coupling_error for branch in answer.branches)
        by_eta = max(branch.by_eta_error for branch in answer.branches)
        errors = f"errors of dv/dc up to {by_c:.1e}, of dv/deta up to {by_eta:.1e}"
        yield f"  {errors}: estimates, no bounds"
    known = []
    for name in ("c_fold", "c_pin", "c_retreat"):
        value, error = getattr(answer, name), getattr(answer, f"{name}_error")
        if value is not None and error is not None:
            known.append(f"{name} = {digits_that_hold(value, error)}")
    if known:
        yield "  " + ", ".join(known)
    if answer.limit_shown and answer.c_stable is None:
        yield "  no loss of stability of the fastest front was found"
    elif answer.limit_shown:
        limit = digits_that_hold(answer.c_stable, answer.c_stable_error)
        yield f"  the fastest front is stable up to c_stable = {limit}"
    yield f"  {answer.terms} values of Sigma, {answer.seconds:.3g} s"


def _certified_relation(answer: Any) -> Iterator[str]:
    yield from _kinetic_relation(answer)
    if answer.certified:
        yield "certified: these velocities and no others, and the thresholds"
    else:
        yield "not certified in every part"
    for each in answer.v_enclosures:
        yield f"  {each.lower!r} < v < {each.upper!r}"
    for name in ("c_fold", "c_pin", "c_retreat"):
        each = getattr(answer, f"{name}_enclosure")
        if each is not None:
            yield f"  {each.lower!r} < {name} < {each.upper!r}"
    for sentence in answer.unproven:
        yield f"  {sentence}"


def digits_that_hold(value: float, error: float) -> str:
    """Write at most twelve digits, and none that the error may change by more than one.

    Examples
    --------
    >>> digits_that_hold(1151998399.931, 0.016), digits_that_hold(0.25, 1e-17)
    ('1151998399.9', '0.25')
    """
    digits = 1
    while digits < 12 and error * 10.0**digits < value:
        digits += 1
    return f"{value:.{digits}g}"


def _verdict(branch: Any) -> str:
    if branch.admissible is None:
        return "not decided"
    stable = {True: ", stable", False: ", not stable", None: ""}[branch.stable]
    if branch.multiplier is not None:
        stable += f", multiplier {branch.multiplier:.6g}"
    return f"yes{stable}" if branch.admissible else f"no, fails at zeta = {branch.fails_at:.3g}"


def _kinetic_curve(curve: Any) -> Iterator[str]:
    yield f"{curve.along:<12}  status         velocities (admissible ones marked *)"
    for answer in curve.points:
        marks = "  ".join(
            f"{branch.v:.10g}{'*' if branch.admissible else ''}" for branch in answer.branches
        )
        yield f"{getattr(answer, curve.along):<12.7g}  {answer.status.value:<13}  {marks}"


def _sum(found: Any) -> Iterator[str]:
    from theory.piecewise.sums.result import DOUBLE, decimals, in_powers

    def part(value: Any) -> str:
        if isinstance(value, float):
            return f"{value:.16g}"
        return decimals(value, max(found.digits, DOUBLE))

    im = part(found.value.imag)
    yield f"Sigma = {part(found.value.real)}"
    yield f"      {im if im.startswith('-') else '+' + im} i"
    yield (
        f"error below {in_powers(found.error_as_written)}; {found.method}, {found.terms} terms, "
        f"{found.seconds:.3g} s"
    )


def _roots(found: Any) -> Iterator[str]:
    def cell(value: float | str) -> str:
        return f"{value:<22.16g}" if isinstance(value, float) else f"{value:<22}"

    for half, listed in (("upper", found.upper), ("lower", found.lower)):
        yield f"{half} half-plane"
        yield "  label  Re k                    Im k                    radius"
        for root in listed:
            yield f"  {root.label:>5}  {cell(root.re)}  {cell(root.im)}  {root.radius:.1e}"
    certified = "; every radius and the count certified" if found.certified else ""
    yield f"{found.counted} roots by the argument principle{certified}"


def _profile(shape: Any) -> Iterator[str]:
    yield f"v = {shape.v:.15g}, error below {shape.v_error:.1e}"
    if shape.admissible:
        yield "admissible: above threshold everywhere behind, below it everywhere ahead"
    elif shape.admissible is None:
        yield "admissibility was not decided"
    else:
        where = math.nan if shape.fails_at is None else shape.fails_at
        yield f"not admissible: it crosses the threshold again at zeta = {where:.4g}"
    yield (
        f"threshold |phi_us|/|phi_s| = {shape.threshold:.12g}; phi/phi_s is exact to "
        f"{shape.error:.1e}"
    )


def _table(columns: Mapping[str, Any]) -> Iterator[str]:
    """Show columns; a dash stands for what does not exist."""
    rows = [
        list(columns),
        *([_short(value) for value in row] for row in zip(*columns.values(), strict=True)),
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))


def _whole_table(result: Any) -> Iterator[str]:
    return _table(result.columns())


def _short(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _curve(result: Any) -> Iterator[str]:
    yield from _table(_columns_of_a_line(result))
    yield from dict.fromkeys(
        f"{result.along} = {value:g}: {point.reason}"
        for value, point in zip(result.values, result.points, strict=True)
        if type(point).__name__ == "Refusal"
    )
    yield f"{len(result.points)} points, {result.seconds:.3g} s"


def _branch(result: Any) -> Iterator[str]:
    yield from _table(_columns_of_a_line(result))
    for fold in result.folds:
        yield f"fold at c = {_uncertain(fold.c, fold.error, 12)}"
    if result.c_pin is not None:
        yield (
            f"c_pin = {digits_that_hold(result.c_pin, result.c_pin_error)}: fronts rest up to it, "
            f"and v = {result.square_root:.6g} sqrt(c - c_pin) just above it;"
        )
        yield (
            f"at strong coupling v = c {'+' if result.kappa > 0 else '-'} "
            f"{abs(result.kappa):.6g} (c/6)^(1/3)"
        )
        if not result.folds:
            yield "no fold of moving fronts in this range"
    yield f"{len(result.points)} points, {result.seconds:.3g} s"


def _columns_of_a_line(result: Any) -> dict[str, Any]:
    """Return the columns of a curve that fit a line."""
    columns = result.columns()
    names = (
        result.along, "status", "v", "error", "c_crit", "mechanism", "frequency", "centre",
        "stable", "growth", "amplitude", "eta", "effective_damping", "steady", "outruns_waves",
        "largest_group_velocity", "seconds",
    )  # fmt: skip
    return {name: columns[name] for name in names if name in columns}


def _cell(found: Any) -> Iterator[str]:
    yield _said(found.status)
    if found.model == "friction":
        hopf, end = found.hopf_velocity, found.cycle_end_velocity
        above = "at no v_d" if math.isinf(hopf) else "at every v_d" if hopf == 0.0 else ""
        yield (
            f"  steady sliding at y = {found.rest:.12g}, effective damping "
            f"{found.effective_damping:.6g}; stable {above or f'above v_d = {hopf:.12g}'}"
        )
        ends = f"at v_d = {end:.12g}" if math.isfinite(end) else "never"
        first = found.cycle_begin_velocity
        begin = f"begin at v_d = {first:.12g} and " if first else ""
        yield "  no stick-slip cycle at any v_d" if end == 0.0 else f"  cycles {begin}end {ends}"
    elif found.model == "chain":
        yield f"  rest at y = 0, effective damping {found.effective_damping:.6g}"
    else:
        eta = found.parameters["b"] / found.parameters["a"] ** 2
        yield f"  eta = b/a^2 = {eta:.12g}; two cycles exist below 1/8"
    named = [(name, getattr(found, name)) for name in ("stable", "unstable")]
    shown = [each for _, each in named]
    for other in getattr(found, "cycles", ()):
        if other not in shown:
            named.append((f"{'stable' if other.multiplier < 1.0 else 'unstable'} outer", other))
    for name, cycle in named:
        if cycle is not None:
            stick = f", of that stick {cycle.stick_time:.9g}" if cycle.stick_time else ""
            limit = cycle.averaged
            yield (
                f"  {name} cycle: y from {cycle.min:.12g} to {cycle.max:.12g}, amplitude "
                f"{cycle.amplitude:.9g}, period {cycle.period:.9g}{stick}"
                + ("" if limit is None else f"; amplitude as eps -> 0: {limit:.9g}")
            )
    yield _basin(found.basin)
    error = f"{found.error:.1e}" if math.isfinite(found.error) else "not known"
    yield f"  error {error}, {found.seconds:.3g} s"


def _basin(basin: tuple[float, float] | None) -> str:
    if basin is None:
        return "  no start with zero velocity ends at rest"
    if math.isinf(basin[0]):
        return "  every start with zero velocity ends at rest"
    low, high = basin
    return f"  starts with zero velocity and y from {low:.12g} to {high:.12g} end at rest"


_STABILITY = {True: "stable", False: "not stable", None: "stability not decided"}


def _breather(found: Any) -> Iterator[str]:
    yield _said(found.status)
    if found.fold is not None:
        yield f"  its branch folds at c = {found.fold:.10g}"
    if found.amplitudes.size:
        shown = "  ".join(f"{value:.6g}" for value in found.outward[:8])
        pattern = f", pattern {found.nucleus.pattern}" if found.nucleus.pattern else ""
        yield f"  {_STABILITY[found.stable]}{pattern}"
        yield f"  amplitudes, centre outwards: {shown}"
        yield f"  frequency {found.frequency:.12g}, outward phase step {found.phase_step:.6f}"
    if found.growth is not None:
        yield f"  largest growth rate per unit of slow time: {found.growth:.6g}"
    if found.trivial is not None:
        yield f"  trivial exponent or multiplier off by {found.trivial:.1e}"
    if found.error_unknown:
        yield f"  error against the periodic orbit of (8) unknown: {found.error_unknown}"
    elif found.frequency_error is not None:
        yield (
            f"  error {found.error:.1e} of the amplitudes, {found.frequency_error:.1e} of the "
            "frequency, against the chain's own breather"
        )
    elif found.error is not None:
        yield f"  error {found.error:.1e}"
    if found.time is not None:
        yield f"  t = {found.time:.6g} was run"
    yield f"  {found.seconds:.3f} s"


def _breathers(found: Any) -> Iterator[str]:
    yield from _table(found.columns())
    for name, each in found.methods.items():
        if each.error_unknown:
            yield f"{name}: error unknown, {each.error_unknown}"
    yield "errors are those of a solution of (8)"


def _threshold(found: Any) -> Iterator[str]:
    if found.readings is not None:
        yield "fold of (29) with (37), by the site n at which (37) is taken:"
        for name, c in found.readings.items():
            yield f"  {name:<10} {'no solution' if c is None else f'c = {c:.12g}'}"
        return
    yield f"escape at c = {_uncertain(found.c, found.error, 8)}, at rate zero"
    yield from _delay(found.delay)
    yield f"  {found.seconds:.3f} s"


def _delay(delay: Any) -> Iterator[str]:
    for rate, c in zip(delay.rates, delay.escapes, strict=True):
        yield f"  dc/dT = {rate:<8.3g} escapes at c = {c:.6f}"
    if delay.exponent is None:
        yield "  the escapes do not fall with the rate"
    else:
        yield f"  the delay grows like rate^{delay.exponent:.3f}; 2/3 at a fold"


def _branch_threshold(found: Any) -> Iterator[str]:
    where = "" if found.c_stable is None else f" Stable up to c = {found.c_stable:.12g}."
    yield f"fold: the breather exists up to c = {_uncertain(found.c, found.error, 12)}"
    yield f"  {_said(found.stability_lost_by)}{where}"
    yield f"  half way there the largest growth rate is {found.growth:.4g} per unit of slow time"
    if found.growth_mirrored is not None:
        yield f"  and {found.growth_mirrored:.4g} if mirror symmetry is kept"
    yield f"  {found.sites} sites, {found.seconds:.3f} s"


def _held_threshold(found: Any) -> Iterator[str]:
    noisy = found.perturbation > 0.0
    yield (
        f"escape at c = {_uncertain(found.c, found.error, 6)}, with c held: "
        f"from {found.low:.6f} to {found.high:.6f}"
    )
    yield (
        f"  below it every run held for {found.final_time:g} of slow time; above it every run "
        f"escaped within {0.5 * found.final_time:g}"
    )
    if noisy:
        for seed, (low, high) in found.by_seed.items():
            yield f"  seed {seed}: from {low:.6f} to {high:.6f}"
    if not found.monotone:
        yield "  escape is not monotone in c: the range is twice as wide as what was found"
    seeds = f"noise of {found.perturbation:g}, these seeds and " if noisy else ""
    yield f"  this is for {seeds}this waiting time: others may escape lower"
    if found.delay is not None:
        yield "the sweeps do not follow the law of a fold:"
        yield from _delay(found.delay)
    yield f"  {found.runs} runs, {found.seconds:.3f} s"


def _run_threshold(found: Any) -> Iterator[str]:
    if found.method.value == "hold":
        yield from _held_threshold(found)
        return
    yield f"spreads from c = {found.c:.8g} on, uncertain by {found.error:.1e}"
    yield f"  {found.definition.sentence}"
    ends = "" if found.ends is None else f"; {found.ends} ends"
    point = found.start_point
    start = "" if point is None else f"; start at the {point} of the cycle"
    yield f"  final time {found.final_time:g}{ends}{start}"
    if found.late is not None:
        yield f"  by twice that time: c = {found.late:.8g}"
    if found.fuzzy is not None:
        yield (
            f"  fuzzy from c = {found.fuzzy[0]:.8g} to {found.fuzzy[1]:.8g}, a width of "
            f"{found.fuzzy_width:.2g}" + ("" if found.monotone else ": not monotone in c")
        )
    yield f"  {found.runs} runs of {found.sites} sites, {found.seconds:.3f} s"


def _trajectory(run: Any) -> Iterator[str]:
    last, error = run.amplitude[-1], run.error
    reached = int((run.arrivals == run.arrivals).sum())
    largest = int(last.argmax())
    yield (
        f"t = {run.times[-1]:g}: {run.to_dict()['width']} of {last.size} sites are excited, "
        f"{reached} were at some time"
    )
    yield f"  largest amplitude {last[largest]:.8g} at site {largest + 1}"
    if error is not None:
        yield (
            f"  error of the states at most {error:.1e} (from a run at another tolerance): "
            f"{run.status.value}"
        )
    if run.status.value not in ("resolved", "not compared"):
        yield f"  {run.status.sentence}"
        if run.status.value == "not resolved" and run.resolved_until is not None:
            yield f"  It is resolved until t = {run.resolved_until:g}."
    counts = ", ".join(
        f"{value} {name.replace('_', ' ')}" for name, value in run.counts.items() if name != "steps"
    )
    yield f"  {run.steps} steps of {run.mean_active:.1f} sites ({counts}), {run.seconds:.3f} s"


def in_words_also(payload: Mapping[str, Any]) -> str:
    """Return what is said of further entries: how a nucleus ended."""
    nucleus = payload.get("nucleus")
    if nucleus is None:
        return ""
    stations = [f"{size} from {joined:.4g}" for joined, size in nucleus["sizes"]]
    listed = stations if len(stations) < 9 else [*stations[:6], "…", *stations[-2:]]
    joined = ", ".join(listed)
    return f"\n  nucleus: {nucleus['end']}; sites that had joined by slow time: {joined}"


def _front(found: Any) -> Iterator[str]:
    pinned, wave = found.status.value == "pinned", found.method == "wave"
    yield "pinned: no front travels at this coupling." if wave and pinned else _said(found.status)
    if found.v is not None and not pinned:
        unit = "tau" if found.chain.model == "friction" else "slow time"
        digits = 15 if found.chain.model == "piecewise" else 10
        yield f"  v = {_uncertain(found.v, found.error, digits)} (sites per unit of {unit})"
    if wave:
        yield from _resting_wave(found) if pinned else _wave(found.detail)
    elif found.chain.model == "piecewise":
        yield from _switchings(found.detail)
    else:
        yield from _measured_front(found)


def _measured_front(found: Any) -> Iterator[str]:
    ways = found.detail
    if ways is not None and ways.angles.size > 1:
        for angle, v, error in zip(ways.angles, ways.velocities, ways.errors, strict=True):
            yield f"  at {math.degrees(angle):5.1f} degrees: v = {_uncertain(v, error, 7)}"
    if found.left_boundary is not None and found.v is not None:
        yield (
            "  it outruns the waves behind it"
            if found.outruns_waves
            else "  waves behind it catch up with it: v is that with the left boundary "
            + _said(found.left_boundary)
        )
    yield (
        f"  {found.arrivals.size} arrivals on a chain of {found.chain.sites} sites, "
        f"{found.steps} steps, {found.seconds:.3f} s"
    )


def _resting_wave(found: Any) -> Iterator[str]:
    yield f"  fronts rest up to c_pin = {digits_that_hold(found.detail.c, found.detail.error)}"
    yield f"  {found.seconds:.3f} s"


def _wave(wave: Any) -> Iterator[str]:
    if wave.stable:
        yield "  stable: every disturbance fades, or is a phase wave far behind"
    else:
        yield "  not stable"
    moduli = ", ".join(f"{abs(each):.4g}" for each in wave.multipliers)
    yield f"  multipliers a site, by modulus: {moduli}; continuous spectrum {wave.continuum:.4g}"
    yield (
        f"  {wave.r.size} sites, {wave.steps} steps a site, {wave.iterations} iterations, "
        f"{wave.seconds:.3f} s"
    )


def _switchings(run: Any) -> Iterator[str]:
    if run.period_spread is not None:
        yield f"  spread of the period {run.period_spread:.1e} of its mean"
    if run.events_per_site is not None:
        yield f"  {run.events_per_site:g} switchings a site"
    if run.repeat is not None:
        yield f"  the motion repeats itself every {run.repeat} sites"
    if run.sliding_events:
        yield f"  sites slid along the threshold {run.sliding_events} times"
    if run.margin is not None:
        yield f"  closest approach to the threshold from now on: {run.margin:.3g}"
    yield (
        f"  {run.events} switchings, a window of {run.window} sites (its ends disturb less than "
        f"{run.truncation:.0e}), {run.seconds:.3f} s"
    )


def _map(result: Any) -> Iterator[str]:
    found, agreement = result.to_dict(), result.agreement
    yield f"{found['points']} points, {found['model']}:"
    for label, number in found["counts"].items():
        yield f"  {label:<12} {number}"
    axes = list(result.found.axes)
    if agreement is not None:
        yield f"  the averaged chain gives the same label at {agreement.same} of {agreement.total}"
        for row in agreement.differing[:10]:
            place = ", ".join(f"{name} = {row[name]:g}" for name in axes)
            yield f"    {place}: {row['first']}, averaged {row['second']}"
    undecided = found["undecided"]
    if undecided:
        places = ", ".join(
            "(" + ", ".join(f"{row[name]:g}" for name in axes) + ")" for row in undecided[:10]
        )
        more = f" and {len(undecided) - 10} more" if len(undecided) > 10 else ""
        yield f"  undecided at ({', '.join(axes)}) = {places}{more}"
    yield f"  {found['map_seconds']:.2f} s, with everything {found['seconds']:.2f} s"


WORDS: dict[str, Callable[[Any], Iterator[str]]] = {
    "CertifiedRelation": _certified_relation,
    "KineticRelation": _kinetic_relation,
    "KineticCurve": _kinetic_curve,
    "KineticSum": _sum,
    "Roots": _roots,
    "Profile": _profile,
    "Bifurcation": _whole_table,
    "Branch": _branch,
    "Curve": _curve,
    "Cell": _cell,
    "Trajectory": _trajectory,
    "Front": _front,
    "ComparedMap": _map,
    "Threshold": _threshold,
    "BranchThreshold": _branch_threshold,
    "RunThreshold": _run_threshold,
    "Breather": _breather,
    "BreatherComparison": _breathers,
}
"""Class of result and the function that gives its lines."""
