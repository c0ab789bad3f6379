"""`dist/FlexArm` as one text, for tools that know no package folders and no standard library."""

import re
from pathlib import Path

from conftest import DIST, ROOT

PACKAGE = DIST / "FlexArm"
STAND_IN = ROOT / "tests" / "modelica"


def members(folder: Path) -> list[str]:
    """What the `package.order` of a folder names."""
    return (folder / "package.order").read_text().split()


def assemble(folder: Path) -> str:
    """A package and its members, in their order, as one class."""
    own, annotation, rest = without_within(folder / "package.mo").partition("\n  annotation (")
    assert annotation, f"{folder}/package.mo has no annotation"
    files = [(folder / name, folder / f"{name}.mo") for name in members(folder)]
    classes = (without_within(file) if file.is_file() else assemble(package) for package, file in files)
    return own + "\n" + "".join(classes) + annotation + rest


def without_within(path: Path) -> str:
    return re.sub(r"^within[^;]*;\n", "", path.read_text())


def source() -> str:
    """The package, after the stand-in for the standard library."""
    assert PACKAGE.is_dir(), f"{PACKAGE} is missing: run `cargo xtask package`"
    return (STAND_IN / "Modelica.mo").read_text() + assemble(PACKAGE)
