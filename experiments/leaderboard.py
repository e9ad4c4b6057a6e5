"""The leaderboard: every agent tunes the swarm on maps it has not seen, its recommendations are judged on fresh runs.

    python -m experiments.leaderboard --preset quick --out out/board
    python -m experiments.leaderboard --preset quick --track A B C --suite room-v0 --split test --out out/room

The maps are real terrain unless another suite is asked for; ``--suite tabu-bee-v0 --split test`` is that of the bees,
a folder with splits one of your own. The ledger in the folder is the result: the tables and the page are computed from
it, and computed again without a run where it is complete. A run that was stopped, or killed, goes on where it was when
the same command is given again.
"""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal, NamedTuple

import agents
from agents.steering import FLAGSHIP
from agents.stranger import CALL_SECONDS
from antgym.console import main, parse, progress
from antgym.envs.scenarios import find_items
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem, digest_of
from antgym.planners.planning import are_bees
from antgym.tuning.ledger import Ledger
from experiments import provenance, tracks
from experiments.artefact_files import MAKEABLE, policy_file, require_there, trained_hashes
from experiments.artefacts import prepare
from experiments.board import Track
from experiments.contest import Entrant, enter, foreign_files
from experiments.orders import ask
from experiments.presets import PRESETS, Preset
from experiments.rehearsal import rehearse, rehearse_controllers
from experiments.steering import policy_hashes, steerable
from experiments.tracks import ALWAYS, Round

PROGRAM = "python -m experiments.leaderboard"
AGENTS = (
    "uniform_random",
    "published_default",
    "random_search",
    "sobol",
    "ga",
    "pso",
    "de",
    "cma_es",
    "optuna_tpe",
    "optuna_race",
    "transfer_graph",
    "copy_best_source",
    "portfolio",
    "neighbours",
    "regression",
    "neural_regression",
    "cma_es_warm",
    "transfer_gp",
    "rl",
)
TRAINED = "trained"  # folder of the trained agents' files below the board's


@dataclass(frozen=True)
class Arguments:
    """Run the leaderboard, by default on real terrain, or go on with one that was stopped."""

    preset: Literal["smoke", "quick", "full"] = "quick"
    """smoke: under a minute, for tests; quick: minutes, the published table; full: minutes to hours."""
    out: Path = Path("out/leaderboard")
    """Folder of the ledger, of the trained agents, of board.md and index.html."""
    agents: tuple[str, ...] = AGENTS
    """Names in the catalogue, rl:NAME of NAME.json in OUT/trained or of a shipped policy, path/to/file.py:ClassName of
    your own, folders of submissions; with any there are, as references without a place: uniform_random,
    published_default, random_search, best_static, best_static_by_rules, copy_best_source, regression, the exact planner
    and the virtual best."""
    suite: str = "mountain-v0"
    """Suite of the maps, or a folder of them; trained agents learn from its train split."""
    split: str = "ood"
    """Split of the maps; of mountain-v0's ood, the first are real terrain."""
    track: tuple[Track, ...] = ("A",)
    """A: tuned on every map by itself; B: trained, then no trial or a few; C: control within a run."""
    budgets: tuple[int, ...] = ()
    """Trials per map; by default 1, 5, 20 and 100 in A and 0, 1, 5 and 20 in B, up to the preset's."""
    maps: int | None = None
    """The first so many maps of the split; by default the preset's number."""
    controllers: tuple[str, ...] | None = None
    """Published policies that take part in C beside the agents: their files, rl:NAME, or names of shipped ones; by
    default the shipped one of Control, where ants are steered; none where no name follows."""
    call_seconds: float = CALL_SECONDS
    """Seconds that an agent of your own may take for one call; then its run has failed, and the board goes on."""


class Plan(NamedTuple):
    """What a board asks for, known before anything is trained or run.

    Attributes:
        config: of its ledger, which is refused by any other; tracks, budgets and controllers may join later.
        versions: of what its agents depend on.
        items: the maps.
        preset: how much of everything.
    """

    config: dict[str, Any]
    versions: dict[str, str]
    items: Sequence[SuiteItem]
    preset: Preset


