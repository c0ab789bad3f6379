"""acados: SQP with the exact Hessian and HPIPM, the model and cost as discrete RK4 steps.

The package is kept in a folder of its own, for it brings a CasADi that must not replace ours.
"""

import ctypes
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
from model import EXCESS_WEIGHT
from nlp import NP, NX, REFERENCE_ANGLE, REFERENCE_VELOCITY, THERMAL_LOAD, discrete, first_guess, task

# acados wants a lower bound of T as well; T ≥ 0 always, so this one never matters [A²].
FAR = 10.0

VARIANTS = {
    "acados full": {"qp_solver": "FULL_CONDENSING_HPIPM"},
    "acados partial": {"qp_solver": "PARTIAL_CONDENSING_HPIPM", "qp_solver_cond_N": 8},
}
# The loosest tolerances with which all moves pass the check. SPEED of HPIPM fails on one active instance in
# six, step length control and regularisation of the hard problems only cost time.
OPTIONS = {
    "nlp_solver_type": "SQP",
    "hessian_approx": "EXACT",
    "integrator_type": "DISCRETE",
    "regularize_method": "NO_REGULARIZE",
    "hpipm_mode": "BALANCE",
    "nlp_solver_max_iter": 100,
    "nlp_solver_tol_stat": 1e-4,
    "nlp_solver_tol_eq": 1e-7,
    "nlp_solver_tol_ineq": 5e-7,
    "nlp_solver_tol_comp": 1e-6,
    "qp_solver_iter_max": 100,
    "ext_fun_compile_flags": "-O3 -march=native",
}
# Neither warm starts of the QPs nor a line search help: the same iterations, or more.
# Where the excess is priced, large multipliers make the Hessian indefinite, and its price asks for care.
SOFT_OPTIONS = {
    "regularize_method": "PROJECT",
    "nlp_solver_tol_eq": 1e-8,
    "nlp_solver_tol_ineq": 1e-7,
    "nlp_solver_tol_comp": 1e-7,
}
# Far above the limit the price dwarfs the cost. Measured in such units, objective and tolerance, acados
# solves what it otherwise mostly does not; on the instances just above it would need far more iterations.
FAR_UNIT = 1e3


def load(folder):
    """Makes acados of `folder` importable."""
    install = Path(folder) / "acados" / "install"
    link = install / "interfaces" / "acados_template" / "acados_template"
    if not link.exists():
        link.parent.mkdir(parents=True, exist_ok=True)
        link.unlink(missing_ok=True)  # the folder may have moved since
        link.symlink_to(Path(folder) / "acados" / "acados_template")
    os.environ["ACADOS_SOURCE_DIR"] = str(install)
    os.environ["TERA_PATH"] = str(install / "bin" / "t_renderer")
    sys.path.insert(0, str(link.parent))
    for library in ("blasfeo", "hpipm", "qpOASES_e", "acados"):
        ctypes.CDLL(str(install / "lib" / f"lib{library}.so"), mode=ctypes.RTLD_GLOBAL)


