"""The figure: share of instances solved within a time, one panel per arm and start."""

import numpy as np
from matplotlib import pyplot as plt
from report import in_order, seconds_of

# Colours that those who see red and green alike can tell apart.
COLOURS = {
    "flexarm riccati": "#e69f00",
    "flexarm clarabel": "#0072b2",
    "acados full": "#009e73",
    "acados partial": "#56b4e9",
    "fatrop": "#cc79a7",
    "ipopt": "#777777",
}
SHARES = np.linspace(0.0, 1.0, 201)


def draw(records, path, note):
    """Writes the figure to `path`."""
    arms = list(dict.fromkeys(r["arm"] for r in records))
    plt.switch_backend("svg")
    plt.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "flexarm", "font.size": 10}
    size = (11, 3.6 * len(arms) + 0.9)
    figure, axes = plt.subplots(len(arms), 2, figsize=size, sharex=True, sharey=True, squeeze=False)
    for row, arm in zip(axes, arms, strict=True):
        for axis, warm in zip(row, (False, True), strict=True):
            panel(axis, [r for r in records if r["arm"] == arm and r["warm"] == warm])
            axis.set_title(f"{arm}, {'next step, warm' if warm else 'cold'}")
        row[0].set_ylabel("share of instances solved [%]")
    for axis in axes[-1]:
        axis.set_xlabel("within [ms]")
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=len(labels), frameon=False)
    figure.text(0.5, 0.005, note, ha="center", fontsize=8, color="#555555")
    figure.tight_layout(rect=(0, 0.03, 1, 0.95))
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def panel(axis, records):
    """One line per solver; it ends below 100 % where instances failed."""
    for solver in in_order(r["solver"] for r in records):
        of = [r for r in records if r["solver"] == solver]
        solved = np.sort([1e3 * min(seconds_of(r)) for r in of if r["passes"]])
        if not len(solved):
            continue
        times = np.quantile(solved, SHARES, method="inverted_cdf")
        height = 100.0 * SHARES * len(solved) / len(of)
        ours = solver.startswith("flexarm")
        style = {"lw": 2.4, "zorder": 3} if ours else {"lw": 1.4, "zorder": 2}
        axis.plot(times, height, label=solver, color=COLOURS.get(solver), **style)
    axis.set_xscale("log")
    axis.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_ylim(0, 102)
    axis.grid(True, which="major", color="#dddddd", lw=0.6)
    axis.spines[["top", "right"]].set_visible(False)
    axis.tick_params(labelbottom=True)
