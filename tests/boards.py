"""Made-up boards: eight agents and two references on twelve maps and one mountain to look at, and a small site."""

import numpy as np

from antgym.tuning.ledger import Ledger, Outcome
from antgym.tuning.session import Record, Trial
from experiments.board import EXACT, Board, Picture, Row

HOSTILE = "</script><script>alert(1)</script><img src='https://evil.example/x' onerror=alert(2)>\"&"
AGENTS = {  # name: median gap, deploy, training, summary
    "rl": (0.075, 0, 20_000, "frozen policy (stable-baselines3), no trial"),
    "transfer_graph": (0.078, 6, 4_000, "transfer graph, sound version with guard runs"),
    "optuna_tpe": (0.086, 20, 0, "tree-structured Parzen estimator (Optuna), in batches"),
    "ga": (0.105, 20, 0, "genetic algorithm (pymoo), population fitted to the budget"),
    "pso": (0.110, 20, 0, "particle swarm (pymoo), swarm fitted to the budget"),
    "random_search": (0.128, 20, 0, "uniform settings, the best run again"),
    "published_default": (0.205, 0, 0, "the published setting, no trial"),
    "uniform_random": (0.310, 0, 0, "one random setting, no trial"),
}
SCENARIOS = tuple(f"mountains-{size}-{i:03d}" for size in (15, 21, 30) for i in range(4))
SEEDS = 3


def row(name="ga", gaps=((0.1, 0.2), (0.3, 0.4)), kind="agent", **changes):
    """A row whose numbers do not matter, but for those that are given."""
    plain = {"summary": "", "success": 1.0, "deploy": 0.0, "training": 0, "tuner_seconds": 0.0}
    plain |= {"planner_seconds": 0.0, "optimism": None, "card": {}}
    return Row(name=name, kind=kind, gaps=tuple(map(tuple, gaps)), **{**plain, **changes})


def board(*rows, **changes):
    """A board of these rows; scenario names follow from the first."""
    plain = {
        "title": "A board",
        "track": "A",
        "command": "antgym bench",
        "budget": 20,
        "seeds": 2,
        "manifest": {},
        "pictures": (),
    }
    names = tuple(f"map-{i}" for i in range(len(rows[0].gaps)))
    return Board(rows=tuple(rows), **{"scenarios": names, **plain, **changes})


def fake_board(**changes):
    """The board that the page's screenshots show."""
    rng = np.random.default_rng(5)
    hardness = rng.lognormal(0, 0.5, (len(SCENARIOS), 1))
    rows = [_agent(rng, hardness, name, *facts) for name, facts in AGENTS.items()]
    rows += [
        row(
            "best static setting",
            _gaps(rng, hardness, 0.14),
            "reference",
            training=96_000,
            success=0.97,
            planner_seconds=0.41,
            summary="the setting that is best on the training maps",
        ),
        row(
            EXACT,
            np.zeros((len(SCENARIOS), SEEDS)),
            "reference",
            planner_seconds=0.012,
            summary="shortest path by dynamic programming",
        ),
    ]
    plain = {
        "title": "Mountains: twenty trials per map",
        "command": "python -m experiments.leaderboard --suite mountains-v1/test --budget 20 --seeds 3",
        "seeds": SEEDS,
        "scenarios": SCENARIOS,
        "manifest": {
            "versions": {
                "antgym": "0.1.0",
                "numpy": "2.4.6",
                "numba": "0.68.0",
                "optuna": "5.0.0",
                "pymoo": "0.6.2",
                "python": "3.11.7",
            },
            "host": {"cpu": "AMD EPYC 7B13", "threads": 2},
            "suite": "mountains-v1/test 9c31f0a2",
        },
        "pictures": (mountain(rng),),
    }
    return board(*rows, **{**plain, **changes})


def small_site(*names):
    """Boards of tracks A, B and C on three maps, the first one to look at; rows of these names beside the exact one."""
    rng = np.random.default_rng(2)
    picture = mountain(rng, shape=(8, 8, 16))
    paths = {name: picture.paths["ga"] for name in names[:2]} | {EXACT: picture.paths[EXACT]}
    picture = Picture(
        "one", picture.heights, picture.free, picture.cell, paths, _of(picture, paths), picture.optimum
    )
    kinds = [("A", 1), ("A", 20), ("B", 0), ("B", 5), ("C", 1)]
    return [
        board(
            *(row(name, np.sort(rng.uniform(0.02, 0.3 / (i + 1), (3, 2)))) for i, name in enumerate(names)),
            row(EXACT, np.zeros((3, 2)), "reference"),
            track=track,
            budget=budget,
            scenarios=("one", "two", "three"),
            pictures=(picture,),
            manifest={"config": {"suite": "mountain-v0"}, "versions": {"numpy": "2.4.6"}},
        )
        for track, budget in kinds
    ]


