"""An instance that is called at random, and what holds whatever is called."""

import ctypes as c
import math
import random

from abi import DOUBLES, LOG2, LOG3, REFERENCES, Callbacks, Fmu
from rules import RULES

OK, WARNING, ERROR = 0, 1, 3


class Failed(AssertionError):
    """The FMU did what it must not."""


class Called:
    """One instance and what was done to it."""

    def __init__(self, fmu: Fmu, seed: int):
        self.fmu, self.random, self.messages = fmu, random.Random(seed), 0
        self.trace: list[str] = []
        self.mode: str | None = "I"
        self.time, self.saved, self.points = 0.0, [], fmu.points
        self.kind = self.random.choice(["cs", "me"] + (["events", "scheduled"] if fmu.clocks else []))
        self.instance = c.c_void_p(self.instantiate())
        self.say(self.kind)
        if not self.instance:
            raise self.failure("no instance")

    def say(self, text: str) -> None:
        """Note a call for the report."""
        self.trace.append(text)

    def failure(self, reason: str) -> Failed:
        """What went wrong, after which calls."""
        return Failed(f"{reason} after: {'; '.join(self.trace)}")

    def log(self, *_) -> None:
        """The importer's logger."""
        self.messages += 1

    def instantiate(self):
        """A new instance of the kind."""
        fmu, library = self.fmu, self.fmu.library
        if not fmu.fmi3:
            self.callbacks = Callbacks(LOG2(self.log), None, None, None, None)
            function = library.fmi2Instantiate
            function.restype = c.c_void_p
            kind = 0 if self.kind == "me" else 1
            return function(b"f", kind, fmu.token, b"", c.byref(self.callbacks), 0, 1)
        self.callbacks = LOG3(self.log)
        common = (b"f", fmu.token, b"", c.c_ubyte(0), c.c_ubyte(1))
        if self.kind == "me":
            function, arguments = library.fmi3InstantiateModelExchange, (*common, None, self.callbacks)
        elif self.kind == "scheduled":
            function = library.fmi3InstantiateScheduledExecution
            arguments = (*common, None, self.callbacks, None, None, None)
        else:
            function = library.fmi3InstantiateCoSimulation
            events = c.c_ubyte(self.kind == "events")
            arguments = (*common, events, events, None, c.c_size_t(0), None, self.callbacks, None)
        function.restype = c.c_void_p
        return function(*arguments)

    def number(self) -> float:
        """Any number, as likely as not a bad one."""
        return self.random.choice(
            [0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, math.nan, math.inf, -math.inf, self.random.gauss(0.0, 1.0)]
        )

    def reference(self, variables: list) -> tuple[int, bool]:
        """A value reference and whether it is one of these variables."""
        if variables and self.random.random() < 0.9:
            return self.random.choice(variables).valueReference, True
        return self.random.choice([0, 7, 999, 2**32 - 1, self.random.randrange(2**32)]), False

    def call(self, rule: str, status: int, legal: bool = True, before: int = 0) -> int:
        """Hold a status against the rules; `legal` tells whether the arguments were."""
        self.say(f"{rule} -> {status}")
        if status not in (OK, WARNING, ERROR):
            raise self.failure(f"status {status}")
        if status == ERROR and self.messages == before:
            raise self.failure("an error without a message")
        demanded, harmful = RULES.get(rule, ("", ""))
        if self.mode is not None:
            if self.mode in harmful and status != ERROR:
                raise self.failure(f"{rule} is harmful in mode {self.mode}")
            if self.mode in demanded and legal and status == ERROR:
                raise self.failure(f"{rule} must be accepted in mode {self.mode}")
        return status

    def finite_outputs(self) -> None:
        """NaN never reaches an actuator."""
        outputs = self.fmu.outputs
        references = (c.c_uint32 * len(outputs))(*[v.valueReference for v in outputs])
        values = (c.c_double * len(outputs))()
        status = self.get_floats(references, len(outputs), values, len(outputs))
        bad = [v.name for v, x in zip(outputs, values, strict=True) if not math.isfinite(x)]
        if status <= WARNING and bad:
            raise self.failure(f"{bad} are no numbers")

    def get_floats(self, references, n: int, values, n_values: int) -> int:
        """`GetReal` or `GetFloat64`."""
        if self.fmu.fmi3:
            types = (c.c_void_p, REFERENCES, c.c_size_t, DOUBLES, c.c_size_t)
            return self.fmu.function("GetFloat64", *types)(self.instance, references, n, values, n_values)
        types = (c.c_void_p, REFERENCES, c.c_size_t, DOUBLES)
        return self.fmu.function("GetReal", *types)(self.instance, references, n, values)

    def set_float(self, reference: int, value: float) -> int:
        """`SetReal` or `SetFloat64` of one."""
        references, values = (c.c_uint32 * 1)(reference), (c.c_double * 1)(value)
        if self.fmu.fmi3:
            types = (c.c_void_p, REFERENCES, c.c_size_t, DOUBLES, c.c_size_t)
            return self.fmu.function("SetFloat64", *types)(self.instance, references, 1, values, 1)
        types = (c.c_void_p, REFERENCES, c.c_size_t, DOUBLES)
        return self.fmu.function("SetReal", *types)(self.instance, references, 1, values)

    def close(self) -> None:
        """Forget what was saved and free the instance."""
        state = "State" if self.fmu.fmi3 else "state"
        for pointer, *_ in self.saved:
            self.fmu.function(f"FreeFMU{state}", c.c_void_p, c.c_void_p)(self.instance, c.byref(pointer))
        free = getattr(self.fmu.library, self.fmu.prefix + "FreeInstance")
        free.argtypes, free.restype = (c.c_void_p,), None
        free(self.instance)
