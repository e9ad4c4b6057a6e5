"""Verification: an honest claim holds, another does not, and nothing is trusted before it is checked."""

import json
import os
import pickle
import re
import shutil
import struct
import time
from pathlib import Path

import numpy as np
import pytest

import agents
from agents.submission import read_submission
from antgym.errors import AgentError, AntgymError, ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.run_features import CONTROL_FEATURES
from experiments.artefacts import problem
from experiments.verify import Arguments, interval, verdict, verify

TASK, CONTROL = len(TASK_FEATURES), len(CONTROL_FEATURES)
EXAMPLE = Path(__file__).parents[2] / "docs" / "example-submission"


@pytest.fixture
def folder(tmp_path):
    """A copy of the example that a test may damage."""
    return Path(shutil.copytree(EXAMPLE, tmp_path / "mine"))


def change(path, **fields):
    """Change fields of a JSON file; None removes one."""
    content = {**json.loads(path.read_text()), **fields}
    path.write_text(json.dumps({name: value for name, value in content.items() if value is not None}))


def refused(folder, message):
    with pytest.raises(ParameterError, match=message):
        verify(Arguments(folder, salt=0))


def test_the_example_is_verified_and_the_salt_is_printed(capsys):
    assert verify(Arguments(EXAMPLE, salt=7)) == 0
    said = capsys.readouterr().out
    assert "salt 7" in said
    assert said.rstrip().endswith("verified")


def test_trials_that_were_paid_on_each_map_are_remarked(folder, capsys):
    change(folder / "submission.json", trials=500, maps=2, mean_gap=0)
    verify(Arguments(folder, salt=7, seeds=2))
    assert "note     500 trials on each map, by its own word: no place in track B" in capsys.readouterr().out


def test_a_setting_for_no_map_is_a_typing_error_and_falls_back_to_nothing(folder):
    change(folder / "table.json", by_scenario={"mountain-v0/test/00": [0.1, 0.2, 0.3, 0.4]})
    refused(
        folder, r"table.json: field 'by_scenario': no map of .* 'mountain-v0/test/00'; did you mean 'mount"
    )


@pytest.mark.parametrize(("claim", "how"), [(0, "lower"), (1, "higher")])
def test_a_claim_that_does_not_hold_says_what_differs(folder, capsys, claim, how):
    change(folder / "submission.json", mean_gap=claim, maps=2, antgym="0.0.1")
    assert verify(Arguments(folder, salt=7)) == 1
    said = capsys.readouterr().out
    assert f"the claimed mean gap is {how} than what it does" in said
    assert "claimed with antgym 0.0.1" in said


def test_a_salt_gives_the_same_again_and_another_does_not(folder, capsys):
    change(folder / "submission.json", maps=2)
    said = []
    for salt in (3, 3, 4, None):
        verify(Arguments(folder, salt=salt, seeds=2))
        said.append(capsys.readouterr().out.splitlines()[3])
    assert said[0] == said[1]
    assert len(set(said)) == 3


@pytest.mark.parametrize(("maps", "seeds", "said"), [(2, 1, "too vague"), (100, 30, "give --seeds ")])
def test_what_nearly_any_claim_would_pass_is_undecided(folder, maps, seeds, said):
    """Whoever claims chooses maps and seeds, and whoever scores chooses seeds: none of it makes a claim true."""
    change(folder / "submission.json", mean_gap=0.4, maps=maps, seeds=seeds)
    found = verdict(read_submission(folder), np.tile([0.3, 0.5], (maps, 1)))
    assert found.startswith("undecided  +- ")
    assert said in found


def test_an_undecided_claim_is_decided_by_as_many_seeds_as_it_says(capsys):
    assert verify(Arguments(EXAMPLE, salt=7, seeds=2)) == 1
    advised = int(re.search(r"undecided .*give --seeds (\d+)", capsys.readouterr().out)[1])
    assert verify(Arguments(EXAMPLE, salt=7, seeds=advised)) == 0


