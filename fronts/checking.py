"""Derivations, verdicts and the robustness table, from Python.

The module contains the public functions `fronts.derivation`, `fronts.derive_cell`, `fronts.judge`
and `fronts.robustness`. SymPy and the claims are imported only when one of them is called.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from fronts.wording import rows_of
from theory.parameters import ParameterError, Range, count_within, need_instance, truth, with_ranges
from theory.result import Result

if TYPE_CHECKING:
    import sympy as sp

    from derivations.algebra.steps import Derivation, Evidence, Step
    from derivations.averaging.cycles import LimitCycle
    from derivations.cell.envelope import Envelope
    from paper_checks.outcome import JudgedClaim
    from verification.quantities.robustness import Robustness


@dataclass(frozen=True, kw_only=True)
class DerivedCell(Result):
    """The averaged chain of user-defined oscillators.

    Attributes
    ----------
    envelope : Envelope
        The averaged equation, with the methods ``compiled()`` and ``kinetic_relation()``.
    seconds : float
        Wall-clock time.
    """

    envelope: Envelope = field(metadata={"json": None})
    seconds: float

    @property
    def equation(self) -> sp.Eq:
        """The averaged equation of the chain, ``y = Im(phi e^{it})``; a prime means d/d(eps t)."""
        return self.envelope.equation

    @property
    def amplitude_equation(self) -> sp.Eq:
        """The amplitude equation of a single cell; a prime means d/d(eps t)."""
        return self.envelope.amplitude_equation

    @property
    def damping_mean(self) -> sp.Expr:
        """H(s) in the amplitude equation ``r' = -(r/2) H(r^2)``."""
        return self.envelope.damping_mean

    @property
    def cycles(self) -> tuple[LimitCycle, ...]:
        """All limit cycles, from the innermost outwards, with their stability."""
        return self.envelope.cycles

    @property
    def ratio(self) -> sp.Expr:
        """|phi_us| / |phi_s| of a cell with two cycles."""
        return self.envelope.ratio

    def to_dict(self) -> dict[str, Any]:
        """Return the equations in SymPy syntax, and the cycles if they have a closed form."""
        from derivations.algebra.errors import DerivationInputError

        cycles = ratio = None
        try:
            cycles = [
                {
                    "amplitude": str(cycle.amplitude),
                    "value": _value(cycle.amplitude),
                    "stability": str(cycle.stability),
                    "multiplicity": cycle.multiplicity,
                }
                for cycle in self.cycles
            ]
            ratio = {"expression": str(self.ratio), "value": _value(self.ratio)}
        except DerivationInputError:  # no closed form in terms of the symbols, or not two cycles
            pass
        return {
            "equation": str(self.equation),
            "amplitude_equation": str(self.amplitude_equation),
            "damping_mean": str(self.damping_mean),
            "cycles": cycles,
            "ratio": ratio,
            "seconds": self.seconds,
        }


def _value(expression: sp.Expr) -> float | None:
    return None if expression.free_symbols else float(expression)


@dataclass(frozen=True, kw_only=True)
class DerivedEquations(Result):
    """The steps of a derivation, each computed from its sources and with a check that can fail.

    Iteration yields the steps; a notebook shows operations, equations and checks. Pickling stores
    only the arguments, and unpickling repeats the derivation.

    Attributes
    ----------
    of, order : int or str, int
        The arguments of `derivation`.
    title : str
        Title of the derivation.
    derivation : Derivation
        The steps as objects of the package ``derivations``.
    """

    of: int | str = field(metadata={"json": None})
    order: int = field(metadata={"json": None})
    title: str
    derivation: Derivation = field(metadata={"json": None})

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the call that repeats the derivation, since checks contain unnamed functions."""
        return partial(derivation, order=self.order), (self.of,)

    @property
    def steps(self) -> tuple[Step, ...]:
        """The steps, in order; each has ``name``, ``number``, ``operation``, ``result``."""
        return self.derivation.steps

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)

    def verify(self) -> tuple[Evidence, ...]:
        """Run the check of every step.

        Returns
        -------
        tuple of Evidence
            One for each step.

        Raises
        ------
        CheckFailedError
            At the first step whose check fails.
        """
        return self.derivation.verify()

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per step; the number is text, empty if a step has none."""
        rows = self.to_dict()["steps"]
        table = {
            name: np.array([row[name] for row in rows])
            for name in ("name", "kind", "operation", "expression", "latex", "holds")
        }
        return table | {"number": np.array([str(row["number"] or "") for row in rows])}

    def to_dict(self) -> dict[str, Any]:
        """Return the checked steps: operation, sources, equation, SymPy expression, LaTeX."""
        from derivations.algebra.rendering import records

        return records(self.derivation)

    def _repr_html_(self) -> str:
        """Return the derivation for notebooks, with displayed equations."""
        from derivations.algebra.rendering import mathml

        return mathml(self.derivation)


