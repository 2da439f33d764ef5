"""The rules of judging: what may lower a verdict, and what may not.

1. A verdict concerns the sentence as the paper wrote it, at the parameters, starts, sizes and ends
   that it states there. What happens elsewhere (another nucleus, another reading, stronger
   coupling) is a remark, shown beside it; a remark never lowers a verdict.
2. *Holds only in part* needs a named part of that very sentence that fails: `partly` takes these
   words, and `Claim.found` refuses words that are not in the quote.
3. "About" and plotted values allow for the rounding of the number as given (`rounding`). A few
   undecided points of a map do not refute a statement about its regions; their share is reported.
4. A printed equation that passes its check holds, whatever its later use. A matter of notation (<
   for ≤ at one instant, an inequality between moduli, a ring where a chain is used later) is a
   remark, unless the equation cannot be used as it stands.
5. A sentence that repeats another claim is listed under it and not counted again.
6. A tolerance follows from the digits in the text or from the error of the method. If it would
   follow from an axis that cannot be read, the claim is untestable in that respect and says so.
7. The methods of a claim are references to code; those of one claim share no stepper,
   solver, sum or search (``tests/independence.py``). If a second method covers only a part, it
   states which. Claims with a single method say so.
8. A tolerance is a number in its rule; if it is loosened a thousandfold, a verdict on the
   artificial evidence of the tests changes.
9. Every verdict other than *reproduced* has a reason in one sentence. A verdict that differs from
   the recorded one fails the run.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """The five possible verdicts on a claim."""

    REPRODUCED = "reproduced"
    CORRECTED = "reproduced with a correction"
    PARTIAL = "holds only in part"
    NOT_REPRODUCED = "not reproduced"
    UNTESTABLE = "cannot be tested from the text"


@dataclass(frozen=True)
class Ruling:
    """A verdict with its reason.

    Attributes
    ----------
    verdict : Verdict
        The verdict.
    because : str
        Its reason in one sentence; empty if and only if the verdict is 'reproduced'.
    part : str
        The words of the sentence that fail; given if and only if it holds only in part.

    Raises
    ------
    ValueError
        If the reason or the part is missing, or is given where it must not be.
    """

    verdict: Verdict
    because: str = ""
    part: str = ""

    def __post_init__(self) -> None:
        if self.verdict is Verdict.REPRODUCED:
            if self.because or self.part:
                raise ValueError("'reproduced' has neither a because nor a failing part.")
            return
        if not self.because.endswith(".") or _SEVERAL.search(self.because):
            raise ValueError(f"'{self.verdict}' needs its because in one sentence.")
        if (self.verdict is Verdict.PARTIAL) != bool(self.part):
            raise ValueError("'holds only in part' names the part that fails, and no other does.")


_SEVERAL = re.compile(r"[.!?] +[A-Z]")


def holds() -> Ruling:
    """Rule that the sentence holds as written."""
    return Ruling(Verdict.REPRODUCED)


def corrected(because: str) -> Ruling:
    """Rule that the sentence holds after a correction, which is given in the errata."""
    return Ruling(Verdict.CORRECTED, because)


def partly(part: str, because: str) -> Ruling:
    """Rule that one part of the sentence fails, identified by its words."""
    return Ruling(Verdict.PARTIAL, because, part)


def fails(because: str) -> Ruling:
    """Rule that the sentence is not reproduced."""
    return Ruling(Verdict.NOT_REPRODUCED, because)


def untestable(because: str) -> Ruling:
    """Rule that the text does not say enough to test the sentence."""
    return Ruling(Verdict.UNTESTABLE, because)


def rounding(number: str) -> float:
    """Return half a unit of the last digit of a printed number.

    Examples
    --------
    >>> rounding("0.195"), rounding("40")
    (0.0005, 0.5)
    """
    digits = number.partition(".")[2]
    return float(0.5 * 10.0 ** -len(digits))


def agrees(found: float, number: str, error: float = 0.0) -> bool:
    """Return whether a value, within its own error, rounds to a number as printed.

    Examples
    --------
    >>> agrees(0.19113, "0.1916"), agrees(0.1916349, "0.1916")
    (False, True)
    """
    return abs(found - float(number)) <= rounding(number) + error
