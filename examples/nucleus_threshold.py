"""The coupling up to which a breather of one site exists, against η (cf. Fig. 11)."""

import fronts as fr


def main(path: str | None = None) -> float:
    """Return c at a = 2.5, b = 0.5; draw the threshold against b to a file."""
    found = {
        b: fr.threshold(fr.AveragedChain(a=2.5, b=b, c=0.1), fr.Nucleus(1))
        for b in (0.3, 0.4, 0.5, 0.6, 0.7)
    }
    if path is not None:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots()
        axes.plot([b / 2.5**2 for b in found], [each.c_crit for each in found.values()], "o-")
        axes.set(xlabel="η = b/a²", ylabel="coupling c at the fold")
        axes.figure.savefig(path)
    return float(found[0.5].c_crit)


if __name__ == "__main__":
    print(main("nucleus_threshold.svg"))
