"""Labelled roots of Eq. (50) beside the root finders a user has: which are found, and how exactly.

Wanted are the roots of the labels -20 … 20 above the axis; the error is the largest of them. A
method that leaves some out is a failure, and the failure says how many. The reference is mpmath's
``findroot`` (secants) at 40 digits, started at our roots; the number of roots is certain
from the winding of L, which knows nothing of labels. ``agreement`` is how far our roots at 50
digits are from it. Peers are cxroots in a box, and scipy's and mpmath's local methods from guesses
spread evenly over the box.
"""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator, Sequence
from functools import partial
from time import process_time
from typing import TYPE_CHECKING, Any

import mpmath as mp
import numpy as np

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from theory.piecewise.certified_roots import certify_roots
from theory.piecewise.precise_roots import precise_roots
from theory.piecewise.root_count import box_of_strips, count_in_strips
from theory.piecewise.roots import labelled_roots
from verification.quantities.scenes import timed

if TYPE_CHECKING:
    from benchmarks.diagram import Style

REACH = 20
LABELS = np.arange(-REACH, REACH + 1)
DOUBLE, PRECISE, CERTIFIED = "labelled roots", "labelled roots, many digits", "certified roots"
CONTOUR, NEWTON, FINDROOT = "cxroots", "scipy newton from guesses", "mpmath findroot from guesses"
_DIGITS = 40
_SAME = 1e-3
"""A root counts as found if something is so near to it, relative to its size."""


