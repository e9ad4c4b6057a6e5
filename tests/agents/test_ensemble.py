"""Ensembles of nets: the same by seed, the same after a reload, and nothing of a file is believed."""

import json
from dataclasses import fields

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from agents.ensemble import Ensemble, EnsembleCard
from antgym.errors import ParameterError


@pytest.fixture
def saved(ensemble, tmp_path):
    ensemble.save(tmp_path / "nets.json")
    return tmp_path / "nets"


def test_a_reloaded_ensemble_predicts_what_it_did(ensemble, saved, bowl):
    task = bowl(0, features=(0.7, 0.2)).task
    for name in (saved, saved.with_suffix(".json"), saved.with_suffix(".safetensors")):
        np.testing.assert_allclose(Ensemble.load(name).predict(task), ensemble.predict(task), atol=1e-6)
    assert Ensemble.load(saved).card.evaluations == ensemble.card.evaluations == 640


def test_a_seed_decides_the_nets_and_nothing_else_does(experience, ensemble, bowl):
    import torch

    task, before = bowl(0, features=(1.0, 0.1)).task, torch.get_rng_state()
    again, other = (Ensemble.fit(experience, nets=2, seed=seed).predict(task) for seed in (0, 1))
    assert (again == ensemble.predict(task)).all()
    assert (other != again).any()
    assert (torch.get_rng_state() == before).all(), "what else draws from torch does not notice"


def test_nets_predict_the_regrets_of_maps_that_they_have_seen(experience, ensemble, bowl):
    """Near them, and far nearer than the mean of all maps is."""
    for group in (0, 1):
        shown = ensemble.predict(bowl(0, features=(group, 0.1)).task).mean(axis=0)
        wanted = experience.regrets[group::2].mean(axis=0)
        assert np.abs(shown - wanted).mean() < 0.5 * np.abs(experience.regrets.mean(axis=0) - wanted).mean()


WRONG = {
    "format": "antgym ensemble 0",
    "parameters": [1, 2, 3, 4],
    "described": "moves",
    "mean": [0.0],
    "scale": [float("nan")],
    "units": [[2.0, 0.5, 0.5, 0.5]],
    "noise": -1.0,
    "between": float("inf"),
    "nets": 10**9,
    "hidden": [10**9],
    "evaluations": 1.5,
    "seconds": "7",
    "seed": True,
    "settings": 3,
    "versions": [],
    "provenance": None,
    "sha256": "00",
}


def test_every_field_is_checked():
    assert set(WRONG) == {"format", *(each.name for each in fields(EnsembleCard))}


@pytest.mark.parametrize(("name", "value"), WRONG.items())
def test_a_damaged_field_is_named(saved, name, value):
    file = saved.with_suffix(".json")
    file.write_text(json.dumps({**json.loads(file.read_text()), name: value}))
    message = "'antgym ensemble 1'" if name == "format" else name
    with pytest.raises(ParameterError, match=rf"nets(\.json|\.safetensors): .*{message}"):
        Ensemble.load(saved)


@pytest.mark.parametrize("change", [{"nets": 1}, {"nets": 3}, {"hidden": [128]}, {"hidden": [128, 64]}])
def test_weights_of_another_shape_are_refused(saved, change):
    file = saved.with_suffix(".json")
    file.write_text(json.dumps({**json.loads(file.read_text()), **change}))
    with pytest.raises(ParameterError, match=r"nets: weights '.*' (are|belong)"):
        Ensemble.load(saved)


def test_a_task_of_another_kind_is_refused(ensemble, bowl):
    import dataclasses

    task = bowl(0).task
    with pytest.raises(ParameterError, match="features a map, the task has 3"):
        ensemble.predict(dataclasses.replace(task, features=task.features[:3]))


def test_nets_that_see_nothing_are_not_fitted(experience):
    with pytest.raises(ParameterError, match="epochs = 0"):
        Ensemble.fit(experience, epochs=0)
    with pytest.raises(ParameterError, match="field 'nets' = 0"):
        Ensemble.fit(experience, nets=0)
