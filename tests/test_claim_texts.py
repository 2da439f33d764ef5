"""What the texts of claims say of where they were tried, and of the tolerances of their rules.

The numbers stand in the text as words; here each is written anew from the constant of the code.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import pytest

from paper_checks.claims import (
    _maps,
    fig02,
    fig03,
    fig04,
    fig05,
    fig06,
    fig07,
    fig08,
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
)
from paper_checks.discover import find_entries
from paper_checks.prose import template, words


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
    "fig02-states": lambda: (f"{plain(fig02.AGREE)} in period and stick time",),
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
    "fig10-in-phase": lambda: (
        f"{fig10.IN_PHASE} π for \"in phase\", {fig10.STEADY} π for \"steady\"",
        f"Nuclei of {listed(fig10.SIZES, ' and ')} sites",
        f"breathers of nucleus sizes {listed(fig10.SIZES, ' and ')} at c = {fig10.C},",
        f"a perturbation of {plain(fig10.NOISE)} the", f"by εt = {plain(fig10.END)};",
        f"--c {fig10.C} ",
    ),
    "fig11-values": lambda: (f"within a factor of {fig11.SAME_RATE}",),
    "fig11-converged": lambda: (
        f"tolerance: {plain(fig11.CONVERGED)},", f"over sizes {listed(fig11.ODD[2:])}\n",
    ),
    "fig11-stable": lambda: (
        f"up to c = {fig11.MIRRORED_AT[-1]}:", f"sizes {fig11.RANGE[0]} to {fig11.RANGE[-1]} with",
        f"for sizes {listed(fig11.FAMILY, ' and ')} the family",
    ),
    "fig11-all-lost": lambda: (
        f"stable at {fig11.LAST} would", f"sizes {fig11.RANGE[0]} to {fig11.RANGE[-1]}, "
        f"{listed(fig11.FAMILY, ' and ')}, none is stable at {fig11.LAST}.",
    ),
    "fig12-steady": lambda: (
        f"the first {fig12.COMPARED} arrivals", f"{plain(fig12.STEADY)} between",
        f"{percent(fig12.DELAY)} in the delay", f"the last of {fig12.SITES} sites",
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
        f"at c = {fig13.BELT_COUPLING}, divided",
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
    ),
    "fig15-alike": lambda: (
        f"counted at εt = {plain(fig15.SCIPY_END)} ",
        f"{len(fig15.ETAS) * len(fig15.COUPLINGS)} points (II)",
    ),
    "fig16-admissible": lambda: (f"tolerance: {plain(fig16.AGREE)} between",),
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
    "fig18-alike": lambda: (f"grows from {fig18.ETAS[0]} to {fig18.ETAS[-1]} v̂",),
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


def test_the_text_names_the_coupling_at_which_the_exponent_is_taken() -> None:
    power = str(round(math.log10(fig17.LAST))).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    assert 10.0 ** round(math.log10(fig17.LAST)) == fig17.LAST
    assert f"at c = 10{power}\n" in template(fig17.__name__, "fig17-linear")
