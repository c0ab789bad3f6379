"""The C interface of a packaged FMU through ctypes, for calls that no well-behaved client makes."""

import ctypes as c
import tempfile
from pathlib import Path

import fmpy
from fmpy import extract, read_model_description

LOG2 = c.CFUNCTYPE(None, c.c_void_p, c.c_char_p, c.c_int, c.c_char_p, c.c_char_p, c.c_char_p)
LOG3 = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p, c.c_char_p)
DOUBLES, REFERENCES = c.POINTER(c.c_double), c.POINTER(c.c_uint32)


class Callbacks(c.Structure):
    """`fmi2CallbackFunctions`."""

    _fields_ = [
        ("logger", LOG2),
        ("allocate", c.c_void_p),
        ("free", c.c_void_p),
        ("finished", c.c_void_p),
        ("environment", c.c_void_p),
    ]


class EventInfo(c.Structure):
    """`fmi2EventInfo`."""

    _fields_ = [(name, c.c_int) for name in ("again", "terminate", "nominals", "states", "defined")] + [
        ("next", c.c_double)
    ]


class Fmu:
    """A shared library with its description, loaded once."""

    def __init__(self, path: Path):
        self.description = read_model_description(str(path))
        self.fmi3 = self.description.fmiVersion.startswith("3")
        folder = fmpy.platform_tuple if self.fmi3 else fmpy.platform
        name = self.description.coSimulation.modelIdentifier + fmpy.sharedLibraryExtension
        with tempfile.TemporaryDirectory() as directory:
            extract(str(path), directory)
            self.library = c.CDLL(str(Path(directory, "binaries", folder, name)))
        self.prefix = "fmi3" if self.fmi3 else "fmi2"
        self.token = (self.description.instantiationToken if self.fmi3 else self.description.guid).encode()
        variables = self.description.modelVariables
        self.floats = [v for v in variables if v.type in ("Real", "Float64") and not v.dimensions]
        self.outputs = [v for v in self.floats if v.causality == "output"]
        self.inputs = [v for v in self.floats if v.causality == "input"]
        self.parameters = [v for v in self.floats if v.causality == "parameter"]
        self.integers = [v for v in variables if v.type in ("Integer", "Enumeration", "Int32", "Int64")]
        self.clocks = [v.valueReference for v in variables if v.type == "Clock"]
        structural = [v for v in variables if v.causality == "structuralParameter"]
        self.structural = [v.valueReference for v in structural]
        # All arrays of the controller's outputs have the size that its one structural parameter says.
        self.arrays = [v.valueReference for v in variables if v.dimensions and v.causality == "output"]
        self.points = int(structural[0].start) if structural else None
        self.state_variables = [v.derivative.valueReference for v in variables if v.derivative is not None]
        self.states = len(self.state_variables)

    def function(self, name: str, *types):
        """A function of the interface, by its name without `fmi2` or `fmi3`."""
        function = getattr(self.library, self.prefix + name)
        function.argtypes = types
        function.restype = c.c_int
        return function
