"""Curves of a training for TensorBoard: those of stable-baselines3, and what training and validation cost and gave."""

from pathlib import Path
from typing import Any

from experiments.checkpoints import Standing

GAP = "validation/gap"
RUNS = "time/planner_runs"
"""Planner runs of the training so far. Curves are over steps of all slots, as stable-baselines3 draws them."""


def logger(folder: Path | None, name: str, first: int) -> Any:
    """Return what a model logs to: a run of TensorBoard's, or nothing.

    Args:
        folder: of all runs; None for nothing.
        name: of the run; one of that name is gone on with.
        first: step from which it is drawn anew: what a stopped training drew from there on is drawn no more.
    """
    from stable_baselines3.common.logger import Logger, TensorBoardOutputFormat

    if folder is None:
        return Logger(None, [])
    from tensorboard.compat.proto.event_pb2 import Event, SessionLog

    drawn = TensorBoardOutputFormat(str(folder / name))
    begun = SessionLog(
        status=SessionLog.START
    )  # as the purge_step of a SummaryWriter, which is not ours to make
    drawn.writer.file_writer.add_event(Event(step=first, session_log=begun))
    return Logger(str(folder / name), [drawn])


def draw(model: Any, standing: Standing) -> None:
    """Draw the gap that a model was just found to leave, at the step that it has come to."""
    evaluations, gap = standing.history[-1]
    model.logger.record(GAP, gap)
    model.logger.record(RUNS, evaluations)
    model.logger.dump(model.num_timesteps)
