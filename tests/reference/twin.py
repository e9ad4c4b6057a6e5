"""The colony walked slowly: the same ants bit for bit, in the kernel's arithmetic but none of its bookkeeping."""

from types import SimpleNamespace

import numpy as np

from antgym.kernels import floats, rng
from antgym.planners.rules import find_rules
from reference.ground import F, allowed, clearance, degree, end_of, length_of, mean_move, steps_of

FLOOR = 2.0**-1000


def log2(x):
    return F(floats.log2(F(x)))  # compiled functions return Python floats


def log2_wide(x):
    return F(floats.log2_wide(np.float64(x)))


def exp2(x):
    return F(floats.exp2(F(x)))


def draw(seed, counter):
    return np.uint64(rng.draw(np.uint64(seed), np.uint64(counter)))


LANE_MAJOR = [8 * depth + lane for lane in range(8) for depth in range(4)]  # the kernel's order of summation


class Twin:
    """One run of the twin."""

    def __init__(self, scenario, parameters, rules, ants, seed):
        self.scenario, self.rules, self.ants, self.seed = scenario, find_rules(rules), ants, seed
        self.alpha, self.beta, self.rho = F(parameters[0]), F(parameters[1]), np.float64(parameters[2])
        self.deposit = np.float64(parameters[3]) / self.rules.initial_pheromone
        self.steps = steps_of(scenario.motion)
        self.lengths = [length_of(step, scenario.world.cell) for step in self.steps]
        self.nodes, self.scale, self.unvisited, self.bounds = {}, 1.0, 1.0, (0.0, np.inf)
        self.mean_move = mean_move(scenario) if self.rules.initial == "degree" else None
        self.roams = not scenario.motion.layered or self.rules.trap == "retreat"
        self.drawn, self.moves, self.best, self.best_walk = 0, 0, np.inf, []

    def node(self, cell):
        """A node with log2 of the heuristic of every move; None where the move is illegal."""
        if cell not in self.nodes:
            rules, eta = self.rules, heuristic(self.scenario, self.rules, cell, self.steps)
            tau = [self.unvisited] * len(self.steps)
            if rules.initial == "degree":
                for k, step in enumerate(self.steps):
                    moves = max(degree(self.scenario, rules, end_of(cell, step))[0], 1)
                    tau[k] *= moves * self.lengths[k] / self.mean_move
            open_slots = [k for k, e in enumerate(eta) if e is not None]
            self.nodes[cell] = SimpleNamespace(
                cell=cell,
                eta=eta,
                tau=tau,
                open=open_slots,
                weight=[F(0)] * 32,
                point=self.unvisited,
                stale=True,
            )
        return self.nodes[cell]

    def pheromone(self, node):
        """log2 of the pheromone of every legal move."""
        tau = node.tau
        if self.rules.pheromone_on == "node":
            ends = [end_of(node.cell, step) for step in self.steps]
            tau = [self.nodes[end].point if end in self.nodes else self.unvisited for end in ends]
        if self.rules.limits:
            tau = [max(min(max(t * self.scale, self.bounds[0]), self.bounds[1]), FLOOR) for t in tau]
        return {k: log2_wide(tau[k]) for k in node.open}

    def weigh(self, node):
        """All weights of a node anew, relative to its largest exponent."""
        if not node.open or not (node.stale or self.rules.pheromone_on == "node"):
            return
        node.stale, taus = False, self.pheromone(node)
        exponents = {k: self.alpha * taus[k] + self.beta * node.eta[k] for k in node.open}
        node.peak = max(exponents.values())
        for k in node.open:
            node.weight[k] = exp2(exponents[k] - node.peak)
        plain = self.rules.greedy == "plain"
        scores = {k: taus[k] + node.eta[k] if plain else exponents[k] - node.peak for k in node.open}
        node.top = max(scores.values())
        node.greedy = next(k for k in node.open if scores[k] == node.top)

    def choose(self, node, seen, bits):
        """The pseudo-random proportional rule (liu2020 (4)) over the moves that are open; None where none is."""
        self.weigh(node)
        greedy = F(rng.low_uniform(np.uint64(bits))) < F(self.rules.q0)
        if not node.open:
            return None
        if greedy and self.is_open(node, node.greedy, seen):
            return node.greedy
        for _ in range(0 if greedy else 4 if self.roams else 1):
            slot = pick(node.weight, bits)
            if self.is_open(node, slot, seen):
                return slot
            bits = np.uint64(rng.mix(bits + np.uint64(rng.GOLDEN)))
        left = [k for k in node.open if self.is_open(node, k, seen)]
        if not left:
            return None
        taus = self.pheromone(node)
        exponents = {k: self.alpha * taus[k] + self.beta * node.eta[k] for k in left}
        if greedy:
            plain = self.rules.greedy == "plain"
            return max(left, key=lambda k: (taus[k] + node.eta[k] if plain else exponents[k], -k))
        weight = [F(0)] * 32
        for k in left:
            weight[k] = exp2(exponents[k] - max(exponents.values()))
        return pick(weight, bits)

    def is_open(self, node, slot, seen):
        """Whether a move leads to a cell that the ant has not been to, nor, looking ahead, into a dead end."""
        if not self.roams:
            return True
        end = end_of(node.cell, self.steps[slot])
        if end in seen or self.rules.trap != "lookahead" or end == self.scenario.goal:
            return end not in seen
        following = self.node(end)
        return any(end_of(end, self.steps[k]) not in seen for k in following.open)

    def walk(self):
        """One iteration's paths, [(cell, slot)] of each ant, and who arrived."""
        walks, seen = [[] for _ in range(self.ants)], [{self.scenario.start} for _ in range(self.ants)]
        at, on_the_way = [self.scenario.start] * self.ants, list(range(self.ants))
        layers = None if self.roams else self.scenario.layers
        pace = 0
        while on_the_way if layers is None else pace < layers:
            for ant in list(on_the_way):
                node = self.node(at[ant])
                slot = self.choose(node, seen[ant], draw(self.seed, self.drawn + ant))
                if slot is not None:
                    self.move(node, slot, walks[ant])
                    at[ant] = end_of(node.cell, self.steps[slot])
                    self.node(at[ant])
                    seen[ant].add(at[ant])
                elif self.rules.trap == "retreat" and walks[ant]:
                    at[ant] = walks[ant].pop()[0]
                    continue
                if slot is None or at[ant] == self.scenario.goal:
                    on_the_way.remove(ant)
            self.drawn, pace = self.drawn + self.ants, pace + 1
        return [(w, c == self.scenario.goal) for w, c in zip(walks, at, strict=True)]

    def move(self, node, slot, walk):
        """One move, and the local update it leaves behind."""
        self.moves += 1
        walk.append((node.cell, slot))
        if self.rules.local:
            self.node(end_of(node.cell, self.steps[slot]))
            self.change(node, slot, self.passed)

    def change(self, node, slot, rule):
        """Apply a rule to the pheromone that a move sees."""
        if self.rules.pheromone_on == "node":
            end = self.nodes[end_of(node.cell, self.steps[slot])]
            end.point = rule(end.point)
        else:
            node.tau[slot] = rule(node.tau[slot])
            node.stale = node.stale or bool(self.rules.local) or self.rules.best_only

    def passed(self, tau):
        xi, (low, high) = self.rules.local, self.bounds
        if self.rules.limits:
            tau = min(max(tau * self.scale, low), high) / self.scale
        return max((1.0 - xi) * tau + xi * self.rules.local_to / self.scale, FLOOR)

    def grown(self, tau, amount):
        if self.rules.best_only:
            return max(self.rho * tau + (1.0 - self.rho) * amount, FLOOR)
        if self.rules.limits:
            low, high = self.bounds
            return min(max(tau * self.scale, low) + amount * self.scale, high) / self.scale
        return tau + amount

    def length(self, walk):
        total = 0.0
        for _, slot in walk:
            total += self.lengths[slot]
        return total

    def iterate(self, out):
        """Walk, remember, evaporate, deposit."""
        done = [(walk, self.length(walk)) for walk, arrived in self.walk() if arrived]
        for walk, total in done:
            if total < self.best:
                self.best, self.best_walk = total, walk
        out.best.append(self.best)
        out.mean.append(sum(t for _, t in done) / len(done) if done else np.inf)
        out.arrived.append(len(done))
        if self.rules.limits and self.best_walk:
            high = self.deposit / (max(1.0 - self.rho, 1e-9) * self.best)
            self.bounds = high / (2.0 * len(self.best_walk)), high
        if not self.rules.best_only:
            self.evaporate()
        self.reward(done)

    def evaporate(self):
        self.scale *= self.rho
        if self.scale < 2.0**-500:
            self.unvisited = max(self.unvisited * self.scale, FLOOR)
            for node in self.nodes.values():
                node.tau = [max(tau * self.scale, FLOOR) for tau in node.tau]
                node.point, node.stale = max(node.point * self.scale, FLOOR), True
            self.scale = 1.0

    def reward(self, done):
        """All deposits, first moves before second moves, then those of the best path so far."""
        per_edge = self.rules.deposit == "edge"
        paid = [
            (walk, share * self.deposit / (1.0 if per_edge else total) / self.scale)
            for (walk, total), share in shares(done, self.rules)
        ]
        edges = [
            (walk[depth], amount)
            for depth in range(max((len(walk) for walk, _ in paid), default=0))
            for walk, amount in paid
            if depth < len(walk)
        ]
        if self.rules.elite and self.best_walk:
            amount = self.rules.elite * self.deposit / (1.0 if per_edge else self.best) / self.scale
            edges += [(edge, amount) for edge in self.best_walk]
        for (cell, slot), amount in edges:
            more = amount * self.edge_share(cell, slot) if per_edge else amount
            self.change(self.nodes[cell], slot, lambda tau, more=more: self.grown(tau, more))
        if self.rules.pheromone_on == "edge":
            for cell, slot in {edge for edge, _ in edges}:
                self.renew(self.nodes[cell], slot)
        if self.rules.limits:
            for node in self.nodes.values():
                node.stale = True

    def edge_share(self, cell, slot):
        """ε / d of wei2018 (15), (16)."""
        (here, near_here), (there, near_there) = (
            degree(self.scenario, self.rules, c) for c in (cell, end_of(cell, self.steps[slot]))
        )
        return (near_there if there >= here else near_here) / (self.lengths[slot] * self.lengths[slot])

    def renew(self, node, slot):
        """One edge's weight after a deposit; a weight that outgrows its node makes all of it be weighed again."""
        if node.stale:
            return
        tau = log2_wide(node.tau[slot])
        exponent = self.alpha * tau + self.beta * node.eta[slot] - node.peak
        if exponent > F(60):
            node.stale = True
            return
        node.weight[slot] = exp2(exponent)
        score = tau + node.eta[slot] if self.rules.greedy == "plain" else exponent
        if score > node.top or (score == node.top and slot < node.greedy):
            node.top, node.greedy = score, slot


