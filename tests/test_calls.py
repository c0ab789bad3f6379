"""Random calls, legal and illegal, against every package; `tests/search.py` makes as many as you like."""

import pytest

from abi import Fmu
from called import Failed
from calls import Sequence
from conftest import fmu
from rules import RULES
from search import run


@pytest.mark.parametrize("unit", ["FlexArmPlant", "FlexArmController"])
def test_random_calls_find_nothing(version, unit):
    assert run(fmu(version, unit), first=1, count=3000) == []


@pytest.mark.parametrize(
    ("unit", "rule", "broken", "found"),
    [
        ("Plant", "get", ("", "INSECAT"), "get is harmful in mode"),
        ("Plant", "enter_step", ("INSECAT", ""), "enter_step must be accepted in mode"),
        ("Controller", "set_structure", ("", "K"), "set_structure is harmful in mode"),
    ],
)
def test_a_broken_rule_would_be_found(monkeypatch, unit, rule, broken, found):
    """The search itself: rules that no FMU keeps are broken in the first sequences."""
    monkeypatch.setitem(RULES, rule, broken)
    library = Fmu(fmu("fmi3", f"FlexArm{unit}"))
    with pytest.raises(Failed, match=found):
        for seed in range(100):
            Sequence(library, seed).run()
