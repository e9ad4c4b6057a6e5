"""The exact optimum among discs: the shortest way over the lines that touch two discs, and over arcs of their rims.

A taut string from start to goal is straight where it is free and lies on a rim where it bends, so it consists of
common tangents and arcs (start and goal are discs of radius 0). All tangents that no disc cuts, and all arcs between
neighbouring points of contact that no other disc covers, make a graph that holds the shortest path; Dijkstra finds it.

Discs that touch or overlap leave no gap. A cut or a gap below 1e-9 of the world's extent does not count, so the
length is exact to about that. The bounds are convex: a string never bends at them, but an arc may not leave them.

A path no longer than some reach stays within an ellipse around start and goal. What lies in a slim one is searched
first, and all of the world only where the path that this gives, or the lack of one, leaves room for a better one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ScenarioError
from antgym.maps.discs import DiscScenario, Floats

TOLERANCE = 1e-9  # of the world's extent
MOST_DISCS = 1000  # a pair has four tangents and each is held against all discs
CHORD = np.pi / 180
REACHES = (1.03, 1.2, 1.6, np.inf)  # of the straight line, looked through one after the other
_Ints = NDArray[np.int64]


class _Rims(NamedTuple):
    """Start, goal and discs as circles seen from the start: (n,) arrays, start and goal first with radius 0."""

    x: Floats
    y: Floats
    radius: Floats
    slack: float

    def at(self, circle: _Ints, angle: Floats) -> Floats:
        """Return the points of circles at angles, (k, 2)."""
        radius = self.radius[circle]
        return np.stack(
            [self.x[circle] + radius * np.cos(angle), self.y[circle] + radius * np.sin(angle)], axis=1
        )


class _Lines(NamedTuple):
    """Tangents: which circles each touches, at which angle of either, and where."""

    one: _Ints
    other: _Ints
    angle_one: Floats
    angle_other: Floats
    begin: Floats
    end: Floats

    def only(self, kept: NDArray[np.bool_]) -> "_Lines":
        """Return some of them."""
        return _Lines._make(part[kept] for part in self)


def shortest_length(scenario: DiscScenario) -> float:
    """Return the length of the shortest path in world units, to about 1e-9; ScenarioError where none exists.

    Raises:
        ScenarioError: also if the world has over 1,000 discs.
    """
    return _search(scenario).length


def shortest_path(scenario: DiscScenario) -> Floats:
    """Return the shortest path, (n, 2) points from start to goal, arcs as chords of at most a degree."""
    _, rims, circles, angles = _search(scenario)
    parts = []
    for i, circle in enumerate(circles):
        turn = 0.0
        if (
            i + 1 < len(circles) and circles[i + 1] == circle
        ):  # the arc was free, so it is the shorter way round
            turn = (angles[i + 1] - angles[i] + np.pi) % (2 * np.pi) - np.pi
        steps = np.arange(max(int(np.ceil(abs(turn) / CHORD)), 1)) * CHORD * np.sign(turn)
        parts.append(rims.at(np.full(len(steps), circle), angles[i] + steps))
    return np.concatenate(parts) + scenario.start


class _Found(NamedTuple):
    """A shortest path: its length, and which of some circles it touches, at which angles."""

    length: float
    rims: _Rims
    circles: _Ints
    angles: Floats


def _search(scenario: DiscScenario) -> _Found:
    grown = scenario.world.grown
    if len(grown) > MOST_DISCS:
        raise ScenarioError(
            f"{len(grown):,} discs are too many for the exact optimum: at most {MOST_DISCS:,}; "
            "leave out those that lie inside others or far away"
        )
    ends = np.array([(*scenario.start, 0.0), (*scenario.goal, 0.0)])
    # as seen from the start: a small world far from the origin would lose digits
    x, y, radius = (np.concatenate([ends, grown]) - (*scenario.start, 0.0)).T
    bounds = np.array(scenario.world.bounds) - np.repeat(scenario.start, 2)
    rims = _Rims(x, y, radius, TOLERANCE * max(float(np.ptp(x)), float(np.ptp(y)), float(radius.max())))
    by_way_of = np.hypot(x - x[0], y - y[0]) + np.hypot(x - x[1], y - y[1]) - 2 * radius
    found = None
    for times in REACHES:
        # once there is a path, the shortest one is no longer
        reach = times * scenario.straight_line if found is None else found.length
        near = by_way_of <= reach + rims.slack
        found = _shortest(bounds, _Rims(x[near], y[near], radius[near], rims.slack))
        if found is not None and (found.length <= reach or near.all()):
            return found
        if near.all():
            break
    raise ScenarioError(
        f"no path leads from {scenario.start} to {scenario.goal}: discs and bounds close every way; "
        "take out or shrink a disc, or widen the bounds"
    )


def _shortest(bounds: Floats, rims: _Rims) -> _Found | None:
    """Return the shortest path past these discs alone, None where they leave none."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    lines = _uncut(_within(_tangents(rims), bounds, rims.slack), rims)
    count = len(lines.one)
    circle = np.concatenate([[0, 1], lines.one, lines.other])
    angle = np.concatenate([[0.0, 0.0], lines.angle_one, lines.angle_other])
    node = np.where(circle < 2, circle, np.arange(len(circle)))  # all lines from the start begin in one node
    one, other = node[2 : 2 + count], node[2 + count :]
    arcs = _arcs(bounds, rims, circle, angle)
    tails, heads = np.concatenate([one, arcs[0]]), np.concatenate([other, arcs[1]])
    lengths = np.concatenate([np.hypot(*(lines.end - lines.begin).T), arcs[2]])
    # a length of 0 would be no edge at all
    graph = coo_array((np.maximum(lengths, np.finfo(float).tiny), (tails, heads)), (len(node),) * 2)
    distances, before = dijkstra(graph.tocsr(), directed=False, indices=0, return_predecessors=True)
    if not np.isfinite(distances[1]):
        return None
    way = [1]
    while way[-1] != 0:
        way.append(int(before[way[-1]]))
    passed = np.array(way[::-1])
    return _Found(float(distances[1]), rims, circle[passed], angle[passed])


