"""Verify a submission: its mean gap is measured again on seeds that nobody has seen, and held against the claim.

    python -m experiments.verify docs/example-submission

Nothing of the submission is run: its table or its policy is read as data. The salt, from which every seed of the
planner follows, is drawn and printed; ``--salt`` gives the same seeds again.
"""

import secrets
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray

import antgym
from agents.steering import Controller
from agents.submission import (
    MANIFEST,
    Submission,
    SubmittedController,
    TableAgent,
    make_agent,
    read_submission,
)
from antgym.console import PATIENCE, main, parse, progress
from antgym.envs.control import BLOCKS
from antgym.errors import AgentError, ParameterError, nearest
from antgym.maps.recipes import SUITES
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.agent import Agent, tune
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import observe_run
from antgym.tuning.session import Session, steer_together
from experiments.artefacts import derived_seed, problem
from experiments.columns import percent
from experiments.steering import steerable

Floats = NDArray[np.float64]
RUNS = 16  # runs that judge a recommendation, as on boards
CONFIDENCE = 0.99  # of the interval: an honest claim fails once in a hundred, not once in twenty
DIGIT = 1e-4  # claims are rounded
WIDEST = 0.02  # half of the interval: two points tell most agents of a board apart, a wider one holds nearly any claim
MOST_SEEDS = 1000  # that are advised
VERIFIED = "verified"
PROG = "python -m experiments.verify"


@dataclass(frozen=True)
class Arguments:
    """Score a submission again on fresh seeds: "verified" (exit code 0), or what differs or is undecided (1)."""

    folder: tyro.conf.Positional[Path]
    """Folder of the submission; one that cannot be used is a line that says why, and exit code 2."""
    salt: int | None = None
    """Root of the seeds, a whole number from 0 on; drawn and printed where none is given."""
    seeds: int = 10
    """Seeds on each map, at least 2; each is one recommendation and sixteen runs with it, or one run steered."""


class Score(NamedTuple):
    """What was found: mean gaps, (maps, seeds), and the share of runs that found a path."""

    gaps: Floats
    success: float


Run = Callable[[SuiteItem, TuningProblem], Floats]
"""Returns the path lengths of the runs that one seed on one map is scored by."""


def verify(arguments: Arguments) -> int:
    """Score, print, and return the exit code."""
    if arguments.seeds < 2 or (arguments.salt or 0) < 0:
        raise ParameterError(
            f"--seeds {arguments.seeds} must be 2 or more, --salt {arguments.salt} 0 or more"
        )
    submission = read_submission(arguments.folder)
    items = maps_of(arguments.folder, submission)
    salt = secrets.randbits(63) if arguments.salt is None else arguments.salt
    try:
        score = _score(_runs(arguments.folder, submission), items, salt, arguments.seeds)
    except AgentError as error:
        raise ParameterError(f"{arguments.folder}: {error}") from None
    low, high = interval(score.gaps, submission.seeds)
    found = verdict(submission, score.gaps)
    print(f"{report(submission, score, low, high, salt)}\n{found}")
    return 0 if found == VERIFIED else 1


def maps_of(folder: Path, submission: Submission) -> list[SuiteItem]:
    """Return the maps that a claim is about; ParameterError names the field where there are none such."""
    if submission.suite not in SUITES:  # a folder would be one of this machine, named by a stranger
        hint = nearest(submission.suite, tuple(SUITES))
        raise ParameterError(
            f"{folder / MANIFEST}: field 'suite': unknown suite {submission.suite!r}; {hint}"
        )
    try:
        suite = load_suite(submission.suite, submission.split)
    except ParameterError as error:
        raise ParameterError(f"{folder / MANIFEST}: field 'suite': {error}") from None
    if submission.maps > len(suite):
        raise ParameterError(
            f"{folder / MANIFEST}: field 'maps' = {submission.maps}: {suite} has {len(suite)} maps"
        )
    _check_names(folder, submission, suite)
    items = suite[: submission.maps]
    if submission.track == "C":
        return steerable(items)
    return list(items)


def _check_names(folder: Path, submission: Submission, suite: Sequence[SuiteItem]) -> None:
    """Raise ParameterError where a table has a setting for a map that its suite's split has not."""
    if submission.kind != "table":
        return
    path, agent = folder / submission.files[0], make_agent(str(folder))
    given = agent.table.by_scenario if isinstance(agent, TableAgent) else {}
    known = tuple(item.name for item in suite) if given else ()
    for name in given:
        if name not in known:
            raise ParameterError(
                f"{path}: field 'by_scenario': no map of {submission.suite}, {submission.split} is called {name!r}; "
                f"{nearest(name, known)}"
            )


def _runs(folder: Path, submission: Submission) -> Run:
    """Return what runs a submission: fresh runs of what it recommends, or one that it steers."""
    if submission.track == "C":
        controller = SubmittedController(folder / submission.files[0])
        return lambda item, this: _steered(controller, this)
    agent, budget = make_agent(str(folder)), submission.trials if submission.kind == "policy" else 0
    if isinstance(agent, TableAgent):
        return lambda item, this: this.fresh(_recommended(agent.on(item.name), this, 0), RUNS).lengths
    return lambda item, this: this.fresh(_recommended(agent, this, budget), RUNS).lengths