def plan(scenario, parameters, *, rules="liu2020", ants=20, iterations=10, seed=0):
    """The twin. Returns a namespace with length, path, best, mean, arrived, moves."""
    out = SimpleNamespace(best=[], mean=[], arrived=[])
    with np.errstate(over="ignore"):
        twin = Twin(scenario, parameters, rules, ants, seed)
        for _ in range(iterations):
            twin.iterate(out)
    out.length, out.moves = twin.best, twin.moves
    out.path = [cell for cell, _ in twin.best_walk] + [scenario.goal] if twin.best_walk else []
    return out


def heuristic(scenario, rules, cell, steps):
    """log2 η of every move: liu2020 (5)-(8), zhang_apf (4)-(7), wei2018 (10), (11); None where it is not allowed."""
    size = [F(edge) for edge in scenario.world.cell]
    possible = [allowed(scenario, rules, cell, step) for step in steps]
    mean, count = F(0), 0
    for step, there in zip(steps, possible, strict=True):
        if there:
            mean, count = mean + F(length_of(step, scenario.world.cell)), count + 1
    most = mean / F(max(count, 1)) if rules.clipped else F(np.inf)
    eta = []
    for step, there in zip(steps, possible, strict=True):
        if not there:
            eta.append(None)
            continue
        anchor = scenario.goal if rules.target == "goal" else scenario.start
        length = min(F(length_of(step, scenario.world.cell)), most)
        distance = away(scenario, anchor, cell, step)
        span = {"goal": length + distance, "start": distance, "current": length}[rules.target]
        value = -(F(rules.w1) * log2(span)) - F(rules.w2) * log2(F(abs(step[2]) + 1))
        if rules.z2 > 0 or rules.z3 > 0:
            value -= F(rules.z2) * log2(max(away(scenario, scenario.goal, cell, step), min(size)))
        if rules.z3 > 0:
            edge = min(scenario.world.cell)
            from_, over = F(rules.clearance[0] * edge), F((rules.clearance[1] - rules.clearance[0]) * edge)
            ramp = min((clearance(scenario, end_of(cell, step)) - from_) / over, F(1))
            value += F(rules.z3) * log2(ramp)
        eta.append(value)
    return eta


