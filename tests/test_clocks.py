"""FMI 3.0 alone: Event Mode in Co-Simulation, clocks ticked by the importer, Scheduled Execution.

However the controller is driven, the same angles at the same instants give the same torques, to the bit.
"""

from ctypes import c_double, c_int, c_uint32
from functools import wraps
from threading import Event, Lock, Thread

import pytest
from fmpy import simulate_fmu
from fmpy.fmi3 import (
    FMU3ScheduledExecution,
    fmi3LockPreemptionCallback,
    fmi3UnlockPreemptionCallback,
)

from conftest import fmu
from fmus import SAMPLE, CoSimulation, EventfulCoSimulation, Instance, Loop, ModelExchange, hot_pendulum

SAMPLES = 1200
PER_PLAN = 200
OUTPUTS = ("torque", "reference.angle", "feedback_torque", "nmpc.status", "nmpc.iterations", "nmpc.cost")


def setpoint(k: int) -> float:
    """Setpoint at sample k: the motor is hot, so that plans take the solver."""
    return 1.2 if k < 500 else 0.4


@pytest.fixture(scope="module")
def recorded() -> dict[float, list[tuple[float, list]]]:
    """By latency: angle and outputs at each sample of a plain co-simulation."""
    found = {}
    for latency in (0.0, SAMPLE, 0.025):
        values = hot_pendulum() | {"nmpc.latency": str(latency)}
        rows = []
        with Loop("fmi3", values) as loop:
            loop.initialize(setpoint(0))
            for k in range(SAMPLES):
                angle = loop.plant.get("angle")
                loop.controller.set("setpoint", setpoint(k))
                loop.sequential(k * SAMPLE)
                rows.append((angle, [loop.controller.get(name) for name in OUTPUTS]))
        assert any(row[1][4] > 0 for row in rows), "the solver never worked"
        found[latency] = rows
    return found


class Preemptible(FMU3ScheduledExecution):
    """Scheduled Execution whose preemption locks are real; FMPy's do nothing."""

    @wraps(FMU3ScheduledExecution.fmi3InstantiateScheduledExecution)
    def fmi3InstantiateScheduledExecution(self, *arguments):
        """Puts a lock between the threads of the partitions in the place of FMPy's last two arguments."""
        mutex = Lock()
        self.unlocked = Event()

        def lock():
            mutex.acquire()

        def unlock():
            mutex.release()
            self.unlocked.set()

        self.locks = [fmi3LockPreemptionCallback(lock), fmi3UnlockPreemptionCallback(unlock)]
        return super().fmi3InstantiateScheduledExecution(*arguments[:-2], *self.locks)


class ScheduledExecution(Instance):
    """One instance for Scheduled Execution."""

    clients = (None, Preemptible)


def clocks(unit: Instance) -> dict[str, tuple[int, float]]:
    """Value reference and interval of each clock."""
    names = [v.name for v in unit.description.modelVariables if v.type == "Clock"]
    found = {}
    for name in names:
        reference, interval, qualifier = unit.variables[name].valueReference, c_double(), c_int()
        unit.fmu.getIntervalDecimal((c_uint32 * 1)(reference), interval, qualifier)
        assert qualifier.value == 2, "fmi3IntervalChanged in Initialization Mode"
        found[name] = (reference, interval.value)
    return found


def start(unit: Instance, values: dict) -> tuple[int, int]:
    """Go through Initialization Mode; the references of clock.feedback and clock.plan."""
    unit.configure(values)
    unit.initialize()
    feedback, plan = (unit.variables[f"clock.{name}"].valueReference for name in ("feedback", "plan"))
    return feedback, plan


def tick(unit: Instance, *references: int) -> None:
    """Activate clocks and update the discrete states."""
    unit.fmu.setClock(list(references), [True] * len(references))
    *_, defined, _ = unit.fmu.updateDiscreteStates()
    assert not defined, "clocks make the events, not time"


def assert_row(unit: Instance, k: int, row: tuple[float, list]) -> None:
    """The outputs are those of the plain co-simulation at sample k."""
    assert [unit.get(name) for name in OUTPUTS] == row[1], k


def apply(unit: Instance, k: int, row: tuple[float, list]) -> None:
    """The inputs of sample k."""
    unit.set("angle", row[0])
    unit.set("setpoint", setpoint(k))


def test_intervals_are_parameters():
    with CoSimulation(fmu("fmi3", "FlexArmController")) as unit:
        unit.configure({"sample_period": "0.001", "nmpc.period": "0.02"})
        unit.enter_initialization()
        found = clocks(unit)
        assert {name: interval for name, (_, interval) in found.items()} == {
            "clock.feedback": 0.001,
            "clock.plan": 0.02,
        }
        reference = (c_uint32 * 1)(found["clock.plan"][0])
        unit.fmu.setIntervalDecimal(reference, (c_double * 1)(0.1))
        assert unit.get("nmpc.period") == 0.1


