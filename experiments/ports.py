"""Plain numba ports of the published equations, as anyone would write them down: what our speed is measured against.

Ratios compare only under the same port, so the hash of its source stands above every table, and a test pins it. The
bees' distribution is held against the hive here too.
"""

import hashlib
import inspect

import numba
import numpy as np
from numpy.typing import NDArray

from antgym.bench import Work, Workload
from antgym.maps.discs import DiscScenario
from antgym.maps.motion import move_table


@numba.njit
def plain_colony(
    free: NDArray[np.uint8],
    crossed: NDArray[np.int64],
    start: NDArray[np.int64],
    goal: NDArray[np.int64],
    cell: float,
    parameters: tuple[float, float, float, float],
    ants: int,
    iterations: int,
    seed: int,
) -> tuple[float, int]:
    """Walk liu2020's equations as they are printed: 50 powers a move, all pheromone swept every iteration."""
    np.random.seed(seed)  # noqa: NPY002 - numba's generator inside compiled code
    alpha, beta, rho, q = parameters
    nx, ny, nz = free.shape
    tau = np.ones((nx, ny, nz, 25))
    layers = goal[0] - start[0]
    weights = np.empty(25)
    paths = np.empty((ants, layers, 3), np.int64)
    best, moves = np.inf, 0
    for _ in range(iterations):
        lengths = np.full(ants, np.inf)
        for a in range(ants):
            x, y, z = start[0], start[1], start[2]
            length = 0.0
            for layer in range(layers):
                total = 0.0
                for k in range(25):
                    yn, zn = y + crossed[2, k, 1], z + crossed[2, k, 2]
                    left = 2 * (layers - layer - 1)
                    feasible = 0.0  # S of (6)
                    reachable = abs(yn - goal[1]) <= left and abs(zn - goal[2]) <= left
                    if reachable and 0 <= yn < ny and 0 <= zn < nz:
                        feasible = 1.0
                        for part in range(3):
                            dx, dy, dz = crossed[part, k, 0], crossed[part, k, 1], crossed[part, k, 2]
                            feasible *= free[x + dx, y + dy, z + dz]
                    step = cell * np.sqrt(1.0 + (yn - y) ** 2 + (zn - z) ** 2)
                    far = (goal[0] - x - 1) ** 2 + (goal[1] - yn) ** 2 + (goal[2] - zn) ** 2
                    eta = feasible / (step + cell * np.sqrt(far))
                    weights[k] = tau[x, y, z, k] ** alpha * eta**beta
                    total += weights[k]
                if total == 0.0:
                    length = np.inf
                    break
                mark, k = np.random.random() * total, 0  # noqa: NPY002
                mark -= weights[0]
                while mark >= 0.0 and k < 24:
                    k += 1
                    mark -= weights[k]
                paths[a, layer] = (y, z, k)
                yn, zn = y + crossed[2, k, 1], z + crossed[2, k, 2]
                length += cell * np.sqrt(1.0 + (yn - y) ** 2 + (zn - z) ** 2)
                x, y, z = x + 1, yn, zn
                moves += 1
            lengths[a] = length
            best = min(best, length)
        tau *= rho
        for a in range(ants):
            if lengths[a] < np.inf:
                for layer in range(layers):
                    y, z, k = paths[a, layer]
                    tau[start[0] + layer, y, z, k] += q / lengths[a]
    return best, moves


def colony_port(workload: Workload) -> Work:
    """Return a turn of the plain port."""
    scenario = workload.scenario()
    table = move_table(scenario.motion)
    crossed = np.stack([table.before, table.after, table.steps])
    ends = (np.array(scenario.start), np.array(scenario.goal))
    free, cell = np.ascontiguousarray(scenario.world.free), scenario.world.cell[0]
    effort = (workload.ants, workload.iterations)
    return lambda seed: int(plain_colony(free, crossed, *ends, cell, workload.parameters, *effort, seed)[1])