def _tangents(rims: _Rims) -> _Lines:
    """Return every line that touches two circles: two outer ones and, where there is a gap, two inner ones."""
    one, other = np.triu_indices(len(rims.x), 1)
    dx, dy = rims.x[other] - rims.x[one], rims.y[other] - rims.y[one]
    apart, towards = np.hypot(dx, dy), np.arctan2(dy, dx)
    first, second = rims.radius[one], rims.radius[other]
    parts = []
    for sign in (1.0, -1.0):  # of the other's radius: outer, then inner
        reach = first - sign * second
        drawn = apart > np.abs(reach) + rims.slack
        if sign < 0:
            drawn &= (first > 0) & (second > 0)  # with a point for a circle both kinds are one
        aside = np.arccos(reach[drawn] / apart[drawn])
        for side in (1.0, -1.0):
            here = towards[drawn] + side * aside
            there = here if sign > 0 else here + np.pi
            circles = one[drawn], other[drawn]
            parts.append(_Lines(*circles, here, there, rims.at(circles[0], here), rims.at(circles[1], there)))
        if sign > 0:  # from point to point there is one line, not two
            parts[-1] = parts[-1].only(np.greater(first[drawn] + second[drawn], 0))
    return _Lines(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _within(lines: _Lines, bounds: Floats, slack: float) -> _Lines:
    low, high = bounds[::2] - slack, bounds[1::2] + slack
    points = np.stack([lines.begin, lines.end], axis=1)
    return lines.only(np.asarray(((points >= low) & (points <= high)).all(axis=(1, 2))))


def _uncut(lines: _Lines, rims: _Rims) -> _Lines:
    """Return the lines that no disc cuts; those that one disc cuts are not held against the next."""
    along = lines.end - lines.begin
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    rows = np.column_stack([lines.begin, along, along / square[:, None]])
    left = np.arange(len(rows))
    discs = np.column_stack(rims[:3])[2:]
    for x, y, radius in np.concatenate([discs, _knots(rims)]).tolist():
        to_x, to_y = x - rows[:, 0], y - rows[:, 1]
        share = np.clip(to_x * rows[:, 4] + to_y * rows[:, 5], 0.0, 1.0)
        apart = (to_x - share * rows[:, 2]) ** 2 + (to_y - share * rows[:, 3]) ** 2
        free = apart >= max(radius - rims.slack, 0.0) ** 2
        if not free.all():
            rows, left = rows[free], left[free]
    kept = np.zeros(len(lines.one), np.bool_)
    kept[left] = True
    return lines.only(kept)


def _knots(rims: _Rims) -> Floats:
    """Return a tiny disc, (k, 3), wherever two discs touch: through a gap of nothing no line may pass."""
    one, other = (part + 2 for part in np.triu_indices(len(rims.x) - 2, 1))
    dx, dy = rims.x[other] - rims.x[one], rims.y[other] - rims.y[one]
    apart = np.hypot(dx, dy)
    touching = np.abs(apart - rims.radius[one] - rims.radius[other]) <= 4 * rims.slack
    share = rims.radius[one[touching]] / apart[touching]
    x = rims.x[one[touching]] + share * dx[touching]
    y = rims.y[one[touching]] + share * dy[touching]
    return np.column_stack([x, y, np.full(len(x), 10 * rims.slack)])


def _arcs(bounds: Floats, rims: _Rims, circle: _Ints, angle: Floats) -> tuple[_Ints, _Ints, Floats]:
    """Return the arcs between neighbouring points of contact: both nodes and the length of each.

    Where another disc covers some of a rim, or the rim leaves the bounds, no point of contact lies there: that piece
    is all within one arc, and the one place of it that is looked up tells which.
    """
    turned = np.where(circle < 2, 0.0, angle % (2 * np.pi))
    order = np.lexsort((turned, circle))
    order = order[circle[order] >= 2]
    owner, turned = circle[order], turned[order]
    last = np.append(owner[1:] != owner[:-1], True)[: len(owner)]
    first = np.flatnonzero(np.append(True, last[:-1])[: len(owner)])
    following = np.arange(1, len(owner) + 1)
    following[last] = first
    sweep = (turned[following] - turned) % (2 * np.pi)
    blocked = np.zeros(len(owner), np.bool_)
    for some, at in _covered(bounds, rims):
        # the last contact of that rim at or before the place; before the first, the last of all
        place = (
            np.searchsorted(owner + turned / (2 * np.pi) * 0.5, some + at / (2 * np.pi) * 0.5, "right") - 1
        )
        met = np.isin(some, owner)
        begin = np.searchsorted(owner, some)
        wrapped = np.where(place < begin, np.searchsorted(owner, some, "right") - 1, place)
        blocked[wrapped[met]] = True
    kept = ~blocked & (following != np.arange(len(owner)))
    one, other = order[kept], order[following[kept]]
    lengths = rims.radius[owner[kept]] * sweep[kept]
    return _shorter_of_two(one, other, lengths)


def _shorter_of_two(one: _Ints, other: _Ints, lengths: Floats) -> tuple[_Ints, _Ints, Floats]:
    """Drop the longer arc where a rim has two contacts alone, which two arcs join: a graph would add them up."""
    low, high = np.minimum(one, other), np.maximum(one, other)
    order = np.lexsort((lengths, high, low))
    low, high, lengths = low[order], high[order], lengths[order]
    kept = np.append(True, (low[1:] != low[:-1]) | (high[1:] != high[:-1]))[: len(low)]
    return low[kept], high[kept], lengths[kept]


def _covered(bounds: Floats, rims: _Rims) -> list[tuple[_Ints, Floats]]:
    """Return circles and one angle each within every piece of their rims that cannot be walked along."""
    one, other = (part + 2 for part in np.nonzero(~np.eye(len(rims.x) - 2, dtype=np.bool_)))
    dx, dy = rims.x[other] - rims.x[one], rims.y[other] - rims.y[one]
    apart, first, second = np.hypot(dx, dy), rims.radius[one], rims.radius[other]
    crossed = (apart <= first + second + rims.slack) & (apart > np.abs(first - second))
    pieces = [(one[crossed], np.arctan2(dy[crossed], dx[crossed]) % (2 * np.pi))]
    x_min, x_max, y_min, y_max = bounds
    beyond = (x_max - rims.x, y_max - rims.y, rims.x - x_min, rims.y - y_min)
    for quarter, room in enumerate(beyond):
        out = np.flatnonzero(rims.radius[2:] > room[2:] + rims.slack) + 2
        pieces.append((out, np.full(len(out), quarter * np.pi / 2)))
    return pieces