def _score(run: Run, items: Sequence[SuiteItem], salt: int, seeds: int) -> Score:
    gaps, solved = np.empty((len(items), seeds)), np.empty((len(items), seeds))
    with progress("scoring again", gaps.size, after=PATIENCE) as advance:
        for (i, item), seed in product(enumerate(items), range(seeds)):
            this = problem(item, "verify", salt, seed)
            lengths = run(item, this)
            gaps[i, seed], solved[i, seed] = this.gap(lengths).mean(), np.isfinite(lengths).mean()
            advance(1)
    return Score(gaps, float(solved.mean()))


def _recommended(agent: Agent, this: TuningProblem, budget: int) -> Floats:
    seed = derived_seed("verify", this.seed)
    if budget:
        return tune(agent, Session(this, budget), seed=seed).recommendation
    agent.reset(this.task(0), seed=seed)
    return this.space.check(agent.recommend())[0]


def _steered(controller: Controller, this: TuningProblem) -> Floats:
    session = Session(this, 1)
    trial = session.open(BLOCKS)
    controller.reset(session.task, seed=derived_seed("verify", this.seed))
    while not trial.over:
        steer_together([(session, controller.act(observe_run(session.task, trial)))])
    return np.array(session.lengths)


def interval(gaps: Floats, claimed_seeds: int) -> tuple[float, float]:
    """Return where a mean over other seeds of the same maps lies, with ``CONFIDENCE``.

    Maps are those of the claim, so that only seeds differ. Their variance within each map tells how far two means may
    lie apart, one over our seeds and one over those of the claim. Maps are unlike, so Student's t has the degrees of
    freedom that Satterthwaite (1946) gives a sum of unlike variances.

    Args:
        gaps: (maps, seeds), at least two seeds.
        claimed_seeds: that the other mean is over.
    """
    mean, half = float(gaps.mean()), _half_width(gaps.var(axis=1, ddof=1), gaps.shape[1], claimed_seeds)
    return mean - half, mean + half


def _half_width(variances: Floats, seeds: int, claimed_seeds: int) -> float:
    from scipy.stats import t

    maps, squares = len(variances), float((variances**2).sum())
    error = np.sqrt(variances.mean() * (1 / seeds + 1 / claimed_seeds) / maps)
    freedom = (seeds - 1) * float(variances.sum()) ** 2 / squares if squares else maps * (seeds - 1)
    return float(t.ppf((1 + CONFIDENCE) / 2, freedom) * error) + DIGIT


def report(submission: Submission, score: Score, low: float, high: float, salt: int) -> str:
    """Return what was claimed and what was found."""
    maps, seeds = score.gaps.shape
    mean, claim = float(score.gaps.mean()), submission.mean_gap
    lines = [
        f"{submission.name}, by {', '.join(submission.authors)}",
        f"maps     first {maps} of {submission.suite}, {submission.split}; {seeds} seeds each, salt {salt}",
        f"claimed  mean gap {percent(claim)} % over {submission.seeds} seeds",
        f"found    mean gap {percent(mean)} %, {percent(score.success)} % of runs found a path; a mean over "
        f"{submission.seeds} seeds lies in [{percent(max(low, 0.0))}, {percent(high)}] % ({CONFIDENCE:.0%})",
    ]
    if submission.trials:
        lines.append(
            f"note     {submission.trials:,} trials on each map, by its own word: no place in track {submission.track} "
            "where fewer are allowed"
        )
    if submission.antgym != antgym.__version__:
        lines.append(f"note     claimed with antgym {submission.antgym}, scored with {antgym.__version__}")
    return "\n".join(lines)


def verdict(submission: Submission, gaps: Floats) -> str:
    """Return what the interval says of a claim: "undecided" where it holds the claim, and would hold many others.

    Args:
        submission: with the claim.
        gaps: what was found, (maps, seeds).
    """
    claim, (low, high) = submission.mean_gap, interval(gaps, submission.seeds)
    if not low <= claim <= high:
        return f"differs  the claimed mean gap is {'lower' if claim < low else 'higher'} than what it does"
    half = (high - low) / 2
    return (
        VERIFIED if half <= WIDEST else f"undecided  +- {percent(half)} points; {_way_out(submission, gaps)}"
    )


def _way_out(submission: Submission, gaps: Floats) -> str:
    """Return how the interval would come to be narrow enough, if these variances are what they seem."""
    variances, most = gaps.var(axis=1, ddof=1), percent(WIDEST)
    for seeds in range(gaps.shape[1], MOST_SEEDS):
        if _half_width(variances, seeds, submission.seeds) <= WIDEST:
            return f"at most {most} tell claims apart, give --seeds {seeds}"
    claimed = f"a claim over {submission.seeds} seeds on {submission.maps} maps"
    return f"at most {most} tell claims apart, {claimed} is too vague for that"


if __name__ == "__main__":
    main(lambda: sys.exit(verify(parse(Arguments, None, PROG))))
