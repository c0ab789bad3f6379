"""IPOPT and fatrop through CasADi: multiple shooting, stage by stage, exact Hessian.

`soft` problems carry one slack per thermal bound, priced as in `model.EXCESS_WEIGHT`.
"""

import hashlib
import subprocess
import time
from pathlib import Path

import casadi as ca
import numpy as np
from model import EXCESS_WEIGHT
from nlp import NP, NX, REFERENCE_ANGLE, THERMAL_LOAD, discrete, first_guess, task

FLAGS = ["-O3", "-march=native", "-fPIC", "-shared"]
# Bounds must not be relaxed: as little as 1e-7 A² shows in the priced excess. fatrop relaxes them by this
# share and cannot be told not to; it gets tighter ones.
FATROP_RELAXATION = 1e-8
OPTIONS = {
    "ipopt": {
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-8,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.mu_strategy": "adaptive",
    },
    "fatrop": {"fatrop.print_level": 0, "fatrop.tol": 1e-8},
}
# Added when a former solution is at hand.
WARM = {
    "ipopt": {
        "ipopt.mu_strategy": "monotone",
        "ipopt.mu_init": 1e-5,
        "ipopt.warm_start_init_point": "yes",
        "ipopt.warm_start_bound_push": 1e-8,
        "ipopt.warm_start_slack_bound_push": 1e-8,
        "ipopt.warm_start_mult_bound_push": 1e-8,
    },
    "fatrop": {"fatrop.mu_init": 1e-5},
}
# The yardstick: never timed.
REFERENCE = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-11,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 1000,
}
# Added for the yardstick to stay where it starts.
NEAR = {
    "ipopt.mu_init": 1e-7,
    "ipopt.bound_push": 1e-9,
    "ipopt.bound_frac": 1e-9,
    "ipopt.slack_bound_push": 1e-9,
    "ipopt.slack_bound_frac": 1e-9,
}


def compiled(solver, name, folder):
    """The shared library of a solver's functions; built anew only when its source changed."""
    folder.mkdir(parents=True, exist_ok=True)
    # Generated into the working directory: CasADi takes no path here.
    solver.generate_dependencies(f"{name}.c")
    source = Path(f"{name}.c").read_bytes()
    Path(f"{name}.c").unlink()
    library = folder / f"{name}_{hashlib.sha256(source).hexdigest()[:12]}.so"
    if not library.exists():
        (folder / f"{name}.c").write_bytes(source)
        command = ["cc", *FLAGS, str(folder / f"{name}.c"), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)
    return library


class Nlp:
    """The problem of one arm as a structured NLP: all of a stage's variables, then the next stage's."""

    def __init__(self, problem, soft, limited=True):
        self.problem, self.soft, self.limited = problem, soft, limited
        horizon = problem.horizon
        x, u, p, after, cost = discrete(problem)
        # A function of its own: generated code holds one step, not forty.
        step = ca.Function("step", [x, u, p], [after, cost], {"never_inline": True})
        self.nu = [int(k < horizon) + int(soft and k > 0) for k in range(horizon + 1)]
        variables = ca.MX.sym("w", sum(self.nu) + NX * (horizon + 1))
        initial, end = ca.MX.sym("initial", NX), ca.MX.sym("end", 2)
        parameters = ca.MX.sym("p", NP, horizon)
        ends = [0]
        for nu in self.nu:
            ends += [ends[-1] + NX, ends[-1] + NX + nu]
        parts = ca.vertsplit(variables, ends)
        states, controls = parts[0::2], parts[1::2]
        objective, constraints, self.equality, self.ng = 0.0, [], [], []
        for k, (state, control) in enumerate(zip(states, controls, strict=True)):
            path, equal = [], []
            if k < horizon:
                following, price = step(state, control[0], parameters[:, k])
                objective += price
                constraints.append(states[k + 1] - following)
                self.equality += [True] * NX
            if k == 0:
                path.append(state - initial)
                equal += [True] * NX
            elif soft:
                slack = control[self.nu[k] - 1]
                objective += EXCESS_WEIGHT * slack
                path.append(state[THERMAL_LOAD] - slack)
                equal.append(False)
            if k == horizon:
                path.append(state[:2] - end)
                equal += [True] * 2
            constraints += path
            self.equality += equal
            self.ng.append(len(equal))
        self.nlp = {
            "x": variables,
            "f": objective,
            "g": ca.vertcat(*constraints),
            "p": ca.vertcat(initial, end, ca.vec(parameters)),
        }
        self.bounds = self._bounds()

    def solver(self, plugin, options, folder):
        """A CasADi solver of this NLP, its functions compiled from C into `folder`."""
        options = {"print_time": False, "record_time": True, "error_on_fail": False, **options}
        if plugin == "fatrop":
            options |= {
                "structure_detection": "manual",
                "nx": [NX] * (self.problem.horizon + 1),
                "nu": self.nu,
                "ng": self.ng,
                "N": self.problem.horizon,
                "equality": self.equality,
            }
        interpreted = ca.nlpsol("solver", plugin, self.nlp, options)
        kind = ("soft" if self.soft else "hard") if self.limited else "free"
        name = f"{self.problem.arm}_{plugin}_{kind}"
        return ca.nlpsol("solver", plugin, str(compiled(interpreted, name, Path(folder))), options)

    def _bounds(self):
        problem, inf = self.problem, float("inf")
        lower, upper = [], []
        for k in range(problem.horizon + 1):
            low, high = [-inf] * NX, [inf] * NX
            if self.limited and 0 < k < problem.horizon:
                low[REFERENCE_ANGLE], high[REFERENCE_ANGLE] = problem.angle_lower, problem.angle_upper
            if self.limited and not self.soft and k > 0:
                high[THERMAL_LOAD] = problem.thermal_limit
            moves = 1 if k < problem.horizon else 0
            slacks = self.nu[k] - moves
            lower += low + [-inf] * moves + [0.0] * slacks
            upper += high + [inf] * (moves + slacks)
        limit = problem.thermal_limit
        return {
            "lbx": lower,
            "ubx": upper,
            "lbg": [0.0 if equal else -inf for equal in self.equality],
            "ubg": [0.0 if equal else limit for equal in self.equality],
        }

    def parameters(self, todo):
        """Parameters of a task."""
        return [*todo.start, *todo.end, *(value for stage in todo.stages for value in stage)]

    def pack(self, states, moves):
        """Variables of states and moves; slacks as large as they need be."""
        packed = []
        for k, state in enumerate(states):
            packed += state
            packed += moves[k : k + 1]
            if self.soft and k > 0:
                packed.append(max(0.0, state[THERMAL_LOAD] - self.problem.thermal_limit))
        return packed

    def moves(self, packed):
        """Moves among the variables."""
        packed, at, moves = packed.full().ravel(), 0, []
        for k in range(self.problem.horizon):
            moves.append(float(packed[at + NX]))
            at += NX + self.nu[k]
        return moves

    def shift(self, vector, sizes):
        """A vector of stages moved on by one stage; the last stage twice where the sizes allow it."""
        vector = vector.full().ravel()
        ends = [sum(sizes[: k + 1]) for k in range(len(sizes))]
        parts = [list(vector[end - size : end]) for end, size in zip(ends, sizes, strict=True)]
        shifted = []
        for k, part in enumerate(parts):
            following = parts[min(k + 1, len(parts) - 1)]
            shifted += following if len(following) == len(part) else part
        return shifted