def plan_board(arguments: Arguments) -> Plan:
    """Return what a board asks for; ParameterError on agents, suites, splits or budgets that there are not."""
    _check(arguments)
    preset = PRESETS[arguments.preset]
    items = _items(arguments, preset)
    _rehearse(arguments, items)
    config = {
        "code": provenance.code_hash(*provenance.CONTEST),
        "preset": arguments.preset,
        **preset._asdict(),
        "suite": arguments.suite,
        "split": arguments.split,
        "maps": [item.scenario.digest[:16] for item in items],
        "split_hash": digest_of(items),  # with efforts and rules
        "agents": list(arguments.agents),
        "call_seconds": arguments.call_seconds,  # decides failures
    }
    names = [*names_of(arguments), *_submitted(arguments), *(["rl"] if _controllers(arguments) else [])]
    return Plan(config, provenance.versions(names), items, preset)


def _check(arguments: Arguments) -> None:
    cards = [agents.find_card(name) for name in arguments.agents]
    for option, values in (("agents", arguments.agents), ("track", arguments.track)):
        if len(set(values)) < len(values) or not values:
            raise ParameterError(f"--{option} {' '.join(values)}: name at least one, and each once")
    if arguments.maps is not None and arguments.maps < 1:
        raise ParameterError(f"--maps {arguments.maps}: needs at least one")
    if arguments.split == "train":
        raise ParameterError("--split train: agents learn from these maps; judge on validation, test or ood")
    for track in arguments.track:
        _budgets(track, arguments)
    for card in cards:
        _check_place(card, arguments)
    if arguments.controllers and "C" not in arguments.track:
        raise ParameterError("--controllers steer runs, which is track C; add --track C")
    if (submitted := _submitted(arguments)) and "C" not in arguments.track:
        raise ParameterError(f"--agents {submitted[0]} steers runs, which is track C; add --track C")


def _items(arguments: Arguments, preset: Preset) -> Sequence[SuiteItem]:
    """Return the maps of a board, under rules that agents can learn of."""
    maps = preset.scenarios if arguments.maps is None else arguments.maps
    items = find_items(arguments.suite, arguments.split)[:maps]
    if "C" in arguments.track:
        steerable(items)
    lacking = {item.rules for item in items} - set(find_items(arguments.suite, "train").rules)
    if lacking:
        raise ParameterError(
            f"--suite {arguments.suite}: no map of its train split is planned by the rules "
            f"{', '.join(sorted(lacking))}, which {arguments.split} has; name rules in suite.toml, or add a map"
        )
    return items


def _rehearse(arguments: Arguments, items: Sequence[SuiteItem]) -> None:
    """Raise ParameterError where a file of an agent is missing that no board makes, or a policy cannot be played."""
    names, trained = names_of(arguments), arguments.out / TRAINED
    require_there(names, trained, arguments.suite, makes=MAKEABLE)
    rounds = [(track, budget) for track in _tracks(arguments) for budget in _budgets(track, arguments)]
    rehearse(names, trained, items[0], min(0 if track == "C" else budget for track, budget in rounds))
    others = (*names, *_submitted(arguments))
    rehearse_controllers(_controllers(arguments) if arguments.controllers else (), items[0], others)


def _tracks(arguments: Arguments) -> list[Track]:
    return [track for track in tracks.TRACKS if track in arguments.track]


def _budgets(track: Track, arguments: Arguments) -> tuple[int, ...]:
    return tracks.budgets_of(track, PRESETS[arguments.preset].budget, arguments.budgets)


def _check_place(card: agents.Card, arguments: Arguments) -> None:
    """Raise ParameterError where a submission, of A or B, would be in none of the rounds."""
    rounds = [(track, budget) for track in _tracks(arguments) for budget in _budgets(track, arguments)]
    if card.track == "C" or any(tracks.admits(track, budget, card) for track, budget in rounds):
        return
    raise ParameterError(
        f"--agents {card.name}: submitted for track {card.track}, {card.trials:,} trials on each map, has no place "
        f"on any of these boards; give --track {card.track} and --budgets of as many, or leave it out"
    )


def _references(arguments: Arguments) -> tuple[str, ...]:
    return tuple(name for name in ALWAYS if name not in arguments.agents)


