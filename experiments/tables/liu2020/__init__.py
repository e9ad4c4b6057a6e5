"""liu2020 replayed: its Tables 1-3 and its convergence figure on six maps of ours, then all again on other sixes.

The paper's maps are not published, so lengths compare within a column, never across; one six says nothing about
others, so Table 4 and the verdict are over all draws. :mod:`.methods` holds the rows, :mod:`.draw` plays one draw,
:mod:`.archive` keeps it, :mod:`.findings` judges, :mod:`.sheets`, :mod:`.figure` and :mod:`.report` write.
"""

from experiments.tables.liu2020.draw import Arguments
from experiments.tables.liu2020.report import replay

__all__ = ["Arguments", "replay"]
