"""Results in words, for people at a terminal: one function a kind, by the name of its class."""

from __future__ import annotations

import math
from collections.abc import Callable
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
    lines.append(f"  {answer.terms} values of Sigma, {answer.seconds:.3g} s")
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
    return "yes" if branch.admissible else f"no, fails at zeta = {branch.fails_at:.3g}"


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


WORDS: dict[str, Callable[[Any], str]] = {
    "KineticRelation": _kinetic_relation,
    "KineticCurve": _kinetic_curve,
    "KineticSum": _sum,
    "Roots": _roots,
    "Profile": _profile,
}
"""Class of result and the function that puts it into words."""
