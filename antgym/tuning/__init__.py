"""One paid trial: spaces, tasks, budgets, sessions, agents and the ledger. All that an agent may import."""

from antgym.planners.space import Parameter, ParameterSpace
from antgym.tuning.actions import Choice, Start, changed, choices, moved, settings_of, starts_of
from antgym.tuning.agent import Agent, Result, tune, tune_together
from antgym.tuning.budget import Budget
from antgym.tuning.features import shown_rules
from antgym.tuning.observation import observe, observe_with_map
from antgym.tuning.problem import COST_CAP, Task
from antgym.tuning.session import Session, Trial, incumbent
from antgym.tuning.shown import Shown, shown_in

__all__ = [
    "COST_CAP",
    "Agent",
    "Budget",
    "Choice",
    "Parameter",
    "ParameterSpace",
    "Result",
    "Session",
    "Shown",
    "Start",
    "Task",
    "Trial",
    "changed",
    "choices",
    "incumbent",
    "moved",
    "observe",
    "observe_with_map",
    "settings_of",
    "shown_in",
    "shown_rules",
    "starts_of",
    "tune",
    "tune_together",
]
