"""The colony as the equations print it."""

from itertools import pairwise

import numpy as np

from antgym.planners.rules import find_rules
from reference.ground import allowed, clearance, degree, end_of, mean_move, steps_of
from reference.twin import shares


class Textbook:
    """The colony as printed, float64: all pheromone in a dictionary, all of it swept, powers with ``**`` in logs."""

    def __init__(self, scenario, parameters, rules):
        self.scenario, self.rules = scenario, find_rules(rules)
        self.alpha, self.beta, self.rho, q = parameters
        self.q, self.tau, self.options = q / self.rules.initial_pheromone, {}, {}
        self.fresh, self.limits, self.best, self.best_path = 1.0, (0.0, np.inf), np.inf, []
        self.mean_move = mean_move(scenario) if self.rules.initial == "degree" else None
        self.layered = scenario.motion.layered and self.rules.trap != "retreat"

    def moves(self, cell):
        """Ends, lengths, log η and initial pheromone of the moves from a cell."""
        if cell not in self.options:
            rules, size = self.rules, np.array(self.scenario.world.cell)
            steps = [s for s in steps_of(self.scenario.motion) if allowed(self.scenario, rules, cell, s)]
            ends = [end_of(cell, s) for s in steps]
            lengths = np.array([np.linalg.norm(np.array(s) * size) for s in steps])
            to_goal = np.array([np.linalg.norm((np.array(self.scenario.goal) - e) * size) for e in ends])
            to_start = np.array([np.linalg.norm((np.array(self.scenario.start) - e) * size) for e in ends])
            if steps:
                step = np.minimum(lengths, lengths.mean()) if rules.clipped else lengths
                span = {"goal": step + to_goal, "start": to_start, "current": step}[rules.target]
                flat = np.array([1.0 / (abs(s[2]) + 1) for s in steps])
                eta = np.log(1 / span) * rules.w1 + np.log(flat) * rules.w2
                eta -= rules.z2 * np.log(np.maximum(to_goal, size.min()))
                if rules.z3:
                    far = np.array([clearance(self.scenario, end) for end in ends]) / size.min()
                    least, most = rules.clearance
                    eta += rules.z3 * np.log(np.minimum((far - least) / (most - least), 1))
                first = np.ones(len(steps))
                if rules.initial == "degree":
                    counts = [max(degree(self.scenario, rules, end)[0], 1) for end in ends]
                    first = lengths / self.mean_move * counts
            self.options[cell] = (ends, lengths, eta, first) if steps else ([], lengths, None, None)
        return self.options[cell]

    def key(self, cell, end):
        return end if self.rules.pheromone_on == "node" else (cell, end)

    def step(self, cell, seen, rng):
        """The end and the length of one ant's next move; None where it is trapped."""
        ends, lengths, eta, first = self.moves(cell)
        ways = [k for k, end in enumerate(ends) if self.layered or self.is_open(end, seen)]
        if not ways:
            return None
        tau = np.array([self.tau.get(self.key(cell, ends[k]), self.fresh * first[k]) for k in ways])
        logits = self.alpha * np.log(tau) + self.beta * eta[ways]
        if rng.random() < self.rules.q0:
            i = int(np.argmax(np.log(tau) + eta[ways] if self.rules.greedy == "plain" else logits))
        else:
            sums = np.exp(logits - logits.max()).cumsum()
            i = int(np.searchsorted(sums, rng.random() * sums[-1], side="right"))
        if self.rules.local:
            xi, key = self.rules.local, self.key(cell, ends[ways[i]])
            self.tau[key] = (1 - xi) * np.clip(tau[i], *self.limits) + xi * self.rules.local_to
        return ends[ways[i]], lengths[ways[i]]

    def is_open(self, end, seen):
        if end in seen or self.rules.trap != "lookahead" or end == self.scenario.goal:
            return end not in seen
        return any(following not in seen for following in self.moves(end)[0])

    def walk(self, ants, rng):
        """[(cells, lengths)] of the ants that arrive; all take their first step, then all their second."""
        paths, seen = (
            [[self.scenario.start] for _ in range(ants)],
            [{self.scenario.start} for _ in range(ants)],
        )
        lengths, done, on_the_way = [[] for _ in range(ants)], [], list(range(ants))
        while on_the_way:
            for ant in list(on_the_way):
                move = self.step(paths[ant][-1], seen[ant], rng)
                if move is None and self.rules.trap == "retreat" and lengths[ant]:
                    paths[ant].pop()
                    lengths[ant].pop()
                elif move is None:
                    on_the_way.remove(ant)
                else:
                    paths[ant].append(move[0])
                    lengths[ant].append(move[1])
                    seen[ant].add(move[0])
                    if move[0] == self.scenario.goal:
                        on_the_way.remove(ant)
                        done.append((paths[ant], sum(lengths[ant])))
        return done

    def update(self, done):
        """Evaporation, deposits, limits."""
        rules = self.rules
        for path, total in done:
            if total < self.best:
                self.best, self.best_path = total, path
        deposits = [(path, share * self.q, total) for (path, total), share in shares(done, rules)]
        deposits += [(self.best_path, rules.elite * self.q, self.best)]
        if rules.limits and self.best_path:
            high = self.q / ((1 - self.rho) * self.best)
            self.limits = high / (2 * (len(self.best_path) - 1)), high
        keep = lambda tau: np.clip(tau, *self.limits)  # noqa: E731
        if not rules.best_only:
            self.fresh *= self.rho
            self.tau = {key: keep(self.rho * tau) for key, tau in self.tau.items()}
            if rules.limits:
                self.fresh = keep(self.fresh)
        for path, amount, total in deposits:
            for cell, end in pairwise(path):
                self.reward(cell, end, amount, total, keep)

    def reward(self, cell, end, amount, total, keep):
        ends, lengths, _, first = self.moves(cell)
        k, key = ends.index(end), self.key(cell, end)
        old = self.tau.get(key, self.fresh * first[k])
        if self.rules.deposit == "edge":
            (here, near_here), (there, near_there) = (
                degree(self.scenario, self.rules, c) for c in (cell, end)
            )
            total = lengths[k] / ((near_there if there >= here else near_here) / lengths[k])
        if self.rules.best_only:
            self.tau[key] = self.rho * old + (1 - self.rho) * amount / total
        else:
            self.tau[key] = keep(old + amount / total)


def textbook(scenario, parameters, *, rules="liu2020", ants=20, iterations=10, seed=0):
    """Shortest length that the textbook colony finds, inf where no ant arrives."""
    colony, rng = Textbook(scenario, parameters, rules), np.random.default_rng(seed)
    for _ in range(iterations):
        colony.update(colony.walk(ants, rng))
    return colony.best