def test_an_honest_claim_fails_once_in_a_hundred():
    rng = np.random.default_rng(0)
    truth, noise = rng.random((20, 1)), rng.random((20, 1))
    failed = 0
    for _ in range(2000):
        ours = truth + noise * rng.normal(size=(20, 3))
        low, high = interval(ours, 5)
        failed += not low <= float((truth + noise * rng.normal(size=(20, 5))).mean()) <= high
    assert 5 <= failed <= 30


def test_a_setting_for_a_map_goes_before_one_for_its_rules(folder):
    item, settings = load_suite("mountain-v0", "test")[0], []
    change(folder / "table.json", by_scenario={item.name: [0.1, 0.2, 0.3, 0.4]})
    agent = agents.make(str(folder))
    for name in (item.name, "another"):
        (asked := agent.on(name)).reset(problem(item, "test").task(0), seed=0)
        settings.append(asked.recommend().tolist())
    assert settings == [[0.1, 0.2, 0.3, 0.4], [0.047, 0.087, 0.613, 0.773]]


def test_a_map_without_a_setting_is_named(folder):
    change(folder / "table.json", by_rules={})
    refused(folder, r"no setting for the map '.*' or the rules 'liu2020'")


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"suite": None}, "submission.json: field 'suite' is missing"),
        ({"suite": "mountain"}, "field 'suite': unknown suite 'mountain'; did you mean"),
        ({"suite": "../maps"}, "field 'suite': unknown suite '../maps'"),
        ({"suite": "/tmp"}, "field 'suite': unknown suite '/tmp'"),
        ({"maps": 900}, "field 'maps' = 900: .* has 100 maps"),
        ({"maps": True}, "field 'maps' = True"),
        ({"mean_gap": 1.5}, "field 'mean_gap' = 1.5"),
        ({"mean_gap": 10**400}, "field 'mean_gap' = 1000"),
        ({"seeds": 0}, "field 'seeds' = 0"),
        ({"score": 1}, "unknown field 'score'"),
        ({"format": "antgym submission 9"}, "field 'format'"),
        ({"kind": "code"}, "field 'kind' = 'code': has to be table or policy"),
        ({"name": "a\nb"}, "field 'name'"),
        ({"name": "\x1b[2J"}, "field 'name'"),
        ({"authors": ["\u202eevil"]}, "field 'authors'"),
        ({"authors": []}, "field 'authors'"),
        ({"summary": "x" * 301}, "field 'summary'"),
        ({"files": ["../table.json"]}, "field 'files'.*without any path"),
        ({"files": ["/etc/passwd"]}, "field 'files'"),
        ({"files": ["a/../table.json"]}, "field 'files'"),
        ({"files": [".hidden"]}, "field 'files'"),
        ({"files": ["table.json", "table.json"]}, "a table is one file"),
        ({"files": ["other.json"]}, "other.json: cannot be read"),
        ({"track": "C"}, "field 'track' = 'C': C is for policies of Control"),
        ({"kind": "policy"}, "a policy is NAME.json and NAME.safetensors"),
    ],
)
def test_a_manifest_that_is_amiss_is_named_by_its_field(folder, fields, message):
    change(folder / "submission.json", **fields)
    refused(folder, message)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", "no JSON object"),
        ("{", "no JSON"),
        ("[" * 100_000, "no JSON"),
        ('{"name": 1, "name": 2}', "'name' is there twice"),
        ('{"mean_gap": NaN}', "NaN is no number of JSON"),
        (" " * (1 << 21), "2,097,152 bytes; at most 1,048,576 are read"),
    ],
)
def test_a_manifest_that_is_no_json_object_is_refused(folder, text, message):
    (folder / "submission.json").write_text(text)
    refused(folder, message)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"by_rules": {"liu2020": [0.1, 0.2]}}, "'liu2020': 2 values for 4 parameters"),
        ({"by_rules": {"liu2020": [0.1, 0.2, 0.3, 1.4]}}, "table.json: field 'by_rules'"),
        ({"parameters": ["a", "b", "c", "d"]}, r"the table sets \['a', 'b', 'c', 'd'\], the task has"),
    ],
)
def test_a_table_that_is_amiss_is_named_by_its_field(folder, fields, message):
    change(folder / "table.json", **fields)
    refused(folder, message)


