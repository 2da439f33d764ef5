"""All derivations, with all checks, for random chains: ``python -m benchmarks.other_models``.

A derivation is a function of its model, and its checks must hold for any model: with rates,
couplings and amplitudes of any size, symbols as well as numbers, springs to further neighbours, and
a nonlinear stiffness of the cell. A result that a model does not have, such as a front without two
cycles, is refused with a sentence.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import process_time

import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.catalogue import WITH_MODEL, load
from derivations.chain import ChainModel
from derivations.symbols import c

EXAMPLE = """examples:
  python -m benchmarks.other_models 3001:3040    one model for each seed, some ten seconds each
  python -m benchmarks.other_models 7

Exit code 1: a check fails for a model, or its derivation ends in anything but a refusal."""
_LETTERS = tuple(sp.Symbol(name, positive=True) for name in "dhuw")
_HALF, _TENTH = sp.Rational(1, 2), sp.Rational(1, 10)


@dataclass(frozen=True, kw_only=True)
class ModelFinding:
    """The outcome of a derivation that failed or refused the model.

    Attributes
    ----------
    derivation : str
        Name of the derivation.
    message : str
        The step that fails and the message of its check, or why the model is refused.
    fails : bool
        Whether this is a failure rather than a refusal.
    """

    derivation: str
    message: str
    fails: bool


def random_model(seed: int) -> ChainModel:
    """Return a chain with random powers, coefficients, symbols, springs and coupling.

    Examples
    --------
    >>> random_model(7) == random_model(7)
    True
    """
    chance = random.Random(seed)
    rest, middle, top, stiff = _LETTERS

    def coefficient(letter: sp.Symbol) -> sp.Expr:
        factor = chance.choice([1, 1, 2, 3, _HALF, 3 * _HALF])
        return factor * (letter if chance.random() < 0.5 else chance.choice([1, 2, 4]))

    low, high = chance.choice([(2, 4), (2, 4), (4, 8), (2, 6)])
    damping = {0: chance.choice([1, 2, _HALF, rest]), low: -coefficient(middle),
               high: coefficient(top)}  # fmt: skip
    if chance.random() < 0.6:  # a² > 8 b, as two cycles of (8) need, but for letters
        at_rest, above = (
            chance.choice([1, 2, _HALF, 3]),
            chance.choice([1, 2, sp.Rational(1, 3), 5]),
        )
        between = chance.choice([4, 5, 8]) * sp.Rational(round(100 * (at_rest * above) ** 0.5), 100)
        damping = {0: at_rest, 2: -between, 4: above}
        damping[0] *= rest if chance.random() < 0.3 else 1
        damping[4] *= top if chance.random() < 0.2 else 1
    if chance.random() < 0.2:
        damping[1] = coefficient(stiff)
    stiffness = {}
    for power, share in ((3, 0.4), (2, 0.15), (5, 0.1)):
        if chance.random() < share:
            stiffness[power] = chance.choice([1, -1]) * coefficient(stiff)
    weights = chance.choice([(1,), (1,), (1,), (1, _HALF / 2), (1, -_TENTH), (1, _HALF, 2 * _TENTH),
                             (2,)])  # fmt: skip
    coupling = chance.choice([c, c, c, 2 * c, c / 3, c + 1, 3])
    return ChainModel(damping=damping, stiffness=stiffness, coupling=coupling, weights=weights)


def findings(model: ChainModel) -> Iterator[ModelFinding]:
    """Yield the first failing check of each derivation, its refusal, or any other error."""
    for name in WITH_MODEL:
        try:
            for step, evidence in load(name, model=model).examined():
                if not evidence.holds:
                    message = f"{step.name}: {evidence.statement}"
                    yield ModelFinding(derivation=name, message=message, fails=True)
        except DerivationInputError as error:
            yield ModelFinding(derivation=name, message=str(error), fails=False)
        except Exception as error:
            message = f"{type(error).__name__}: {error}"
            yield ModelFinding(derivation=name, message=message, fails=True)


def _seeds(text: str) -> range:
    first, _, last = text.partition(":")
    try:
        seeds = range(int(first), int(last or first) + 1)
    except ValueError:
        seeds = range(0)
    if not seeds:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a seed: give a whole number such as 7, or the first and the last of "
            "several, such as 3001:3040"
        )
    return seeds


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.other_models",
        description="Derive everything for random other chains, and check every step.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("seeds", type=_seeds, metavar="SEED[:SEED]", help="one or a range, both in")
    failing = 0
    seeds = parser.parse_args(arguments).seeds
    for seed in seeds:
        begin, model = process_time(), random_model(seed)
        found = list(findings(model))
        fails = any(each.fails for each in found)
        failing += fails
        verdict = "FAILS" if fails else "holds"
        print(f"{seed} {verdict} in {process_time() - begin:.0f} s: {model}", flush=True)
        for each in found:
            print(f"    {'FAILS' if each.fails else 'refused'} {each.derivation}: {each.message}")
    print(f"{len(seeds)} models, {failing} with a check that fails")
    return 1 if failing else 0


if __name__ == "__main__":
    sys.exit(main())
