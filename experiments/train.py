"""Train an RL tuner with an algorithm of stable-baselines3 or sb3-contrib, and publish it.

    python -m experiments.train PPO antgym/MountainOneShot-v0 --evaluations 64000 --out out/policy

writes OUT.safetensors and OUT.json, a policy that ``agents.make("rl", path=OUT)`` follows. Training goes in ten legs.
After each, the policy plays the validation maps, one episode each, on runs that are counted apart; the best of the ten
is published. With ``--action moved`` PPO and its like are judged before they have learnt anything, too, when a move is
a hundredth of a range at most: where learning only harms, what is published stays at its start. Stopped or killed, the
same command goes on after the last whole leg; finished, it says so.

Every leg begins with new episodes, its seeds a function of the root seed and the leg. So a training that was resumed
gives the same policy as one that was not, bit for bit, with the same versions on the same machine; the seconds are what
may differ. ``--evaluations`` is rounded down to whole updates of the networks and whole episodes; one update is made at
least, and where that costs more, the command says so.

TensorBoard's curves are over steps of all slots; ``time/planner_runs`` says what they had cost. ``rollout/ep_rew_mean``
is in units of the environment's reward, whatever scale the settings learn from.
"""

import json
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from agents.choosing import digest_of
from agents.networks import algorithm_class, export
from agents.published import beside, read_card
from agents.shipped import find_policy
from agents.static import StaticSettings
from antgym.console import RESUMES, main, parse, progress
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning.actions import Start
from experiments import curves
from experiments.checkpoints import Checkpoints, Standing, require_same
from experiments.course import LEGS, SEED_LIMIT, Course, unit_of
from experiments.learners import Learner, parsed
from experiments.provenance import file_hash
from experiments.replay import Replayed
from experiments.training import facts, short
from experiments.validation import Validation


@dataclass(frozen=True)
class Arguments:
    """Train an RL tuner, or go on with a training that was stopped."""

    algorithm: Annotated[str, tyro.conf.Positional]
    """PPO, A2C, TRPO, RecurrentPPO, ARS, SAC, TD3, DDPG, TQC, CrossQ; in Control also DQN and QRDQN."""
    env: Annotated[str, tyro.conf.Positional] = "antgym/MountainOneShot-v0"
    """Id of the environment; its train split is used."""
    evaluations: int = 64_000
    """Planner runs to spend on training."""
    seed: int = 0
    """Root seed of networks, scenarios and planner."""
    out: Path = Path("out/policy")
    """Where the policy goes; .safetensors and .json are added, .checkpoints while it is made."""
    observation: Literal["features", "map", "map2d", "map3d"] = "features"
    """What the policy sees; maps are read by convolutions."""
    action: Literal["each", "one", "setting", "moved"] | None = None
    """Control: changes of each parameter or of one, or settings; by default the first that the algorithm learns.
    Everywhere: settings, or moves from a start."""
    start: tuple[float, ...] | None = None
    """The setting that changes or moves begin from, a value from 0 to 1 a parameter; by default the published one."""
    start_by_rules: Path | None = None
    """A file of such settings by rules, as experiments.artefacts best_static_by_rules makes it."""
    start_by_policy: str | None = None
    """What changes begin from, chosen by a published policy of OneShot or a committee: what is learnt corrects it. The
    name of a shipped one, as open-committee, or files in the folder of OUT."""
    kwargs: str = "{}"
    """Arguments of the environment as JSON: '{"suite": "room-v0", "reward": "improvement", "budget": 20}'."""
    experience: Path | None = None
    """OneShot, algorithms that replay: a table of trials to learn from before any episode, as experiments.artefacts
    experience makes it. Its trials are the first evaluations, as many of its maps as --replayed pays for."""
    replayed: int | None = None
    """Evaluations at most that are trials of --experience; by default as many as there are."""
    validation: int = 50
    """Maps of the validation split that checkpoints are chosen on, one run each."""
    config: Path | None = None
    """Settings by algorithm; by default the regime's file in experiments/configs."""
    tensorboard: Path | None = None
    """Folder of TensorBoard's curves; none by default."""


def train(arguments: Arguments) -> dict[str, Any]:
    """Train what is left to train, publish it, and return what the policy's JSON says."""
    _check(arguments)
    learner = _learner(arguments)
    asked = _asked(learner, arguments)
    finished = beside(arguments.out, ".json")
    kept = Checkpoints(beside(arguments.out, ".checkpoints"), asked)
    if finished.exists():
        card = read_card(finished)
        require_same(finished, card.settings.get("asked", {}), json.loads(json.dumps(asked)))
        kept.remove()  # where it was killed right before
        return {"finished": str(finished), **short(card)}
    model = _run(learner, arguments, kept)
    card = export(
        kept.best(model),
        arguments.out,
        **facts(learner, arguments.start_by_rules, kept.standing, seed=arguments.seed, asked=asked),
    )
    kept.remove()
    return short(card)


