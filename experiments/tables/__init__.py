"""The papers' tables, our figures beside theirs: ``python -m experiments.tables liu2020`` and three comparisons.

liu2020 is replayed in :mod:`experiments.tables.liu2020`. Each of zhang_apf, zhang2011 and wei2018 sets an improved
colony against a basic one, on a single map and mostly in pictures; :mod:`experiments.tables.comparison` does it again
on a hundred maps, :mod:`experiments.tables.findings` counts and :mod:`experiments.tables.report` writes.
"""
