"""Results in words, for people at a terminal: one function a kind, by the name of its class."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from theory.result import Result


def in_words(result: Result) -> str:
    """Return what the command line prints of a result.

    Examples
    --------
    >>> from fronts.piecewise import Root
    >>> print(in_words(Root(label=0, re=0.1, im=0.2, residual=0.0, radius=1e-15)))
    label: 0
    re: 0.1
    im: 0.2
    residual: 0
    radius: 1e-15
    """
    for each in type(result).__mro__:
        if each.__name__ in WORDS:
            return WORDS[each.__name__](result)
    return "\n".join(
        f"{name}: {f'{value:.12g}' if isinstance(value, float) else value}"
        for name, value in result.to_dict().items()
        if not isinstance(value, (list, dict))
    )


def _kinetic_relation(answer: Any) -> str:
    lines = [f"{answer.status.value}: {answer.reason}"]
    if answer.branches:
        lines.append("  v                    error    slope  dv/dc       dv/deta     admissible")
    lines += [
        f"  {branch.v:<19.15g}  {branch.error:.1e}  {branch.slope:+5d}  {branch.by_coupling:<10.5g}"
        f"  {branch.by_eta:<10.5g}  {_verdict(branch)}"
        for branch in answer.branches
    ]
    known = []
    for name in ("c_fold", "c_pin", "c_retreat"):
        value, error = getattr(answer, name), getattr(answer, f"{name}_error")
        if value is not None and error is not None:
            known.append(f"{name} = {digits_that_hold(value, error)}")
    if known:
        lines.append("  " + ", ".join(known))
    if answer.limit_shown:
        lines.append(f"  {_limit(answer)}")
    lines.append(f"  {answer.terms} values of Sigma, {answer.seconds:.3g} s")
    return "\n".join(lines)


def _limit(answer: Any) -> str:
    value, error = answer.c_stable, answer.c_stable_error
    if value is None:
        return "no loss of stability of the fastest front was found"
    return f"the fastest front is stable up to c_stable = {digits_that_hold(value, error)}"


def _certified_relation(answer: Any) -> str:
    lines = [_kinetic_relation(answer)]
    lines.append(
        "certified: these velocities and no others, and the thresholds"
        if answer.certified
        else "not certified in every part"
    )
    lines += [f"  {each.lower!r} < v < {each.upper!r}" for each in answer.v_enclosures]
    for name in ("c_fold", "c_pin", "c_retreat"):
        each = getattr(answer, f"{name}_enclosure")
        if each is not None:
            lines.append(f"  {each.lower!r} < {name} < {each.upper!r}")
    lines += [f"  {sentence}" for sentence in answer.unproven]
    return "\n".join(lines)


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


def _kinetic_curve(curve: Any) -> str:
    lines = [f"{curve.along:<12}  status         velocities (admissible ones marked *)"]
    for answer in curve.points:
        marks = "  ".join(
            f"{branch.v:.10g}{'*' if branch.admissible else ''}" for branch in answer.branches
        )
        lines.append(f"{getattr(answer, curve.along):<12.7g}  {answer.status.value:<13}  {marks}")
    return "\n".join(lines)


def _sum(found: Any) -> str:
    from theory.piecewise.sums.result import DOUBLE, decimals, in_powers

    def part(value: Any) -> str:
        if isinstance(value, float):
            return f"{value:.16g}"
        return decimals(value, max(found.digits, DOUBLE))

    im = part(found.value.imag)
    return (
        f"Sigma = {part(found.value.real)}\n      {im if im.startswith('-') else '+' + im} i\n"
        f"error below {in_powers(found.error_as_written)}; {found.method}, {found.terms} terms, "
        f"{found.seconds:.3g} s"
    )


def _roots(found: Any) -> str:
    def cell(value: float | str) -> str:
        return f"{value:<22.16g}" if isinstance(value, float) else f"{value:<22}"

    head = "  label  Re k                    Im k                    radius"
    lines = []
    for half, listed in (("upper", found.upper), ("lower", found.lower)):
        lines += [f"{half} half-plane", head]
        lines += [
            f"  {root.label:>5}  {cell(root.re)}  {cell(root.im)}  {root.radius:.1e}"
            for root in listed
        ]
    certified = "; every radius and the count certified" if found.certified else ""
    lines.append(f"{found.counted} roots by the argument principle{certified}")
    return "\n".join(lines)


def _profile(shape: Any) -> str:
    if shape.admissible:
        verdict = "admissible: above threshold everywhere behind, below it everywhere ahead"
    elif shape.admissible is None:
        verdict = "admissibility was not decided"
    else:
        where = math.nan if shape.fails_at is None else shape.fails_at
        verdict = f"not admissible: it crosses the threshold again at zeta = {where:.4g}"
    return "\n".join(
        [
            f"v = {shape.v:.15g}, error below {shape.v_error:.1e}",
            verdict,
            f"threshold |phi_us|/|phi_s| = {shape.threshold:.12g}; phi/phi_s is exact to "
            f"{shape.error:.1e}",
        ]
    )


def _table(result: Any) -> str:
    """Show the columns of a result; a dash stands for what does not exist."""
    columns = result.columns()
    rows = [
        list(columns),
        *([_short(value) for value in row] for row in zip(*columns.values(), strict=True)),
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        for row in rows
    )


def _short(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _curve(result: Any) -> str:
    lines = [_table(_Shown(result))]
    reasons = dict.fromkeys(
        f"{result.along} = {value:g}: {point.reason}"
        for value, point in zip(result.values, result.points, strict=True)
        if type(point).__name__ == "Refusal"
    )
    return "\n".join([*lines, *reasons, f"{len(result.points)} points, {result.seconds:.3g} s"])


def _branch(result: Any) -> str:
    lines = [_table(_Shown(result))]
    lines += [f"fold at c = {fold.c:.12g}, uncertain by {fold.error:.1e}" for fold in result.folds]
    if result.c_pin is not None:
        lines.append(
            f"c_pin = {digits_that_hold(result.c_pin, result.c_pin_error)}: fronts rest up to it, "
            f"and v = {result.square_root:.6g} sqrt(c - c_pin) just above it;\n"
            f"at strong coupling v = c {'+' if result.kappa > 0 else '-'} "
            f"{abs(result.kappa):.6g} (c/6)^(1/3)"
        )
        if not result.folds:
            lines.append("no fold of moving fronts in this range")
    return "\n".join([*lines, f"{len(result.points)} points, {result.seconds:.3g} s"])


class _Shown:
    """The columns of a curve that fit a line."""

    names = (
        "status", "v", "error", "c_crit", "mechanism", "frequency", "centre", "stable", "growth",
        "amplitude", "eta",
        "effective_damping", "steady", "outruns_waves", "largest_group_velocity", "seconds",
    )  # fmt: skip

    def __init__(self, result: Any) -> None:
        columns = result.columns()
        wanted = (result.along, *self.names)
        self._columns = {name: columns[name] for name in wanted if name in columns}

    def columns(self) -> Any:
        return self._columns


def _cell(found: Any) -> str:
    def velocity(value: float) -> str:
        return f"at v_d = {value:.12g}" if math.isfinite(value) else "never"

    lines = [f"{found.status.value}: {found.status.sentence}"]
    if found.model == "friction":
        hopf, end = found.hopf_velocity, found.cycle_end_velocity
        above = "at no v_d" if math.isinf(hopf) else "at every v_d" if hopf == 0.0 else ""
        lines += [
            f"  steady sliding at y = {found.rest:.12g}, effective damping "
            f"{found.effective_damping:.6g}; stable {above or f'above v_d = {hopf:.12g}'}",
            "  no stick-slip cycle at any v_d" if end == 0.0 else f"  cycles end {velocity(end)}",
        ]
    else:
        eta = found.parameters["b"] / found.parameters["a"] ** 2
        lines.append(f"  eta = b/a^2 = {eta:.12g}; two cycles exist below 1/8")
    for name in ("stable", "unstable"):
        cycle = getattr(found, name)
        if cycle is not None:
            lines.append(
                f"  {name} cycle: y from {cycle.min:.12g} to {cycle.max:.12g}, amplitude "
                f"{cycle.amplitude:.9g}, period {cycle.period:.9g}"
                + (f", of that stick {cycle.stick_time:.9g}" if cycle.stick_time else "")
                + (
                    ""
                    if cycle.averaged is None
                    else f"; amplitude as eps -> 0: {cycle.averaged:.9g}"
                )
            )
    lines.append(_basin(found.basin))
    error = f"{found.error:.1e}" if math.isfinite(found.error) else "not known"
    return "\n".join([*lines, f"  error {error}, {found.seconds:.3g} s"])


def _basin(basin: tuple[float, float] | None) -> str:
    if basin is None:
        return "  no start with zero velocity ends at rest"
    if math.isinf(basin[0]):
        return "  every start with zero velocity ends at rest"
    low, high = basin
    return f"  starts with zero velocity and y from {low:.12g} to {high:.12g} end at rest"


_STABILITY = {True: "stable", False: "not stable", None: "stability not decided"}


def _breather(found: Any) -> str:
    lines = [f"{found.status.value}: {found.status.sentence}"]
    if found.fold is not None:
        lines.append(f"  its branch folds at c = {found.fold:.10g}")
    if found.amplitudes.size:
        shown = "  ".join(f"{value:.6g}" for value in found.outward[:8])
        pattern = f", pattern {found.nucleus.pattern}" if found.nucleus.pattern else ""
        lines += [
            f"  {_STABILITY[found.stable]}{pattern}",
            f"  amplitudes, centre outwards: {shown}",
            f"  frequency {found.frequency:.12g}, outward phase step {found.phase_step:.6f}",
        ]
    if found.growth is not None:
        lines.append(f"  largest growth rate per unit of slow time: {found.growth:.6g}")
    if found.trivial is not None:
        lines.append(f"  trivial exponent or multiplier off by {found.trivial:.1e}")
    if found.error_unknown:
        lines.append(f"  error against the periodic orbit of (8) unknown: {found.error_unknown}")
    elif found.frequency_error is not None:
        lines.append(
            f"  error {found.error:.1e} of the amplitudes, {found.frequency_error:.1e} of the "
            "frequency, against the chain's own breather"
        )
    elif found.error is not None:
        lines.append(f"  error {found.error:.1e}")
    if found.time is not None:
        lines.append(f"  t = {found.time:.6g} was run")
    return "\n".join([*lines, f"  {found.seconds:.3f} s"])


def _breathers(found: Any) -> str:
    unknown = [
        f"{name}: error unknown, {each.error_unknown}"
        for name, each in found.methods.items()
        if each.error_unknown
    ]
    return "\n".join([_table(found), *unknown, "errors are those of a solution of (8)"])


def _threshold(found: Any) -> str:
    if found.readings is not None:
        lines = ["fold of (29) with (37), by the site n at which (37) is taken:"]
        lines += [
            f"  {name:<10} {'no solution' if c is None else f'c = {c:.12g}'}"
            for name, c in found.readings.items()
        ]
        return "\n".join(lines)
    lines = [f"escape at c = {found.c:.8g}, uncertain by {found.error:.1e}, at rate zero"]
    return "\n".join([*lines, *_delay(found.delay), f"  {found.seconds:.3f} s"])


def _delay(delay: Any) -> list[str]:
    lines = [
        f"  dc/dT = {rate:<8.3g} escapes at c = {c:.6f}"
        for rate, c in zip(delay.rates, delay.escapes, strict=True)
    ]
    if delay.exponent is None:
        return [*lines, "  the escapes do not fall with the rate"]
    return [*lines, f"  the delay grows like rate^{delay.exponent:.3f}; 2/3 at a fold"]


def _branch_threshold(found: Any) -> str:
    lost = found.stability_lost_by
    where = "" if found.c_stable is None else f" Stable up to c = {found.c_stable:.12g}."
    lines = [
        f"fold: the breather exists up to c = {found.c:.12g}, uncertain by {found.error:.1e}",
        f"  {lost.value}: {lost.sentence}{where}",
        f"  half way there the largest growth rate is {found.growth:.4g} per unit of slow time",
    ]
    if found.growth_mirrored is not None:
        lines.append(f"  and {found.growth_mirrored:.4g} if mirror symmetry is kept")
    return "\n".join([*lines, f"  {found.sites} sites, {found.seconds:.3f} s"])


def _held_threshold(found: Any) -> str:
    noisy = found.perturbation > 0.0
    lines = [
        f"escape at c = {found.c:.6g}, uncertain by {found.error:.1e}, with c held: "
        f"from {found.low:.6f} to {found.high:.6f}",
        f"  below it every run held for {found.final_time:g} of slow time; above it every run "
        f"escaped within {0.5 * found.final_time:g}",
    ]
    if noisy:
        lines += [
            f"  seed {seed}: from {low:.6f} to {high:.6f}"
            for seed, (low, high) in found.by_seed.items()
        ]
    if not found.monotone:
        lines.append("  escape is not monotone in c: the range is twice as wide as what was found")
    seeds = f"noise of {found.perturbation:g}, these seeds and " if noisy else ""
    lines.append(f"  this is for {seeds}this waiting time: others may escape lower")
    if found.delay is not None:
        lines += ["the sweeps do not follow the law of a fold:", *_delay(found.delay)]
    return "\n".join([*lines, f"  {found.runs} runs, {found.seconds:.3f} s"])


def _start_of(found: Any) -> str:
    """Return ends and start of the friction chain, whose thresholds say them."""
    ends = "" if found.ends is None else f"; {found.ends} ends"
    point = found.start_point
    return ends + ("" if point is None else f"; start at the {point} of the cycle")


def _run_threshold(found: Any) -> str:
    if found.method.value == "hold":
        return _held_threshold(found)
    lines = [
        f"spreads from c = {found.c:.8g} on, uncertain by {found.error:.1e}",
        f"  {found.definition.sentence}",
        f"  final time {found.final_time:g}" + _start_of(found),
    ]
    if found.late is not None:
        lines.append(f"  by twice that time: c = {found.late:.8g}")
    if found.fuzzy is not None:
        lines.append(
            f"  fuzzy from c = {found.fuzzy[0]:.8g} to {found.fuzzy[1]:.8g}, a width of "
            f"{found.fuzzy_width:.2g}" + ("" if found.monotone else ": not monotone in c")
        )
    return "\n".join([*lines, f"  {found.runs} runs of {found.sites} sites, {found.seconds:.3f} s"])


def _trajectory(run: Any) -> str:
    last, error = run.amplitude[-1], run.error
    reached = int((run.arrivals == run.arrivals).sum())
    largest = int(last.argmax())
    lines = [
        f"t = {run.times[-1]:g}: {run.to_dict()['width']} of {last.size} sites are excited, "
        f"{reached} were at some time",
        f"  largest amplitude {last[largest]:.8g} at site {largest + 1}",
    ]
    if error is not None:
        lines.append(
            f"  error of the states at most {error:.1e} (from a run at another tolerance): "
            f"{run.status.value}"
        )
    if run.status.value not in ("resolved", "not compared"):
        lines.append(f"  {run.status.sentence}")
        if run.status.value == "not resolved" and run.resolved_until is not None:
            lines.append(f"  It is resolved until t = {run.resolved_until:g}.")
    counts = ", ".join(
        f"{value} {name.replace('_', ' ')}" for name, value in run.counts.items() if name != "steps"
    )
    return "\n".join(
        [
            *lines,
            f"  {run.steps} steps of {run.mean_active:.1f} sites ({counts}), {run.seconds:.3f} s",
        ]
    )


def in_words_also(payload: Mapping[str, Any]) -> str:
    """Return what is said of further entries: how a nucleus ended."""
    nucleus = payload.get("nucleus")
    if nucleus is None:
        return ""
    stations = [f"{size} from {joined:.4g}" for joined, size in nucleus["sizes"]]
    listed = stations if len(stations) < 9 else [*stations[:6], "…", *stations[-2:]]
    joined = ", ".join(listed)
    return f"\n  nucleus: {nucleus['end']}; sites that had joined by slow time: {joined}"


def _front(found: Any) -> str:
    lines = [f"{found.status.value}: {found.status.sentence}"]
    if found.method == "wave" and found.status.value == "pinned":
        lines = ["pinned: no front travels at this coupling."]
    if found.v is not None and found.status.value != "pinned":
        unit = "tau" if found.chain.model == "friction" else "slow time"
        digits = 15 if found.chain.model == "piecewise" else 10
        lines.append(
            f"  v = {found.v:.{digits}g}, uncertain by {found.error:.1e} (sites per unit of {unit})"
        )
    if found.method == "wave":
        return "\n".join([*lines, *_wave(found)])
    if found.chain.model == "piecewise":
        return "\n".join([*lines, *_switchings(found.detail)])
    if found.detail is not None and found.detail.angles.size > 1:
        lines += [
            f"  at {math.degrees(angle):5.1f} degrees: v = {v:.7g}, uncertain by {error:.1e}"
            for angle, v, error in zip(
                found.detail.angles, found.detail.velocities, found.detail.errors, strict=True
            )
        ]
    if found.left_boundary is not None and found.v is not None:
        lines.append(
            "  it outruns the waves behind it"
            if found.outruns_waves
            else "  waves behind it catch up with it: v is that with the left boundary "
            f"{found.left_boundary.value}: {found.left_boundary.sentence}"
        )
    lines.append(
        f"  {found.arrivals.size} arrivals on a chain of {found.chain.sites} sites, "
        f"{found.steps} steps, {found.seconds:.3f} s"
    )
    return "\n".join(lines)


def _wave(found: Any) -> list[str]:
    wave = found.detail
    if found.status.value == "pinned":
        pinned = digits_that_hold(wave.c, wave.error)
        return [f"  fronts rest up to c_pin = {pinned}", f"  {found.seconds:.3f} s"]
    moduli = ", ".join(f"{abs(each):.4g}" for each in wave.multipliers)
    return [
        "  stable: every disturbance fades, or is a phase wave far behind"
        if wave.stable
        else "  not stable",
        f"  multipliers a site, by modulus: {moduli}; continuous spectrum {wave.continuum:.4g}",
        f"  {wave.r.size} sites, {wave.steps} steps a site, {wave.iterations} iterations, "
        f"{wave.seconds:.3f} s",
    ]


def _switchings(run: Any) -> list[str]:
    lines = []
    if run.period_spread is not None:
        lines.append(f"  spread of the period {run.period_spread:.1e} of its mean")
    if run.events_per_site is not None:
        lines.append(f"  {run.events_per_site:g} switchings a site")
    if run.repeat is not None:
        lines.append(f"  the motion repeats itself every {run.repeat} sites")
    if run.sliding_events:
        lines.append(f"  sites slid along the threshold {run.sliding_events} times")
    if run.margin is not None:
        lines.append(f"  closest approach to the threshold from now on: {run.margin:.3g}")
    lines.append(
        f"  {run.events} switchings, a window of {run.window} sites (its ends disturb less than "
        f"{run.truncation:.0e}), {run.seconds:.3f} s"
    )
    return lines


def _map(result: Any) -> str:
    found, agreement = result.to_dict(), result.agreement
    lines = [f"{found['points']} points, {found['model']}:"]
    lines += [f"  {label:<12} {number}" for label, number in found["counts"].items()]
    axes = list(result.found.axes)
    if agreement is not None:
        lines.append(
            f"  the averaged chain gives the same label at {agreement.same} of {agreement.total}"
        )
        lines += [
            "    "
            + ", ".join(f"{name} = {row[name]:g}" for name in axes)
            + f": {row['first']}, averaged {row['second']}"
            for row in agreement.differing[:10]
        ]
    undecided = found["undecided"]
    if undecided:
        places = ", ".join(
            "(" + ", ".join(f"{row[name]:g}" for name in axes) + ")" for row in undecided[:10]
        )
        more = f" and {len(undecided) - 10} more" if len(undecided) > 10 else ""
        lines.append(f"  undecided at ({', '.join(axes)}) = {places}{more}")
    lines.append(f"  {found['map_seconds']:.2f} s, with everything {found['seconds']:.2f} s")
    return "\n".join(lines)


WORDS: dict[str, Callable[[Any], str]] = {
    "CertifiedRelation": _certified_relation,
    "KineticRelation": _kinetic_relation,
    "KineticCurve": _kinetic_curve,
    "KineticSum": _sum,
    "Roots": _roots,
    "Profile": _profile,
    "Bifurcation": _table,
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
"""Class of result and the function that puts it into words."""
