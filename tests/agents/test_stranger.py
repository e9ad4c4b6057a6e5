"""Strangers' agents: an honest one is an agent like any other, and every other kind ends its own run alone."""

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from pathlib import Path

import numpy as np
import pytest

import agents
from agents.nursery import nursery, start
from agents.stranger import harmless
from antgym.errors import AgentError, AntgymError, ParameterError
from antgym.tuning import Session, tune
from antgym.tuning.problem import TuningProblem

ZOO = Path(__file__).with_name("zoo.py")


@pytest.fixture
def problem(valley):
    return TuningProblem(valley, ants=3, iterations=4, seed=5)


@pytest.fixture
def play(problem):
    """A function that lets an agent of the zoo spend seven trials; it returns the agent, the session and the result."""
    played = []

    def play(kind, **limits):
        agent, session = agents.make(f"{ZOO}:{kind}", **{"seconds": 30.0, **limits}), Session(problem, 7)
        played.append(agent)
        return agent, session, tune(agent, session, seed=3)

    yield play
    for agent in played:
        agent.close()


def test_an_honest_agent_does_what_it_would_do_in_the_same_process(play, problem):
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location("zoo", ZOO)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    _, session, result = play("Honest")
    here = tune(module.Honest(), Session(problem, 7), seed=3)
    assert result.trials == here.trials == session.trials
    assert result.recommendation.tolist() == here.recommendation.tolist()


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("Raises", r"ask\(\) raised KeyError"),
        ("AnswersNaN", r"recommend\(\) answered what cannot be run: setting 0: alpha = nan"),
        ("AnswersWrongShape", r"ask\(\) answered .*shape \(k, 4\).*got \(2, 7\)"),
        ("AnswersOutside", r"ask\(\) answered .*alpha = 3.0 lies outside"),
        ("AnswersText", r"recommend\(\) raised ValueError: could not convert string"),
        ("RecommendsTwo", r"recommend\(\) answered 2 settings where one is due"),
        ("AnswersTooMuch", r"ask\(\) answered what cannot be read: more than 4,194,304 bytes"),
        ("Dies", r"ask\(\) ended its process \(exit status 3\)"),
        ("IsKilled", r"recommend\(\) ended its process \(signal 9\)"),
        ("Exits", r"ask\(\) raised SystemExit: goodbye"),
        ("EatsMemory", r"ask\(\) raised MemoryError: Unable to allocate 8.00 GiB"),
        ("PlansItself", r"may not import antgym.planners.*paid for"),
        ("MakesAnEnvironment", r"reset\(\) raised AgentError: an agent may not import antgym.envs"),
        ("ReadsTheBoard", r"reset\(\) raised AgentError: an agent may not import experiments"),
    ],
)
def test_what_an_agent_must_not_do_is_named(play, kind, message):
    with pytest.raises(AgentError, match=rf"zoo.py:{kind}: .*{message}"):
        play(kind)


@pytest.mark.parametrize(
    ("kind", "call"), [("HangsAwake", "ask"), ("HangsAsleep", "tell"), ("HangsAtBirth", "make")]
)
def test_a_hang_is_stopped(play, kind, call):
    with pytest.raises(AgentError, match=rf"{call}\(\) hung: no answer within 0.5 s"):
        play(kind, seconds=0.5)


def test_who_hung_three_times_is_not_waited_for_again(problem):
    """Neither by runs that have begun beside those that hung, nor by later ones."""
    agent = agents.make(f"{ZOO}:HangsAwake", seconds=0.5)
    together = [copy(agent) for _ in range(5)]
    for each in together[:4]:
        each.reset(problem.task(7), seed=0)
    for each in together[:3]:
        with pytest.raises(AgentError, match=r"ask\(\) hung: no answer"):
            each.ask()
    with pytest.raises(AgentError, match=r"ask\(\) was not called: it hung before, 3 times"):
        together[3].ask()
    with pytest.raises(AgentError, match=r"reset\(\) was not called: it hung before"):
        together[4].reset(problem.task(7), seed=0)


def test_who_asks_for_more_than_the_budget_gets_the_budget(play):
    _, session, _ = play("Overspends")
    assert (session.left, len(session.trials)) == (0, 7)


def test_a_forged_trial_is_the_forgers_own(play):
    _, session, result = play("Forges")
    assert result.trials == session.trials
    assert min(trial.cost for trial in session.trials) >= 1


def test_an_agent_sees_a_task_and_trials_and_nothing_else(play):
    with pytest.raises(AgentError) as caught:
        play("Peeks")
    seen = str(caught.value).partition("ValueError: ")[2].split()
    assert set(seen) == {
        "index",
        "unit",
        "cost",
        "work",
        "space",
        "features",
        "ants",
        "iterations",
        "budget",
        "map",
    }


