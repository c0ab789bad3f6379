"""Our solvers, asked through `flexarm-benches serve`."""

import json
import subprocess

from model import Problem


class Server:
    """A running `flexarm-benches serve`; it inherits this process's core."""

    def __init__(self, binary):
        self.process = subprocess.Popen(
            [binary, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, **request):
        """The answer to one request."""
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            raise RuntimeError(f"flexarm-benches serve: {answer['error']}")
        return answer

    def solvers(self):
        """Names of our solvers."""
        return self.ask(solvers=True)["solvers"]

    def problem(self, arm):
        """Numbers of an arm's problem."""
        return Problem(arm=arm, **self.ask(problem=arm))

    def close(self):
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()


class OurSolver:
    """One of our solvers on one arm."""

    # Outcomes that are plans to tolerance, not fallbacks.
    SOLVED = ("Solved", "GoalProjected", "ThermalSlack")

    def __init__(self, server, arm, solver):
        self.server, self.arm, self.solver = server, arm, solver
        self.name = f"flexarm {solver}"

    def solve(self, instance, warm, repeats):
        """Solves an instance; warm: after the last cold plan."""
        answer = self.server.ask(
            arm=self.arm,
            solver=self.solver,
            initial=instance.initial,
            goal=instance.goal,
            warm=warm,
            repeats=repeats,
        )
        solved = answer["status"] in self.SOLVED
        return answer | {"solved": solved, "closed_form": solved and answer["iterations"] == 0}