class MissedRootsError(ArithmeticError):
    """A method that left roots out."""


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at every scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 9, 0.5, 10.0) if quick else Effort(1.0, 3, 51, 2.0, 60.0)
    for scene in timed("roots")[: 2 if quick else None]:
        name = scene.name
        tell(f"roots at the scene {name}")
        true, agreement[name] = reference(scene.v, scene.c)
        rows = [each for each in contenders(scene.v, scene.c, true) if each.quick or not quick]
        done, failed = measure_side_by_side("roots", name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench roots" + " --quick" * quick
    return stamped(command, agreement, points, failures)


def reference(v: float, c: float) -> tuple[list[Any], float]:
    """Return the roots by mpmath, and how far ours at 50 digits are from them.

    Raises
    ------
    ArithmeticError
        If there are not as many as the winding number says.
    """
    start = labelled_roots(v, c, LABELS, upper=True).k
    with mp.workdps(_DIGITS):
        found = [
            mp.findroot(
                partial(dispersion, v, c), (k, k * (1 + 1e-9)), solver="secant",
                tol=mp.mpf(10) ** (5 - _DIGITS), verify=False,
            )
            for k in map(mp.mpc, start.tolist())
        ]  # fmt: skip
        if count_in_strips(v, c, LABELS, upper=True) != LABELS.size:
            raise ArithmeticError("the reference lacks roots")
        ours = precise_roots(v, c, LABELS, True, 50)
        return found, float(max(abs(a - b) for a, b in zip(found, ours, strict=True)))


def dispersion(v: float, c: float, k: Any) -> Any:
    """Return L(k) of Eq. (50) in the numbers of mpmath."""
    return mp.mpf(0.5) - 1j * mp.mpf(c) * (1 - mp.cos(k)) - 1j * mp.mpf(v) * k


def contenders(v: float, c: float, true: Sequence[Any]) -> Iterator[Contender]:
    """Yield every method at every setting."""
    yield Contender(DOUBLE, "as it is", partial(_double, v, c, true), 0)
    for digits in (20, 30, 35):
        yield Contender(PRECISE, f"{digits} digits", partial(_precise, v, c, true, digits), 0)
    yield Contender(CERTIFIED, "120 bits", partial(_certified, v, c, true), 0)
    for name, options in (
        ("M=2", {"M": 2}),
        ("romb, M=3", {"int_method": "romb", "M": 3}),
        ("defaults", {}),
    ):
        yield Contender(
            CONTOUR, name, partial(_contour, v, c, true, options), 0, quick=name == "M=2", peer=True
        )
    for across, up in ((41, 1), (82, 4), (410, 10)):
        yield Contender(
            NEWTON, f"{across * up} guesses", partial(_newton, v, c, true, across, up), 0, peer=True
        )
    for across, up in ((41, 1), (82, 4)):
        yield Contender(
            FINDROOT, f"{across * up} guesses", partial(_findroot, v, c, true, across, up), 0,
            quick=up == 1, peer=True,
        )  # fmt: skip


def _double(v: float, c: float, true: Sequence[Any]) -> Answer:
    found = labelled_roots(v, c, LABELS, upper=True)
    return Answer(_largest(found.k.tolist(), true), float(found.radius.max()))


def _precise(v: float, c: float, true: Sequence[Any], digits: int) -> Answer:
    found = precise_roots(v, c, LABELS, True, digits)
    return Answer(_largest(found, true), None)


def _certified(v: float, c: float, true: Sequence[Any]) -> Answer:
    found = certify_roots(v, c, LABELS, upper=True).roots
    return Answer(_largest(found.k.tolist(), true), float(found.radius.max()))


def _contour(v: float, c: float, true: Sequence[Any], options: dict[str, Any]) -> Answer:
    from cxroots import Rectangle

    logging.getLogger("cxroots").setLevel(logging.ERROR)
    left, right, low, high = box_of_strips(v, c, LABELS, upper=True)
    found = Rectangle((left, right), (low, high)).roots(
        lambda k: 0.5 - 1j * c * (1.0 - np.cos(k)) - 1j * v * k,
        lambda k: -1j * (v + c * np.sin(k)),
        **options,
    )
    return Answer(_largest(list(found.roots), true), None)


def _guesses(v: float, c: float, across: int, up: int) -> Any:
    """Return points spread evenly over the box that holds the roots."""
    left, right, _, high = box_of_strips(v, c, LABELS, upper=True)
    x = left + (right - left) * (np.arange(across) + 0.5) / across
    y = high * (np.arange(up) + 0.5) / up
    return (x[None, :] + 1j * y[:, None]).ravel()


def _newton(v: float, c: float, true: Sequence[Any], across: int, up: int) -> Answer:
    from scipy.optimize import newton

    found: Any = newton(
        lambda k: 0.5 - 1j * c * (1.0 - np.cos(k)) - 1j * v * k,
        _guesses(v, c, across, up),
        fprime=lambda k: -1j * (v + c * np.sin(k)),
        tol=1e-14,
        maxiter=100,
        full_output=True,
    )
    return Answer(_largest(found[0][found[1]].tolist(), true), None)


def _findroot(v: float, c: float, true: Sequence[Any], across: int, up: int) -> Answer:
    found = []
    for guess in _guesses(v, c, across, up).tolist():
        try:
            found.append(mp.findroot(partial(dispersion, v, c), mp.mpc(guess)))
        except (ValueError, ZeroDivisionError, OverflowError):
            continue
    return Answer(_largest(found, true), None)


def _largest(found: Sequence[Any], true: Sequence[Any]) -> float:
    """Return the largest distance of a true root from the nearest one found.

    Raises
    ------
    MissedRootsError
        If there is none near a true root.
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


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error of 41 roots (right is better)",
        "processor seconds",
        "Error against run time of 41 consecutive roots of (50). Methods that leave roots out are "
        "failures and not drawn.",
        {
            DOUBLE: ("blue", "o"),
            PRECISE: ("sky", "P"),
            CERTIFIED: ("green", "D"),
            CONTOUR: ("black", "X"),
            NEWTON: ("orange", "v"),
            FINDROOT: ("vermilion", "s"),
        },
        1.0,
        1e-40,
    )


def _found(method: str) -> object:
    """Return the roots of the ordinary scene, compared with nothing."""
    labelled = labelled_roots(0.3, 0.5, LABELS, upper=True)
    if method == DOUBLE:
        return labelled
    peer = _newton if method == NEWTON else _findroot
    with contextlib.suppress(MissedRootsError):  # what it misses is said elsewhere
        peer(0.3, 0.5, labelled.k.tolist(), 41, 1)
    return None


BENCHMARK = Quantity(
    "roots",
    "41 roots of Eq. (50), none left out",
    DOUBLE,
    (1e-12, 1e-2),
    measure,
    style,
    first={name: partial(_found, name) for name in (DOUBLE, NEWTON, FINDROOT)},
)
