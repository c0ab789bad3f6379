"""From records to a table, a summary and a figure."""

from dataclasses import dataclass

import numpy as np
from instances import CLASSES, SOFT

ACADOS, IPOPT, OURS = "acados", "ipopt", "flexarm"
LEGEND = """\
Median, p99 and maximum over the instances [ms]. !n: n instances failed the check; theirs are then not timed,
ours are. closed: instances that our solvers answer in closed form, without an iteration; the last rows sum
all classes up by that. acados: full or partial condensing, whichever fails less, then whichever is faster.
acados/ours and ipopt/ours: medians over that of flexarm riccati; our max/acados: its maximum over a median.
"""
ACCURACY = """\
Accuracy of what passed. said so: fails that the solver itself reported. other: answers that are an optimum,
but not the one of the yardstick; IPOPT finds none better near them.
"""
INSTANCES = """\
Medians, over the instances of each arm and start and over all of them, of how much longer the others take
on each; what they failed is left out.
"""
# Rows over all classes: whether our solver had to iterate.
EASY, HARD = "all: closed form", "all: iterated"
ROWS = (*CLASSES, EASY, HARD)


@dataclass
class Group:
    """A solver on the instances of one class, cold or warm."""

    solver: str
    best: np.ndarray  # [s], least of the repeats, one per instance that counts
    single: np.ndarray  # [s], every call of those
    instances: int
    closed: int
    fails: int
    unsolved: int
    gap: float
    excess: float

    def order(self):
        """Whose row this is to be: fewer fails first, then the faster."""
        return self.fails, quantiles(self.best)[0]


def seconds_of(record):
    """The solver's own clock where it has one: it leaves out the call from Python."""
    return record.get("own_seconds", record["seconds"])


def quantiles(values):
    """Median, 99th percentile, maximum."""
    if not len(values):
        return [float("nan")] * 3
    return [float(np.quantile(values, share, method="higher")) for share in (0.5, 0.99, 1.0)]


def groups(records):
    """{(arm, class, warm): {solver: Group}}, the classes followed by the rows over all of them."""
    easy = {(r["arm"], r["number"], r["warm"]) for r in records if r.get("closed_form")}
    sorted_records = {}
    for record in records:
        arm, warm = record["arm"], record["warm"]
        of_all = EASY if (arm, record["number"], warm) in easy else HARD
        for row in (record["class"], of_all):
            of_row = sorted_records.setdefault((arm, row, warm), {})
            of_row.setdefault(record["solver"], []).append(record)
    return {
        key: {solver: group(solver, by_solver[solver]) for solver in in_order(by_solver)}
        for key, by_solver in sorted_records.items()
    }


def in_order(solvers):
    """Ours first, whichever solver came first in a turn."""
    return sorted(set(solvers), key=lambda name: (not name.startswith(OURS), name.endswith("clarabel"), name))


def group(solver, records):
    """Statistics of one solver's records. Others' failures are counted, not timed: how long a solver takes to
    give up should not look like its speed. Ours are timed all the same."""
    timed = [r for r in records if r["passes"] or solver.startswith(OURS)]
    return Group(
        solver=solver,
        best=np.array([min(seconds_of(r)) for r in timed]),
        single=np.array([seconds for r in timed for seconds in seconds_of(r)]),
        instances=len(records),
        closed=sum(r.get("closed_form", False) for r in records),
        fails=sum(not r["passes"] for r in records),
        unsolved=sum(not r["solved"] for r in records),
        gap=max((r["gap"] for r in records if r["passes"]), default=float("nan")),
        excess=max((r["excess"] for r in records if r["passes"]), default=float("nan")),
    )


def columns(of_class):
    """Groups by column: our solvers, the better acados, the others."""
    acados = [group for solver, group in of_class.items() if solver.startswith(ACADOS)]
    shown = {solver: group for solver, group in of_class.items() if solver.startswith(OURS)}
    if acados:
        shown["acados, the better"] = min(acados, key=Group.order)
    return shown | {solver: g for solver, g in of_class.items() if g not in acados and solver not in shown}


