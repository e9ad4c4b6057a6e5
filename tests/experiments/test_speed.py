"""The benchmark: every code gives figures, the plain port is the pinned one, and ours is well ahead of it.

The gate is a ratio of 15 to the pinned plain port in the same run (20 to 24 measured): turns alternate, so a noisy
machine slows both.
"""

import importlib.util
import json
import math
import subprocess
import sys
import time
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from antgym import bench
from antgym.errors import AntgymError, MissingExtraError, ParameterError
from antgym.maps.optimum import shortest_length
from antgym.planners.planning import plan
from experiments import batches, growth, ports, rivals, speed

ROOT = Path(__file__).parents[2]
PINNED = {"mountains": "ded15506e5184388", "discs": "38f96583ac1da442"}
PEERS = {
    "aco-routing 1.2.1": "aco_routing",
    "python-motion-planning 1.1.1": "python_motion_planning",
    "mealpy": "mealpy",
    "beecolpy": "beecolpy",
}
SMALL = bench.Workload("small", 10, 20, size=9)
FEW_BEES = bench.Workload("few bees", 8, 300, world="discs")


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """What a tiny run of the script returns and writes."""
    file = tmp_path_factory.mktemp("speed") / "new" / "speed.json"
    arguments = speed.Arguments(1, ("tiny",), growth=False, two_threads=False, envs=False, out=file)
    returned = speed.run(arguments)
    assert json.loads(file.read_text()) == returned
    return returned


@pytest.mark.slow
def test_every_code_gives_finite_positive_figures_or_a_reason(figures):
    mountains = {code.name for code in rivals.CODES if code.takes(bench.TINY)}
    assert {row["code"] for row in figures["rows"]} == mountains
    for row in figures["rows"]:
        if row["skipped"] is None:
            values = [row[name] for name in ("ns_per_move", "ratio", "plans_per_second", "peak_mb")]
            assert all(value is None or (math.isfinite(value) and value > 0) for value in values), row
            assert row["plans_per_second"] is not None
            assert row["peak_mb"] is not None


@pytest.mark.slow
def test_an_absent_peer_is_skipped_with_its_cure(figures):
    skipped = {row["code"]: row["skipped"] for row in figures["rows"] if row["skipped"]}
    absent = importlib.util.find_spec("aco_routing") is None
    assert set(skipped) == ({"aco-routing 1.2.1"} if absent else set())
    assert all("antgym[bench]" in reason for reason in skipped.values())


@pytest.mark.slow
def test_our_own_ratio_is_one(figures):
    assert next(row["ratio"] for row in figures["rows"] if row["code"] == "antgym") == 1.0


@pytest.mark.slow
def test_the_plain_ports_are_the_pinned_ones(figures):
    """Another source is another yardstick: whoever changes it says so, and old ratios do not compare."""
    assert {world: ports.plain_digest(world) for world in PINNED} == PINNED
    assert figures["plain_port"] == PINNED["mountains"]


@pytest.mark.slow
def test_our_planner_is_well_ahead_of_the_plain_port():
    rows = speed.measure(bench.find_workloads((speed.GATE,))[0], repeats=7, memory=False)
    assert next(row["ratio"] for row in rows if row["code"] == "plain numba port") >= 15


@pytest.mark.slow
def test_our_bees_are_three_times_as_fast_as_the_plain_port():
    rows = speed.measure(bench.find_workloads(("bees",))[0], repeats=7, memory=False)
    assert next(row["ratio"] for row in rows if row["code"] == "plain numba port") > 3
    assert all(row["ratio"] > 300 for row in rows if row["code"] in PEERS and row["skipped"] is None)


@pytest.mark.slow
def test_a_vast_world_costs_what_ants_visit_of_it():
    figures = growth.vast(bench.WORKLOADS[0], repeats=5)
    assert figures["ratio_revisit"] <= 2
    assert figures["added_mb"] <= 350


def test_the_plane_is_walked_and_solved_by_its_own_codes():
    rows = speed.measure(bench.find_workloads(("plane-50x100",))[0], repeats=1, memory=False)
    names = {row["code"] for row in rows}
    assert names == {"antgym", "exact: ours", "python-motion-planning 1.1.1"}
    assert next(row["ns_per_move"] for row in rows if row["code"] == "antgym") > 0


@pytest.mark.slow
def test_bees_stand_beside_their_own_codes():
    rows = {row["code"]: row for row in speed.measure(FEW_BEES, repeats=1, memory=False)}
    assert set(rows) == {"antgym", "antgym, wu2018", "plain numba port", "mealpy", "beecolpy", "exact: ours"}
    for code in ("antgym", "antgym, wu2018", "plain numba port"):
        assert rows[code]["ns_per_move"] > 0
    for code in ("mealpy", "beecolpy"):
        assert rows[code]["skipped"] is None or "antgym[bench]" in rows[code]["skipped"]
    headings = [column.header for column in speed.side_by_side(FEW_BEES, list(rows.values()), None).columns]
    assert "ns/path" in headings


def test_without_ants_no_growth_is_measured():
    with pytest.raises(ParameterError, match="--figure shows how the cost of ants grows"):
        speed.run(speed.Arguments(workload=("bees",), figure=Path("growth.png")))


def test_a_vast_scenario_is_one_at_any_size():
    small = bench.vast_scenario(24, boxes=3)
    assert small.world.shape == (24, 24, 24)
    assert small.world.size - small.world.free_count > 0
    assert small.optimum >= small.straight_line


