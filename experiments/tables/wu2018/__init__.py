"""wu2018: bees with a tabu list and a falling ξ against a plain colony, among 20 obstacles.

Its one world is not published: ours are 100, drawn from seeds, flown ten times each by 40 bees in 1,000 cycles. The
paper gives one number for each of three measures: cycles until the best path is steady, its length, and a collision
likelihood that it does not define.
"""

from experiments.tables.wu2018.report import Arguments, replay

__all__ = ["Arguments", "replay"]
