"""One random sequence of calls."""

import ctypes as c
import math

from abi import DOUBLES, REFERENCES, EventInfo
from called import ERROR, WARNING, Called
from fmus import SAMPLE

CALLS = 40


class Sequence(Called):
    """What is called."""

    # The calls, one method each. All know what was legal about their arguments.

    def do_get(self) -> None:
        """Read a number, known or unknown."""
        before, (reference, legal) = self.messages, self.reference(self.fmu.floats)
        values = (c.c_double * 1)()
        status = self.get_floats((c.c_uint32 * 1)(reference), 1, values, 1)
        self.call("get", status, legal, before)

    def do_get_integer(self) -> None:
        """Read an integer with the function of either type."""
        before, (reference, _) = self.messages, self.reference(self.fmu.integers)
        name = self.random.choice(["GetInt32", "GetInt64"]) if self.fmu.fmi3 else "GetInteger"
        values = (c.c_int64 * 1)()
        sizes = (c.c_size_t(1),) if self.fmu.fmi3 else ()
        types = (c.c_void_p, REFERENCES, c.c_size_t, c.c_void_p) + (c.c_size_t,) * len(sizes)
        reference = (c.c_uint32 * 1)(reference)
        status = self.fmu.function(name, *types)(self.instance, reference, 1, values, *sizes)
        self.call("get_integer", status, False, before)

    def do_set_input(self) -> None:
        """Write anything to an input."""
        before, (reference, legal) = self.messages, self.reference(self.fmu.inputs)
        rule = "set_input" if legal else "set_unknown"
        self.call(rule, self.set_float(reference, self.number()), legal, before)

    def do_set_parameter(self) -> None:
        """Write something to a parameter, in range or out of it."""
        variable = self.random.choice(self.fmu.parameters)
        ends = [float(e) for e in (variable.min, variable.max, variable.start) if e is not None]
        value = self.random.choice([*ends, ends[-1] * self.random.uniform(0.5, 2.0), self.number()])
        # To give a parameter the value that it has does no harm: some importers repeat all of them.
        had = (c.c_double * 1)()
        self.get_floats((c.c_uint32 * 1)(variable.valueReference), 1, had, 1)
        rule, before = "set_again" if had[0] == value else "set_parameter", self.messages
        self.say(f"{variable.name} = {value}")
        self.call(rule, self.set_float(variable.valueReference, value), False, before)

    def do_configure(self) -> None:
        """Into Configuration Mode and out, or another size for the arrays."""
        if not self.fmu.structural:
            return
        sensible = {"I": ["enter"], "K": ["set", "set", "exit"]}.get(self.mode, [])
        change = self.random.choice(sensible * 2 + ["enter", "exit", "set"])
        if change != "set":
            mode = "K" if change == "enter" else "I"
            self.plain(f"{change}_configuration", f"{change.capitalize()}ConfigurationMode", mode)
            return
        before, points = self.messages, self.random.choice([0, 1, 2, 3, 41, 81, 401, 402, 2**63])
        types = (c.c_void_p, REFERENCES, c.c_size_t, c.POINTER(c.c_uint64), c.c_size_t)
        reference, value = (c.c_uint32 * 1)(self.fmu.structural[0]), (c.c_uint64 * 1)(points)
        status = self.fmu.function("SetUInt64", *types)(self.instance, reference, 1, value, 1)
        rule = "set_again" if points == self.points else "set_structure"
        if self.call(rule, status, 2 <= points <= 401, before) <= WARNING:
            self.points = points

    def do_get_array(self) -> None:
        """Read an array with room for its size or another one."""
        if not self.fmu.structural:
            return
        before, room = self.messages, self.random.choice([self.points, self.points, 41, 1, 500])
        values = (c.c_double * 500)()
        reference = (c.c_uint32 * 1)(self.random.choice(self.fmu.arrays))
        legal = room == self.points
        status = self.get_floats(reference, 1, values, room)
        self.call("get" if legal else "get_wrong", status, legal, before)
        if self.mode not in (None, "K") and not legal and status != ERROR:
            raise self.failure(f"{room} values were read of an array of {self.points}")

    def do_initialize(self) -> None:
        """From Instantiated to the mode after initialization, or a part of the way."""
        before, start = self.messages, self.random.choice([0.0, 0.0, 0.0, 100.0, self.number()])
        legal = math.isfinite(start)
        if self.fmu.fmi3:
            types = (c.c_void_p, c.c_ubyte, c.c_double, c.c_double, c.c_ubyte, c.c_double)
            status = self.fmu.function("EnterInitializationMode", *types)(
                self.instance, 0, 0.0, start, 0, 0.0
            )
        else:
            types = (c.c_void_p, c.c_int, c.c_double, c.c_double, c.c_int, c.c_double)
            setup = self.fmu.function("SetupExperiment", *types)(self.instance, 0, 0.0, start, 0, 0.0)
            if setup == ERROR and self.messages == before:
                raise self.failure("an error without a message")
            if setup == ERROR:
                return
            status = self.fmu.function("EnterInitializationMode", c.c_void_p)(self.instance)
        if self.call("enter_initialization", status, legal, before) <= WARNING:
            self.mode, self.time = "N", start
        if self.random.random() < 0.8:
            self.do_exit_initialization()

    def do_exit_initialization(self) -> None:
        """Sets the unit up, which refuses parameters that do not fit together."""
        before = self.messages
        status = self.fmu.function("ExitInitializationMode", c.c_void_p)(self.instance)
        if self.call("exit_initialization", status, False, before) <= WARNING:
            self.mode = {"cs": "S", "me": "E", "events": "E", "scheduled": "A"}[self.kind]

    def plain(self, rule: str, name: str, then: str | None) -> None:
        """A call without arguments."""
        before = self.messages
        status = self.fmu.function(name, c.c_void_p)(self.instance)
        if self.call(rule, status, True, before) <= WARNING and then is not None:
            self.mode = then

    def do_mode(self) -> None:
        """Into another mode."""
        changes = [
            ("enter_event", "EnterEventMode", "E"),
            ("enter_continuous", "EnterContinuousTimeMode", "C"),
            ("terminate", "Terminate", "T"),
            ("reset", "Reset", "I"),
        ]
        if self.fmu.fmi3:
            changes.append(("enter_step", "EnterStepMode", "S"))
        weights = [4, 4, 1, 1, 4][: len(changes)]
        change = self.random.choices(changes, weights)[0]
        if change[0] == "terminate" and self.mode is None:
            return
        self.plain(*change)
        if change[0] == "reset":
            self.time, self.points = 0.0, self.fmu.points

    def do_step(self) -> None:
        """A communication step, mostly from where the last one ended."""
        before = self.messages
        size = self.random.choice([SAMPLE, SAMPLE, 0.001, 1 / 60, 0.05, self.number()])
        point = self.random.choice([self.time] * 9 + [self.number()])
        # Very long steps are legal and take as long as they take.
        size = min(size, 0.2) if size == size else size
        if self.fmu.fmi3:
            flags, last = [c.c_ubyte() for _ in range(3)], c.c_double()
            types = (c.c_void_p, c.c_double, c.c_double, c.c_ubyte) + (c.c_void_p,) * 4
            function = self.fmu.function("DoStep", *types)
            out = [c.byref(x) for x in (*flags, last)]
            status = function(self.instance, point, size, 1, *out)
            end = last.value
        else:
            types = (c.c_void_p, c.c_double, c.c_double, c.c_int)
            status = self.fmu.function("DoStep", *types)(self.instance, point, size, 1)
            end = point + size
        # Inputs that are no numbers are refused by the plant, and may be.
        if self.call("step", status, False, before) <= WARNING:
            self.time = end
            self.finite_outputs()
        elif self.mode == "S":
            self.mode = None

    def do_update(self) -> None:
        """An event iteration."""
        before = self.messages
        if self.fmu.fmi3:
            flags, instant = [c.c_ubyte() for _ in range(5)], c.c_double()
            function = self.fmu.function("UpdateDiscreteStates", *(c.c_void_p,) * 7)
            status = function(self.instance, *[c.byref(x) for x in (*flags, instant)])
        else:
            info = EventInfo()
            status = self.fmu.function("NewDiscreteStates", c.c_void_p, c.c_void_p)(
                self.instance, c.byref(info)
            )
        if self.call("update", status, False, before) == ERROR and self.mode == "E":
            self.mode = None

    def do_clock(self) -> None:
        """Tick a clock or activate a partition."""
        if not self.fmu.clocks:
            return
        before = self.messages
        clock = self.random.choice([*self.fmu.clocks, *self.fmu.clocks, 3])
        if self.random.random() < 0.5:
            types = (c.c_void_p, REFERENCES, c.c_size_t, c.c_void_p)
            active = (c.c_ubyte * 1)(self.random.choice([0, 1, 255]))
            status = self.fmu.function("SetClock", *types)(self.instance, (c.c_uint32 * 1)(clock), 1, active)
            self.call("set_clock", status, False, before)
            return
        types = (c.c_void_p, c.c_uint32, c.c_double)
        time = self.random.choice([self.time, self.number()])
        status = self.fmu.function("ActivateModelPartition", *types)(self.instance, clock, time)
        legal = clock in self.fmu.clocks and math.isfinite(time)
        if self.call("activate", status, legal, before) <= WARNING:
            self.time += SAMPLE
            self.finite_outputs()

    def do_time(self) -> None:
        """Set the time of Model Exchange."""
        before, time = self.messages, self.random.choice([self.time, self.time + SAMPLE, self.number()])
        status = self.fmu.function("SetTime", c.c_void_p, c.c_double)(self.instance, time)
        if self.call("set_time", status, math.isfinite(time), before) <= WARNING:
            self.time = time

    def do_states(self) -> None:
        """Read, write or differentiate the continuous states, with the right number or a wrong one."""
        before = self.messages
        n = self.random.choice([self.fmu.states] * 5 + [0, 1, 9])
        values = (c.c_double * max(n, 1))(*[self.number() for _ in range(max(n, 1))])
        derivatives = "GetContinuousStateDerivatives" if self.fmu.fmi3 else "GetDerivatives"
        names = ["SetContinuousStates", "GetContinuousStates", derivatives, "GetNominalsOfContinuousStates"]
        name = self.random.choice(names)
        status = self.fmu.function(name, c.c_void_p, DOUBLES, c.c_size_t)(self.instance, values, n)
        legal = n == self.fmu.states and name != derivatives
        rule = "set_states" if name.startswith("Set") else "get_states"
        self.call(rule, status, legal, before)

    def do_set_state(self) -> None:
        """Write a continuous state as a variable."""
        if self.fmu.state_variables:
            before, reference = self.messages, self.random.choice(self.fmu.state_variables)
            self.call("set_state", self.set_float(reference, self.number()), True, before)

    def do_completed_step(self) -> None:
        """The end of an integrator step."""
        before = self.messages
        if self.fmu.fmi3:
            types, flag = (c.c_void_p, c.c_ubyte, c.c_void_p, c.c_void_p), c.c_ubyte
        else:
            types, flag = (c.c_void_p, c.c_int, c.c_void_p, c.c_void_p), c.c_int
        event, terminate = flag(), flag()
        function = self.fmu.function("CompletedIntegratorStep", *types)
        status = function(self.instance, 1, c.byref(event), c.byref(terminate))
        self.call("completed_step", status, True, before)

    def do_derivative(self) -> None:
        """A directional derivative of anything by anything."""
        before = self.messages
        pick = [self.reference(self.fmu.floats)[0] for _ in range(4)]
        unknowns, knowns = (c.c_uint32 * 2)(*pick[:2]), (c.c_uint32 * 2)(*pick[2:])
        seed, out = (c.c_double * 2)(self.number(), self.number()), (c.c_double * 2)()
        name = "GetDirectionalDerivative"
        if self.fmu.fmi3:
            name = self.random.choice([name, "GetAdjointDerivative"])
            pair = (REFERENCES, c.c_size_t)
            types = (c.c_void_p, *pair, *pair, DOUBLES, c.c_size_t, DOUBLES, c.c_size_t)
            function = self.fmu.function(name, *types)
            status = function(self.instance, unknowns, 2, knowns, 2, seed, 2, out, 2)
        else:
            types = (c.c_void_p, REFERENCES, c.c_size_t, REFERENCES, c.c_size_t, DOUBLES, DOUBLES)
            status = self.fmu.function(name, *types)(self.instance, unknowns, 2, knowns, 2, seed, out)
        self.call("derivative", status, False, before)

    def do_state(self) -> None:
        """Save, restore, serialize, restore from damaged bytes, forget."""
        state = "State" if self.fmu.fmi3 else "state"
        function, before = self.fmu.function, self.messages
        if not self.saved or self.random.random() < 0.3:
            pointer = c.c_void_p()
            status = function(f"GetFMU{state}", c.c_void_p, c.c_void_p)(self.instance, c.byref(pointer))
            if self.call("save", status, True, before) <= WARNING:
                self.saved.append((pointer, self.mode, self.time, self.points, True))
            return
        pointer, mode, time, points, own = self.random.choice(self.saved)
        if self.random.random() < 0.5:
            status = function(f"SetFMU{state}", c.c_void_p, c.c_void_p)(self.instance, pointer)
            if self.call("restore", status, own, before) <= WARNING:
                self.mode, self.time, self.points = mode, time, points
            return
        size = c.c_size_t()
        types = (c.c_void_p, c.c_void_p, c.c_void_p)
        status = function(f"SerializedFMU{state}Size", *types)(self.instance, pointer, c.byref(size))
        if self.call("size", status, False, before) == ERROR:
            return
        data = (c.c_char * size.value)()
        types = (c.c_void_p, c.c_void_p, c.c_void_p, c.c_size_t)
        status = function(f"SerializeFMU{state}", *types)(self.instance, pointer, data, size.value)
        self.call("serialize", status, False, before)
        for _ in range(self.random.choice([0, 1, 1, 5])):
            data[self.random.randrange(size.value)] = self.random.randrange(256)
        length = self.random.choice([size.value] * 3 + [0, size.value // 2])
        copy = c.c_void_p()
        name = "DeserializeFMUState" if self.fmu.fmi3 else "DeSerializeFMUstate"
        types = (c.c_void_p, c.c_void_p, c.c_size_t, c.c_void_p)
        status = function(name, *types)(self.instance, data, length, c.byref(copy))
        if self.call("deserialize", status, False, before) <= WARNING:
            self.saved.append((copy, mode, time, points, False))

    def run(self) -> None:
        """All calls, and the end."""
        often = {
            "do_configure": 4,
            "do_initialize": 8,
            "do_step": 6,
            "do_set_input": 6,
            "do_update": 6,
            "do_clock": 6,
        }
        steps = [name for name in dir(self) if name.startswith("do_")]
        weights = [often.get(name, 2) for name in steps]
        for _ in range(CALLS):
            getattr(self, self.random.choices(steps, weights)[0])()
        self.close()
