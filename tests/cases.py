"""The closed loops that every client runs, whatever its language: parameters, inputs over time, score."""

import csv
import json
from dataclasses import dataclass, field
from pathlib import Path

import fmpy

from conftest import DIST, ROOT
from fmus import ENUMERATIONS, SAMPLE, parameters
from test_disturbance import settings
from test_host import schedule, sets


@dataclass(frozen=True)
class Case:
    """Parameters, and what setpoint and disturbance torque are from which time on."""

    arm: str
    schedule: tuple[tuple[float, float, float], ...]
    until: float
    changes: dict[str, object] = field(default_factory=dict)
    model_error: str | None = None

    @property
    def samples(self) -> int:
        """Samples of the controller, and communication steps."""
        return round(self.until / SAMPLE)

    @property
    def first(self) -> int:
        """First sample that is scored, as our host does it: that of the first move, or else of the run."""
        goals = {sample: setpoint for sample, (setpoint, _) in self.inputs.items()}
        return next((sample for sample, goal in goals.items() if goal != goals[0]), 0)

    @property
    def values(self) -> dict[str, object]:
        """Parameters of both units."""
        return parameters(self.arm) | self.changes

    @property
    def controller(self) -> dict[str, object]:
        """Parameters of the controller alone, after those of both."""
        return parameters(self.model_error) if self.model_error else {}

    @property
    def inputs(self) -> dict[int, tuple[float, float]]:
        """Setpoint and disturbance torque by the sample from which on they hold."""
        return {round(time / SAMPLE): (setpoint, push) for time, setpoint, push in self.schedule}

    def at(self, time: float) -> tuple[float, float]:
        """Setpoint and disturbance torque at a time."""
        return [values for sample, values in self.inputs.items() if sample <= round(time / SAMPLE)][-1]

    def score(self, angles) -> float:
        """Squared error summed over the samples; `angles` are those at each of them."""
        inputs, first, goal, total = self.inputs, self.first, 0.0, 0.0
        for k, angle in zip(range(self.samples), angles, strict=True):
            if k in inputs:
                goal, _ = inputs[k]
            if k >= first:
                total += (goal - angle) ** 2
        return total

    def run(self, loop, order: str) -> float:
        """The score of a pair that its client steps, as `fmus.Loop` does."""
        inputs, step = self.inputs, getattr(loop, order.replace("-", "_"))
        loop.initialize(self.schedule[0][1])

        def angles():
            for k in range(self.samples):
                yield loop.plant.get("angle")
                if k in inputs:
                    setpoint, push = inputs[k]
                    loop.controller.set("setpoint", setpoint)
                    loop.plant.set("disturbance_torque", push)
                step(k * SAMPLE)

        return self.score(angles())

    def for_host(self, folder: Path) -> list:
        """Arguments of `flexarm simulate` for the pair."""
        columns = ["time", "setpoint", "disturbance_torque"]
        inputs = schedule(folder / "inputs.csv", columns, self.schedule)
        words = ["--parameters", DIST / "parameters" / f"{self.arm}.ssv"]
        if self.model_error:
            words += ["--parameters", f"controller={DIST / 'parameters' / self.model_error}.ssv"]
        return [*words, *sets(self.changes), "--setpoints", inputs, "--until", self.until]

    def as_json(self, controller: Path, plant: Path, order: str) -> str:
        """For a client that knows nothing of parameter files: values by type and value reference."""

        def unit(path: Path, values: dict) -> dict:
            return {"fmu": str(path), "parameters": resolve(path, values)}

        units = {
            "controller": unit(controller, self.values | self.controller),
            "plant": unit(plant, self.values),
        }
        inputs = [[sample, *values] for sample, values in self.inputs.items()]
        loop = {"step": SAMPLE, "samples": self.samples, "first": self.first, "order": order}
        return json.dumps(units | loop | {"inputs": inputs})


def resolve(path: Path, values: dict) -> list[dict]:
    """Values of a unit by type and value reference; an array of FMI 3.0 is set at once."""
    variables = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    found = {}
    for name, value in values.items():
        if name in variables:
            variable, values_so_far = variables[name], []
        elif (array := name.split("[")[0]) in variables:
            # Parameter sets list the elements of an array in order, and all of them.
            variable, values_so_far = variables[array], found.get(array, {"values": []})["values"]
        else:
            continue
        kind = {"Float64": "Real", "Int32": "Integer"}.get(variable.type, variable.type)
        if kind == "Boolean":
            value = value in (True, "true", "1")
        else:
            value = ENUMERATIONS.get(name, {}).get(value, value)
            value = float(value) if kind == "Real" else int(value)
        found[variable.name] = {
            "type": kind,
            "reference": variable.valueReference,
            "values": [*values_so_far, value],
        }
    return list(found.values())


def tflex_setpoints(until: float) -> tuple[tuple[float, float, float], ...]:
    """The setpoints that `cargo xtask demo` follows."""
    with (ROOT / "packaging" / "assets" / "tflex-setpoints.csv").open() as file:
        rows = [(float(row["time"]), float(row["setpoint"]), 0.0) for row in csv.DictReader(file)]
    return tuple(row for row in rows if row[0] < until)


CASES = {
    # Table 3 of the paper, LQRI/MPC: pushed at rest, the controller's model a little wrong.
    "pendulum": Case(
        "pendulum",
        ((0.0, 1.0, 0.0), (5.0, 1.0, 30.0), (5.25, 1.0, 0.0), (12.0, 1.0, 27.0), (20.0, 1.0, 0.0)),
        25.0,
        settings("LQRI/MPC"),
        "pendulum-model-error",
    ),
    "T-flex": Case("tflex", tflex_setpoints(10.0), 10.0),
}
