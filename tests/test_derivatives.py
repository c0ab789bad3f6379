"""Partial derivatives of the plant against differences, and declared dependencies against both."""

from ctypes import c_double

import numpy as np
import pytest

from conftest import fmu
from fmus import CoSimulation, ModelExchange, parameters

STATES = ["angle", "velocity", "thermal_load", "hysteresis_state"]
INPUTS = ["torque", "disturbance_torque"]
DERIVATIVES = [f"der({name})" for name in STATES]
OUTPUTS = ["angle", "velocity", "current", "thermal_load", "thermal_fraction"]
UNKNOWNS = DERIVATIVES + OUTPUTS
KNOWNS = STATES + INPUTS
# Lower and upper ends of random states and inputs; torques beyond the peak saturate.
RANGES = np.array([(-3.0, 3.0), (-5.0, 5.0), (0.0, 20.0), (-1.0, 1.0), (-50.0, 50.0), (-20.0, 20.0)])


class Point:
    """The plant in Model Exchange at states and inputs of our choice."""

    def __init__(self, version: str):
        self.plant = ModelExchange(fmu(version, "FlexArmPlant"))
        self.plant.configure(parameters("tflex"))
        self.plant.initialize()
        self.plant.events()
        self.plant.fmu.enterContinuousTimeMode()

    def references(self, names: list[str]) -> list[int]:
        """Value references."""
        return [self.plant.variables[name].valueReference for name in names]

    def place(self, x: np.ndarray) -> None:
        """Put states and inputs there."""
        self.plant.fmu.setContinuousStates((c_double * 4)(*x[:4]), 4)
        for name, value in zip(INPUTS, x[4:], strict=True):
            self.plant.set(name, float(value))

    def values(self, x: np.ndarray) -> np.ndarray:
        """The unknowns there."""
        self.place(x)
        return np.array([self.plant.get(name) for name in UNKNOWNS])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Column by column through directional derivatives."""
        self.place(x)
        unknowns, knowns = self.references(UNKNOWNS), self.references(KNOWNS)
        directional = self.plant.fmu.getDirectionalDerivative
        return np.array([directional(unknowns, knowns, list(row)) for row in np.eye(len(knowns))]).T


@pytest.fixture
def point(version):
    point = Point(version)
    yield point
    point.plant.close()


def random_points(n: int) -> np.ndarray:
    """Away from the kinks of friction and saturation, where a difference has no meaning."""
    x = np.random.default_rng(5).uniform(RANGES[:, 0], RANGES[:, 1], (4 * n, len(RANGES)))
    smooth = (np.abs(x[:, 1]) > 1e-2) & (np.abs(np.abs(x[:, 4]) - 35.3) > 1e-2)
    return x[smooth][:n]


def differences(point: Point, x: np.ndarray) -> np.ndarray:
    """Central differences of fourth order."""
    columns = []
    for j in range(len(x)):
        h = np.zeros(len(x))
        h[j] = 1e-4
        near = point.values(x + h) - point.values(x - h)
        far = point.values(x + 2 * h) - point.values(x - 2 * h)
        columns.append((8 * near - far) / 12e-4)
    return np.array(columns).T


def test_directional_derivatives_are_the_differences_at_1000_states(point):
    worst = 0.0
    for x in random_points(1000):
        exact, difference = point.jacobian(x), differences(point, x)
        scale = np.abs(exact).max(axis=1, keepdims=True)
        worst = max(worst, (np.abs(exact - difference) / np.maximum(scale, 1e-3)).max())
    print(f"\nlargest deviation from differences, relative to the row: {worst:.1e}")
    assert worst < 1e-6


def test_adjoint_is_the_transpose(point, version):
    if version == "fmi2":
        assert not hasattr(point.plant.fmu, "getAdjointDerivative")
        return
    unknowns, knowns = point.references(UNKNOWNS), point.references(KNOWNS)
    for x, seed in zip(
        random_points(20), np.random.default_rng(6).normal(size=(20, len(unknowns))), strict=True
    ):
        jacobian = point.jacobian(x)
        adjoint = point.plant.fmu.getAdjointDerivative(unknowns, knowns, list(seed), len(knowns))
        assert np.allclose(adjoint, jacobian.T @ seed, rtol=1e-13, atol=1e-12)


def declared(plant: ModelExchange, section: str) -> dict[str, set[str]]:
    """Names that each unknown of a section of the model structure depends on."""
    return {u.variable.name: {v.name for v in u.dependencies} for u in getattr(plant.description, section)}


def test_dependencies_cover_the_truth_and_no_more(point):
    seen = np.zeros((len(UNKNOWNS), len(KNOWNS)), dtype=bool)
    for x in random_points(50):
        seen |= np.abs(differences(point, x)) > 1e-9
    dependencies = declared(point.plant, "derivatives") | declared(point.plant, "outputs")
    for i, name in enumerate(UNKNOWNS):
        assert dependencies[name] & set(KNOWNS) == {KNOWNS[j] for j in np.flatnonzero(seen[i])}, name


def test_initial_unknowns_by_every_parameter(version):
    """In Initialization Mode what depends on a parameter is declared; its derivative is the difference."""
    with CoSimulation(fmu(version, "FlexArmPlant")) as plant:
        plant.configure(parameters("tflex") | {"initial.velocity": "0.7", "initial.thermal_load": "3"})
        dependencies = declared(plant, "initialUnknowns")
        plant.enter_initialization()
        plant.set("torque", 5.0)
        plant.set("disturbance_torque", 1.0)
        references = [plant.variables[n].valueReference for n in UNKNOWNS]
        real = [
            v
            for v in plant.description.modelVariables
            if v.causality in ("parameter", "input") and v.type in ("Real", "Float64") and not v.dimensions
        ]
        for known in real:
            value = plant.get(known.name)
            h = 1e-5 * max(abs(value), 1e-3)
            if known.min is not None and value - h < float(known.min):
                continue
            sides = []
            for side in (value + h, value - h):
                plant.set(known.name, side)
                sides.append(np.array([plant.get(n) for n in UNKNOWNS]))
            plant.set(known.name, value)
            difference = (sides[0] - sides[1]) / (2 * h)
            exact = plant.fmu.getDirectionalDerivative(references, [known.valueReference], [1.0])
            assert np.allclose(exact, difference, rtol=1e-5, atol=1e-6), known.name
            for name, slope in zip(UNKNOWNS, difference, strict=True):
                assert abs(slope) < 1e-9 or known.name in dependencies[name], (name, known.name)
