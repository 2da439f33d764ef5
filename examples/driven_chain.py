"""A force at the end of a chain: a weak one moves a few sites, a strong one starts a front."""

import numpy as np

import fronts as fr


def main(path: str | None = None) -> float:
    """Return how far the end moves per unit of the weak force; draw the front to a file."""
    chain = fr.OscillatorChain(
        damping="1 - a*y**2 + b*y**4", values={"a": 4, "b": 0.5}, c=0.6, sites=31
    )
    weak, strong = (
        fr.simulate(chain.replace(drive=f"{force},1@1"), np.zeros((2, 31)), t_end=6000)
        for force in (0.0005, 0.03)
    )
    if path is not None:
        strong.plot().figure.savefig(path)
    assert np.isfinite(strong.arrivals).all()  # every site is reached
    assert not np.isfinite(weak.arrivals).any()
    return float(weak.amplitude[-1, 0] / 0.0005)


if __name__ == "__main__":
    print(main("driven_chain.png"))