def away(scenario, anchor, cell, step):
    """Distance from the end of a move to a cell, in float32."""
    size = [F(edge) for edge in scenario.world.cell]
    dx = (F(anchor[0] - cell[0]) - F(step[0])) * size[0]
    dy = F(anchor[1] - cell[1]) * size[1] - F(np.float64(scenario.world.cell[1]) * step[1])
    dz = F(anchor[2] - cell[2]) * size[2] - F(np.float64(scenario.world.cell[2]) * step[2])
    return np.sqrt(dx * dx + dy * dy + dz * dz)


def pick(weight, bits):
    sums = prefix_sums(weight)
    mark = F(rng.high_uniform(np.uint64(bits))) * sums[31]
    return next(slot for slot in LANE_MAJOR if sums[slot] > mark)


def prefix_sums(weight):
    """Sums up to and including every slot, lane after lane: within a lane first, then the lanes before it."""
    sums, before = [F(0)] * 32, F(0)
    for lane in range(8):
        inside = F(0)
        for depth in range(4):
            inside = inside + weight[8 * depth + lane] if depth else weight[lane]
            sums[8 * depth + lane] = before + inside
        before = sums[24 + lane]
    return sums


def shares(done, rules):
    """Who deposits, and with which weight: everybody who may, or the shortest ``ranked - 1``, the earlier on a tie."""
    totals = [total for _, total in done]
    most = (min(totals) + max(totals)) / 2.0 if rules.selective and done else np.inf
    may = [i for i, total in enumerate(totals) if total <= most]
    if rules.ranked == 0:
        return [(done[i], 1.0) for i in may]
    order = sorted(may, key=lambda i: (totals[i], i))[: rules.ranked - 1]
    weights = {i: float(rules.ranked - 1 - place) for place, i in enumerate(order)}
    return [(done[i], weights[i]) for i in sorted(weights)]  # in the order of the ants
