"""The hive flown slowly: the same bees bit for bit, every path measured whole and held against all discs."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np

from antgym.kernels import rng
from antgym.planners.bee_rules import find_bee_rules
from antgym.planners.parameters import BeeParameters


def least(numbers):
    return min(numbers, default=math.inf)


class Twin:
    """One run of the twin."""

    def __init__(self, scenario, rules, bees, cycles, seed):
        self.scenario, self.rules, self.seed = scenario, find_bee_rules(rules), seed
        self.employed, self.onlookers, self.cycles = bees // 2, bees - bees // 2, cycles
        self.drawn, self.evaluated, self.done, self.clock = 0, 0, 0, 0
        self.tabu, self.best = [], SimpleNamespace(value=math.inf)
        self.sources = [self.source(self.random_points()) for _ in range(self.employed)]
        self.out = SimpleNamespace(best=[], mean=[], arrived=[])
        self.memorise()

    def bits(self, counter):
        return np.uint64(rng.draw(np.uint64(self.seed), np.uint64(counter)))

    def unit(self, counter):
        return float(rng.unit(self.bits(counter)))

    def random_points(self):
        """(7)"""
        x_min, x_max, y_min, y_max = self.scenario.world.bounds
        points = []
        for i in range(self.rules.points):
            x = x_min + (x_max - x_min) * self.unit(self.drawn + 2 * i)
            y = y_min + (y_max - y_min) * self.unit(self.drawn + 2 * i + 1)
            points.append((x, y))
        self.drawn += 2 * self.rules.points
        return points

    def source(self, points):
        """A path that was drawn as a whole, measured from the start on."""
        self.evaluated += 1
        return SimpleNamespace(points=points, tries=0, **self.measured(points))

    def measured(self, points, moved=None):
        """Length, gap and cost; the length summed from both ends to the way-point that moved, if one did."""
        path = [self.scenario.start, *points, self.scenario.goal]
        pairs = list(pairwise(path))
        lengths = [math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay)) for (ax, ay), (bx, by) in pairs]
        gaps = [self.clearance(*pair) for pair in pairs]
        total = added(lengths)
        if moved is not None:
            total = (added(lengths[:moved]) + added(lengths[: moved + 1 : -1])) + (
                lengths[moved] + lengths[moved + 1]
            )
        hits = sum(gap <= 0 for gap in gaps)
        return {"length": total, "gap": least(gaps), "value": self.cost(total, least(gaps), float(hits))}

    def clearance(self, a, b):
        """Of a segment, to the nearest disc."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        square, gaps = dx * dx + dy * dy, []
        for x, y, radius in self.scenario.world.grown.tolist():
            ux, uy = x - a[0], y - a[1]
            t = min(max((ux * dx + uy * dy) * (1.0 / square), 0.0), 1.0) if square > 1e-300 else 0.0
            ex, ey = ux - t * dx, uy - t * dy
            gaps.append(math.sqrt(ex * ex + ey * ey) - radius)
        return least(gaps)

    def cost(self, length, gap, hits):
        rules, scenario, safe = self.rules, self.scenario, self.scenario.world.safe_distance
        if not rules.printed:
            straight = scenario.straight_line
            shortfall = max(safe - gap, 0.0)
            danger = (1 - rules.weight) / straight * shortfall + (1 - rules.weight) * rules.hit * hits
            return rules.weight / straight * length + danger
        aim = math.atan2(scenario.goal[1] - scenario.start[1], scenario.goal[0] - scenario.start[0])
        way = rules.weight * length
        if gap > safe:
            return way + (1.0 - rules.weight) * aim
        d, both = max(gap, 0.0), way + (1.0 - rules.weight) * (safe + 1.0) * aim
        b = d * way - 1.0
        inside = b * b + 4.0 * d * both
        root = math.sqrt(max(inside, 0.0))
        return (b + root) / (2.0 * d) if b > 0.0 or inside <= 0.0 else 2.0 * both / (root - b)

    def coordinate(self, s, bits):
        """Axis, way-point and another source."""
        number = int(rng.below(bits & np.uint64(0xFFFFFFFF), 2 * self.rules.points))
        other = int(rng.below(bits >> np.uint64(32), self.employed - 1))
        return number % 2, number // 2, self.sources[other + (other >= s)]

    def clipped(self, value, axis):
        return min(max(value, self.scenario.world.bounds[2 * axis]), self.scenario.world.bounds[2 * axis + 1])

    def cycle(self, parameters):
        left = (self.cycles - self.done - 1) / self.cycles
        xi = parameters.xi_min + left * (parameters.xi_max - parameters.xi_min)
        for s in range(self.employed):
            self.bee(s, xi)
        sums = running_sums(1.0 / (1.0 + s.value) if s.value >= 0 else 1.0 - s.value for s in self.sources)
        for _ in range(self.onlookers):
            mark = self.unit(self.drawn + 1) * sums[-1]
            self.bee(next(s for s in range(self.employed) if sums[s] > mark), xi)
        self.memorise()
        self.write()
        self.scout(parameters, xi)
        self.done += 1

    def bee(self, s, xi):
        """(9), (11), and what the best path adds."""
        source = self.sources[s]
        axis, i, other = self.coordinate(s, self.bits(self.drawn))
        here = source.points[i][axis]
        share = xi if self.rules.away else xi * (2.0 * self.unit(self.drawn + 2) - 1.0)
        value = here + share * (here - other.points[i][axis])
        if self.rules.pull > 0:
            value += self.rules.pull * self.unit(self.drawn + 3) * (self.best.points[i][axis] - here)
        self.drawn += 4
        self.evaluated += 1
        points = with_value(source.points, i, axis, self.clipped(value, axis))
        source.tries += 1
        if self.measured(points, moved=i)["value"] < source.value:
            self.sources[s] = SimpleNamespace(points=points, tries=0, **self.measured(points))

    def memorise(self):
        for source in self.sources:
            if source.value < self.best.value:
                self.best = source

    def write(self):
        clear = [source.length for source in self.sources if source.gap > 0]
        self.out.best.append(self.best.length if self.best.gap > 0 else math.inf)
        self.out.mean.append(added(clear) / len(clear) if clear else math.inf)
        self.out.arrived.append(len(clear))

    def scout(self, parameters, xi):
        values = [source.value for source in self.sources]
        elite = values.index(min(values)) if self.rules.elite else None
        tried = [(source.tries, -s) for s, source in enumerate(self.sources) if s != elite]
        tries, s = max(tried)
        if tries < parameters.limit:
            return
        s, abandoned = -s, self.sources[-s]
        self.forbid(abandoned.points)
        if self.rules.scout == "neighbour":
            axis, i, other = self.coordinate(s, self.bits(self.drawn))
            here = abandoned.points[i][axis]
            share = xi * (2.0 * self.unit(self.drawn + 1) - 1.0)
            value = self.clipped(here + share * (here - other.points[i][axis]), axis)
            points = with_value(abandoned.points, i, axis, value)
            self.drawn += 2
        else:
            points = self.random_points()
            for _ in range(self.rules.redraws):
                if not self.is_tabu(points, parameters.tabu_radius):
                    break
                points = self.random_points()
        self.sources[s] = self.source(points)

    def forbid(self, points):
        if self.rules.tabu:
            if len(self.tabu) == self.rules.tabu:
                oldest = min(self.tabu, key=lambda entry: entry.stamp)
                oldest.points, entry = points, oldest
            else:
                entry = SimpleNamespace(points=points)
                self.tabu.append(entry)
            self.clock += 1
            entry.stamp = self.clock

    def is_tabu(self, points, radius):
        for entry in self.tabu:
            square = added(
                (p[axis] - q[axis]) * (p[axis] - q[axis])
                for axis in range(2)
                for p, q in zip(points, entry.points, strict=True)
            )
            if square < radius * radius:
                self.clock += 1
                entry.stamp = self.clock
                return True
        return False


def plan(scenario, parameters, *, rules="wu2018", ants=10, iterations=10, seed=0):
    """The twin. Returns a namespace with length, path, best, mean, arrived, moves."""
    return plan_in_blocks(scenario, [(parameters, iterations)], rules=rules, ants=ants, seed=seed)


def plan_in_blocks(scenario, blocks, *, rules, ants, seed):
    """The twin under parameters that change: blocks are (parameters, iterations)."""
    with np.errstate(over="ignore"):
        twin = Twin(scenario, rules, ants, sum(iterations for _, iterations in blocks), seed)
        for parameters, iterations in blocks:
            for _ in range(iterations):
                twin.cycle(BeeParameters(*parameters))
    out = twin.out
    out.length, out.moves = out.best[-1], twin.evaluated
    out.path = [scenario.start, *twin.best.points, scenario.goal]
    return out


def with_value(points, i, axis, value):
    changed = (value, points[i][1]) if axis == 0 else (points[i][0], value)
    return [*points[:i], changed, *points[i + 1 :]]


def added(numbers):
    total = 0.0
    for number in numbers:
        total += number
    return total


def running_sums(numbers):
    sums, total = [], 0.0
    for number in numbers:
        total += number
        sums.append(total)
    return sums
