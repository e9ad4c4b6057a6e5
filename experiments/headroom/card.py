"""The card of one world: the searches run, their winners scored, everything put into one JSON object."""

import hashlib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from antgym.maps.suites import Items, load_suite
from antgym.planners.swarms import find_swarm_rules
from antgym.tuning.problem import GAP_CAP, TuningProblem
from experiments.headroom import measures
from experiments.headroom.measures import Floats
from experiments.headroom.pool import DESIGN, SCORE, Advance, Pool, Stage, cost, design, run_gaps, search
from experiments.headroom.schedules import dynamic, schedule_runs, steerable
from experiments.headroom.widenings import WIDENINGS

FORMAT = "antgym card 2"  # a card that is measured in another way is another format
INSIDE, EDGE = (
    0.1,
    0.02,
)  # of the unit interval: where an optimum at a bound is moved to, and what counts as at it
_ROWS = ("uniform random", "published default", "SBS", "SBS by rule", "VBS")
_PROBES = 10


class Preset(NamedTuple):
    """How much of everything one card takes."""

    train: int  # maps that SBS is raced on
    train_by_rule: int  # maps of each rule, where there are several
    test: int  # maps that everything is scored on
    settings: int  # that a search begins with
    scored: int  # fresh runs of every row and map
    race: tuple[Stage, ...]
    oracle: tuple[Stage, ...]
    design: tuple[int, int]  # settings and repeats of the analysis of variance
    schedule_maps: int


PRESETS = {
    "smoke": Preset(
        6, 2, 4, 8, 4, (Stage(0, 1), Stage(3, 1, 2, 0.1)), (Stage(0, 1), Stage(3, 1, 2, 0.1)), (16, 2), 2
    ),
    "full": Preset(
        train=100,
        train_by_rule=30,
        test=100,
        settings=64,
        scored=24,
        race=(Stage(0, 1), Stage(16, 1, 8, 0.08), Stage(8, 3), Stage(6, 2, 4, 0.04), Stage(4, 6)),
        oracle=(Stage(0, 2), Stage(16, 3, 8, 0.08), Stage(8, 6, 6, 0.04), Stage(4, 16)),
        design=(128, 2),
        schedule_maps=40,
    ),
}


@dataclass(frozen=True)
class Measured:
    """One world under one preset: its problems, and the settings that the searches found."""

    train: list[TuningProblem]
    test: list[TuningProblem]
    static: Floats  # (d,)
    by_rule: Mapping[str, Floats]
    oracle: Floats  # (maps, d)

    @property
    def names(self) -> tuple[str, ...]:
        """The d parameters."""
        return self.test[0].space.names


def problems(suite: Items, indices: Iterable[int]) -> list[TuningProblem]:
    """Return problems of a split by index, as far as there are so many, each with a root seed of its own."""
    seeds = np.random.SeedSequence(int(hashlib.sha256(f"card {suite!r}".encode()).hexdigest(), 16))
    roots = seeds.generate_state(len(suite), np.uint64).tolist()
    return [
        TuningProblem(item.scenario, item.rules, item.ants, item.iterations, roots[i])
        for i, item in ((i, suite[i]) for i in indices if i < len(suite))
    ]


def _by_rule(suite: Items, rules: Collection[str], count: int) -> dict[str, list[int]]:
    """Return the indices of the first items of each rule; looks no further than it must."""
    found: dict[str, list[int]] = {rule: [] for rule in rules}
    for i, item in enumerate(suite):
        if item.rules in found and len(found[item.rules]) < count:
            found[item.rules].append(i)
        if all(len(indices) == count for indices in found.values()):
            break
    return found


