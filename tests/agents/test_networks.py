"""Published policies: they act as the model did, and nothing of a file is believed or run."""

import ast
import json
import pickle
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import blank_model

import agents
from agents.algorithms import ALGORITHMS
from agents.networks import Player, export, load
from agents.published import PolicyCard
from antgym.errors import ParameterError

CASES = [
    (name, action, None) for name, row in ALGORITHMS.items() for action in row.actions if action != "moved"
]
CASES += [
    ("PPO", "setting", (3, 16, 16)),
    ("SAC", "setting", (3, 8, 8, 8)),
    ("RecurrentPPO", "setting", (3, 16, 16)),
]


@pytest.mark.parametrize(("algorithm", "action", "picture"), CASES)
def test_a_reloaded_policy_acts_as_the_model_does(tmp_path, algorithm, action, picture):
    """Within 1e-6, over an episode in which a recurrent one remembers."""
    model = blank_model(algorithm, picture=picture, action=action)
    export(model, tmp_path / "p", env="antgym/OpenOneShot-v0")
    card, network = load(tmp_path / "p.json")
    assert (card.algorithm, card.action) == (algorithm, action)
    model.observation_space.seed(1)
    model.policy.set_training_mode(False)
    ours, theirs = Player(network), Player(model.policy)
    for _ in range(5):
        seen = model.observation_space.sample()
        np.testing.assert_allclose(ours.act(seen), theirs.act(seen), atol=1e-6)


def test_what_acting_does_not_need_is_left_out_and_a_small_policy_is_small(tmp_path):
    export(blank_model("SAC"), tmp_path / "sac")
    model = blank_model("PPO")
    model.policy_kwargs["net_arch"] = [64, 64]
    export(model.__class__("MlpPolicy", model.env, policy_kwargs=model.policy_kwargs), tmp_path / "ppo")
    assert b"critic" not in (tmp_path / "sac.safetensors").read_bytes()
    assert b"value_net" not in (tmp_path / "ppo.safetensors").read_bytes()
    assert sum(path.stat().st_size for path in tmp_path.glob("ppo.*")) < 500_000


@pytest.fixture
def published(tmp_path):
    export(blank_model(), tmp_path / "p", env="antgym/OpenOneShot-v0", evaluations=7)
    return tmp_path / "p"


WRONG = {
    "format": "antgym policy 2",
    "algorithm": "PPPO",
    "policy": "os.system",
    "constructor": {"optimizer_class": "Adam"},
    "size": 10**9,
    "regime": "Fleet",
    "observation": "map2d",
    "map": [3, 16, 16],
    "window": -1,
    "features": "moves",
    "action": "jump",
    "parameters": [1],
    "start": [0.5],
    "follows": "../elsewhere",
    "follows_sha256": 7,
    "start_evaluations": -1,
    "env": None,
    "arguments": [],
    "evaluations": 1.5,
    "validation_runs": -1,
    "validation_gap": float("nan"),
    "seconds": "7",
    "seed": True,
    "settings": 3,
    "versions": {"torch": 2},
    "history": [1],
    "sha256": "00",
}


def test_every_field_is_checked():
    assert set(WRONG) == {"format", *(f for f in asdict(PolicyCard("", "", {}, 1)))}


@pytest.mark.parametrize(("name", "value"), WRONG.items())
def test_a_damaged_field_is_named(published, name, value):
    file = published.with_suffix(".json")
    file.write_text(json.dumps({**json.loads(file.read_text()), name: value}))
    with pytest.raises(
        ParameterError, match=rf"p(\.json|\.safetensors)?: .*{'map' if name == 'observation' else name}"
    ):
        load(published)


