"""Stick-slip spreads from one end of the friction chain, every stick located exactly (Fig. 3b)."""

import numpy as np

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the time at which site 11 first sticks; draw the run to a file."""
    chain = fr.FrictionChain(c=0.02, v_d=1.25, sites=21)
    run = fr.simulate(chain, fr.excite(chain, [1]), t_end=900)
    if path is not None:
        run.plot().figure.savefig(path)
    assert np.nanmax(run.arrivals) < 900
    return float(run.arrivals[10])


if __name__ == "__main__":
    print(main("stick_slip_front.png"))