def test_a_name_that_is_there_twice_is_found_at_once(folder):
    """However many others there are: nobody waits for what a stranger wrote."""
    names = [f'"{number}": 0' for number in range(80_000)]
    (folder / "submission.json").write_text(f"{{{', '.join([*names, names[-1]])}}}")
    begun = time.process_time()
    refused(folder, "'79999' is there twice")
    assert time.process_time() - begun < 5  # counting each name took a minute and more


def test_neither_links_nor_pipes_nor_folders_are_read(folder):
    table = folder / "table.json"
    table.rename(folder / "elsewhere.json")
    table.symlink_to("elsewhere.json")
    refused(folder, "table.json: is a link")
    table.unlink()
    os.mkfifo(table)
    refused(folder, "table.json: is no plain file")
    table.unlink()
    table.mkdir()
    refused(folder, "table.json: is no plain file")


def test_a_folder_without_a_manifest_is_named(tmp_path):
    refused(tmp_path, "submission.json: cannot be read")
    with pytest.raises(ParameterError, match=r"nowhere/submission.json: cannot be read"):
        agents.find_card("./nowhere")


def test_a_folder_without_a_name_is_a_submission_too(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(folder)
    assert agents.find_card(".").summary == agents.find_card(str(folder)).summary
    monkeypatch.chdir(tmp_path)
    for name in ("", ".", "/"):
        with pytest.raises(ParameterError, match=r"submission\.json: cannot be read"):
            agents.find_card(name)


def header(tensors, data=b""):
    text = json.dumps(tensors).encode()
    return struct.pack("<Q", len(text)) + text + data


HUGE = {"weights": {"dtype": "F32", "shape": [2_500_000_000], "data_offsets": [0, 10_000_000_000]}}
SMALL = {"dtype": "F32", "shape": [2], "data_offsets": [0, 8]}


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (pickle.dumps({"weights": [1.0]}), "is a pickle, which could run anything"),
        (b"PK\x03\x04" + bytes(60), "is a pickle, which could run anything"),
        (b"", "its header claims 0 bytes, the file has 0"),
        (struct.pack("<Q", 10**10) + b"{}", "its header claims 10,000,000,000 bytes, the file has 10"),
        (header(HUGE, bytes(8)), "tensors of 10,000,000,000 bytes in all, 8 are there"),
        (header({"w": {**SMALL, "shape": [9]}}, bytes(8)), "'w' promises 36 bytes, bytes 0 to 8"),
        (header({"v": SMALL, "w": SMALL}, bytes(8)), "promises 8 bytes, bytes 0 to 8"),
        (header({"w": {**SMALL, "dtype": "OBJ"}}, bytes(8)), "none of safetensors"),
        (header({"w": {**SMALL, "shape": [-1, -2]}}, bytes(8)), "a size that is no whole number"),
        (header([1], bytes(8)), "none of safetensors"),
        (header({str(i): SMALL for i in range(2000)}), "2,000 tensors"),
    ],
    ids=["pickle", "zip", "empty", "long", "huge", "short", "shared", "type", "negative", "list", "many"],
)
def test_weights_are_checked_before_anybody_makes_room_for_them(folder, data, message):
    (folder / "net.safetensors").write_bytes(data)
    (folder / "net.json").write_text("{}")
    change(folder / "submission.json", kind="policy", files=["net.json", "net.safetensors"])
    refused(folder, f"net.safetensors: .*{message}")


@pytest.fixture
def policy(folder):
    """The shipped policy as a submission, on the maps of the example."""
    shipped = Path(agents.__file__).parent / "policies" / "open-one-shot"
    for suffix in (".json", ".safetensors"):
        shutil.copy(f"{shipped}{suffix}", folder / f"net{suffix}")
    change(folder / "submission.json", kind="policy", files=["net.json", "net.safetensors"], maps=2)
    return folder