@pytest.mark.parametrize("interface", [EventfulCoSimulation, ModelExchange])
def test_clocks_take_the_place_of_time(recorded, interface):
    rows = recorded[0.0]
    with interface(fmu("fmi3", "FlexArmController")) as unit:
        feedback, plan = start(unit, hot_pendulum())
        for k, row in enumerate(rows):
            apply(unit, k, row)
            tick(unit, *([feedback, plan] if k % PER_PLAN == 0 else [feedback]))
            assert_row(unit, k, row)
            if interface is ModelExchange:
                unit.fmu.enterContinuousTimeMode()
                unit.fmu.setTime((k + 1) * SAMPLE)
            else:
                unit.fmu.enterStepMode()
                *flags, last = unit.fmu.doStep(k * SAMPLE, SAMPLE)
                assert not any(flags) and last == pytest.approx((k + 1) * SAMPLE, abs=1e-12)
            unit.fmu.enterEventMode()


def test_event_mode_without_clocks(recorded):
    """Steps of 1.3 samples end at each sample, where the importer sets the inputs and updates."""
    with EventfulCoSimulation(fmu("fmi3", "FlexArmController")) as unit:
        start(unit, hot_pendulum())
        time = 0.0
        for k, row in enumerate(recorded[0.0]):
            apply(unit, k, row)
            _, _, _, _, defined, instant = unit.fmu.updateDiscreteStates()
            assert defined and instant == pytest.approx((k + 1) * SAMPLE, abs=1e-12)
            assert_row(unit, k, row)
            unit.fmu.enterStepMode()
            event, _, early, time = unit.fmu.doStep(time, 1.3 * SAMPLE)
            assert event and early and time == instant
            unit.fmu.enterEventMode()


@pytest.mark.parametrize("latency", [SAMPLE, 0.025])
def test_scheduled_execution_is_the_delayed_planner(recorded, latency):
    """The planner in a thread of its own, preempted by every sample in between.

    A plan that is ready when its latency has gone by is the same plan, to the bit.
    """
    with ScheduledExecution(fmu("fmi3", "FlexArmController")) as unit:
        feedback, plan = start(unit, hot_pendulum() | {"nmpc.latency": str(latency)})
        planner = None
        for k, row in enumerate(recorded[latency]):
            if planner is not None and k % PER_PLAN == round(latency / SAMPLE):
                planner.join()
            apply(unit, k, row)
            unit.fmu.activateModelPartition(feedback, k * SAMPLE)
            # Cost and iterations come with the plan, which may be ready sooner or later.
            names = [name for name in OUTPUTS if name not in ("nmpc.iterations", "nmpc.cost")]
            wanted = dict(zip(OUTPUTS, row[1], strict=True))
            assert {name: unit.get(name) for name in names} == {name: wanted[name] for name in names}, k
            if k % PER_PLAN == 0:
                planner = Thread(target=unit.fmu.activateModelPartition, args=(plan, k * SAMPLE))
                unit.fmu.unlocked.clear()
                planner.start()
                # It has looked at this sample; from now on the next ones preempt it.
                assert unit.fmu.unlocked.wait(10.0)
        planner.join()
        assert_row(unit, SAMPLES - 1, recorded[latency][-1])


def test_a_planner_that_stops_leaves_the_arm_at_rest():
    """The last plan goes on to its end, and says that it is not a new one."""
    with ScheduledExecution(fmu("fmi3", "FlexArmController")) as unit:
        feedback, plan = start(unit, hot_pendulum())
        unit.set("angle", 0.8)
        unit.set("setpoint", 1.0)
        for k in range(10_000):
            unit.fmu.activateModelPartition(feedback, k * SAMPLE)
            if k == 0:
                unit.fmu.activateModelPartition(plan, 0.0)
            assert unit.get("nmpc.status") == (0 if k == 0 else 1 if k <= PER_PLAN else 5), k
        assert unit.get("reference.velocity") == 0.0
        assert unit.get("reference.angle") == pytest.approx(unit.get("nmpc.goal"), abs=1e-6)


def test_fmpy_drives_events():
    """FMPy's own master in Event Mode: the same outputs as without, to the bit."""
    results = [
        simulate_fmu(
            str(fmu("fmi3", "FlexArmController")),
            fmi_type="CoSimulation",
            stop_time=0.1,
            step_size=0.001,
            output_interval=0.001,
            start_values={"angle": 1.3, "setpoint": 1.31},
            output=["torque", "reference.angle"],
            use_event_mode=use,
            early_return_allowed=use,
            record_events=False,
        )
        for use in (False, True)
    ]
    # Of the rows at an event the last one, after it, stays.
    plain, eventful = [{round(row["time"], 9): tuple(row)[1:] for row in result} for result in results]
    assert len(plain) == 101 and len(eventful) == 401
    del plain[0.0]
    # Without Event Mode a sample at the end of a step belongs to the next one.
    for time, row in plain.items():
        assert row == eventful[round(time - SAMPLE, 9)], time
    assert len(set(plain.values())) == 100