def runs_needed(suite: str, preset: Preset) -> int:
    """Return how many planner runs a card takes; what looks at optima on a bound comes on top."""
    train, test = (load_suite(suite, split) for split in ("train", "test"))
    sources, maps = min(preset.train, len(train)), min(preset.test, len(test))
    rules = {test[i].rules for i in range(maps)}
    rows, winners, raced = len(_ROWS) - 1, 1, sources
    if len(rules) > 1:
        rows, winners = len(_ROWS), len(rules) + 1
        raced += sum(map(len, _by_rule(train, rules, preset.train_by_rule).values()))
    settings, repeats = preset.design
    each = cost(preset.settings + winners, preset.oracle) + rows * preset.scored + settings * repeats
    long_enough = [
        min(preset.schedule_maps, sum(steerable(split[i]) for i in range(count)))
        for split, count in ((train, sources), (test, maps))
    ]
    return raced * cost(preset.settings, preset.race) + maps * each + schedule_runs(*long_enough)


def find_settings(suite: str, preset: Preset, advance: Advance) -> Measured:
    """Search the best static setting, the best per rule, and the best per test scenario."""
    train = problems(load_suite(suite, "train"), range(preset.train))
    test = problems(load_suite(suite, "test"), range(preset.test))
    rules = sorted({p.rules for p in test})
    raced, units = [train], design(preset.settings, len(test[0].space))
    if len(rules) > 1:
        groups = _by_rule(load_suite(suite, "train"), rules, preset.train_by_rule)
        raced += [problems(load_suite(suite, "train"), groups[rule]) for rule in rules]
    winners = search([Pool(group, units, seed=i) for i, group in enumerate(raced)], preset.race, advance)
    by_rule = dict(zip(rules, winners[1:] if len(rules) > 1 else winners, strict=True))
    candidates = np.vstack([units, winners])
    oracle = search([Pool([p], candidates, seed=i) for i, p in enumerate(test)], preset.oracle, advance)
    return Measured(train, test, winners[0], by_rule, oracle)


def score(found: Measured, preset: Preset, advance: Advance) -> dict[str, Floats]:
    """Return (maps, runs) gaps of every row on seeds that no search saw."""
    rng = np.random.default_rng(1)
    count, dimension = len(found.test), len(found.names)
    settings: dict[str, Callable[[int], Floats]] = {
        "uniform random": lambda _: rng.random((preset.scored, dimension)),
        "published default": lambda _: np.full((preset.scored, dimension), 0.5),
        "SBS": lambda _: np.tile(found.static, (preset.scored, 1)),
        "SBS by rule": lambda i: np.tile(found.by_rule[found.test[i].rules], (preset.scored, 1)),
        "VBS": lambda i: np.tile(found.oracle[i], (preset.scored, 1)),
    }
    gaps: dict[str, Floats] = {}
    for row, (name, units) in enumerate(settings.items()):
        if name == "SBS by rule" and len(found.by_rule) == 1:  # is SBS
            gaps[name] = gaps["SBS"]
            continue
        requests = [(found.test[i], units(i), SCORE, row * preset.scored) for i in range(count)]
        gaps[name] = np.array(run_gaps(requests, advance))
    return gaps


def variance(found: Measured, preset: Preset, advance: Advance) -> tuple[Floats, Floats]:
    """Return (settings, d) units and (maps, settings, repeats) gaps of a design over the test maps."""
    settings, repeats = preset.design
    units = np.random.default_rng(2).random((settings, len(found.names)))
    requests = [(p, np.repeat(units, repeats, axis=0), DESIGN, 0) for p in found.test]
    gaps = np.array(run_gaps(requests, advance)).reshape(len(found.test), settings, repeats)
    return units, gaps


def at_bounds(
    found: Measured, scored: Floats, preset: Preset, advance: Advance
) -> dict[str, dict[str, float]]:
    """Return per parameter the share of oracles at its low and high end for which moving inside costs two errors."""
    shares: dict[str, dict[str, float]] = {}
    for j, name in enumerate(found.names):
        shares[name] = {}
        for end, inside in (("low", INSIDE), ("high", 1 - INSIDE)):
            column = found.oracle[:, j]
            there = np.flatnonzero(column <= EDGE if end == "low" else column >= 1 - EDGE)
            moved = found.oracle[there].copy()
            moved[:, j] = inside
            first = (len(_ROWS) + 2 * j + (end == "high")) * preset.scored
            requests = [
                (found.test[i], np.tile(unit, (preset.scored, 1)), SCORE, first)
                for i, unit in zip(there, moved, strict=True)
            ]
            gaps = np.array(run_gaps(requests, advance)).reshape(len(there), preset.scored)
            costly = measures.better_by_two_errors(scored[there], gaps) if len(there) else np.zeros(0, bool)
            shares[name][end] = float(costly.sum() / len(found.test))
    return shares


