"""Labelled roots of Eq. (50), compared with other root finders: completeness and accuracy.

The roots with labels -20 … 20 above the axis are required; the error is the largest error among
them. A method that misses roots is a failure, and the failure says how many it misses. The
reference is mpmath's ``findroot`` (secant method) at 40 digits, started at our roots; the number of
roots is certain from the winding number of L, which does not depend on labels. ``agreement`` is the
distance of our roots at 50 digits from the reference. The other programs are cxroots in a box, and
scipy's and mpmath's local methods from guesses spread evenly over the box.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
)
from theory.piecewise.certified_roots import certify_roots
from theory.piecewise.precise_roots import precise_roots
from theory.piecewise.root_count import box_of_strips, count_in_strips
from theory.piecewise.roots import labelled_roots
from verification.quantities.problems import Problem
from verification.references.piecewise import dispersion, dispersion_slope

LABELS = np.arange(-20, 21)
DOUBLE, PRECISE, CERTIFIED = "labelled roots", "labelled roots, many digits", "certified roots"
CONTOUR, NEWTON, FINDROOT = "cxroots", "scipy newton from guesses", "mpmath findroot from guesses"
_DIGITS = 40
_SAME = 1e-3
"""Relative distance from a returned value within which a root counts as found."""


class MissedRootsError(ArithmeticError):
    """A method missed roots."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods, and how well the reference roots are known."""
    v, c = problem.v, problem.c
    true, apart = reference(v, c)
    settings = [
        Setting(method=method, knob=knob, evaluate=evaluate, reference=true, quick=short, peer=peer)
        for method, knob, evaluate, short, peer in _methods(v, c)
    ]
    return Prepared(agreement=apart, settings=settings)


def reference(v: float, c: float) -> tuple[list[Any], float]:
    """Return the roots by mpmath, and the distance of ours at 50 digits from them.

    Raises
    ------
    ArithmeticError
        If their number is not the winding number.
    """
    start = labelled_roots(v, c, LABELS, upper=True).k
    with mp.workdps(_DIGITS):
        found = [
            mp.findroot(
                _exact_dispersion(v, c), (k, k * (1 + 1e-9)), solver="secant",
                tol=mp.mpf(10) ** (5 - _DIGITS), verify=False,
            )
            for k in map(mp.mpc, start.tolist())
        ]  # fmt: skip
        if count_in_strips(v, c, LABELS, upper=True) != LABELS.size:
            raise ArithmeticError("the reference lacks roots")
        ours = precise_roots(v, c, LABELS, True, 50)
        return found, float(max(abs(a - b) for a, b in zip(found, ours, strict=True)))


def _exact_dispersion(v: float, c: float) -> Any:
    return partial(dispersion, mp.mpf(v), mp.mpf(c))


def _methods(v: float, c: float) -> Iterator[tuple[str, str, Any, bool, bool]]:
    """Yield the method, its setting, the call, whether it is quick, and whether it is a peer."""
    yield DOUBLE, "as it is", partial(_double, v, c), True, False
    for digits in (20, 30, 35):
        yield PRECISE, f"{digits} digits", partial(_precise, v, c, digits), True, False
    yield CERTIFIED, "120 bits", partial(_certified, v, c), True, False
    contours: tuple[tuple[str, dict[str, Any]], ...] = (
        ("M=2", {"M": 2}), ("romb, M=3", {"int_method": "romb", "M": 3}), ("defaults", {}),
    )  # fmt: skip
    for name, options in contours:
        yield CONTOUR, name, partial(_contour, v, c, options), name == "M=2", True
    for across, up in ((41, 1), (82, 4), (410, 10)):
        yield NEWTON, f"{across * up} guesses", partial(_newton, v, c, across, up), True, True
    for across, up in ((41, 1), (82, 4)):
        found = partial(_findroot, v, c, across, up)
        yield FINDROOT, f"{across * up} guesses", found, up == 1, True


def _double(v: float, c: float) -> MethodAnswer:
    found = labelled_roots(v, c, LABELS, upper=True)
    return MethodAnswer(value=found.k.tolist(), claimed=float(found.radius.max()))