@pytest.mark.slow
def test_a_policy_that_steers_is_scored_by_the_runs_it_steered(folder, capsys):
    pytest.importorskip("stable_baselines3")
    from blank_models import blank_model

    from agents.networks import export

    export(blank_model(size=len(CONTROL_FEATURES)), folder / "net", regime="Control")
    files = {"kind": "policy", "files": ["net.json", "net.safetensors"], "maps": 2}
    change(folder / "submission.json", **files, track="C", mean_gap=1, seeds=100)
    assert verify(Arguments(folder, salt=1, seeds=4)) == 1
    assert "first 2 of mountain-v0, test; 4 seeds each" in capsys.readouterr().out
    change(folder / "submission.json", track="B")
    refused(folder, "field 'track' = 'B': C is for policies of Control")


@pytest.mark.slow
def test_a_policy_is_scored_from_its_numbers(policy, capsys):
    pytest.importorskip("stable_baselines3")
    change(policy / "submission.json", mean_gap=1, seeds=100)
    assert verify(Arguments(policy, salt=1, seeds=4)) == 1
    said = capsys.readouterr().out
    assert "first 2 of mountain-v0, test" in said
    assert "the claimed mean gap is higher than what it does" in said
    assert agents.find_card(str(policy)).needs == "rl"
    bees = problem(load_suite("tabu-bee-v0", "test")[0], "test").task(0)
    with pytest.raises(AgentError, match="the task has"):
        agents.make(str(policy)).reset(bees, seed=0)


@pytest.mark.parametrize("algorithm", ["PPO", "SAC"])
@pytest.mark.parametrize(("regime", "size"), [("OneShot", TASK), ("Control", CONTROL)])
def test_weights_beyond_reason_fail_the_policy_and_no_board(folder, algorithm, regime, size):
    """They are finite, what they lead to is not: torch raises of it, or answers NaN."""
    pytest.importorskip("stable_baselines3")
    import torch
    from blank_models import blank_model

    from agents.networks import export

    model = blank_model(algorithm, size=size)
    with torch.no_grad():
        for weights in model.policy.parameters():
            weights.copy_(torch.where(weights > 0, 3e38, -3e38))
    export(model, folder / "net", regime=regime)
    track = {"OneShot": "B", "Control": "C"}[regime]
    change(
        folder / "submission.json",
        kind="policy",
        files=["net.json", "net.safetensors"],
        maps=2,
        track=track,
    )
    refused(folder, "net.json: (its network cannot work|chose .*nan)")


def test_a_policy_whose_map_would_fill_the_memory_is_refused(policy):
    change(policy / "net.json", map=[128, 128, 128, 128], observation="map3d")
    refused(policy, "net.json: field 'map' = .*no map of antgym is that large")


def test_a_policy_follows_a_shipped_one_and_opens_no_other_file(policy):
    """What lies beside it, or what a link there leads to, was checked by nobody."""
    (policy / "secret.json").symlink_to("/etc/passwd")
    change(policy / "net.json", start=None, follows="secret")
    refused(policy, "net.json: field 'follows' = 'secret': a submission follows a policy that comes with")
    change(policy / "net.json", follows="open-one-shot")
    assert agents.find_card(str(policy)).files[1] == policy / "net.json"
    (policy / "open-one-shot.json").symlink_to("/etc/passwd")
    refused(policy, "field 'follows' = 'open-one-shot': .*take open-one-shot.json out")


def test_a_policy_that_would_pick_trials_for_ever_is_refused(policy):
    change(policy / "submission.json", trials=1 << 40)
    refused(policy, "field 'trials' = 1099511627776: a policy may pick 1,000 at most")


def test_a_policy_of_many_nets_is_refused(policy):
    change(policy / "net.json", constructor={"n_critics": 1024})
    refused(policy, "net.json: .*n_critics = 1024 is none that can be published")


@pytest.mark.parametrize("arguments", [{"seeds": 1}, {"salt": -1}])
def test_what_cannot_be_asked_for_is_named(arguments):
    with pytest.raises(AntgymError, match="--seeds"):
        verify(Arguments(EXAMPLE, **arguments))
