"""Random calls, legal and illegal, against every package; `tests/search.py` makes as many as you like."""

import pytest

import calls
from abi import Fmu
from conftest import fmu
from search import run


@pytest.mark.parametrize("unit", ["FlexArmPlant", "FlexArmController"])
def test_random_calls_find_nothing(version, unit):
    assert run(fmu(version, unit), first=1, count=3000) == []


def test_a_broken_rule_would_be_found(version):
    """The search itself: rules that no FMU keeps are broken in the first sequences."""
    path = fmu(version, "FlexArmPlant")
    rules = dict(calls.RULES)
    try:
        calls.RULES["get"] = ("", "INSECAT")
        sequences = (calls.Sequence(Fmu(path), seed) for seed in range(20))
        with pytest.raises(calls.Failed, match="get is harmful in mode"):
            for sequence in sequences:
                sequence.run()
    finally:
        calls.RULES.clear()
        calls.RULES.update(rules)