def _precise(v: float, c: float, digits: int) -> MethodAnswer:
    return MethodAnswer(value=precise_roots(v, c, LABELS, True, digits))


def _certified(v: float, c: float) -> MethodAnswer:
    found = certify_roots(v, c, LABELS, upper=True).roots
    return MethodAnswer(value=found.k.tolist(), claimed=float(found.radius.max()))


def _contour(v: float, c: float, options: dict[str, Any]) -> MethodAnswer:
    from cxroots import Rectangle

    logging.getLogger("cxroots").setLevel(logging.ERROR)
    left, right, low, high = box_of_strips(v, c, LABELS, upper=True)
    found = Rectangle((left, right), (low, high)).roots(
        lambda k: dispersion(v, c, k, np.cos),
        lambda k: dispersion_slope(v, c, k, np.sin),
        **options,
    )
    return MethodAnswer(value=list(found.roots))


def _guesses(v: float, c: float, across: int, up: int) -> Any:
    """Return points spread evenly over the box that holds the roots."""
    left, right, _, high = box_of_strips(v, c, LABELS, upper=True)
    x = left + (right - left) * (np.arange(across) + 0.5) / across
    y = high * (np.arange(up) + 0.5) / up
    return (x[None, :] + 1j * y[:, None]).ravel()


def _newton(v: float, c: float, across: int, up: int) -> MethodAnswer:
    from scipy.optimize import newton

    found: Any = newton(
        lambda k: dispersion(v, c, k, np.cos),
        _guesses(v, c, across, up),
        fprime=lambda k: dispersion_slope(v, c, k, np.sin),
        tol=1e-14,
        maxiter=100,
        full_output=True,
    )
    return MethodAnswer(value=found[0][found[1]].tolist())


def _findroot(v: float, c: float, across: int, up: int) -> MethodAnswer:
    found = []
    for guess in _guesses(v, c, across, up).tolist():
        with contextlib.suppress(ValueError, ZeroDivisionError, OverflowError):
            found.append(mp.findroot(_exact_dispersion(v, c), mp.mpc(guess)))
    return MethodAnswer(value=found)


def largest_error(found: Sequence[Any], true: Sequence[Any]) -> float:
    """Return the largest distance of a true root from the nearest one found.

    Raises
    ------
    MissedRootsError
        If no root is found near a true root.
    """
    found = [k for k in found if np.isfinite(complex(k))]
    rough = np.array([complex(k) for k in found] or [np.inf])
    missed, largest = 0, 0.0
    for k in true:
        near = int(np.abs(rough - complex(k)).argmin())
        if not abs(rough[near] - complex(k)) < _SAME * (1.0 + abs(complex(k))):
            missed += 1
            continue
        with mp.workdps(_DIGITS):
            largest = max(largest, float(abs(mp.mpmathify(found[near]) - k)))
    if missed:
        raise MissedRootsError(f"{missed} of {len(true)} roots missed")
    return largest


BENCHMARK = WorkPrecision(
    name="roots",
    prepare=prepare,
    error=largest_error,
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.5, limit=10.0),
    quick_problems=2,
    style=Style(
        xlabel="largest error of 41 roots (right is better)",
        ylabel="processor seconds",
        caption="Error against run time of 41 consecutive roots of (50). Methods that miss roots "
        "count as failures and are not drawn.",
        methods={
            DOUBLE: ("blue", "o"),
            PRECISE: ("sky", "P"),
            CERTIFIED: ("green", "D"),
            CONTOUR: ("black", "X"),
            NEWTON: ("orange", "v"),
            FINDROOT: ("vermilion", "s"),
        },
        garbage=1.0,
        floor=1e-40,
    ),
    reasons={
        NEWTON: "it states neither which root it has found, nor its error, nor whether "
        "one is left out; ours labels every root and bounds its error",
    },
    first={
        DOUBLE: partial(_double, 0.3, 0.5),
        NEWTON: partial(_newton, 0.3, 0.5, 41, 1),
        FINDROOT: partial(_findroot, 0.3, 0.5, 41, 1),
    },
)