def tightened(bounds, share):
    """Inequality bounds moved inwards by a share of their size, at least 1."""
    moved = {}
    for low, high in (("lbx", "ubx"), ("lbg", "ubg")):
        lower, upper = np.array(bounds[low]), np.array(bounds[high])
        room = np.where(lower < upper, share, 0.0)
        moved[low] = lower + room * np.maximum(1.0, np.abs(lower, where=np.isfinite(lower), out=0 * room))
        moved[high] = upper - room * np.maximum(1.0, np.abs(upper, where=np.isfinite(upper), out=0 * room))
    return moved


class CasadiSolver:
    """IPOPT or fatrop on one arm."""

    def __init__(self, problem, plugin, folder):
        self.name, self.problem = plugin, problem
        self.nlps = {soft: Nlp(problem, soft) for soft in (False, True)}
        self.solvers = {
            (soft, warm): nlp.solver(plugin, OPTIONS[plugin] | (WARM[plugin] if warm else {}), folder)
            for soft, nlp in self.nlps.items()
            for warm in (False, True)
        }
        share = FATROP_RELAXATION if plugin == "fatrop" else 0.0
        self.bounds = {soft: tightened(nlp.bounds, share) for soft, nlp in self.nlps.items()}
        self.last = None

    def solve(self, instance, warm, repeats):
        """Solves an instance; warm: from the last cold solution, moved on by one stage."""
        nlp = self.nlps[instance.soft]
        solver = self.solvers[instance.soft, warm]
        todo = task(self.problem, instance)
        start = {"p": nlp.parameters(todo), **self.bounds[instance.soft]}
        if warm and self.last is not None:
            sizes = [NX + nu for nu in nlp.nu]
            rows = [NX + ng for ng in nlp.ng]
            rows[-1] -= NX
            start["x0"] = nlp.shift(self.last["x"], sizes)
            start["x0"][:NX] = todo.start
            start["lam_x0"] = nlp.shift(self.last["lam_x"], sizes)
            start["lam_g0"] = nlp.shift(self.last["lam_g"], rows)
        else:
            start["x0"] = nlp.pack(*first_guess(self.problem, todo))
        start = {key: ca.DM(value) for key, value in start.items()}
        seconds, own_seconds = [], []
        for _ in range(repeats):
            begin = time.perf_counter()
            solution = solver(**start)
            seconds.append(time.perf_counter() - begin)
            stats = solver.stats()
            own_seconds.append(float(stats["t_wall_total"]))
        if not warm:
            self.last = solution if stats["success"] else None
        return {
            "seconds": seconds,
            "own_seconds": own_seconds,
            "solved": bool(stats["success"]),
            "status": str(stats["return_status"]),
            "iterations": int(stats.get("iter_count", -1)),
            "moves": nlp.moves(solution["x"]),
        }
