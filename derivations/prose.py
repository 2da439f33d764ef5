"""The prose of the derivations, written in ASCII and shown with the signs of the paper."""

from __future__ import annotations

import re

_LETTERS = {
    "mu": "μ", "xi": "ξ", "phi": "φ", "Psi": "Ψ", "psi": "ψ", "omega": "ω", "eps": "ε",
    "alpha": "α", "delta": "δ", "theta": "θ", "zeta": "ζ", "eta": "η", "tau": "τ", "pi": "π",
    "infinity": "∞", "v_hat": "v̂",
}  # fmt: skip
_LETTER = re.compile(rf"(?<![A-Za-z'_])({'|'.join(_LETTERS)})(?![A-Za-z'-])")
_SIGNS = {" >= ": " ≥ ", " <= ": " ≤ ", " << ": " ≪ ", " -> ": " → ", "sqrt(": "√("}


def readable(prose: str) -> str:
    """Return notes, operations and statements of evidence with the letters and signs of the paper.

    Examples
    --------
    >>> readable("mu(0) = mu_st for n >= 1, not in 'multiple-scales'")
    "μ(0) = μ_st for n ≥ 1, not in 'multiple-scales'"
    """
    for sign, better in _SIGNS.items():
        prose = prose.replace(sign, better)
    return _LETTER.sub(lambda found: _LETTERS[found.group(1)], prose)