@pytest.mark.parametrize(
    ("constructor", "message"),
    [
        ({"net_arch": [10**9]}, "net_arch"),
        ({"features_extractor_class": "Popen"}, "features_extractor_class = 'Popen'"),
        ({"features_extractor_kwargs": {"mean": [0.0]}}, "features_extractor_kwargs"),
        ({"activation_fn": "__import__"}, "activation_fn"),
        ({"n_quantiles": 5}, "builds no MlpPolicy"),
        ({"lr_schedule": 1}, "no policy takes 'lr_schedule'"),
        ({"net_arch": [8, 9]}, r"weights .* are \(8,"),
    ],
)
def test_a_constructor_takes_nothing_but_what_the_tables_hold(published, constructor, message):
    file = published.with_suffix(".json")
    content = json.loads(file.read_text())
    content["constructor"].update(constructor)
    file.write_text(json.dumps(content))
    with pytest.raises(ParameterError, match=message):
        load(published)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (None, "no such policy"),
        ("{", "no JSON"),
        ("[]", "field 'format'"),
        ('{"algorithm": "PPO"}', "field 'format'"),
    ],
)
def test_a_card_that_is_none_says_why(tmp_path, text, reason):
    if text is not None:
        (tmp_path / "p.json").write_text(text)
    with pytest.raises(ParameterError, match=rf"p\.json: .*{reason}"):
        load(tmp_path / "p")


@pytest.mark.parametrize("change", ["unknown", "missing"])
def test_fields_that_are_too_many_or_too_few_are_named(published, change):
    file = published.with_suffix(".json")
    content = json.loads(file.read_text())
    content["extra"] = content["size"] if change == "unknown" else content.pop("size")
    file.write_text(json.dumps(content))
    with pytest.raises(ParameterError, match="unknown field 'extra'"):
        load(published)
    del content["extra"]
    content.pop("size", None)
    file.write_text(json.dumps(content))
    with pytest.raises(ParameterError, match="field 'size' is missing"):
        load(published)


def _put(published, data):
    """Put other weights beside the card, under a hash that fits."""
    import hashlib

    published.with_suffix(".safetensors").write_bytes(data)
    file = published.with_suffix(".json")
    file.write_text(json.dumps({**json.loads(file.read_text()), "sha256": hashlib.sha256(data).hexdigest()}))


class Bomb:
    def __reduce__(self):
        return Path.touch, (Path("bomb"),)


def test_a_pickle_in_the_place_of_weights_is_not_run(published, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _put(published, pickle.dumps(Bomb()))
    with pytest.raises(ParameterError, match="no safetensors"):
        load(published)
    assert not Path("bomb").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda w: w.pop("action_net.bias"), "'action_net.bias' are missing"),
        (lambda w: w.update(other=w["action_net.bias"].clone()), "'other' belong to no part"),
        (lambda w: w["action_net.bias"].fill_(float("nan")), "'action_net.bias' are not finite"),
        (lambda w: w.update({"action_net.bias": w["action_net.bias"].double()}), "float64, the network's"),
    ],
)
def test_weights_are_those_of_the_network_or_refused(published, change, message):
    from safetensors.torch import load_file, save

    weights = load_file(published.with_suffix(".safetensors"))
    change(weights)
    _put(published, save(weights))
    with pytest.raises(ParameterError, match=message):
        load(published)


def test_weights_cut_short_are_noticed(published):
    file = published.with_suffix(".safetensors")
    file.write_bytes(file.read_bytes()[:-4])
    with pytest.raises(ParameterError, match="field 'sha256'"):
        load(published)


def test_the_readers_import_nothing_that_unpickles():
    folder = Path(agents.__file__).parent
    readers = ("artefact", "published", "algorithms", "networks", "policy", "ensemble", "choosing")
    for name in (f"{reader}.py" for reader in readers):
        tree = ast.parse((folder / name).read_text(encoding="utf-8"))
        words = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        words |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        modules = {
            alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.Import | ast.ImportFrom)
            for alias in node.names
        } | {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        assert not (words | modules) & {
            "pickle",
            "cloudpickle",
            "dill",
            "joblib",
            "eval",
            "exec",
            "marshal",
            "shelve",
        }
        assert not any(
            word in ("torch.load", "load_from_zip_file", "load_from_pkl") for word in words | modules
        )


def test_what_a_card_cannot_hold_is_not_published(tmp_path):
    model = blank_model()
    model.policy_kwargs["use_sde"] = True
    with pytest.raises(ParameterError, match="use_sde"):
        export(model, tmp_path / "p")
    assert not list(tmp_path.iterdir())
