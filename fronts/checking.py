"""Derivations, verdicts and the stability table, from Python.

The public functions `fronts.derivation`, `fronts.derive_cell`, `fronts.judge` and
`fronts.stability`. SymPy and the claims are imported when one is called.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from theory.parameters import ParameterError, count_within, whole_number

if TYPE_CHECKING:
    from derivations.algebra.steps import Derivation
    from derivations.cell.envelope import Envelope
    from paper_checks.outcome import Outcome
    from verification.quantities.robustness import Stability


def derivation(of: int | str, *, order: int = 1) -> Derivation:
    """Return the derivation of an equation of the paper, or a derivation by its name.

    Parameters
    ----------
    of : int or str
        Number of the equation, from 1 to 54; or a name that ``fronts derive`` lists.
    order : int, optional
        Order in the small parameter, 1 or 2, where the derivation has both.

    Returns
    -------
    Derivation
        Its steps, each with a check that can fail.

    Raises
    ------
    ParameterError
        If there is no such equation or derivation.

    Examples
    --------
    >>> import fronts as fr
    >>> all(evidence.holds for evidence in fr.derivation(34).verify())
    True
    """
    from derivations import catalogue

    order = count_within("order", order, 1, 2)
    if isinstance(of, str):
        if of not in catalogue.LISTING:
            raise ParameterError(
                "derivation", of, f"one of {', '.join(catalogue.LISTING)}", "choose one"
            )
        return catalogue.load(of, order)
    number = whole_number("equation", of, 1, 54)
    return catalogue.load(catalogue.owner(number), order).only(number)


def derive_cell(
    damping: str,
    *,
    stiffness: str | None = None,
    coupling: str = "c",
    values: Mapping[str, float | str] | None = None,
) -> Envelope:
    """Average a chain of your own oscillators ÿ + y + ε(...) = 0 with polynomial damping.

    Parameters
    ----------
    damping : str
        h(y) of the term ε h(y) ẏ, a polynomial in y, as in ``"1 - a*y**2 + b*y**4"``.
    stiffness : str, optional
        g(y) of a further term ε g(y), a polynomial in y.
    coupling : str, optional
        The coupling, a letter or an expression.
    values : mapping of str to float or str, optional
        Numbers for the letters.

    Returns
    -------
    Envelope
        The averaged equation, its cycles, and the threshold ratio of the piecewise front.

    Raises
    ------
    DerivationInputError
        If an expression is not of this kind.

    References
    ----------
    Krylov, N. M. & Bogoliubov, N. N. (1947), Introduction to Non-Linear Mechanics, Princeton:
    averaging.

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.derive_cell("1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5})
    >>> [cycle.stability for cycle in found.cycles]
    ['unstable', 'stable']
    """
    from derivations.cell.envelope import derive_envelope

    envelope = derive_envelope(damping, stiffness, coupling)
    return envelope.with_values({name: str(value) for name, value in (values or {}).items()})


def judge(*keys: str, workers: int = 1, full: bool = False) -> tuple[Outcome, ...]:
    """Judge claims of the paper.

    Parameters
    ----------
    *keys : str
        Claims, as ``"fig17-linear"``, or modules of claims, as ``"fig17"``; all if none is given.
    workers : int, optional
        Processes, from 1 to 256.
    full : bool, optional
        Compute everything: use no stored finding of the expensive claims.

    Returns
    -------
    tuple of Outcome
        One for each claim; see ``.claim`` and ``.judgement``.

    Raises
    ------
    ParameterError
        If there is no such claim.

    Examples
    --------
    >>> import fronts as fr
    >>> [each.claim.key for each in fr.judge("fig16-admissible")]
    ['fig16-admissible']
    """
    from paper_checks import discover
    from paper_checks.run import run
    from paper_checks.shipped import FOLDER, Shipped
    from verification.execution.digest import SOURCES

    every = discover.find_entries()
    try:
        entries = discover.select(every, keys)
    except discover.UnknownKeyError as error:
        raise ParameterError("claim", " ".join(keys), "a claim that exists", str(error)) from None
    return run(
        entries,
        jobs=count_within("workers", workers, 1, 256),
        package=discover.PACKAGE,
        shipped=None if full else Shipped(FOLDER, discover.PACKAGE, SOURCES),
    )


def stability(
    quantities: Sequence[str] = (), *, points: int = 1000, seed: int = 0, workers: int | None = None
) -> Stability:
    """Hold every quantity against another method over all decades of its parameters.

    Parameters
    ----------
    quantities : sequence of str, optional
        Only these; ``fronts stress --list`` names them.
    points : int, optional
        Points in all: test problems, corners of the ranges, and at random.
    seed : int, optional
        Of the points at random.
    workers : int, optional
        Processes; by default one a core.

    Returns
    -------
    Stability
        Counts of what is right, refused, unchecked or wrong, by quantity, and each wrong point.

    Raises
    ------
    ParameterError
        If there is no such quantity, or a number is out of range.
    """
    from verification.quantities.robustness import stability as table

    return table(tuple(dict.fromkeys(quantities)), points, seed, workers=workers)