class AcadosSolver:
    """One variant of acados on one arm."""

    def __init__(self, problem, name, folder):
        self.name, self.problem = name, problem
        self.folder = Path(folder)
        self.options = OPTIONS | VARIANTS[name]
        self.solvers = {soft: self._build(soft) for soft in (False, True)}
        self.last = None

    def _build(self, soft):
        from acados_template import AcadosOcp, AcadosOcpSolver

        problem, horizon = self.problem, self.problem.horizon
        key = f"{problem.arm}_{self.name}_{'soft' if soft else 'hard'}".replace(" ", "_").replace("-", "_")
        ocp = AcadosOcp()
        x, u, p, after, cost = discrete(problem)
        model = ocp.model
        model.name, model.x, model.u, model.p = key, x, u, p
        model.disc_dyn_expr = after
        # acados weighs a stage by its length.
        model.cost_expr_ext_cost = cost / problem.period
        model.cost_expr_ext_cost_e = ca.SX(0.0)
        ocp.dims.N = horizon
        ocp.parameter_values = np.array([0.0, 1.0] + [0.0] * (NP - 2))
        ocp.cost.cost_type = ocp.cost.cost_type_e = "EXTERNAL"

        limit = problem.thermal_limit
        ocp.constraints.x0 = np.zeros(NX)
        ocp.constraints.idxbx = np.array([REFERENCE_ANGLE, THERMAL_LOAD])
        ocp.constraints.lbx = np.array([problem.angle_lower, -FAR])
        ocp.constraints.ubx = np.array([problem.angle_upper, limit])
        ocp.constraints.idxbx_e = np.array([REFERENCE_ANGLE, REFERENCE_VELOCITY, THERMAL_LOAD])
        ocp.constraints.lbx_e = np.array([0.0, 0.0, -FAR])
        ocp.constraints.ubx_e = np.array([0.0, 0.0, limit])
        if soft:
            ocp.constraints.idxsbx, ocp.constraints.idxsbx_e = np.array([1]), np.array([2])
            price = np.array([EXCESS_WEIGHT / problem.period])
            ocp.cost.zl = ocp.cost.zu = price
            ocp.cost.Zl = ocp.cost.Zu = np.zeros(1)
            ocp.cost.zl_e = ocp.cost.zu_e = np.array([EXCESS_WEIGHT])
            ocp.cost.Zl_e = ocp.cost.Zu_e = np.zeros(1)

        settings = ocp.solver_options
        settings.tf = horizon * problem.period
        for name, value in (self.options | (SOFT_OPTIONS if soft else {})).items():
            setattr(settings, name, value)
        self.folder.mkdir(parents=True, exist_ok=True)
        ocp.code_export_directory = str(self.folder / key)
        return AcadosOcpSolver(ocp, json_file=str(self.folder / f"{key}.json"), verbose=False)

    def solve(self, instance, warm, repeats):
        """Solves an instance; warm: from the last cold solution, moved on by one stage."""
        solver = self.solvers[instance.soft]
        horizon = self.problem.horizon
        unit = FAR_UNIT if instance.kind == "far over" else 1.0
        todo = task(self.problem, replace(instance, cost_scale=unit * instance.cost_scale))
        start = np.array(todo.start)
        if instance.soft:
            self._price(solver, unit)
        for k, parameters in enumerate(todo.stages):
            solver.set(k, "p", np.array(parameters))
        solver.constraints_set(0, "lbx", start)
        solver.constraints_set(0, "ubx", start)
        for bound, load in (("lbx", -FAR), ("ubx", self.problem.thermal_limit)):
            solver.constraints_set(horizon, bound, np.array([*todo.end, load]))
        guess = self._shifted(start) if warm and self.last else self._first(todo)
        seconds, own_seconds = [], []
        for _ in range(repeats):
            solver.reset()
            for field, stages in guess.items():
                for k, value in enumerate(stages):
                    solver.set(k, field, value)
            begin = time.perf_counter()
            status = solver.solve()
            seconds.append(time.perf_counter() - begin)
            own_seconds.append(float(solver.get_stats("time_tot")[0]))
        if not warm:
            self.last = self._iterate(solver) if status == 0 else None
        return {
            "seconds": seconds,
            "own_seconds": own_seconds,
            "solved": status == 0,
            "status": str(status),
            "iterations": int(solver.get_stats("sqp_iter")[0]),
            "moves": [float(solver.get(k, "u")[0]) for k in range(horizon)],
        }

    def _price(self, solver, unit):
        """Measures the objective in a unit: the price of excess, and the tolerance of its gradient."""
        horizon = self.problem.horizon
        for k in range(1, horizon + 1):
            price = EXCESS_WEIGHT / unit / (self.problem.period if k < horizon else 1.0)
            for side in ("zl", "zu"):
                solver.cost_set(k, side, np.array([price]))
        solver.options_set("tol_stat", OPTIONS["nlp_solver_tol_stat"] / unit)

    def _first(self, todo):
        states, moves = first_guess(self.problem, todo)
        return {"x": [np.array(x) for x in states], "u": [np.array([u]) for u in moves]}

    def _iterate(self, solver):
        horizon = self.problem.horizon
        fields = {"x": horizon + 1, "u": horizon, "pi": horizon, "lam": horizon + 1}
        if solver is self.solvers[True]:
            fields |= {"sl": horizon + 1, "su": horizon + 1}
        return {field: [solver.get(k, field) for k in range(count)] for field, count in fields.items()}

    def _shifted(self, start):
        """Stages moved on by one where the following one is of the same size."""
        shifted = {}
        for field, stages in self.last.items():
            following = [*stages[1:], stages[-1]]
            shifted[field] = [b if b.shape == a.shape else a for a, b in zip(stages, following, strict=True)]
        shifted["x"][0] = start
        return shifted
