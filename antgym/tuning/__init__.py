"""One paid trial: spaces, tasks, budgets, sessions, agents and the ledger. All that an agent may import."""

from antgym.planners.space import Parameter, ParameterSpace
from antgym.tuning.actions import changed, choices, settings_of, start_of
from antgym.tuning.agent import Agent, Result, tune, tune_together
from antgym.tuning.budget import Budget
from antgym.tuning.features import shown_rules
from antgym.tuning.observation import observe, observe_with_map
from antgym.tuning.problem import COST_CAP, Task
from antgym.tuning.session import Session, Trial, incumbent

__all__ = [
    "COST_CAP",
    "Agent",
    "Budget",
    "Parameter",
    "ParameterSpace",
    "Result",
    "Session",
    "Task",
    "Trial",
    "changed",
    "choices",
    "incumbent",
    "observe",
    "observe_with_map",
    "settings_of",
    "shown_rules",
    "start_of",
    "tune",
    "tune_together",
]
