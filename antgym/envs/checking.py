"""Checking a batch: whether a vector environment keeps Gymnasium's contract, and each slot repeats a single one.

Gymnasium's ``check_env`` looks at single environments only. This is its counterpart for batches that step together.
"""

from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.vector.utils import batch_space, iterate
from numpy.typing import NDArray

from antgym.envs.vector import env_seeds
from antgym.errors import ContractError, ParameterError

SLOTS = 3
_NOT_ITS_OWN = (
    "num_envs",
    "vectorization_mode",
    "autoreset_mode",
)  # what a batch's spec holds beside its slots'
_PARTS = ("observations", "rewards", "terminations", "truncations", "infos")


def check_vector_env(
    env: "str | VectorEnv[Any, Any, Any]",
    *,
    single: Callable[[], gymnasium.Env[Any, Any]] | None = None,
    steps: int = 25,
    seed: int = 0,
    **kwargs: Any,
) -> None:
    """Check a batch; says nothing where all is well.

    Checked are the batched spaces, dtypes, shapes and bounds; that the same seed gives the same rollout and another one
    another; that slot i is, to the bit, the single environment with ``env_seeds(seed, n)[i]``; when episodes begin
    anew, ``final_obs`` and ``final_info`` among infos, and the masks of infos; that earlier observations stay.

    Args:
        env: an id, of which a batch of three is made in every autoreset mode, or a batch, checked in its own.
        single: makes what each slot must repeat; known where ``env`` is an id or comes from ``gymnasium.make_vec``.
        steps: of a rollout; episodes must end within them.
        seed: of the rollouts and of their actions.
        kwargs: arguments of the environment, where ``env`` is an id.

    Raises:
        ContractError: saying what is wrong, and at which step.
        ParameterError: if no episode ended, or what is to be repeated is not known.
    """
    if not isinstance(env, str):
        if kwargs:
            raise ParameterError(f"{sorted(kwargs)} are arguments of an id; a batch has its own already")
        _check(env, single or _single_of(env), steps, seed)
        return
    for mode in AutoresetMode:
        batch = gymnasium.make_vec(
            env, num_envs=SLOTS, vectorization_mode="vector_entry_point", autoreset_mode=mode, **kwargs
        )
        _check(batch, single or _single_of(batch), steps, seed)
        batch.close()


def _single_of(batch: VectorEnv[Any, Any, Any]) -> Callable[[], gymnasium.Env[Any, Any]]:
    spec = batch.spec
    if spec is None:
        raise ParameterError(
            "this batch was not made by gymnasium.make_vec; pass single=, which makes a slot alone"
        )
    own = {name: value for name, value in spec.kwargs.items() if name not in _NOT_ITS_OWN}
    return lambda: gymnasium.make(spec.id, **own)


def _check(
    batch: VectorEnv[Any, Any, Any], single: Callable[[], gymnasium.Env[Any, Any]], steps: int, seed: int
) -> None:
    mode = batch.metadata.get("autoreset_mode")
    if not isinstance(mode, AutoresetMode):
        raise ContractError(f"metadata['autoreset_mode'] is {mode!r}, no AutoresetMode")
    alone = SyncVectorEnv([single] * batch.num_envs, autoreset_mode=mode)
    _check_spaces(batch, alone)
    seen: list[Any] = []
    kept: list[Any] = []
    guide = _Guide(batch, mode)
    rollouts = _rollout(batch, seed, steps), _rollout(alone, env_seeds(seed, batch.num_envs), steps)
    for (place, mine), (_, theirs) in zip(*rollouts, strict=True):
        guide.check(place, mine)
        _require_same(place, mine, theirs, "alone, with its seed, it is")
        seen.append(mine)
        kept.append(deepcopy(mine))
    if not guide.ended:
        raise ParameterError(f"no episode ended within {steps} steps; give more of them")
    if not data_equivalence([result[0] for result in seen], [result[0] for result in kept], exact=True):
        raise ContractError(f"{mode}: observations are written over by later steps")
    for (place, again), before in zip(_rollout(batch, seed, steps), kept, strict=True):
        _require_same(place, again, before, "with the same seed before, it was")
    others = [result for _, result in _rollout(batch, seed + 1, steps)]
    if data_equivalence(others, kept, exact=True):
        raise ContractError(f"{mode}: another seed gives the same rollout")
    alone.close()


def _check_spaces(batch: VectorEnv[Any, Any, Any], alone: SyncVectorEnv) -> None:
    for name in ("action_space", "observation_space"):
        one, all_of_them = getattr(batch, f"single_{name}"), getattr(batch, name)
        if one != getattr(alone, f"single_{name}"):
            raise ContractError(f"single_{name} is {one}, that of a single environment is not")
        if all_of_them != batch_space(one, batch.num_envs):
            raise ContractError(f"{name} is {all_of_them}, not single_{name} {batch.num_envs} times")


def _rollout(env: Any, seed: int | list[int], steps: int) -> Iterator[tuple[str, Any]]:
    """Yield (where we are, what reset or step returned); the same actions for every environment of a shape."""
    disabled = env.metadata["autoreset_mode"] is AutoresetMode.DISABLED
    actions = deepcopy(env.action_space)
    actions.seed(0)
    yield "reset", env.reset(seed=seed)
    over = np.zeros(env.num_envs, bool)
    for step in range(steps):
        if disabled and over.any():
            slots = np.flatnonzero(over).tolist()
            yield f"reset of slots {slots} before step {step}", env.reset(options={"reset_mask": over})
        result = env.step(actions.sample())
        over = np.asarray(result[2]) | np.asarray(result[3])
        yield f"step {step}", result


