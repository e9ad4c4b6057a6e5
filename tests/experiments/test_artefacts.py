"""What trained agents need is made once, for the agents that are there, and found again."""

from pathlib import Path

import pytest

import agents
from agents.experience import Experience
from agents.published import SHIPPED, read_card
from agents.static import StaticByRules, StaticSetting, StaticSettings
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from experiments import leaderboard
from experiments.artefact_files import MADE, files_needed, require_there, trained_argument, trained_hashes
from experiments.artefacts import prepare, problem
from experiments.contest import enter
from experiments.presets import PRESETS

TINY = PRESETS["smoke"]._replace(race_maps=2, race_settings=4)


def test_settings_by_rules_are_raced_once_and_recommended(tmp_path):
    name = "best_static_by_rules"
    spent = prepare(tmp_path, "open-v0", TINY, [name, "random_search"])
    settings = StaticSettings.load(tmp_path / "static_by_rules.json")
    items = load_suite("open-v0", "train")
    assert set(settings.by_rules) == set(items.rules)  # two maps lack most, so that one of each is added
    raced = 2 + len(set(items.rules) - {item.rules for item in items[:2]})
    assert spent == {"static_by_rules.json": 4 * raced}
    begun = (tmp_path / "static_by_rules.json").stat().st_mtime_ns
    assert prepare(tmp_path, "open-v0", TINY, [name]) == spent
    assert (tmp_path / "static_by_rules.json").stat().st_mtime_ns == begun
    agent = StaticByRules(**trained_argument(name, tmp_path))
    agent.reset(problem(items[0]).task(0), seed=0)
    assert tuple(agent.recommend()) == settings.by_rules[items[0].rules].unit


def test_nets_are_fitted_to_the_experience_of_their_folder_and_charged_what_it_spent(tmp_path):
    for library in ("torch", "safetensors"):
        pytest.importorskip(library, reason="needs the extra rl")
    spent = prepare(tmp_path, "mountain-v0", TINY, ["neural_regression"])
    experience = Experience.load(tmp_path / "experience.json")
    assert spent == {"neural.json": experience.evaluations}
    agent = agents.make("neural_regression", **trained_argument("neural_regression", tmp_path))
    assert agent.ensemble.card.units == experience.units
    assert agent.ensemble.card.provenance == {"repeats": 2, "suite": "mountain-v0"}


def test_a_file_of_its_own_name_is_found_and_never_made(tmp_path):
    for name, evaluations in (("static", 5), ("other", 7)):
        StaticSetting((0.5,) * 4, evaluations, ("alpha", "beta", "rho", "Q")).save(tmp_path / f"{name}.json")
    names = ["best_static", "best_static:other"]
    assert prepare(tmp_path, "mountain-v0", TINY, names) == {"static.json": 5, "other.json": 7}
    assert trained_argument(names[1], tmp_path) == {"setting": tmp_path / "other.json"}
    assert [entrant.training for entrant in enter(names, tmp_path, {"static.json": 5, "other.json": 7})] == [
        5,
        7,
    ]
    with pytest.raises(ParameterError, match=r"third\.json is not there"):
        prepare(tmp_path, "mountain-v0", TINY, ["rl:third"])


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "rl",
            r"policy\.json is not there; .*rl:open-one-shot,.* experiments\.train PPO antgym/RoomOneShot-v0 --out",
        ),
        ("rl:open-trails", r"open-trails\.json is not there; did you mean 'rl:open-trials'"),
        ("rl_committee", r"shipped: rl_committee:open-committee; .*python -m experiments\.committee"),
        ("best_static_by_rules", r"experiments\.artefacts best_static_by_rules --suite room-v0 --out"),
        (
            "best_static:mine",
            r"mine\.json is not there; .* experiments\.artefacts best_static .*static\.json",
        ),
    ],
)
def test_a_missing_file_is_named_with_the_command_that_makes_it(tmp_path, name, message):
    with pytest.raises(ParameterError, match=message):
        require_there([name], tmp_path, "room-v0")


def test_a_policy_for_maps_of_ones_own_is_trained_on_them(tmp_path):
    with pytest.raises(
        ParameterError, match=r"""train PPO --kwargs '{"suite": "my/maps"}' --out .*/policy$"""
    ):
        require_there(["rl"], tmp_path, "my/maps")


def test_what_is_shipped_needs_no_file_and_one_of_its_name_goes_before_it(tmp_path):
    name = "rl:open-one-shot"
    spent = prepare(tmp_path, "mountain-v0", TINY, [name])
    assert spent == {"open-one-shot.json": read_card(SHIPPED / "open-one-shot").evaluations}
    assert trained_argument(name, tmp_path) == {"path": SHIPPED / "open-one-shot.json"}
    assert not list(tmp_path.iterdir())
    (tmp_path / "moved-1.checkpoints").mkdir()  # of a training that was stopped
    pinned = trained_hashes(tmp_path, [name])
    (tmp_path / "open-one-shot.json").write_text('{"evaluations": 3}')
    assert prepare(tmp_path, "mountain-v0", TINY, [name]) == {"open-one-shot.json": 3}
    assert trained_argument(name, tmp_path) == {"path": tmp_path / "open-one-shot.json"}
    assert pinned.keys() == (after := trained_hashes(tmp_path, [name])).keys()
    assert pinned != after


def test_what_another_preset_or_suite_made_is_refused_and_what_was_put_there_by_hand_is_not(tmp_path):
    prepare(tmp_path, "mountain-v0", TINY, ["best_static"])
    more = TINY._replace(race_settings=8)
    with pytest.raises(ParameterError, match=r"static\.json was made with race_settings 4, now 8; remove it"):
        prepare(tmp_path, "mountain-v0", more, ["best_static"])
    with pytest.raises(ParameterError, match="was made with suite mountain-v0, now open-v0;"):
        prepare(tmp_path, "open-v0", TINY, ["best_static"])
    assert prepare(tmp_path, "mountain-v0", more, ["random_search"]) == {}  # needs no file of theirs
    assert prepare(tmp_path, "mountain-v0", TINY._replace(fresh=9), ["best_static"]) == {"static.json": 8}
    assert list(trained_hashes(tmp_path)) == ["static.json"]
    (tmp_path / MADE).unlink()
    assert prepare(tmp_path, "mountain-v0", more, ["best_static"]) == {"static.json": 8}
    (tmp_path / MADE).write_text("[")
    with pytest.raises(ParameterError, match=r"made\.json is damaged"):
        prepare(tmp_path, "mountain-v0", TINY, ["best_static"])


def test_the_guide_trains_every_file_that_its_array_needs():
    guide = (Path(agents.__file__).parents[1] / "docs" / "ledgers.md").read_text(encoding="utf-8")
    (command,) = (line for line in guide.splitlines() if line.startswith("python -m experiments.artefacts "))
    named = command.partition(" --")[0].split()[3:]
    assert set(files_needed(named)) == set(files_needed(leaderboard.names_of(leaderboard.Arguments())))
    assert "--preset full" in command
