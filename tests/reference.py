"""Slow, obvious twins of the kernels.

``plan`` walks the same ants as the compiled colony, bit for bit, one ant after the other and one move after the
other, driven by the same ``Rules``; it shares only the random numbers and the float32 logarithm and power with it.
``textbook`` is the colony as the equations print it, in float64, with its own random numbers: the two agree in
distribution. ``shortest`` enumerates.
"""

from types import SimpleNamespace

import numpy as np

from antgym.kernels import floats, rng
from antgym.maps.motion import REACH
from antgym.planners.rules import find_rules

F = np.float32


def log2(x):
    return F(floats.log2(F(x)))  # compiled functions return Python floats


def log2_wide(x):
    return F(floats.log2_wide(np.float64(x)))


def exp2(x):
    return F(floats.exp2(F(x)))


def draw(seed, counter):
    return np.uint64(rng.draw(np.uint64(seed), np.uint64(counter)))


STEPS = [(1, dy, dz) for dy in range(-2, 3) for dz in range(-2, 3)]
LANE_MAJOR = [8 * depth + lane for lane in range(8) for depth in range(4)]  # the kernel's order of summation


def free(scenario, cell):
    inside = all(0 <= i < n for i, n in zip(cell, scenario.world.shape, strict=True))
    return inside and bool(scenario.world.free[cell])


def crossed(step):
    """Cells that the segment to ``step`` passes, found by walking along it in small steps."""
    cells = set()
    for t in np.linspace(0, 1, 4001)[1:-1]:
        point = np.array([0.5, 0.5, 0.5]) + t * np.array(step)
        if np.abs(point - np.round(point)).min() > 1e-9:  # not on a boundary
            cells.add(tuple(np.floor(point).astype(int).tolist()))
    return cells


CROSSED = {step: crossed(step) for step in STEPS}


def legal(scenario, cell, step):
    """Whether a move is one the layered motion allows, by the book."""
    end = tuple(c + s for c, s in zip(cell, step, strict=True))
    left = scenario.goal[0] - end[0]
    if max(abs(scenario.goal[1] - end[1]), abs(scenario.goal[2] - end[2])) > REACH * left:
        return False
    cells = [end]
    if scenario.motion.check_segments and max(abs(step[1]), abs(step[2])) == REACH:
        cells += [tuple(c + d for c, d in zip(cell, part, strict=True)) for part in CROSSED[step]]
    return all(free(scenario, c) for c in cells)


def allowed(scenario, rules, cell, step):
    """Whether the rules let an ant make a move: legal and, with look-ahead, not into a dead end."""
    if not legal(scenario, cell, step):
        return False
    end = tuple(c + s for c, s in zip(cell, step, strict=True))
    if rules.trap == "die" or end == scenario.goal:
        return True
    return any(legal(scenario, end, following) for following in STEPS)


def length_of(step, cell_size):
    x, y, z = (np.float64(edge) * s for edge, s in zip(cell_size, step, strict=True))
    return np.sqrt(x * x + y * y + z * z)


def plan(scenario, parameters, *, rules="liu2020", ants=20, iterations=10, seed=0):
    """The twin. Returns a namespace with length, path, best, mean, arrived, moves."""
    rules = find_rules(rules)
    alpha, beta = F(parameters[0]), F(parameters[1])
    rho, deposit = np.float64(parameters[2]), np.float64(parameters[3]) / rules.initial_pheromone
    lengths = [length_of(step, scenario.world.cell) for step in STEPS]
    nodes, scale, unvisited, bounds, best_walk = {}, 1.0, 1.0, (0.0, np.inf), None
    out = SimpleNamespace(length=np.inf, path=[], best=[], mean=[], arrived=[], moves=0)
    with np.errstate(over="ignore"):
        for iteration in range(iterations):
            cells, walks, totals = [scenario.start] * ants, [[] for _ in range(ants)], [0.0] * ants
            for layer in range(scenario.layers):
                for ant in range(ants):
                    if len(walks[ant]) < layer:
                        continue  # died
                    cell = cells[ant]
                    if cell not in nodes:
                        nodes[cell] = new_node(scenario, rules, cell, unvisited)
                        weigh(nodes[cell], alpha, beta, rules, bounds, scale)
                    node = nodes[cell]
                    if not node.alive:
                        continue
                    if node.stale:
                        weigh(node, alpha, beta, rules, bounds, scale)
                    counter = (iteration * scenario.layers + layer) * ants + ant
                    slot = choose(node, draw(seed, counter), F(rules.q0))
                    if rules.local:
                        node.tau[slot] = (1.0 - rules.local) * node.tau[slot] + rules.local / scale
                        node.stale = True
                    walks[ant].append((cell, slot))
                    totals[ant] += lengths[slot]
                    cells[ant] = tuple(c + s for c, s in zip(cell, STEPS[slot], strict=True))
                    out.moves += 1
            done = [(w, t) for w, t, c in zip(walks, totals, cells, strict=True) if c == scenario.goal]
            for walk, total in done:
                if total < out.length:
                    out.length, out.path, best_walk = total, [c for c, _ in walk] + [scenario.goal], walk
            out.best.append(out.length)
            out.mean.append(sum(t for _, t in done) / len(done) if done else np.inf)
            out.arrived.append(len(done))
            if rules.limits and np.isfinite(out.length):
                high = deposit / (max(1.0 - rho, 1e-9) * out.length)
                bounds = high / (2.0 * scenario.layers), high
            if not rules.best_only:
                scale *= rho
            if scale < 2.0**-500:
                unvisited = max(unvisited * scale, 2.0**-1000)
                for node in nodes.values():
                    node.tau = [max(tau * scale, 2.0**-1000) for tau in node.tau]
                    node.stale = True
                scale = 1.0
            deposits = [
                (walk, share * deposit / total / scale) for (walk, total), share in shares(done, rules.ranked)
            ]
            if rules.elite and best_walk:
                deposits.append((best_walk, rules.elite * deposit / out.length / scale))
            for walk, amount in deposits:
                for cell, slot in walk:
                    receive(nodes[cell], slot, amount, rules, rho, bounds, scale)
            for cell, slot in {edge for walk, _ in deposits for edge in walk}:
                renew(nodes[cell], slot, alpha, beta, rules)
            if rules.limits:
                for node in nodes.values():
                    node.stale = True
    return out


