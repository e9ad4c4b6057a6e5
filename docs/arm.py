"""Make docs/arm.png, the README's robot: a colony's path over mountains, smoothed, that a FANUC LR Mate follows.

    python docs/arm.py

The map is one of the suite's, in millimetres, before the robot. Needs matplotlib, and Pillow, which comes with it and
makes the file small.
"""

import io
from pathlib import Path

import numpy as np
from PIL import Image

from antgym import Scenario, load_suite, plan, smooth
from antgym.console import write_whole
from antgym.robots import follow, lr_mate_200id, place
from antgym.robots.picture import Ground, draw

PICTURE = Path(__file__).with_name("arm.png")
MAP, SETTING = 45, (1.0, 0.2, 0.9, 100.0)
SCALE, AHEAD, UP = 0.001, 0.3, 0.15  # metres a millimetre; where the map lies before the base


def ground_of(scenario: Scenario, at: tuple[float, float, float]) -> Ground:
    """Return the highest blocked cells as a surface in the base frame."""
    world = scenario.world
    blocked = world.free == 0
    heights = np.where(blocked.any(axis=2), world.shape[2] - blocked[:, :, ::-1].argmax(axis=2), 0)
    cells = np.stack([*np.indices(heights.shape), heights - 0.5], axis=-1)
    x, y, z = np.moveaxis(place(world.centre(cells).reshape(-1, 3), SCALE, at).reshape(cells.shape), -1, 0)
    return x, y, z


def main() -> None:
    """Write the picture and say what the robot does."""
    scenario = load_suite("mountain-v0", "test")[MAP].scenario
    found = plan(scenario, SETTING, ants=20, iterations=100, seed=0)
    path = smooth(found.path, scenario)
    at = (AHEAD, -scenario.world.shape[1] * scenario.world.cell[1] * SCALE / 2, UP)
    trajectory = follow(lr_mate_200id(), place(path.points, SCALE, at))
    title = (
        f"{path.before:.0f} mm planned, {path.length:.0f} mm smoothed, {trajectory.seconds:.1f} s of a "
        "FANUC LR Mate 200iD"
    )
    picture, buffer = Image.open(io.BytesIO(draw(trajectory, title, ground_of(scenario, at)))), io.BytesIO()
    picture.convert("RGB").quantize(96).save(buffer, "png", optimize=True)
    write_whole(PICTURE, buffer.getvalue())
    print(f"{PICTURE}: {len(buffer.getvalue()) / 1000:.0f} KB; margin {trajectory.margin:.2f}")


if __name__ == "__main__":
    main()
