"""A breather of the Van der Pol chain as a periodic orbit, with its Floquet multipliers."""

import numpy as np

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the largest modulus of the nontrivial multipliers; draw the breather to a file."""
    chain = fr.VdpChain(a=2.5, b=0.5, c=0.1, sites=15)
    orbit = fr.breather(chain, method="orbit")
    if path is not None:
        orbit.plot().figure.savefig(path)
    moduli = np.sort(np.abs(orbit.multipliers))
    return float(moduli[-2])


if __name__ == "__main__":
    print(main("breather_stability.svg"))
