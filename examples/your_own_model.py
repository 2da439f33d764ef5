"""A model of your own: one dataclass and one right-hand side are all that is needed.

The chain of Nagumo, ẏ_n = y_n (1 - y_n)(y_n - α) + c (y_{n-1} - 2 y_n + y_{n+1}).
"""

from dataclasses import dataclass

import fronts as fr
from theory.chains.chain import SmoothChain, parameter


def nagumo(site, left, right, p):  # type: ignore[no-untyped-def]
    """Return the derivatives of (y, w) of one site; w is not used."""
    y, w = site
    return y * (1 - y) * (y - p[0]) + p[1] * (left[0] + right[0] - 2 * y), -w


@dataclass(frozen=True, kw_only=True)
class NagumoChain(SmoothChain, model="nagumo-example", kernel=nagumo):
    """Its parameters."""

    alpha: float = parameter("threshold", "α", 0.2)
    c: float = parameter("coupling", "c", 1.0)
    sites: int = parameter("number of sites", "N", 31)
    stable_amplitude = 1.0
    unstable_amplitude = property(lambda chain: chain.alpha)


def main(path: str | None = None) -> float:
    """Return the velocity of its front; draw the arrivals to a file."""
    front = fr.measure_front(NagumoChain(alpha=0.2, c=1.0))
    if path is not None:
        front.plot().figure.savefig(path)
    assert front.v is not None
    return front.v


if __name__ == "__main__":
    print(main("your_own_model.svg"))