def _submitted(arguments: Arguments) -> tuple[str, ...]:
    """Return the submissions that steer runs, which is what they do in C and all that they do."""
    return tuple(name for name in arguments.agents if agents.find_card(name).steers)


def _controllers(arguments: Arguments) -> tuple[str, ...]:
    """Return the policies that steer in C, by their files where they are asked for."""
    if "C" not in arguments.track:
        return ()
    if arguments.controllers is None:
        return () if are_bees(find_items(arguments.suite, "train").rules) else (FLAGSHIP,)
    files = [policy_file(name, arguments.out / TRAINED) for name in arguments.controllers]
    return tuple(dict.fromkeys(map(str, files)))


def _agents(arguments: Arguments) -> tuple[str, ...]:
    return tuple(name for name in arguments.agents if not agents.find_card(name).steers)


def names_of(arguments: Arguments) -> tuple[str, ...]:
    """Return who can be asked for a setting: the agents that are asked for, then references."""
    return *_agents(arguments), *_references(arguments)


def enter_board(arguments: Arguments, plan: Plan) -> list[Round]:
    """Return the rounds of a board, track by track, their entrants trained now where they are not yet."""
    trained, references = arguments.out / TRAINED, _references(arguments)
    spent = prepare(trained, arguments.suite, plan.preset, names_of(arguments))
    entrants = enter(_agents(arguments), trained, spent, references, arguments.call_seconds)
    return board_rounds(arguments, plan, entrants)


def untrained_board(arguments: Arguments, plan: Plan) -> list[Round]:
    """Return the rounds of a board with an agent that needs nothing in the place of every other, to count its runs."""
    nobody = agents.make("published_default")
    cards = map(agents.find_card, names_of(arguments))
    return board_rounds(
        arguments,
        plan,
        [Entrant(card.name, "agent", "", nobody, card.training, card.track, card.trials) for card in cards],
    )


def board_rounds(arguments: Arguments, plan: Plan, entrants: Sequence[Entrant]) -> list[Round]:
    """Return the rounds that entrants play, track by track."""
    rounds = []
    for track in _tracks(arguments):
        for budget in _budgets(track, arguments):
            if track == "C":
                playing: Sequence[Any] = tracks.within_runs(
                    entrants, arguments.suite, _controllers(arguments), _submitted(arguments)
                )
                items = tuple(steerable(plan.items))
            else:
                playing, items = tracks.per_map(track, entrants, budget), tuple(plan.items)
            rounds.append(Round(track, budget, tuple(playing), items, plan.preset.seeds))
    return rounds


def pins(arguments: Arguments) -> dict[str, str]:
    """Return the hashes of the files that the entrants of a board are, by name."""
    files = trained_hashes(arguments.out / TRAINED, names_of(arguments)) | policy_hashes(
        _controllers(arguments)
    )
    return files | foreign_files(arguments.agents)


def run_board(arguments: Arguments) -> Path:
    """Run what is missing of a board, show it, and return the page."""
    plan = plan_board(arguments)
    with Ledger(arguments.out, plan.config, plan.versions, provenance.facts()) as ledger:
        ask(ledger.folder, (), anew=ledger.renewed)  # before a training, which may be stopped
        rounds = enter_board(arguments, plan)
        ledger.pin(pins(arguments))
        todo = tracks.jobs(rounds)
        title = f"{arguments.preset} board: {len(rounds)} rounds, {len(plan.items)} maps"
        with progress(title, len(todo)) as advance:
            tracks.play(todo, ledger, plan.preset.fresh, advance)
        from experiments.faces import show

        return show(arguments.out, ledger, rounds, command(arguments))


def command(arguments: Arguments) -> str:
    """Return what makes a board again, as short as it goes; where it is written to is for whoever gives it."""
    words = [*PROGRAM.split(), "--preset", arguments.preset]
    for field in fields(Arguments)[2:]:
        value = getattr(arguments, field.name)
        if value != field.default:
            values = value if isinstance(value, tuple) else (value,)
            words += [f"--{field.name}", *map(str, values)]
    return shlex.join(words)


if __name__ == "__main__":
    main(lambda: print(f"\npage: {run_board(parse(Arguments, None, PROGRAM))}"))