@dataclass(frozen=True, kw_only=True)
class Verdicts(Result):
    """Verdicts on claims of the paper; a sequence of outcomes.

    Attributes
    ----------
    outcomes : tuple of JudgedClaim
        One for each claim, in the order of the paper, with ``claim``, ``judgement`` and ``status``.
    seconds : float
        Wall-clock time.
    """

    outcomes: tuple[JudgedClaim, ...] = field(metadata={"json": None})
    seconds: float

    def __iter__(self) -> Iterator[JudgedClaim]:
        return iter(self.outcomes)

    def __len__(self) -> int:
        return len(self.outcomes)

    def __getitem__(self, place: int) -> JudgedClaim:
        return self.outcomes[place]

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per claim: key, place, verdict, whether it changed, reason, seconds."""
        rows = self.outcomes
        return {
            "key": np.array([each.claim.key for each in rows]),
            "place": np.array([each.claim.place for each in rows]),
            "verdict": np.array([each.status for each in rows]),
            "changed": np.array([each.changed for each in rows]),
            "because": np.array([each.because for each in rows]),
            "seconds": np.array([each.judgement.seconds for each in rows]),
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the claims and the run time."""
        return {"claims": rows_of(self.columns()), "seconds": self.seconds}


EQUATIONS, WORKERS = Range(1, 54), Range(1, 256)
"""Numbers of the equations of the paper, and range of the number of processes."""


@with_ranges(equations=EQUATIONS)
def derivation(of: int | str, *, order: int = 1) -> DerivedEquations:
    """Return the derivation of an equation of the paper, or a derivation given by name.

    Parameters
    ----------
    of : int or str
        Number of the equation, {equations}; or a name listed by ``fronts derive``.
    order : int, optional
        Order in the small parameter, 1 or 2, where the derivation has both.

    Returns
    -------
    DerivedEquations
        The steps, each with a check that can fail.

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
        found = catalogue.load(of, order)
    else:
        number = count_within("equation", of, *EQUATIONS)
        found = catalogue.load(catalogue.owner(number), order).only(number)
    return DerivedEquations(of=of, order=order, title=found.title, derivation=found)


def derive_cell(
    damping: str,
    *,
    stiffness: str | None = None,
    coupling: str = "c",
    values: Mapping[str, float | str] | None = None,
) -> DerivedCell:
    """Average a chain of user-defined oscillators ÿ + y + ε(...) = 0 (cf. Eq. 34).

    Parameters
    ----------
    damping : str
        Polynomial h(y) in the term ε h(y) ẏ, such as ``"1 - a*y**2 + b*y**4"``.
    stiffness : str, optional
        Polynomial g(y) in a further term ε g(y).
    coupling : str, optional
        The coupling, a symbol or an expression.
    values : mapping of str to float or str, optional
        Numerical values of symbols.

    Returns
    -------
    DerivedCell
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

    begin = perf_counter()
    if values is not None:
        need_instance("values", values, (Mapping,), 'give numbers by letter, as {"a": 4}')
    envelope = derive_envelope(damping, stiffness, coupling)
    given = {name: str(value) for name, value in (values or {}).items()}
    return DerivedCell(envelope=envelope.with_values(given), seconds=perf_counter() - begin)


@with_ranges(workers=WORKERS)
def judge(*keys: str, workers: int = 1, full: bool = False) -> Verdicts:
    """Judge claims of the paper.

    Parameters
    ----------
    *keys : str
        Claims, such as ``"fig17-linear"``, or modules of claims, such as ``"fig17"``; by default
        all claims.
    workers : int, optional
        Number of processes, {workers}.
    full : bool, optional
        Compute everything, without the stored findings of expensive claims.

    Returns
    -------
    Verdicts
        One outcome for each claim, with the attributes ``claim`` and ``judgement``.

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
    from verification.execution.imports import SOURCES

    begin = perf_counter()
    whole = truth("full", full)
    for key in keys:
        if not isinstance(key, str):
            raise ParameterError("claim", key, "the key of a claim, as 'fig17-linear'", "name one")
    every = discover.find_entries()
    try:
        entries = discover.select(every, keys)
    except discover.UnknownKeyError as error:
        why = str(error).removesuffix(".")
        raise ParameterError("claim", " ".join(keys), "one that exists", why) from None
    outcomes = run(
        entries,
        jobs=count_within("workers", workers, *WORKERS),
        package=discover.PACKAGE,
        shipped=None if whole else Shipped(FOLDER, SOURCES),
    )
    return Verdicts(outcomes=outcomes, seconds=perf_counter() - begin)


def robustness(
    quantities: Sequence[str] = (), *, points: int = 1000, seed: int = 0, workers: int | None = None
) -> Robustness:
    """Compare every quantity with another method over all decades of its parameters.

    Parameters
    ----------
    quantities : sequence of str, optional
        Quantities to be tested, as listed by ``fronts stress --list``; by default all.
    points : int, optional
        Total number of points: test problems, corners of the ranges, and random points.
    seed : int, optional
        Seed of the random points.
    workers : int, optional
        Number of processes; by default one per core.

    Returns
    -------
    Robustness
        For each quantity, the numbers of points that are right, refused, undecided, unchecked or
        wrong, and a list of the wrong points.

    Raises
    ------
    ParameterError
        If there is no such quantity, or a number is out of range.

    Examples
    --------
    >>> import fronts as fr
    >>> found = fr.robustness(["c-pin"], points=12, workers=1)
    >>> found.bad, found.counts["exceeded"]
    ((), 0)
    """
    from verification.quantities.robustness import robustness as table

    if isinstance(quantities, str):
        quantities = (quantities,)  # a single name, not a sequence of its characters
    need_instance("quantities", quantities, (Collection,), 'name them, as ["c-pin"]')
    return table(tuple(dict.fromkeys(quantities)), points, seed, workers=workers)
