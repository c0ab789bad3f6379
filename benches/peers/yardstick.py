"""IPOPT at tight tolerances: what an instance's optimum is, and whether the instance is of its class."""

from dataclasses import replace

from casadi_solvers import NEAR, REFERENCE, Nlp
from model import THERMAL_TOLERANCE, simulate
from nlp import first_guess, reduced, task

# Classes of which the thermal limit must decide.
DECIDED_BY_HEAT = ("active", "starved")


class Yardstick:
    """Optima for one arm; never timed."""

    def __init__(self, problem, folder):
        self.problem = problem
        self.free = Nlp(problem, soft=False, limited=False)
        self.nlps = {soft: Nlp(problem, soft) for soft in (False, True)}
        self.free_solver = self.free.solver("ipopt", REFERENCE, folder)
        self.solvers, self.near_solvers = (
            {soft: nlp.solver("ipopt", options, folder) for soft, nlp in self.nlps.items()}
            for options in (REFERENCE, REFERENCE | NEAR)
        )

    def complete(self, instance, successor=False):
        """The instance with cost scale and optimum, and the optimal moves; none where IPOPT found no optimum,
        or where the first of a pair is not of its class."""
        moves, success = self._solve(self.free, self.free_solver, replace(instance, cost_scale=1.0))
        free = simulate(self.problem, instance.initial, instance.goal, moves)
        over = free.excess > THERMAL_TOLERANCE
        if not success or (instance.kind in DECIDED_BY_HEAT and not successor and not over):
            return instance, None
        instance = replace(instance, cost_scale=free.cost)
        if over or free.angle_excess > 0.0:
            nlp = self.nlps[instance.soft]
            moves, success = self._solve(nlp, self.solvers[instance.soft], instance)
        check = simulate(self.problem, instance.initial, instance.goal, moves)
        return replace(instance, optimum=check.objective(instance)), moves if success else None

    def nearest(self, instance, moves):
        """The instance with the optimum that IPOPT finds from `moves` as its own.

        Far above the thermal limit there may be several: an answer must not count as wrong for being another
        one than IPOPT found from its first guess.
        """
        states = [reduced(x) for x in simulate(self.problem, instance.initial, instance.goal, moves).nodes]
        nlp, solver = self.nlps[instance.soft], self.near_solvers[instance.soft]
        found, success = self._solve(nlp, solver, instance, (states, moves))
        check = simulate(self.problem, instance.initial, instance.goal, found)
        return replace(instance, optimum=check.objective(instance)) if success else instance

    def _solve(self, nlp, solver, instance, start=None):
        todo = task(self.problem, instance)
        guess = nlp.pack(*(start or first_guess(self.problem, todo)))
        solution = solver(x0=guess, p=nlp.parameters(todo), **nlp.bounds)
        return nlp.moves(solution["x"]), solver.stats()["success"]
