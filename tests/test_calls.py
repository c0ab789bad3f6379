"""Random calls, legal and illegal, against every package; `tests/search.py` makes as many as you like."""

import pytest

import calls
from abi import Fmu
from conftest import fmu
from search import run


@pytest.mark.parametrize("unit", ["FlexArmPlant", "FlexArmController"])
def test_random_calls_find_nothing(version, unit):
    assert run(fmu(version, unit), first=1, count=3000) == []


@pytest.mark.parametrize(
    ("rule", "broken", "found"),
    [
        ("get", ("", "INSECAT"), "get is harmful in mode"),
        ("enter_step", ("INSECAT", ""), "enter_step must be accepted in mode"),
    ],
)
def test_a_broken_rule_would_be_found(monkeypatch, rule, broken, found):
    """The search itself: rules that no FMU keeps are broken in the first sequences."""
    monkeypatch.setitem(calls.RULES, rule, broken)
    plant = Fmu(fmu("fmi3", "FlexArmPlant"))
    with pytest.raises(calls.Failed, match=found):
        for seed in range(20):
            calls.Sequence(plant, seed).run()
