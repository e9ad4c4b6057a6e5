"""The first cases of the bees' fuzzer; ten thousand of them, bounds checked, are run by hand (CONTRIBUTING.md)."""

import pytest

from experiments import bee_fuzz


def test_the_first_cases_show_no_fault():
    assert sum(map(bee_fuzz.check, range(400))) > 100


def test_a_fault_names_its_case(monkeypatch):
    monkeypatch.setattr(bee_fuzz, "_fault", lambda *_: "something is no number")
    case = next(n for n in range(99) if bee_fuzz.scenario(bee_fuzz.np.random.default_rng([n])) is not None)
    with pytest.raises(AssertionError, match=f"case {case}: something is no number"):
        bee_fuzz.check(case)
