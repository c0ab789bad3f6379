"""CasADi imports the plant as a function, for optimal control, and takes its derivatives from the FMU."""

import numpy as np
import pytest
from fmpy import simulate_fmu

from conftest import fmu

casadi = pytest.importorskip("casadi", reason="CasADi has no package for this platform")

STATES = ["angle", "velocity", "thermal_load", "hysteresis_state"]
INPUTS = ["torque", "disturbance_torque"]
H = 1e-6


@pytest.fixture
def dynamics(version):
    """dx/dt as a function of states and inputs."""
    plant = casadi.DaeBuilder("plant", str(fmu(version, "FlexArmPlant")))
    assert (plant.x(), plant.u()) == (STATES, INPUTS)
    return plant.create("dynamics", ["x", "u"], ["ode"])


def test_the_jacobian_is_that_of_the_dynamics(dynamics):
    jacobian = dynamics.factory("jacobian", ["x", "u"], ["jac:ode:x", "jac:ode:u"])
    random = np.random.default_rng(1)
    worst = 0.0
    for _ in range(100):
        x = random.uniform([1.0, -5.0, 0.0, -0.9], [1.6, 5.0, 20.0, 0.9])
        u = random.uniform(-1.0, 1.0, 2)
        exact = np.hstack([np.array(casadi.densify(block)) for block in jacobian(x, u)])
        found = np.empty_like(exact)
        for i in range(6):
            dx, du = np.split(H * np.eye(6)[i], [4])
            change = dynamics(x + dx, u + du) - dynamics(x - dx, u - du)
            found[:, i] = np.array(change).ravel() / (2 * H)
        worst = max(worst, float(np.abs(found - exact).max() / np.abs(exact).max()))
    print(f"\nworst relative difference to finite differences: {worst:.1e}")
    assert worst < 1e-6


def test_its_integrator_goes_where_that_of_fmpy_goes(dynamics, version):
    """Half a second of a torque from rest, both in CVODES."""
    start, torque, end = [1.3, 0.0, 0.0, 0.0], 3.5, 0.5
    x, u = casadi.MX.sym("x", 4), casadi.MX.sym("u", 2)
    options = {"abstol": 1e-10, "reltol": 1e-10}
    integrator = casadi.integrator("move", "cvodes", {"x": x, "p": u, "ode": dynamics(x, u)}, 0, end, options)
    found = float(integrator(x0=start, p=[torque, 0.0])["xf"][0])
    expected = simulate_fmu(
        str(fmu(version, "FlexArmPlant")),
        fmi_type="ModelExchange",
        relative_tolerance=1e-9,
        stop_time=end,
        start_values={"torque": torque, "initial.angle": start[0]},
        output=["angle"],
    )["angle"][-1]
    print(f"\n{found:.6f} rad by CasADi, {found - expected:.1e} rad from FMPy's")
    assert abs(expected - start[0]) > 0.01
    assert abs(found - expected) < 1e-8