def test_every_run_begins_anew(play):
    for _ in range(2):
        assert play("Remembers")[2].recommendation.tolist() == [0.25] * 4


def test_what_is_printed_is_no_answer(play):
    assert play("Prints")[2].trials == play("Honest")[2].trials


def test_the_map_is_there_for_who_looks(play, problem):
    _, _, result = play("LooksAtTheMap")
    assert result.recommendation[0] == problem.task(7).map(False)[0].mean()


def test_time_in_any_thread_is_counted(play):
    agent, _, _ = play("Computes")
    agent.close()
    assert agent.cpu >= 0.1


needs_proc = pytest.mark.skipif(
    not Path("/proc/self/stat").exists(), reason="reads the state of a process from /proc"
)


def lives(pid):
    """Whether a process is there and not merely waiting to be buried."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except (FileNotFoundError, ProcessLookupError):  # the latter: it ended between opening and reading
        return False


def require_end(pid):
    deadline = time.monotonic() + 10
    while lives(pid):
        assert time.monotonic() < deadline


@needs_proc
def test_no_process_outlives_a_run(play):
    agent, _, result = play("Abandons")
    pid = round(result.recommendation[0] * 2**22)
    assert lives(pid)
    agent.close()
    require_end(pid)


HARNESS = """
import sys, time, agents
from antgym.maps.suites import load_suite
from experiments.artefacts import problem
agent = agents.make(sys.argv[1])
agent.reset(problem(load_suite("mountain-v0", "test")[0], "test").task(5), seed=0)
print(agent._child.pid, flush=True)
agent.ask()
"""


@pytest.mark.slow
@needs_proc
def test_no_process_outlives_a_harness_that_was_killed():
    """Not even one that hangs, and will never read that the other end is closed."""
    command = [sys.executable, "-c", HARNESS, f"{ZOO}:HangsAwake"]
    root = Path(agents.__file__).parents[1]
    with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, text=True) as harness:
        pid = int(harness.stdout.readline())
        assert lives(pid)
        harness.kill()
    require_end(pid)


@pytest.mark.slow
def test_a_nursery_that_was_killed_is_replaced(play):
    play("KillsTheNursery")[0].close()
    assert play("Honest")[1].left == 0


def test_a_nursery_that_cannot_be_started_is_said_to(monkeypatch):
    nursery().close()
    monkeypatch.setenv("PYTHONHOME", "/nowhere")  # where no Python finds its library
    with pytest.raises(AntgymError, match="cannot be started"):
        start(1 << 30)


def test_an_agent_that_failed_is_not_asked_again(play, problem):
    agent = agents.make(f"{ZOO}:Honest")
    with pytest.raises(AgentError, match="reset it first"):
        agent.ask()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (f"{ZOO}:Honst", "did you mean 'Honest'"),
        (str(ZOO), "has no class ''"),
        ("nowhere.py:Agent", "nowhere.py cannot be read"),
        (f"{ZOO.parent / 'conftest.py'}:Agent", "has no class 'Agent'"),
    ],
)
def test_a_name_that_leads_nowhere_is_refused_before_anything_runs(name, message):
    with pytest.raises(ParameterError, match=message):
        agents.find_card(name)


def test_a_file_is_described_without_being_run(tmp_path):
    (tmp_path / "a.py").write_text(
        'raise SystemExit\nclass A:\n    """Does \\x1b[1m this.\n\n    And more."""\n'
    )
    assert agents.find_card(f"{tmp_path}/a.py:A").summary == "Does  [1m this."


def test_a_file_that_is_no_python_is_named(tmp_path):
    (tmp_path / "b.py").write_text("class B(:\n")
    with pytest.raises(ParameterError, match="is no Python"):
        agents.find_card(f"{tmp_path}/b.py:B")


def test_what_a_stranger_says_is_one_harmless_line():
    said = harmless("a\x1b[31m\nb <object at 0x7f12ab34cd>" + "x" * 999)
    assert said.isprintable()
    assert len(said) == 300
    assert "0x…" in said


def test_one_nursery_serves_all(play):
    assert play("Honest")[0]._child.nursery is play("Honest")[0]._child.nursery


def test_threads_share_a_nursery_and_get_the_children_that_they_asked_for():
    def begin_and_end(_):
        child = nursery().start(1 << 30)
        return child.pid, child.end().code

    with ThreadPoolExecutor(4) as threads:
        ended = list(threads.map(begin_and_end, range(60)))
    assert len({pid for pid, _ in ended}) == 60
    assert {code for _, code in ended} <= {-9, 0}  # killed, or gone by itself as its line was closed


def test_settings_come_back_to_the_bit(play):
    _, session, _ = play("Honest")
    drawn = np.random.default_rng(3).random((3, 4))
    assert np.array([trial.unit for trial in session.trials[:3]]).tolist() == drawn.tolist()
