"""From records to a table, a summary and a figure."""

from dataclasses import dataclass

import numpy as np
from instances import CLASSES, SOFT

ACADOS = "acados"


@dataclass
class Group:
    """A solver on the instances of one class, cold or warm."""

    solver: str
    best: np.ndarray  # [s], least of the repeats, one per instance
    single: np.ndarray  # [s], every call
    fails: int
    unsolved: int
    gap: float
    excess: float

    def order(self):
        """Whose row this is to be: fewer fails first, then the faster."""
        return self.fails, np.median(self.best)


def seconds_of(record):
    """The solver's own clock where it has one: it leaves out the call from Python."""
    return record.get("own_seconds", record["seconds"])


def quantiles(values):
    """Median, 99th percentile, maximum."""
    return [float(np.quantile(values, share, method="higher")) for share in (0.5, 0.99, 1.0)]


def groups(records):
    """{(arm, class, warm): {solver: Group}}"""
    sorted_records = {}
    for record in records:
        key = (record["arm"], record["class"], record["warm"])
        sorted_records.setdefault(key, {}).setdefault(record["solver"], []).append(record)
    return {
        key: {solver: group(solver, by_solver[solver]) for solver in in_order(by_solver)}
        for key, by_solver in sorted_records.items()
    }


def in_order(solvers):
    """Ours first, whichever solver came first in a turn."""
    return sorted(set(solvers), key=lambda solver: (not solver.startswith("flexarm"), solver))


def group(solver, records):
    """Statistics of one solver's records."""
    return Group(
        solver=solver,
        best=np.array([min(seconds_of(r)) for r in records]),
        single=np.concatenate([seconds_of(r) for r in records]),
        fails=sum(not r["passes"] for r in records),
        unsolved=sum(not r["solved"] for r in records),
        gap=max((r["gap"] for r in records if r["passes"]), default=float("nan")),
        excess=max((r["excess"] for r in records if r["passes"]), default=float("nan")),
    )


def columns(of_class):
    """Groups by column: our solvers, the better acados, the others."""
    acados = [group for solver, group in of_class.items() if solver.startswith(ACADOS)]
    shown = {solver: group for solver, group in of_class.items() if solver.startswith("flexarm")}
    if acados:
        shown["acados, the better"] = min(acados, key=Group.order)
    return shown | {solver: g for solver, g in of_class.items() if g not in acados and solver not in shown}


def cell(found):
    """Median, p99, maximum in ms, fails, and which variant of acados."""
    text = "  ".join(f"{digits(1e3 * t):>6}" for t in quantiles(found.best))
    fails = f"!{found.fails}" if found.fails else ""
    variant = found.solver.removeprefix(ACADOS) if found.solver.startswith(ACADOS) else ""
    return f"{text} {fails:>4}{variant}".rstrip()


def digits(value):
    """Three digits, at least."""
    places = 3 if value < 1 else 2 if value < 10 else 1 if value < 100 else 0
    return f"{value:.{places}f}"


def table(records):
    """Rows of text, the header first."""
    rows = []
    found = groups(records)
    for arm, kind, warm in sorted(found, key=lambda key: (key[0], CLASSES.index(key[1]), key[2])):
        shown = columns(found[arm, kind, warm])
        ours = [solver for solver in shown if solver.startswith("flexarm")]
        better = next((group for solver, group in shown.items() if solver.startswith(ACADOS)), None)
        ratios = {f"acados/{name.split()[-1]}": ratio(better, shown[name]) for name in ours[:1] if better}
        if not rows:
            rows.append(["arm", "class", "n", "start", *shown, *ratios])
        count = str(len(shown[ours[0]].best))
        start = "warm" if warm else "cold"
        rows.append([arm, kind, count, start, *map(cell, shown.values()), *ratios.values()])
    return rows


def ratio(theirs, ours):
    """Of medians, 99th percentiles and maxima."""
    pairs = zip(quantiles(theirs.best), quantiles(ours.best), strict=True)
    return "  ".join(f"{digits(a / b):>6}" for a, b in pairs)


def aligned(rows):
    """The table for a terminal."""
    rows = [list(row) for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    cells = [[text.ljust(width) for text, width in zip(row, widths, strict=True)] for row in rows]
    lines = ["  ".join(row).rstrip() for row in cells]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def accuracy(records):
    """Worst cost above the optimum and worst excess among the moves that passed, and fails, per solver."""
    rows = [["solver", "limit", "solves", "fails", "said so", "worst gap", "worst excess"]]
    for solver in in_order(r["solver"] for r in records):
        for soft in (False, True):
            of = [r for r in records if r["solver"] == solver and (r["class"] in SOFT) == soft]
            if not of:
                continue
            g = group(solver, of)
            failed = [r for r in of if not r["passes"]]
            said = sum(not r["solved"] for r in failed)
            kept = ["priced", "-"] if soft else ["kept", f"{g.excess:.1e} A²"]
            counts = [str(count) for count in (len(of), g.fails, said)]
            rows.append([solver, kept[0], *counts, f"{g.gap:.1e}", kept[1]])
    return rows


def summary(records):
    """What is stored: statistics of best and of single calls [s] per group."""
    return [
        {
            "arm": arm,
            "class": kind,
            "warm": warm,
            "solver": solver,
            "instances": len(g.best),
            "best": quantiles(g.best),
            "single": quantiles(g.single),
            "fails": g.fails,
            "reported_unsolved": g.unsolved,
            "worst_gap": g.gap,
            "worst_excess": g.excess,
        }
        for (arm, kind, warm), by_solver in groups(records).items()
        for solver, g in by_solver.items()
    ]