@pytest.mark.slow
def test_codes_walk_about_as_many_moves_as_ours():
    """The same equations on the same map: what dies on the way is a matter of chance, not of the code."""
    ours = bench.our_planner(SMALL)(1)
    for code in (ports.colony_port, rivals.numpy_colony):
        assert 0.9 < code(SMALL)(1) / ours < 1.1


def test_the_layered_graph_holds_the_exact_optimum():
    from scipy.sparse import csgraph, csr_array

    scenario = SMALL.scenario()
    sources, targets, lengths = rivals.layered_graph(scenario)
    count = scenario.world.free.size
    graph = csr_array((lengths, (sources, targets)), shape=(count, count))
    start, goal = (
        int(np.ravel_multi_index(c, scenario.world.shape)) for c in (scenario.start, scenario.goal)
    )
    assert csgraph.dijkstra(graph, indices=start)[goal] == pytest.approx(shortest_length(scenario))


@pytest.mark.parametrize("name", PEERS)
def test_a_peer_says_how_to_install_it(name, monkeypatch):
    monkeypatch.setitem(sys.modules, PEERS[name], None)
    code = next(code for code in rivals.CODES if code.name == name)
    with pytest.raises(MissingExtraError, match=r"antgym\[bench\]"):
        code.prepare(SMALL)


def test_cost_growth_is_a_table_and_a_picture():
    rows = growth.growth(bench.TINY, repeats=1)
    assert [row["axis"] for row in rows] == list(growth.AXES)
    assert all(row["ratio"][0] == 1.0 and min(row["ns_per_move"]) > 0 for row in rows)
    assert growth.to_table(rows, bench.TINY).row_count == 2 * len(growth.AXES)
    pytest.importorskip("matplotlib")
    assert growth.figure(rows).startswith(b"\x89PNG")


def test_each_axis_grows_what_it_says():
    base = bench.WORKLOADS[0]
    worlds = {axis: growth.grown(base, axis, 2).scenario().world.shape for axis in growth.AXES}
    assert worlds == {"ants": (21,) * 3, "iterations": (21,) * 3, "layers": (41, 21, 21), "world": (41,) * 3}
    assert growth.grown(base, "ants", 8).ants == 8 * base.ants
    assert growth.grown(base, "iterations", 8).iterations == 8 * base.iterations


def test_a_second_thread_is_compared_with_arithmetic(monkeypatch):
    monkeypatch.setattr(speed, "BATCH", 4)
    gain = speed.thread_gain(bench.TINY, repeats=1)
    assert all(math.isfinite(value) and value > 0 for value in gain.values())


@pytest.fixture
def small_batches(monkeypatch):
    """Figures of a few slots, in the script's own file."""
    monkeypatch.setattr(batches, "EFFORT", (3, 4))
    return batches.batches(repeats=2, slots=4, few=4)


def test_a_batch_is_measured_outside_its_planner_and_beside_single_environments(small_batches):
    outside, beside = small_batches["overhead"], small_batches["singles"]
    assert 0 < outside["share_outside"] < 1
    assert 0 < outside["us_outside"] < outside["us"]
    peers = {"SyncVectorEnv"} | ({"DummyVecEnv"} if importlib.util.find_spec("stable_baselines3") else set())
    assert set(beside["us"]) == set(beside["ratio"]) == {"native", *peers}
    assert beside["ratio"]["native"] == 1.0
    assert "4 slots" in batches.to_sentence(small_batches)


def test_the_planner_clock_sees_the_planner_alone():
    env = gymnasium.make(batches.ENV, effort=(3, 4))
    env.reset(seed=0)
    with batches.planner_clock() as inside:
        assert inside == [0.0]
        begun = time.perf_counter()
        env.step(np.zeros(4, np.float32))
        assert 0 < inside[0] < time.perf_counter() - begun
        spent = inside[0]
        env.reset(seed=0)  # the same map: of another one, naive ants would walk first
        assert inside == [spent]


def test_threads_are_put_back(monkeypatch):
    monkeypatch.delenv("ANTGYM_THREADS", raising=False)
    with bench.threads(2):
        assert bench.os.environ["ANTGYM_THREADS"] == "2"
    assert "ANTGYM_THREADS" not in bench.os.environ


def test_turns_alternate_and_each_has_its_own_seed():
    heard = []
    codes = {name: lambda seed, name=name: heard.append((name, seed)) or 1 for name in "ab"}
    bench.take_turns(codes, 2)
    assert [name for name, _ in heard] == list("ababab")
    assert len({seed for name, seed in heard if name == "a"}) == 3


def test_every_workload_is_solved():
    for workload in bench.WORKLOADS:
        effort = {"ants": workload.ants, "iterations": 300 if workload.world == "discs" else 5}
        assert plan(workload.scenario(), workload.parameters, rules=workload.rules, **effort).solved


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (speed.Arguments(workload=("20x10",)), "did you mean '20x100'"),
        (speed.Arguments(repeats=0), "repeats = 0"),
    ],
)
def test_bad_input_is_an_error(arguments, message):
    with pytest.raises(ParameterError, match=message) as caught:
        speed.run(arguments)
    assert isinstance(caught.value, AntgymError)


def test_the_script_says_what_is_wrong_in_one_line():
    command = [sys.executable, "-m", "experiments.speed", "--repeats", "some"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