@numba.njit
def plain_cost(path: NDArray[np.float64], discs: NDArray[np.float64], safe: float, straight: float) -> float:
    """Return the sound cost of a path (points, 2): every segment against every disc."""
    length, low, hits = 0.0, np.inf, 0
    for j in range(path.shape[0] - 1):
        dx, dy = path[j + 1, 0] - path[j, 0], path[j + 1, 1] - path[j, 1]
        square = dx * dx + dy * dy
        length += np.sqrt(square)
        inverse = 1.0 / square if square > 0.0 else 0.0
        nearest = np.inf
        for i in range(discs.shape[0]):
            ux, uy = discs[i, 0] - path[j, 0], discs[i, 1] - path[j, 1]
            t = min(max((ux * dx + uy * dy) * inverse, 0.0), 1.0)
            nearest = min(nearest, np.sqrt((ux - t * dx) ** 2 + (uy - t * dy) ** 2) - discs[i, 2])
        low = min(low, nearest)
        hits += nearest <= 0.0
    return 0.5 * (length + max(safe - low, 0.0)) / straight + 5.0 * hits


@numba.njit
def plain_hive(
    discs: NDArray[np.float64],
    bounds: NDArray[np.float64],
    ends: NDArray[np.float64],
    safe: float,
    effort: tuple[int, int, int, float],
    seed: int,
) -> tuple[float, int]:
    """Fly Karaboga's standard colony as it is written down; return the least cost and the paths evaluated.

    Args:
        discs: (n, 3).
        bounds: x_min, x_max, y_min, y_max.
        ends: (2, 2) start and goal.
        safe: D_safe.
        effort: bees, cycles, way-points and limit.
        seed: of numba's own generator.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba's generator inside compiled code
    bees, cycles, points, limit = effort
    count = bees // 2
    straight = np.hypot(ends[1, 0] - ends[0, 0], ends[1, 1] - ends[0, 1])
    paths, values, tries = np.empty((count, points + 2, 2)), np.empty(count), np.zeros(count)
    qualities, best, evaluated = np.empty(count), np.inf, 0
    for s in range(count):
        values[s] = -1.0
        tries[s] = limit
    for cycle in range(cycles + 1):
        for bee in range(bees if cycle > 0 else 0):
            s = bee
            if bee >= count:
                if bee == count:
                    for i in range(count):
                        qualities[i] = 1.0 / (1.0 + values[i])
                mark, s = np.random.random() * qualities.sum(), 0  # noqa: NPY002
                while mark >= qualities[s] and s < count - 1:
                    mark -= qualities[s]
                    s += 1
            j, axis = np.random.randint(points) + 1, np.random.randint(2)  # noqa: NPY002
            other = np.random.randint(count - 1)  # noqa: NPY002
            other += other >= s
            here, phi = paths[s, j, axis], np.random.uniform(-1.0, 1.0)  # noqa: NPY002
            moved = here + phi * (here - paths[other, j, axis])
            paths[s, j, axis] = min(max(moved, bounds[2 * axis]), bounds[2 * axis + 1])
            value = plain_cost(paths[s], discs, safe, straight)
            evaluated += 1
            if value < values[s]:
                values[s], tries[s] = value, 0
            else:
                paths[s, j, axis] = here
                tries[s] += 1
        if cycle > 0:
            best = min(best, values.min())
        worst = tries.argmax()
        for s in range(count):  # one scout a cycle; at first all of them
            if cycle == 0 or (s == worst and tries[s] >= limit):
                paths[s, 0], paths[s, -1] = ends[0], ends[1]
                for j in range(1, points + 1):
                    for axis in range(2):
                        low, high = bounds[2 * axis], bounds[2 * axis + 1]
                        paths[s, j, axis] = np.random.uniform(low, high)  # noqa: NPY002
                values[s], tries[s] = plain_cost(paths[s], discs, safe, straight), 0
                evaluated += 1
    return best, evaluated


def hive_port(workload: Workload) -> Work:
    """Return a turn of the plain port."""
    scenario: DiscScenario = workload.scenario()
    world, ends = scenario.world, np.array([scenario.start, scenario.goal])
    arguments = (np.ascontiguousarray(world.grown), np.array(world.bounds), ends, world.safe_distance)
    effort = (workload.ants, workload.iterations, 12, workload.parameters[0])
    return lambda seed: int(plain_hive(*arguments, effort, seed)[1])


def plain_digest(world: str = "mountains") -> str:
    """Return the hash of a port's source: ratios to another source are other ratios."""
    ports = (plain_cost, plain_hive) if world == "discs" else (plain_colony,)
    source = "".join(inspect.getsource(port.py_func) for port in ports)
    return hashlib.sha256(source.encode()).hexdigest()[:16]
