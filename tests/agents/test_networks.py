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

from blank_models import SIZE, blank_model

import agents
from agents.algorithms import ALGORITHMS
from agents.networks import Player, export, load
from agents.published import PolicyCard
from antgym.errors import ParameterError
from antgym.tuning.run_features import CONTROL_FEATURES

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
    steers = action in ("each", "one")
    model = blank_model(
        algorithm, size=len(CONTROL_FEATURES) if steers else SIZE, picture=picture, action=action
    )
    export(model, tmp_path / "p", regime="Control" if steers else "OneShot")
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
    readers = ("artefact", "published", "algorithms", "facts", "networks", "policy", "ensemble", "choosing")
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


ANTS, BEES = ["alpha", "beta", "rho", "Q"], ["limit", "xi_max", "xi_min"]


@pytest.mark.parametrize(
    ("world", "arguments", "model", "expected"),
    [
        ("RoomOneShot", {}, {}, ("OneShot", 0, ANTS, 68)),
        ("RoomTrials", {}, {"size": 104}, ("Trials", 5, ANTS, 68)),
        ("RoomTrials", {"window": 2}, {"size": 86}, ("Trials", 2, ANTS, 68)),
        ("RoomControl", {}, {"size": 81, "action": "each"}, ("Control", 0, ANTS, 81)),
        ("RoomOneShot", {"observation": "map"}, {"picture": (3, 32, 32)}, ("OneShot", 0, ANTS, 68)),
        ("BeeOneShot", {}, {"size": 36, "chosen": 3}, ("OneShot", 0, BEES, 36)),
        (
            "TabuBeeControl",
            {},
            {"size": 49, "action": "one", "algorithm": "DQN"},
            ("Control", 0, [*BEES, "tabu_radius"], 49),
        ),
    ],
)
def test_where_a_policy_may_be_played_follows_from_its_environment(
    tmp_path, world, arguments, model, expected
):
    card = export(blank_model(**model), tmp_path / "p", env=f"antgym/{world}-v0", arguments=arguments)
    assert (card.regime, card.window, card.parameters, len(card.features)) == expected
    assert load(tmp_path / "p")[0] == card


@pytest.mark.parametrize(
    ("model", "facts", "message"),
    [
        ({}, {"environ": "x"}, "unknown field 'environ' of a policy's card; did you mean 'env'"),
        ({}, {"env": "Room"}, "unknown environment 'Room'; did you mean 'antgym/RoomTrials-v0'"),
        ({}, {"env": "CartPole-v1"}, "unknown environment 'CartPole-v1'; did you mean 'antgym/"),
        ({}, {"env": "antgym/BeeOneShot-v0"}, "the model sees 68 numbers, antgym/BeeOneShot-v0 shows 36"),
        (
            {"size": 80},
            {"env": "antgym/RoomTrials-v0"},
            "sees 80 numbers, .* shows 104 numbers; env= and arg",
        ),
        ({"size": 104}, {}, "sees 104 numbers, OneShot of alpha, beta, rho, Q shows 68 numbers; env= says"),
        ({"size": 104}, {"regime": "Trials"}, "window = 0: trials that Trials shows; one at least"),
        ({}, {"window": 5}, "window = 5: trials that OneShot shows; 0, none is shown"),
        ({}, {"window": "5"}, r"p\.json: field 'window' = '5': has to be a whole number"),
        (
            {"size": 92},
            {"env": "antgym/RoomTrials-v0", "window": 3},
            "window = 3: antgym/RoomTrials-v0 says 5; leave window out, or give arguments={'window': 3}",
        ),
        (
            {"size": 81},
            {"env": "antgym/RoomControl-v0", "regime": "OneShot"},
            "regime = 'OneShot': antgym/RoomControl-v0 says 'Control'; leave regime out",
        ),
        ({}, {"size": 81}, "size = 81: the model says 68; leave size out"),
        ({"size": 36, "chosen": 3}, {}, "the model sees 36 numbers"),
        ({"chosen": 3}, {}, r"picks of Box\(-1.0, 1.0, \(3,\), float32\), .* takes Box\(-1.0, 1.0, \(4,\)"),
        ({"size": 36, "chosen": 4}, {"env": "antgym/BeeOneShot-v0"}, r"picks of Box.*\(4,\).* \(3,\)"),
        (
            {},
            {"parameters": ["alpha", "beta", "rho", "q0"]},
            "what is chosen is alpha, beta, rho, Q or limit",
        ),
        (
            {"picture": (3, 32, 32)},
            {"env": "antgym/RoomOneShot-v0"},
            r"sees 68 numbers and a map of \[3, 32, 32\], antgym/RoomOneShot-v0 shows 68 numbers; env= and",
        ),
        ({"action": "each"}, {}, "the model changes settings .* as in Control alone"),
        ({}, {"env": "antgym/RoomOneShot-v0", "arguments": {"sweet": 1}}, "argument 'sweet'"),
        ({}, {"settings": {"rate": {1}}}, r"p\.json: holds what JSON has no form for"),
        ({}, {"action": "moved"}, "needs a start"),
    ],
)
def test_what_is_told_and_does_not_fit_the_model_is_refused_before_anything_is_written(
    tmp_path, model, facts, message
):
    with pytest.raises(ParameterError, match=message):
        export(blank_model(**model), tmp_path / "own" / "p", **facts)
    assert not list(tmp_path.iterdir())
