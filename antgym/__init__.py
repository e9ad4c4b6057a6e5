"""antgym: Gymnasium environments in which an agent picks the parameters of a swarm path planner.

Importing this package registers the environments and imports nothing heavy; names are loaded on first use.
"""

from typing import TYPE_CHECKING, Any

from antgym.envs.catalogue import register_all
from antgym.errors import AntgymError

if TYPE_CHECKING:
    from antgym.envs.vector import env_seeds
    from antgym.exports import write_map, write_scenarios
    from antgym.maps.discs import DiscWorld
    from antgym.maps.fleet import Fleet
    from antgym.maps.formats.elevation import jacksboro, read_heights
    from antgym.maps.map import Map
    from antgym.maps.motion import Motion
    from antgym.maps.readers import read_map, read_scenarios
    from antgym.maps.scenes import read_discs
    from antgym.maps.shaping import fill_missing, voxelise
    from antgym.maps.suites import SuiteItem, load_suite
    from antgym.maps.world import GridWorld, Scenario
    from antgym.planners.bee_rules import BeeRules
    from antgym.planners.colony import Colony
    from antgym.planners.fleet import plan_fleet
    from antgym.planners.hive import Hive
    from antgym.planners.parameters import BeeParameters, ColonyParameters
    from antgym.planners.planning import plan, plan_many
    from antgym.planners.rules import Rules
    from antgym.planners.smoothing import smooth
    from antgym.tuning.agent import tune, tune_together
    from antgym.tuning.problem import TuningProblem
    from antgym.tuning.session import Session

__version__ = "0.1.0"

_HOMES = {
    "BeeParameters": "antgym.planners.parameters",
    "BeeRules": "antgym.planners.bee_rules",
    "Colony": "antgym.planners.colony",
    "ColonyParameters": "antgym.planners.parameters",
    "DiscWorld": "antgym.maps.discs",
    "Fleet": "antgym.maps.fleet",
    "GridWorld": "antgym.maps.world",
    "Hive": "antgym.planners.hive",
    "Map": "antgym.maps.map",
    "Motion": "antgym.maps.motion",
    "Rules": "antgym.planners.rules",
    "Scenario": "antgym.maps.world",
    "Session": "antgym.tuning.session",
    "SuiteItem": "antgym.maps.suites",
    "TuningProblem": "antgym.tuning.problem",
    "env_seeds": "antgym.envs.vector",
    "fill_missing": "antgym.maps.shaping",
    "jacksboro": "antgym.maps.formats.elevation",
    "load_suite": "antgym.maps.suites",
    "plan": "antgym.planners.planning",
    "plan_fleet": "antgym.planners.fleet",
    "plan_many": "antgym.planners.planning",
    "read_discs": "antgym.maps.scenes",
    "read_heights": "antgym.maps.formats.elevation",
    "read_map": "antgym.maps.readers",
    "read_scenarios": "antgym.maps.readers",
    "smooth": "antgym.planners.smoothing",
    "tune": "antgym.tuning.agent",
    "tune_together": "antgym.tuning.agent",
    "voxelise": "antgym.maps.shaping",
    "write_map": "antgym.exports",
    "write_scenarios": "antgym.exports",
}

__all__ = [
    "AntgymError",
    "BeeParameters",
    "BeeRules",
    "Colony",
    "ColonyParameters",
    "DiscWorld",
    "Fleet",
    "GridWorld",
    "Hive",
    "Map",
    "Motion",
    "Rules",
    "Scenario",
    "Session",
    "SuiteItem",
    "TuningProblem",
    "env_seeds",
    "fill_missing",
    "jacksboro",
    "load_suite",
    "plan",
    "plan_fleet",
    "plan_many",
    "read_discs",
    "read_heights",
    "read_map",
    "read_scenarios",
    "smooth",
    "tune",
    "tune_together",
    "voxelise",
    "write_map",
    "write_scenarios",
]

register_all()


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'antgym' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
