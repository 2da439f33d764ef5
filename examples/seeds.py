"""A sweep over the seeds of a disorder on all cores: the mean velocity of a front, its spread."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the mean velocity; draw the velocities of all seeds to a file."""
    chain = fr.OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, overdamped=True,
        disorder={"alpha": 0.1}, c=1, sites=64,
    )  # fmt: skip
    found = fr.ensemble(fr.measure_front, chain, range(12), accuracy=0.05)
    if path is not None:
        found.plot().figure.savefig(path)
    return found.mean


if __name__ == "__main__":
    print(main("seeds.svg"))