def fingerprint(suite: str, preset: str) -> dict[str, str]:
    """Return what a card depends on: hashes of its maps, of their rules, of plans with each, and of the preset."""
    train, test = (load_suite(suite, split) for split in ("train", "test"))
    sizes = PRESETS[preset]
    tested = [test[i] for i in range(min(sizes.test, len(test)))]
    rules = sorted({item.rules for item in tested})
    raced = set(range(min(sizes.train, len(train))))
    if len(rules) > 1:
        raced.update(chain(*_by_rule(train, rules, sizes.train_by_rule).values()))
    used = [*(train[i] for i in sorted(raced)), *tested]
    named = repr([(rule, find_swarm_rules(rule)) for rule in rules])
    probes = problems(test, chain(*_by_rule(test, rules, -(-_PROBES // len(rules))).values()))
    lengths = np.concatenate([p.run(design(3, len(p.space)), DESIGN, 0).lengths for p in probes])
    return {
        "maps": _hash(repr([(i.scenario.digest, i.ants, i.iterations, i.rules) for i in used]).encode()),
        "rules": _hash(named.encode()),
        "plans": _hash(lengths.tobytes()),
        "preset": _hash(repr(sizes).encode()),
    }


def measure(world: str, suite: str, preset_name: str, advance: Advance) -> dict[str, Any]:
    """Return the card of a world."""
    preset = PRESETS[preset_name]
    found = find_settings(suite, preset, advance)
    gaps = score(found, preset, advance)
    means = {name: values.mean(axis=1) for name, values in gaps.items()}
    units, designed = variance(found, preset, advance)
    flat = ~measures.better_by_two_errors(gaps["VBS"], gaps["SBS"])
    effects = measures.sensitivity(units, designed.mean(axis=2))
    return {
        "format": FORMAT,
        "world": world,
        "suite": suite,
        "preset": preset_name,
        "fingerprint": fingerprint(suite, preset_name),
        "maps": {"train": len(found.train), "test": len(found.test)},
        "gap": {name: _rounded(measures.mean_interval(mean)) for name, mean in means.items()},
        "solved": {name: _digits(float((values < GAP_CAP).mean())) for name, values in gaps.items()},
        "headroom": {
            "over SBS": _rounded(measures.headroom(means["SBS"], means["VBS"])),
            "over SBS by rule": _rounded(measures.headroom(means["SBS by rule"], means["VBS"])),
            "where SBS mostly arrives": _where_static_arrives(gaps),
        },
        "variance": {k: _digits(v) for k, v in measures.variance_shares(designed).items()},
        "main effects": {name: _digits(float(e)) for name, e in zip(found.names, effects, strict=True)},
        "flat": _digits(float(flat.mean())),
        "bounds": at_bounds(found, gaps["VBS"], preset, advance),
        "SBS": [_digits(float(u)) for u in found.static],
        "SBS by rule": {rule: [_digits(float(u)) for u in unit] for rule, unit in found.by_rule.items()},
        "widened": list(WIDENINGS.get(world, ())),
        "dynamic": dynamic(found.train, found.test, found.static, preset.schedule_maps, advance),
    }


def _where_static_arrives(gaps: dict[str, Floats]) -> list[float] | None:
    """Return the headroom over SBS where its first runs mostly find a path, judged by its other runs."""
    first, rest = np.hsplit(gaps["SBS"], [gaps["SBS"].shape[1] // 2])
    there = (first < GAP_CAP).mean(axis=1) > 1 / 2
    if not there.any():
        return None
    return _rounded(measures.headroom(rest[there].mean(axis=1), gaps["VBS"][there].mean(axis=1)))


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def _digits(value: float) -> float:
    return round(value, 4)


def _rounded(interval: Sequence[float]) -> list[float]:
    return [_digits(value) for value in interval]
