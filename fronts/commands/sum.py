"""``fronts sum``: Σ(v, c), the left side of the kinetic relation (53)."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from fronts.answer import Answer, UsageError
from fronts.arguments import decimal, whole

if TYPE_CHECKING:
    from theory.piecewise.sums.result import KineticSum

EXAMPLE = """examples:
  fronts sum --v 0.3 --c 0.5
  fronts sum --v 0.3 --c 0.5 --method series --digits 50 --json"""

_DOUBLE = 15
_METHODS = {
    "integral": "one integral over a period, trapezoidal rule (the default)",
    "series": "the printed series over the roots, its tail summed",
    "bessel": "a series of Bessel functions",
    "quadrature": "adaptive quadrature on the real line",
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts sum``."""
    parser.add_argument("--v", type=decimal, required=True, help="front velocity v > 0")
    parser.add_argument("--c", type=decimal, required=True, help="coupling c > 0")
    parser.add_argument(
        "--method",
        choices=list(_METHODS),
        default="integral",
        help="; ".join(f"{name}: {text}" for name, text in _METHODS.items()),
    )
    parser.add_argument(
        "--digits", type=whole, default=12, help="digits after the point wanted (default 12)"
    )


def run(options: argparse.Namespace) -> Answer:
    """Evaluate the sum by the method that was named."""
    from theory.parameters import count_within

    digits = count_within("digits", options.digits, 1, 2000)
    try:
        found = _evaluate(options.method, options.v, options.c, digits)
    except ArithmeticError as refusal:
        raise UsageError(str(refusal)) from None
    # Beyond double precision the value is printed with so many digits, which costs one of the last.
    error = found.error + (10.0**-digits if digits > _DOUBLE else 0.0)
    payload: dict[str, object] = {
        "re": _number(found.value.real, digits),
        "im": _number(found.value.imag, digits),
        "error": error,
        "terms": found.terms,
        "method": found.method,
        "seconds": found.seconds,
    }
    text = (
        f"Sigma = {_text(found.value.real, digits)}\n"
        f"      {_text(found.value.imag, digits, sign=True)} i\n"
        f"error below {error:.1e}; {found.method}, {found.terms} terms, "
        f"{found.seconds:.3g} s"
    )
    return Answer(payload, text)


def _evaluate(method: str, v: str, c: str, digits: int) -> KineticSum:
    if method == "series":
        from theory.piecewise.sums.series import sum_by_roots

        found = sum_by_roots(v, c, digits)
        enough = digits > _DOUBLE or found.error <= 10.0**-digits
        return found if enough else sum_by_roots(v, c, _DOUBLE + 1)
    if method == "integral":
        if digits <= _DOUBLE:
            from theory.piecewise.sums.integral import sum_by_integral

            found = sum_by_integral(
                float(v), float(c), 0.5 * 10.0**-digits if digits < 15 else 1e-15
            )
            if found.error <= 10.0**-digits:
                return found
        from theory.piecewise.sums.precise import precise_sum_by_integral

        return precise_sum_by_integral(v, c, digits)
    if digits > 13:
        raise UsageError(
            f"--method {method} works in double precision: ask for 13 digits or fewer, or use "
            "--method integral or series."
        )
    if method == "bessel":
        from theory.piecewise.sums.bessel import sum_by_bessel

        return sum_by_bessel(float(v), float(c), 10.0**-digits)
    from theory.piecewise.sums.quadrature import sum_by_quadrature

    return sum_by_quadrature(float(v), float(c), 0.1 * 10.0**-digits)


def _number(value: Any, digits: int) -> float | str:
    """Return a float, or a decimal string beyond double precision."""
    return float(value) if digits <= _DOUBLE else _text(value, digits)


def _text(value: Any, digits: int, sign: bool = False) -> str:
    if isinstance(value, float):
        return f"{value:+.16g}" if sign else f"{value:.16g}"
    import mpmath as mp

    with mp.workdps(digits + 5):
        text = mp.nstr(value, digits, strip_zeros=False)
    return "+" + text if sign and not text.startswith("-") else str(text)
