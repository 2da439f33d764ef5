"""A disordered chain in space and time: thresholds of the cells that differ by ten per cent."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return the mean velocity between two sites; draw the run to a file."""
    chain = fr.OscillatorChain(
        damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, overdamped=True,
        disorder={"alpha": 0.1}, seed=1, c=1, sites=60,
    )  # fmt: skip
    run = fr.simulate(chain, fr.excite(chain, range(1, 9)), t_end=150)
    if path is not None:
        run.plot().figure.savefig(path)
    return float(30 / (run.arrivals[49] - run.arrivals[19]))


if __name__ == "__main__":
    print(main("disordered_chain.png"))