def _check(arguments: Arguments) -> None:
    if arguments.evaluations < 1:
        raise ParameterError(
            f"evaluations = {arguments.evaluations}: training needs at least one planner run"
        )
    if not 0 <= arguments.seed < SEED_LIMIT:
        raise ParameterError(f"seed = {arguments.seed}: needs a whole number from 0 to 2^32 - 1")
    if arguments.tensorboard is not None and find_spec("tensorboard") is None:
        raise MissingExtraError("tensorboard", "rl")


def _learner(arguments: Arguments) -> Learner:
    kwargs = {"observation": arguments.observation, **parsed(arguments.kwargs)}
    if kwargs.get("split") in ("validation", "test", "ood"):
        raise ParameterError(
            f"split {kwargs['split']!r}: a policy is trained on train maps and judged on others"
        )
    return Learner(
        arguments.algorithm,
        arguments.env,
        arguments.action,
        kwargs,
        _start(arguments),
        arguments.config,
        None if arguments.start_by_policy is None else find_policy(arguments.start_by_policy),
    )


def _start(arguments: Arguments) -> Start | None:
    """Return what changes begin from."""
    if arguments.start_by_rules is None:
        return arguments.start and list(arguments.start)
    if arguments.start is not None:
        raise ParameterError("--start and --start-by-rules: changes begin from one of them")
    settings = StaticSettings.load(arguments.start_by_rules).by_rules
    return {rules: list(setting.unit) for rules, setting in settings.items()}


def _asked(learner: Learner, arguments: Arguments) -> dict[str, Any]:
    """Return what decides a training; with the same it goes on, with anything else it does not."""
    names = ("algorithm", "env", "evaluations", "seed", "validation")
    asked = {name: getattr(arguments, name) for name in names}
    return {
        **asked,
        "start": learner.start,
        "follows": learner.follows and digest_of(learner.follows),
        "action": learner.how,
        "kwargs": dict(learner.kwargs),
        "settings": learner.settings,
        "experience": arguments.experience and file_hash(arguments.experience),
        "replayed": arguments.replayed,
    }


def _run(learner: Learner, arguments: Arguments, kept: Checkpoints) -> Any:
    """Return the model after all legs, those that are kept among them."""
    kind = algorithm_class(arguments.algorithm)
    envs, validation = learner.train_envs(arguments.seed), Validation(learner, arguments.validation)
    table = _table(learner, arguments)
    charged = table.trials if table else 0
    steps = int((arguments.evaluations - charged) / learner.runs_a_step)
    begun = bool(kept.standing.history)
    held = max(1, steps + charged)
    model = kept.resume(kind, envs) if begun else learner.model(envs, arguments.seed, held)
    name = f"{arguments.algorithm}-{arguments.out.name}"
    model.set_logger(curves.logger(arguments.tensorboard, name, model.num_timesteps + begun))
    unit = unit_of(model, learner.steps_an_episode)
    units = steps // unit if table else max(1, steps // unit)
    spends = charged + round(units * unit * learner.runs_a_step)
    course = Course(model, validation, table, arguments.seed, unit * units)
    if not begun:
        _say_what_is_more(arguments, spends)
        _begin(learner, course, kept)
    title = f"{arguments.algorithm} on {arguments.env.removeprefix('antgym/')}"
    with progress(title, spends) as advance:
        advance(kept.standing.evaluations, _titled(title, kept.standing))
        for leg in range(kept.standing.leg, LEGS):
            until = unit * (units * (leg + 1) // LEGS)
            if table or until > model.num_timesteps:
                kept.keep(model, course.walk(leg + 1, until, kept.standing, advance))
                advance(0, _titled(title, kept.standing))
    return model


def _say_what_is_more(arguments: Arguments, spent: int) -> None:
    """Say on stderr where a training takes more planner runs than were asked for."""
    if spent > arguments.evaluations:
        print(
            f"--evaluations {arguments.evaluations}: {arguments.algorithm} spends {spent}, its least: one update",
            file=sys.stderr,
        )


def _begin(learner: Learner, course: Course, kept: Checkpoints) -> None:
    """Give a new model the trials of its table, and judge the start where it does not move from it yet."""
    if course.table:
        course.table.fill(course.model)
    nearly_still = hasattr(
        course.model, "rollout_buffer"
    )  # those that learn on-policy begin with next to no action
    if learner.how == "moved" and nearly_still:
        kept.keep(course.model, course.judge(kept.standing))


def _table(learner: Learner, arguments: Arguments) -> Replayed | None:
    if arguments.experience is None:
        return None
    most = arguments.evaluations if arguments.replayed is None else arguments.replayed
    return Replayed(arguments.experience, learner, min(most, arguments.evaluations))


def _titled(title: str, standing: Standing) -> str:
    if not standing.history:
        return title
    return f"{title}: gap {standing.history[-1][1]:.3f}, best {standing.lowest:.3f}"


def script() -> None:
    """Run the command line."""
    told = train(parse(Arguments, None, "python -m experiments.train"))
    if "finished" in told:
        print(f"{told['finished']} is finished; nothing to do")
    print(json.dumps(told))


if __name__ == "__main__":
    main(script, interrupted=RESUMES)