def new_node(scenario, rules, cell, unvisited):
    """A node with log2 of the heuristic of every move, (5)-(8) of liu2020; None where the move is illegal."""
    size = [F(edge) for edge in scenario.world.cell]
    anchor = scenario.goal if rules.target == "goal" else scenario.start
    eta = []
    for step in STEPS:
        if not allowed(scenario, rules, cell, step):
            eta.append(None)
            continue
        dx = F(anchor[0] - cell[0] - 1) * size[0]
        dy = F(anchor[1] - cell[1]) * size[1] - F(np.float64(scenario.world.cell[1]) * step[1])
        dz = F(anchor[2] - cell[2]) * size[2] - F(np.float64(scenario.world.cell[2]) * step[2])
        distance = np.sqrt(dx * dx + dy * dy + dz * dz)
        length = F(length_of(step, scenario.world.cell))
        span = {"goal": length + distance, "start": distance, "current": length}[rules.target]
        eta.append(-(F(rules.w1) * log2(span)) - F(rules.w2) * log2(F(abs(step[2]) + 1)))
    return SimpleNamespace(
        eta=eta, tau=[unvisited] * 25, alive=any(e is not None for e in eta), stale=False, weight=[F(0)] * 32
    )


def shares(done, ranked):
    """Who deposits, and with which weight: everybody, or the shortest ``ranked - 1``, the earlier ant on a tie."""
    if ranked == 0:
        return [(walk, 1.0) for walk in done]
    order = sorted(range(len(done)), key=lambda i: (done[i][1], i))[: ranked - 1]
    weights = {i: float(ranked - 1 - place) for place, i in enumerate(order)}
    return [(done[i], weights[i]) for i in sorted(weights)]  # in the order of the ants


def receive(node, slot, amount, rules, rho, bounds, scale):
    """One deposit on one edge."""
    if rules.best_only:
        node.tau[slot] = rho * node.tau[slot] + (1.0 - rho) * amount
        node.stale = True
    elif rules.limits:
        kept = max(node.tau[slot] * scale, bounds[0])
        node.tau[slot] = min(kept + amount * scale, bounds[1]) / scale
    else:
        node.tau[slot] += amount


def weigh(node, alpha, beta, rules, bounds, scale):
    """All weights of a node anew, relative to its largest exponent."""
    node.stale = False
    open_slots = [k for k in range(25) if node.eta[k] is not None]
    if not open_slots:
        return
    tau = node.tau
    if rules.limits:
        tau = [max(min(max(t * scale, bounds[0]), bounds[1]), 2.0**-1000) for t in tau]
    taus = {k: log2_wide(tau[k]) for k in open_slots}
    exponents = {k: alpha * taus[k] + beta * node.eta[k] for k in open_slots}
    node.peak = max(exponents.values())
    for k in open_slots:
        node.weight[k] = exp2(exponents[k] - node.peak)
    scores = {
        k: taus[k] + node.eta[k] if rules.greedy == "plain" else exponents[k] - node.peak for k in open_slots
    }
    node.top = max(scores.values())
    node.greedy = next(k for k in open_slots if scores[k] == node.top)


def renew(node, slot, alpha, beta, rules):
    """One edge's weight after a deposit; a weight that outgrows its node makes all of it be weighed again."""
    if node.stale:
        return
    tau = log2_wide(node.tau[slot])
    exponent = alpha * tau + beta * node.eta[slot] - node.peak
    if exponent > F(60):
        node.stale = True
        return
    node.weight[slot] = exp2(exponent)
    score = tau + node.eta[slot] if rules.greedy == "plain" else exponent
    if score > node.top or (score == node.top and slot < node.greedy):
        node.top, node.greedy = score, slot


