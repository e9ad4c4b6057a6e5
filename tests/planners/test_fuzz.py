"""The first cases of the fuzzer; ten thousand of them, bounds checked, are run by hand (CONTRIBUTING.md)."""

import pytest

from experiments import fuzz


def test_the_first_cases_show_no_fault():
    assert sum(map(fuzz.check, range(400))) > 100


def test_a_case_is_a_function_of_its_number():
    draws = [fuzz.np.random.default_rng(fuzz.np.random.SeedSequence(7)) for _ in range(2)]
    assert fuzz.scenario(draws[0]).digest == fuzz.scenario(draws[1]).digest
    assert fuzz.rules(draws[0]) == fuzz.rules(draws[1])
    assert fuzz.parameters(draws[0]).tolist() == fuzz.parameters(draws[1]).tolist()


def test_a_fault_names_its_case(monkeypatch):
    monkeypatch.setattr(fuzz, "_fault", lambda *_: "a length is no number")
    with pytest.raises(AssertionError, match="case 3: a length is no number"):
        fuzz.check(3)