def _of(picture, names):
    return {name: picture.lengths.get(name, picture.lengths["ga"]) for name in names}


def recorded(boards, folder):
    """Write the ledger that boards could come from: two trials and two fresh runs a gap. Return its folder."""
    with Ledger(folder, {}, {}) as ledger:
        for one in boards:
            for agent in one.rows:
                for i, name in enumerate(one.scenarios if agent.name != EXACT else ()):
                    for seed, gap in enumerate(agent.gaps[i]):
                        _record(
                            ledger.run(one.key(agent.name, name, seed)), gap, 10 if one.track == "C" else 1
                        )
    return folder


def _record(run, gap, blocks):
    lost = Record(Trial(0, (0.9, 0.8, 0.7, 0.6) * blocks, 10.0, 7), float("inf"), 1)
    found = Record(Trial(1, (0.1, 0.2, 0.3, 0.4) * blocks, 1.5, 7), 150.0, 2)
    run.append([lost, found])
    run.finish(Outcome(found.trial.unit, (100 * (1 + gap),) * 2, (gap, gap)))


def _gaps(rng, hardness, median):
    gaps = median * hardness * rng.lognormal(0, 0.16, (len(SCENARIOS), SEEDS))
    failed = rng.random(gaps.shape) < median / 25
    return np.where(failed, 1.0, np.minimum(gaps, 1.0))


def _agent(rng, hardness, name, median, deploy, training, summary):
    return row(
        name,
        _gaps(rng, hardness, median),
        deploy=deploy,
        training=training,
        success=1 - median / 25,
        tuner_seconds=0.004 + rng.gamma(2, 0.02) * deploy,
        planner_seconds=0.4 * (deploy + 1),
        optimism=rng.gamma(2, 0.006) if deploy else None,
        summary=summary,
        card={"needs": "agents", "libraries": ["numpy"]},
    )


def mountain(rng, shape=(32, 32, 24), edge=15.0):
    """A range with peaks, and paths that are shortest on a ground which the worse agents see more dimly."""
    x, y = np.mgrid[0 : shape[0], 0 : shape[1]] / shape[0]
    heights = 30 + 14 * np.sin(5 * x + 1) * np.cos(7 * y)
    for _ in range(14):
        cx, cy, width = rng.uniform(0.12, 0.88), rng.uniform(0, 1), rng.uniform(0.06, 0.16)
        heights += rng.uniform(30, 120) * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * width**2))
    free = (edge * np.arange(shape[2]) >= heights[:, :, None]).astype(np.uint8)
    noises = {EXACT: 0.0, **{name: 1.6 * facts[0] for name, facts in AGENTS.items()}}
    paths = {
        name: _walk(free, edge, rng.lognormal(0, 4 * noise, shape[:2])) for name, noise in noises.items()
    }
    lengths = {name: _length(path, edge) for name, path in paths.items()}
    return Picture("mountains-21-003", heights, free, (edge,) * 3, paths, lengths, lengths[EXACT])


def _walk(free, edge, dread):
    """The path over the ground, a layer a move, that minimises length × dread."""
    ground = free.argmax(axis=2)
    nx, ny = ground.shape
    steps = np.arange(ny)[:, None] - np.arange(ny)[None, :]
    cost, came = np.where(np.arange(ny) == ny // 3, 0.0, np.inf), []
    for i in range(1, nx):
        climbs = ground[i][:, None] - ground[i - 1][None, :]
        lengths = np.where(abs(steps) <= 2, np.sqrt(1.0 + steps**2 + climbs**2), np.inf)
        total = cost[None, :] + lengths * dread[i][:, None]
        came.append(total.argmin(axis=1))
        cost = total.min(axis=1)
    ys = [2 * ny // 3]
    for back in reversed(came):
        ys.append(int(back[ys[-1]]))
    ys = np.array(ys[::-1])
    return np.stack([np.arange(nx), ys, ground[np.arange(nx), ys]], axis=1)


def _length(path, edge):
    return float(edge * np.sqrt((np.diff(path, axis=0) ** 2).sum(axis=1)).sum())
