"""Defects that no FMU may have: the host refuses each with a message that names it.

Independent checkers must find the same FMUs broken, where they look at all: FMPy knows no starts of
enumerations, and none of them loads the binary.
"""

import re

import pytest
from fmpy.validation import validate_fmu

from conftest import edited, fmu
from test_bad_input import refused


def sub(pattern: str, replacement: str):
    """An edit of the description."""
    return lambda text: re.sub(pattern, replacement, text, count=1, flags=re.DOTALL)


ITEM = r'(name="nmpc.solver".*?start=")\d+'
# Unit, edit of the description, what the host names, whether FMPy finds it.
DEFECTS = {
    "causality": (
        "Plant",
        sub(r'(name="torque"[^>]*?causality=")input', r"\1entry"),
        ["variable torque: causality is entry, which is none of parameter, calculatedParameter"],
        True,
    ),
    "variability": (
        "Plant",
        sub(r'(name="torque"[^>]*?variability=")\w+', r"\1sometimes"),
        ["variable torque: variability is sometimes, which is none of constant, fixed, tunable"],
        True,
    ),
    "combination": (
        "Plant",
        sub(r'(name="arm.inertia"[^>]*?variability=")fixed', r"\1continuous"),
        ["variable arm.inertia: variability continuous does not go with causality parameter"],
        True,
    ),
    "enumeration start": (
        "Controller",
        sub(ITEM, r"\g<1>9"),
        ["variable nmpc.solver: its start 9 is no item of the enumeration NmpcSolver"],
        False,
    ),
    "enumeration type": (
        "Controller",
        sub(r'declaredType="NmpcSolver"', 'declaredType="Solver"'),
        ["variable nmpc.solver: no enumeration Solver, its type, is defined"],
        True,
    ),
    "duplicate name": (
        "Plant",
        sub(r'name="motor.torque_constant"', 'name="arm.inertia"'),
        ["two variables are called arm.inertia; the other stands in line"],
        True,
    ),
    "unlisted output": (
        "Plant",
        sub(r'(<Outputs>)\s*<Unknown [^>]*>|<Output valueReference="3"[^>]*>', r"\1"),
        ["variable angle is an output, but ModelStructure does not list it"],
        True,
    ),
    "no token": (
        "Plant",
        sub(r'(guid|instantiationToken)="[^"]*"', ""),
        ["modelDescription.xml: Missing required attribute"],
        True,
    ),
    "token": (
        "Plant",
        sub(r'(guid|instantiationToken)="[^"]*"', r'\1="wrong"'),
        ["refuses to be instantiated", "its token is wrong"],
        False,
    ),
    "no binary": (
        "Plant",
        None,
        ["has no binary FlexArmPlant for", "platforms in it: none"],
        False,
    ),
}


def broken(edit):
    """An edit of a package: another description, or no binaries."""

    def entry(name: str, data: bytes) -> bytes | None:
        if name == "modelDescription.xml" and edit:
            text = edit(data.decode()).encode()
            assert text != data
            return text
        return None if name.startswith("binaries/") and not edit else data

    return entry


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_broken_fmu_is_refused_by_name(flexarm, version, defect, tmp_path):
    unit, edit, names, seen_by_fmpy = DEFECTS[defect]
    name = f"FlexArm{unit}"
    path = edited(fmu(version, name), tmp_path / f"{name}.fmu", broken(edit))
    message = refused(flexarm, tmp_path, **{unit.lower(): path})
    assert all(name in message for name in [str(path), *names]), message
    if "variable" in message:
        assert re.search(r"modelDescription\.xml: line \d+: ", message), message
    assert bool(validate_fmu(str(path))) == seen_by_fmpy
