"""A committee recommends the mean of its members, and reads nothing but policies beside its own file."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import blank_model

import agents
from agents.choosing import Committee
from agents.networks import export
from agents.policy import PolicyAgent
from agents.published import SHIPPED, read_card
from antgym.errors import ParameterError
from antgym.tuning import tune
from experiments.artefact_files import spent, trained_hashes
from experiments.committee import Arguments, seat
from experiments.provenance import file_hash


@pytest.fixture
def seated(tmp_path):
    """Three policies beside each other, and a committee of two of them."""
    for seed in range(3):
        export(blank_model(seed=seed), tmp_path / f"seed-{seed}", evaluations=100 + seed)
    Committee(("seed-0", "seed-2")).save(tmp_path / "committee.json")
    return tmp_path


def asked(*policies):
    return Arguments(tuple(map(str, policies)))


def test_it_recommends_the_mean_of_its_members_and_runs_nothing(seated, bowl):
    session = bowl(5)
    found = tune(agents.make("rl_committee", path=seated / "committee.json"), session, seed=0)
    members = [tune(PolicyAgent(seated / f"seed-{i}"), bowl(5), seed=0).recommendation for i in (0, 2)]
    assert found.recommendation == pytest.approx(np.mean(members, axis=0))
    assert found.recommendation.tolist() != members[0].tolist()
    assert not found.trials
    assert session.left == 5


def test_it_is_charged_for_all_of_its_members(seated):
    assert spent(seated, ["rl_committee"]) == {"committee.json": 100 + 102}


def test_a_member_that_picks_trials_is_refused(seated):
    export(blank_model(size=80), seated / "seed-2", regime="Trials", window=1)
    with pytest.raises(ParameterError, match="seed-2 is a policy of Trials, not OneShot"):
        agents.make("rl_committee", path=seated / "committee.json")


@pytest.mark.parametrize(
    "members", [[], ["seed-0", "seed-0"], ["../seed-0"], ["/etc/passwd"], [3], "seed-0", None]
)
def test_members_are_names_in_the_same_folder(seated, members):
    path = seated / "committee.json"
    path.write_text(json.dumps({"format": "antgym committee 1", "members": members}))
    with pytest.raises(ParameterError, match=r"committee\.json"):
        agents.make("rl_committee", path=path)


def test_a_member_that_is_not_there_is_named(seated):
    (seated / "seed-2.json").unlink()
    with pytest.raises(ParameterError, match="seed-2"):
        agents.make("rl_committee", path=seated / "committee.json")


def test_a_command_seats_a_committee_whose_members_can_be_read(seated):
    (seated / "committee.json").unlink()
    assert seat(asked(seated / "seed-1", seated / "seed-2.json")) == seated / "committee.json"
    assert Committee.load(seated / "committee.json").members == ("seed-1", "seed-2")
    with pytest.raises(ParameterError, match="name the policies that sit on it, as: python -m"):
        seat(asked())
    with pytest.raises(ParameterError, match="sits in one folder"):
        seat(asked(seated / "seed-1", seated / "other" / "seed-2"))


def test_members_that_cannot_sit_leave_what_was_there(seated):
    before = {path: path.read_bytes() for path in seated.iterdir()}
    with pytest.raises(ParameterError, match=r"seed-9\.json: no such policy"):
        seat(asked(seated / "seed-1", seated / "seed-9"))
    with pytest.raises(ParameterError, match="open-trials is a policy of Trials, not OneShot"):
        seat(asked(seated / "seed-1", "open-trials"))
    with pytest.raises(ParameterError, match="no such policy"):
        seat(asked(seated / "sead" / "seed-1"))
    assert {path: path.read_bytes() for path in seated.iterdir()} == before


def test_one_of_ones_own_does_not_sit_in_a_shipped_ones_place(seated):
    export(blank_model(seed=9), seated / "open-one-shot", evaluations=7)
    with pytest.raises(
        ParameterError, match=r"open-one-shot\.json would sit instead of the shipped open-one-shot"
    ):
        seat(asked(seated / "seed-0", "open-one-shot"))
    seat(asked(seated / "seed-0", seated / "open-one-shot"))
    assert spent(seated, ["rl_committee"]) == {"committee.json": 100 + 7}


def test_shipped_policies_sit_beside_others_or_alone_without_a_copy(seated, monkeypatch):
    monkeypatch.chdir(seated)
    mixed = seat(asked(seated / "seed-0", "open-one-shot"))
    assert mixed == seated / "committee.json"
    evaluations = read_card(SHIPPED / "open-one-shot").evaluations
    assert spent(seated, ["rl_committee"]) == {"committee.json": 100 + evaluations}
    alone = seat(asked("open-one-shot", "open-one-shot-2"))
    assert alone == Path("out/trained/committee.json")
    assert [path.name for path in alone.parent.iterdir()] == ["committee.json"]
    assert set(trained_hashes(alone.parent, ["rl_committee"])) == {
        "committee.json",
        "committee.json: open-one-shot.json",
        "committee.json: open-one-shot-2.json",
    }


def test_a_shipped_member_is_pinned_beside_a_file_of_its_name(seated):
    name = "rl_committee:open-committee"
    pinned = trained_hashes(seated, [name])
    (seated / "open-one-shot.json").write_text("{}")
    after = trained_hashes(seated, [name])
    assert after.pop("open-one-shot.json") not in after.values()
    assert after == pinned
    assert file_hash(SHIPPED / "open-one-shot.json") in after.values()


def test_a_member_that_is_no_longer_the_shipped_one_is_another(seated):
    committee = seat(asked(seated / "seed-0", "open-one-shot"))
    pinned = trained_hashes(committee.parent, ["rl_committee"])
    export(blank_model(seed=9), seated / "open-one-shot")
    member = "committee.json: open-one-shot.json"
    assert trained_hashes(committee.parent, ["rl_committee"])[member] != pinned[member]
