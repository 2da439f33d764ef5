"""A front of the averaged chain in space and time, and its velocity as a solution of (43)."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the velocity read from the arrivals at two sites; draw the run to a file."""
    chain = fr.AveragedChain(a=4, b=0.5, c=0.6, sites=40)
    run = fr.simulate(chain, fr.excite(chain, [1, 2, 3]), t_end=5000)
    if path is not None:
        run.plot().figure.savefig(path)
    first, last = run.arrivals[9], run.arrivals[29]
    return float(20 / (chain.eps * (last - first)))


if __name__ == "__main__":
    print(main("front_in_space_and_time.png"))