def _require_same(place: str, mine: tuple[Any, ...], theirs: tuple[Any, ...], who: str) -> None:
    names = _PARTS if len(theirs) == len(_PARTS) else ("observations", "infos")
    for name, one, other in zip(names, mine, theirs, strict=True):
        if not data_equivalence(one, other, exact=True):
            raise ContractError(f"{place}: {_difference(name, one, other, who)}")


def _difference(name: str, one: Any, other: Any, who: str) -> str:
    """Say where two things that are not the same differ first."""
    if isinstance(one, dict) and isinstance(other, dict) and one.keys() == other.keys():
        key = next(key for key in one if not data_equivalence(one[key], other[key], exact=True))
        return _difference(f"{name}[{key!r}]", one[key], other[key], who)
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        if (one.shape, one.dtype) == (other.shape, other.dtype):
            same = [data_equivalence(a, b, exact=True) for a, b in zip(one.flat, other.flat, strict=True)]
            at = np.unravel_index(same.index(False), one.shape)
            return _difference(f"{name}[{', '.join(map(str, at))}]", one[at], other[at], who)
        one, other = (f"{array.dtype} of shape {array.shape}" for array in (one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        one, other = (f"there for {list(part)}" for part in (one, other))
    return f"{name} is {one}, {who} {other}"


class _Guide:
    """Walks along a rollout and checks every result by itself, and against the one before."""

    def __init__(self, batch: VectorEnv[Any, Any, Any], mode: AutoresetMode) -> None:
        self._batch, self._mode, self.ended = batch, mode, False
        self._over = np.zeros(batch.num_envs, bool)
        self._shown: list[Any] = []

    def check(self, place: str, result: tuple[Any, ...]) -> None:
        """Check what reset or step returned."""
        observations, infos = result[0], result[-1]
        _require_within(place, observations, self._batch.observation_space)
        self._require_masks(place, infos)
        shown = deepcopy(list(iterate(self._batch.observation_space, observations)))
        if len(result) == len(_PARTS):
            self._check_step(place, result)
        elif self._shown:
            for i in np.flatnonzero(~self._over):
                if not data_equivalence(shown[i], self._shown[i], exact=True):
                    raise ContractError(f"{place}: slot {i} was not to be reset, but shows something else")
        self._shown = shown

    def _check_step(self, place: str, result: tuple[Any, ...]) -> None:
        _, rewards, terminations, truncations, infos = result
        count = self._batch.num_envs
        for name, array, kind in (
            ("rewards", rewards, np.floating),
            ("terminations", terminations, np.bool_),
            ("truncations", truncations, np.bool_),
        ):
            if not (
                isinstance(array, np.ndarray)
                and array.shape == (count,)
                and issubclass(array.dtype.type, kind)
            ):
                raise ContractError(
                    f"{place}: {name} are {array!r}, not {count} numbers of type {kind.__name__}"
                )
        if not np.isfinite(rewards).all():
            raise ContractError(f"{place}: rewards are {rewards}")
        over = terminations | truncations
        if self._mode is AutoresetMode.NEXT_STEP and (over[self._over].any() or rewards[self._over].any()):
            slots = np.flatnonzero(self._over).tolist()
            raise ContractError(
                f"{place}: slots {slots} begin anew, with reward 0 and not over, but got {rewards}"
            )
        self._check_finals(place, infos, over)
        self.ended = self.ended or bool(over.any())
        self._over = over

    def _check_finals(self, place: str, infos: dict[str, Any], over: NDArray[np.bool_]) -> None:
        due = over if self._mode is AutoresetMode.SAME_STEP else np.zeros_like(over)
        for name in ("final_obs", "final_info"):
            given = infos.get(f"_{name}", np.zeros_like(over))
            if (given != due).any():
                raise ContractError(
                    f"{place}, {self._mode}: {name} is there for {given}, episodes ended in {due}"
                )
        for i in np.flatnonzero(due):
            _require_within(
                f"{place}, final_obs of slot {i}", infos["final_obs"][i], self._batch.single_observation_space
            )

    def _require_masks(self, place: str, infos: dict[str, Any]) -> None:
        for key, values in infos.items():
            mask = infos.get(f"_{key}")
            if key.startswith("_"):
                continue
            if not (
                isinstance(mask, np.ndarray) and mask.dtype == bool and mask.shape == (self._batch.num_envs,)
            ):
                raise ContractError(f"{place}: info {key!r} has no mask _{key}, one bool a slot")
            if isinstance(values, dict):
                self._require_masks(f"{place}, {key}", values)


def _require_within(place: str, observation: Any, space: gymnasium.Space[Any]) -> None:
    """Say what is wrong with an observation that does not lie in its space."""
    if observation in space:
        return
    if isinstance(space, gymnasium.spaces.Dict) and isinstance(observation, dict):
        if observation.keys() != space.keys():
            raise ContractError(f"{place}: the observation has {list(observation)}, its space {list(space)}")
        for name, part in space.items():
            _require_within(f"{place}, {name}", observation[name], part)
    if isinstance(space, gymnasium.spaces.Box) and isinstance(observation, np.ndarray):
        if (observation.shape, observation.dtype) != (space.shape, space.dtype):
            raise ContractError(
                f"{place}: the observation is {observation.dtype} of shape {observation.shape}, its space "
                f"{space.dtype} of shape {space.shape}"
            )
        where = tuple(np.argwhere(~((observation >= space.low) & (observation <= space.high)))[0].tolist())
        raise ContractError(
            f"{place}: entry {where} of the observation is {observation[where]}, outside "
            f"[{space.low[where]}, {space.high[where]}]"
        )
    raise ContractError(f"{place}: the observation {observation!r} does not lie in {space}")
