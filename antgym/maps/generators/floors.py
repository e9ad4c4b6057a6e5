"""Floors: floor plans seen from above, a home with furniture and a warehouse with racks."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.generators.draws import redrawn
from antgym.maps.generators.flats import across
from antgym.maps.world import Scenario

Blocked = NDArray[np.bool_]
SECOND_DOORS = 0.25  # share of the walls between two rooms that get a door though there is a way already


class Room(NamedTuple):
    """A rectangle of cells from (x0, y0) up to, but not including, (x1, y1)."""

    x0: int
    y0: int
    x1: int
    y1: int


def rooms(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw a home or an office, as the ceiling camera of zhang2011 sees it: rooms, doors and furniture.

    A floor is divided again and again by walls one cell thick. Doors join all rooms, and now and then there is a
    second way. Furniture is rectangular, L- or U-shaped: some of it concave, a pocket for an ant. Start and
    goal lie in different rooms. Two numbers set the character: ``division`` how small rooms are, ``furniture``
    how full.
    """
    return redrawn(_rooms, "rooms", rng, size)


def warehouse(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw a warehouse: long racks side by side, aisles between them and a few cross aisles.

    Some aisles are blocked halfway, and at either end of the racks there may be no way round, so an aisle can be
    a long dead end. Two numbers set the character: ``crossings`` how many cross aisles there are, ``blockage``
    how many aisles are blocked.
    """
    return redrawn(_warehouse, "warehouse", rng, size)


def _rooms(rng: np.random.Generator, size: int, division: float, furniture: float) -> Scenario | None:
    plan = _divided(rng, size, max(2, round(size * (0.3 - 0.16 * division))))
    labels = np.zeros((size, size), dtype=np.int64)
    for number, room in enumerate(plan, start=1):
        labels[room.x0 : room.x1, room.y0 : room.y1] = number
    blocked = labels == 0
    for room in plan:
        for _ in range(rng.poisson(3 * furniture)):
            _place(rng, blocked, room)
    _open_doors(rng, blocked, labels)
    return across(rng, blocked, "rooms", labels)


def _divided(rng: np.random.Generator, size: int, least: int) -> list[Room]:
    """Divide a square into rooms whose sides are at least ``least``, with a wall of one cell between them."""
    plan, undivided = [], [Room(0, 0, size, size)]
    while undivided:
        room = undivided.pop()
        sides = room.x1 - room.x0, room.y1 - room.y0
        if max(sides) < 2 * least + 1:
            plan.append(room)
        elif sides[0] > sides[1] or (sides[0] == sides[1] and rng.random() < 0.5):
            wall = int(rng.integers(room.x0 + least, room.x1 - least))
            undivided += [room._replace(x1=wall), room._replace(x0=wall + 1)]
        else:
            wall = int(rng.integers(room.y0 + least, room.y1 - least))
            undivided += [room._replace(y1=wall), room._replace(y0=wall + 1)]
    return plan


def _open_doors(rng: np.random.Generator, blocked: Blocked, labels: NDArray[np.int64]) -> None:
    """Open doors of one or two cells until all rooms are joined, and some more."""
    walls = _walls(labels)
    joined = np.arange(labels.max() + 1)
    pairs = list(walls)
    for index in rng.permutation(len(pairs)):
        a, b = pairs[index]
        if joined[a] != joined[b] or rng.random() < SECOND_DOORS:
            joined[joined == joined[b]] = joined[a]
            cells = walls[a, b]
            first = rng.integers(len(cells))
            for cell in cells[first : first + rng.integers(1, 3)]:
                blocked[cell] = False


def _walls(labels: NDArray[np.int64]) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """Return the wall cells between every two rooms, in order along the wall."""
    walls: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for dx, dy in ((1, 0), (0, 1)):
        here = labels[dx : len(labels) - dx, dy : len(labels) - dy]
        low, high = labels[: len(here), : here.shape[1]], labels[2 * dx :, 2 * dy :]
        for x, y in np.argwhere((here == 0) & (low > 0) & (high > 0)).tolist():
            walls.setdefault((int(low[x, y]), int(high[x, y])), []).append((x + dx, y + dy))
    return walls


def _place(rng: np.random.Generator, blocked: Blocked, room: Room) -> None:
    """Put a block, an L or a U anywhere into a room, against a wall or free."""
    sides = np.array([room.x1 - room.x0, room.y1 - room.y0])
    extent = rng.integers(1, np.maximum(sides * 2 // 3, 2) + 1)
    turned = rng.random() < 0.5
    piece = np.ones(extent[::-1] if turned else extent, dtype=np.bool_)
    kind = rng.choice(("block", "L", "U"))
    if kind != "block":
        piece[1 : -1 if kind == "U" else None, 1:] = False
    piece = piece.T if turned else piece
    dx, dy = rng.choice((-1, 1), 2)
    x, y = np.array([room.x0, room.y0]) + rng.integers(sides - extent + 1)
    blocked[x : x + extent[0], y : y + extent[1]] |= piece[::dx, ::dy]


def _warehouse(rng: np.random.Generator, size: int, crossings: float, blockage: float) -> Scenario | None:
    aisle, rack = rng.integers(1, 3 + size // 30, 2)
    stocked = np.ones(size, dtype=np.bool_)  # along the racks; a cross aisle is where it is False
    for place in (0, size - aisle):
        stocked[place : place + aisle] = rng.random() > 0.3 + 0.7 * crossings
    for place in rng.integers(size, size=rng.binomial(3, crossings)):
        stocked[place : place + aisle] = False
    blocked = stocked[:, None] & (np.arange(size) % (aisle + rack) >= aisle)
    for first in range(0, size, int(aisle + rack)):
        if stocked.any() and rng.random() < 0.8 * blockage:
            blocked[rng.choice(np.flatnonzero(stocked)), first : first + aisle] = True
    return across(rng, blocked.T if rng.random() < 0.5 else blocked, "warehouse")
