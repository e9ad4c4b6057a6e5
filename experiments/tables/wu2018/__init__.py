"""wu2018: bees with a tabu list and a falling ξ against a plain colony, among 20 obstacles.

Its one world is not published: ours are 100, drawn from seeds, flown ten times each by 40 bees in 1,000 cycles. The
paper gives one number for each of three measures: cycles until the best path is steady, its length, and a collision
likelihood that it does not define.

As was measured once, none of its three directions holds. The tabu list changes nothing: random paths lie some 80 cm
apart, so none is within its 1 cm of another. Smaller steps are all that is left of the rule, and they keep more sources
among the obstacles; as printed, where bees only move away and a collision costs little, all three turn against it.
"""

from experiments.tables.wu2018.report import Arguments, replay

__all__ = ["Arguments", "replay"]
