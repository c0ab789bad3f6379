"""Every solver on every instance, in turn, on one core."""

import contextlib
import gc
import math
import os

import acados_solver
import instances
from casadi_solvers import CasadiSolver
from model import simulate
from ours import OurSolver
from tqdm import tqdm
from yardstick import Yardstick

# Moves beyond this have diverged [rad/s²].
LARGEST = 1e9
# What is kept of an answer.
KEPT = ("seconds", "own_seconds", "status", "iterations", "solved", "closed_form")


def pin(core):
    """Binds this process and those it starts to one core; which one, if the platform can."""
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    if not hasattr(os, "sched_setaffinity"):
        return None
    core = max(os.sched_getaffinity(0)) if core is None else core
    os.sched_setaffinity(0, {core})
    return core


@contextlib.contextmanager
def silent():
    """Keeps C libraries from writing to the terminal."""
    terminal, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(terminal, 1)
        os.close(terminal)
        os.close(nowhere)


def solvers_of(server, problem, build, acados):
    """All solvers for an arm, and what keeps others from taking part."""
    solvers = [OurSolver(server, problem.arm, name) for name in server.solvers()]
    absent = {}
    if acados:
        for name in acados_solver.VARIANTS:
            try:
                solvers.append(acados_solver.AcadosSolver(problem, name, build / "acados"))
            except Exception as error:
                absent[name] = str(error)
    for name in ("fatrop", "ipopt"):
        try:
            solvers.append(CasadiSolver(problem, name, build))
        except Exception as error:
            absent[name] = str(error)
    return solvers, absent


def run(server, arm, counts, options, folders, acados):
    """Records of one arm, and the solvers that could not take part."""
    problem = server.problem(arm)
    build = folders["build"]
    build.mkdir(parents=True, exist_ok=True)
    print(f"{arm}: generating and compiling the peers' models; a few minutes at first ...", flush=True)
    with contextlib.chdir(build), silent():
        yardstick = Yardstick(problem, build)
        solvers, absent = solvers_of(server, problem, build, acados)
        total = sum(counts.values()) + len(instances.golden(problem, folders["golden"]))
        with tqdm(total=total, desc=f"{arm}: instances", unit="", leave=False, disable=None) as bar:
            drawn = instances.pairs(problem, yardstick, folders["golden"], counts, options.seed, bar.update)
        for solver in solvers:
            # The first calls load code and fill caches.
            for warm, instance in enumerate(drawn[0]):
                solver.solve(instance, bool(warm), 2)
        records = []
        gc.disable()
        for number, (first, second) in enumerate(
            tqdm(drawn, desc=f"{arm}: solve", unit="", leave=False, disable=None)
        ):
            for warm, instance in ((False, first), (True, second)):
                # Nobody always comes first.
                turn = number % len(solvers)
                for solver in solvers[turn:] + solvers[:turn]:
                    answer = solver.solve(instance, warm, options.repeats)
                    records.append(record(problem, yardstick, instance, number, warm, solver.name, answer))
            gc.collect()
        gc.enable()
    return records, absent


def record(problem, yardstick, instance, number, warm, solver, answer):
    """What a solver did on an instance, judged by its moves alone."""
    finite = all(abs(u) < LARGEST for u in answer["moves"])
    moves = answer["moves"] if finite else [math.nan] * problem.horizon
    check = simulate(problem, instance.initial, instance.goal, moves)
    admissible = finite and check.admissible(instance)
    optimal = admissible and check.optimal(instance)
    other = False
    if admissible and instance.soft and not optimal:
        near = yardstick.nearest(instance, moves)
        other = optimal = check.optimal(near)
        instance = near if other else instance
    entry = {
        "arm": instance.arm,
        "class": instance.kind,
        "number": number,
        "warm": warm,
        "solver": solver,
        **{key: answer[key] for key in KEPT if key in answer},
        "passes": optimal,
        "other_optimum": other,
        "gap": check.gap(instance),
        "excess": 0.0 if instance.soft else check.excess,
        "angle_excess": check.angle_excess,
        "rest_error": check.rest_error,
    }
    if not math.isnan(instance.noted_cost):
        entry["optimum_to_noted"] = instance.optimum * instance.cost_scale / instance.noted_cost - 1.0
    return entry
