"""Springs to second neighbours make a front faster: its velocity against their weight."""

import matplotlib.pyplot as plt

import fronts as fr

WEIGHTS = (0.0, 0.1, 0.2)


def main(path: str | None = None) -> float:
    """Return the factor by which a weight of 0.2 makes the front faster; draw the velocities."""
    speeds = []
    for weight in WEIGHTS:
        chain = fr.OscillatorChain(
            damping=0, stiffness="y*(1 - y)*(alpha - y)", values={"alpha": 0.2}, overdamped=True,
            c=1, coupling=f"next-nearest:1,{weight}", sites=64,
        )  # fmt: skip
        front = fr.measure_front(chain, accuracy=1e-4)
        assert front.v is not None
        speeds.append(front.v)
    if path is not None:
        figure, axes = plt.subplots()
        axes.plot(WEIGHTS, speeds, "o-")
        axes.set(xlabel="weight of the springs to second neighbours", ylabel="front velocity v")
        figure.savefig(path)
    return speeds[-1] / speeds[0]


if __name__ == "__main__":
    print(main("next_nearest.svg"))