def cell(found):
    """Median, p99, maximum in ms, fails, and which variant of acados."""
    text = "  ".join(f"{digits(1e3 * t) if t == t else '-':>6}" for t in quantiles(found.best))
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
    for arm, kind, warm in sorted(found, key=lambda key: (key[0], ROWS.index(key[1]), key[2])):
        shown = columns(found[arm, kind, warm])
        ours = next(group for solver, group in shown.items() if solver.startswith(OURS))
        theirs = {
            ACADOS: next((g for solver, g in shown.items() if solver.startswith(ACADOS)), None),
            IPOPT: shown.get(IPOPT),
        }
        if not rows:
            rows.append(["arm", "class", "n", "closed", "start", *shown, *RATIOS])
        count = [str(ours.instances), str(ours.closed)]
        cells = [cell(group) for group in shown.values()]
        rows.append([arm, kind, *count, "warm" if warm else "cold", *cells, *ratios(ours, theirs)])
    return rows


# Medians of others over ours, and our slowest over the median of the better acados.
RATIOS = ("acados/ours", "our max/acados", "ipopt/ours")


def ratios(ours, theirs):
    """The row's `RATIOS`."""
    median, _, slowest = quantiles(ours.best)
    of = {name: quantiles(group.best)[0] if group else float("nan") for name, group in theirs.items()}
    values = (of[ACADOS] / median, slowest / of[ACADOS], of[IPOPT] / median)
    return [digits(value) if value == value else "-" for value in values]


def aligned(rows):
    """The table for a terminal."""
    rows = [list(row) for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    cells = [[text.ljust(width) for text, width in zip(row, widths, strict=True)] for row in rows]
    lines = ["  ".join(row).rstrip() for row in cells]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def accuracy(records):
    """Worst cost above the optimum and worst excess among the moves that passed, and fails, per solver."""
    rows = [["solver", "limit", "solves", "fails", "said so", "other", "worst gap", "worst excess"]]
    for solver in in_order(r["solver"] for r in records):
        for soft in (False, True):
            of = [r for r in records if r["solver"] == solver and (r["class"] in SOFT) == soft]
            if not of:
                continue
            g = group(solver, of)
            failed = [r for r in of if not r["passes"]]
            said = sum(not r["solved"] for r in failed)
            kept = ["priced", "-"] if soft else ["kept", f"{g.excess:.1e} A²"]
            other = sum(r["other_optimum"] for r in of)
            counts = [str(count) for count in (len(of), g.fails, said, other)]
            rows.append([solver, kept[0], *counts, f"{g.gap:.1e}", kept[1]])
    return rows


def by_instance(records):
    """Median ratios to flexarm riccati over the instances, the header first."""
    rows = [["arm", "start", f"{ACADOS}/ours", f"{IPOPT}/ours"]]
    found = {ACADOS: [], IPOPT: []}
    for arm in sorted({r["arm"] for r in records}):
        for warm in (False, True):
            of = [r for r in records if (r["arm"], r["warm"]) == (arm, warm)]
            solvers = {
                solver: group(solver, [r for r in of if r["solver"] == solver])
                for solver in in_order(r["solver"] for r in of)
            }
            names = {name.split(",")[0]: g.solver for name, g in columns(solvers).items()}
            times = {(r["solver"], r["number"]): min(seconds_of(r)) for r in of if r["passes"]}
            row = {}
            for peer in found:
                numbers = [number for solver, number in times if solver == names.get(peer)]
                ours = f"{OURS} riccati"
                row[peer] = [times[names[peer], n] / times[ours, n] for n in numbers if (ours, n) in times]
                found[peer] += row[peer]
            rows.append([arm, "warm" if warm else "cold", *map(median, row.values())])
    return [*rows, ["all", "both", *map(median, found.values())]]


def median(ratios):
    """As text."""
    return digits(float(np.median(ratios))) if ratios else "-"


def summary(records):
    """What is stored: statistics of best and of single calls [s] per group."""
    return [
        {
            "arm": arm,
            "class": kind,
            "warm": warm,
            "solver": solver,
            "instances": g.instances,
            "closed_form": g.closed,
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
