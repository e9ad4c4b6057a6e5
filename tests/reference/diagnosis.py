"""Slow, obvious twin of a steered colony and of its diagnosis."""

from types import SimpleNamespace

import numpy as np

from reference.ground import F, end_of
from reference.twin import FLOOR, Twin

LOOKED_AT = 32


class Steered(Twin):
    """The twin of a colony whose parameters change between blocks, and that remembers its last walks."""

    def set(self, parameters):
        before = self.alpha, self.beta
        self.alpha, self.beta, self.rho = (
            F(parameters[0]),
            F(parameters[1]),
            np.float64(parameters[2]),
        )
        self.deposit = np.float64(parameters[3]) / self.rules.initial_pheromone
        for node in self.nodes.values() if before != (self.alpha, self.beta) else ():
            node.stale = True

    def walk(self):
        self.walks = super().walk()
        return self.walks

    def amounts(self, node):
        """Pheromone of every legal move, within the limits where there are some."""
        tau = [node.tau[k] for k in node.open]
        if self.rules.pheromone_on == "node":
            ends = [end_of(node.cell, self.steps[k]) for k in node.open]
            tau = [self.nodes[end].point if end in self.nodes else self.unvisited for end in ends]
        if self.rules.limits:
            low, high = self.bounds
            tau = [max(min(max(t * self.scale, low), high), FLOOR) for t in tau]
        return tau

    def branching(self):
        walks = [walk for walk, _ in self.walks[:LOOKED_AT]]
        total, choices = 0.0, 0
        for depth in range(max(map(len, walks))):
            for walk in walks:
                tau = self.amounts(self.nodes[walk[depth][0]]) if depth < len(walk) else []
                if len(tau) > 1:
                    parts = [t / max(tau) for t in tau]
                    effective = sum(parts) * sum(parts) / sum(part * part for part in parts)
                    total += (effective - 1) / (len(tau) - 1)
                    choices += 1
        return total / choices if choices else 1.0

    def distinct(self):
        walks = [tuple(walk) for walk, _ in self.walks[:LOOKED_AT]]
        return len(set(walks)) / len(walks)


def steer(scenario, blocks, *, rules, ants, seed):
    """Walk blocks [(parameters, iterations)]; return the history, the path and a dictionary of numbers per block."""
    history, reports, done, first = SimpleNamespace(best=[], mean=[], arrived=[]), [], 0, np.inf
    total = sum(iterations for _, iterations in blocks)
    with np.errstate(over="ignore"):
        twin = Steered(scenario, blocks[0][0], rules, ants, seed)
        for parameters, iterations in blocks:
            before = twin.best
            twin.set(parameters)
            for _ in range(iterations):
                twin.iterate(history)
            done += iterations
            first = twin.best if first == np.inf else first
            same = [best == twin.best for best in history.best]
            reports.append(
                {
                    "done": done / total,
                    "best": twin.best,
                    "first": first,
                    "gained": gained(before, twin.best),
                    "mean": history.mean[-1],
                    "stagnation": (done if twin.best == np.inf else sum(same) - 1) / total,
                    "arrived": sum(history.arrived[-iterations:]) / (ants * iterations),
                    "branching": twin.branching(),
                    "distinct": twin.distinct(),
                }
            )
    return history, twin.best_walk, reports


def gained(before, after):
    if before == after:
        return 0.0
    return 1.0 if before == np.inf else (before - after) / before