def choose(node, bits, q0):
    """The pseudo-random proportional rule (4)."""
    if F(rng.low_uniform(np.uint64(bits))) < q0:
        return node.greedy
    sums = prefix_sums(node.weight)
    mark = F(rng.high_uniform(bits)) * sums[31]
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


class Textbook:
    """The colony as printed, float64: all pheromone in a dictionary, all of it swept, powers with ``**`` in logs."""

    def __init__(self, scenario, parameters, rules):
        self.scenario, self.rules = scenario, find_rules(rules)
        self.alpha, self.beta, self.rho, q = parameters
        self.q, self.tau, self.options = q / self.rules.initial_pheromone, {}, {}
        self.unseen, self.limits, self.best, self.best_edges = 1.0, (0.0, np.inf), np.inf, []

    def moves(self, cell):
        """Ends, lengths and log η of the moves from a cell."""
        if cell not in self.options:
            rules, size = self.rules, np.array(self.scenario.world.cell)
            steps = [s for s in STEPS if allowed(self.scenario, rules, cell, s)]
            ends = [tuple(c + d for c, d in zip(cell, s, strict=True)) for s in steps]
            anchor = np.array(self.scenario.goal if rules.target == "goal" else self.scenario.start)
            lengths = np.array([np.linalg.norm(np.array(s) * size) for s in steps])
            far = np.array([np.linalg.norm((anchor - np.array(e)) * size) for e in ends])
            span = {"goal": lengths + far, "start": far, "current": lengths}[rules.target]
            flat = np.array([1.0 / (abs(s[2]) + 1) for s in steps])
            eta = np.log(1 / span) * rules.w1 + np.log(flat) * rules.w2 if steps else None
            self.options[cell] = ends, lengths, eta
        return self.options[cell]

    def step(self, cell, rng):
        """The end and the length of one ant's next move."""
        ends, lengths, eta = self.moves(cell)
        tau = np.array([self.tau.get((cell, end), self.unseen) for end in ends])
        logits = self.alpha * np.log(tau) + self.beta * eta
        if rng.random() < self.rules.q0:
            k = int(np.argmax(np.log(tau) + eta if self.rules.greedy == "plain" else logits))
        else:
            p = np.exp(logits - logits.max())
            sums = p.cumsum()
            k = int(np.searchsorted(sums, rng.random() * sums[-1], side="right"))
        if self.rules.local:
            self.tau[cell, ends[k]] = (1 - self.rules.local) * tau[k] + self.rules.local
        return ends[k], lengths[k]

    def walk(self, ants, rng):
        """[(edges, length)] of the ants that arrive; all take their first move, then all their second."""
        cells, edges, totals = [self.scenario.start] * ants, [[] for _ in range(ants)], [0.0] * ants
        for _ in range(self.scenario.layers):
            for ant, cell in enumerate(cells):
                if cell is not None:
                    cells[ant] = None
                    if self.moves(cell)[0]:
                        cells[ant], length = self.step(cell, rng)
                        edges[ant].append((cell, cells[ant]))
                        totals[ant] += length
        return [(e, t) for e, t, cell in zip(edges, totals, cells, strict=True) if cell is not None]

    def update(self, done):
        """Evaporation, deposits, limits."""
        rules = self.rules
        for edges, total in done:
            if total < self.best:
                self.best, self.best_edges = total, edges
        deposits = [(edges, share * self.q / total) for (edges, total), share in shares(done, rules.ranked)]
        deposits += [(self.best_edges, rules.elite * self.q / self.best)]
        if rules.best_only:
            for edges, amount in deposits:
                for edge in edges:
                    self.tau[edge] = self.rho * self.tau.get(edge, self.unseen) + (1 - self.rho) * amount
            return
        if rules.limits and self.best_edges:
            high = self.q / ((1 - self.rho) * self.best)
            self.limits = high / (2 * self.scenario.layers), high
        keep = lambda tau: np.clip(tau, *self.limits)  # noqa: E731
        old = self.unseen
        self.unseen = keep(self.rho * self.unseen)
        self.tau = {edge: keep(self.rho * tau) for edge, tau in self.tau.items()}
        for edges, amount in deposits:
            for edge in edges:
                self.tau[edge] = keep(self.tau.get(edge, keep(self.rho * old)) + amount)


def textbook(scenario, parameters, *, rules="liu2020", ants=20, iterations=10, seed=0):
    """Shortest length that the textbook colony finds, inf where no ant arrives."""
    colony, rng = Textbook(scenario, parameters, rules), np.random.default_rng(seed)
    for _ in range(iterations):
        colony.update(colony.walk(ants, rng))
    return colony.best


def shortest(scenario):
    """Exact shortest length by recursion over all cells reached."""
    reached = {scenario.start: 0.0}
    for _ in range(scenario.layers):
        following = {}
        for cell, total in reached.items():
            for step in STEPS:
                if legal(scenario, cell, step):
                    end = tuple(c + s for c, s in zip(cell, step, strict=True))
                    length = total + np.linalg.norm(np.array(step) * scenario.world.cell)
                    following[end] = min(following.get(end, np.inf), length)
        reached = following
    return reached.get(scenario.goal, np.inf)
