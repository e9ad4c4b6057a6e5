"""Move tables: which moves a motion has, and which cells each needs free."""

import numpy as np
import pytest

from antgym.errors import ParameterError
from antgym.maps.motion import CORNERS, LAYERED, MOTIONS, Motion, move_table, step_lengths

ALL = [Motion(name, corners=corners) for name in CORNERS for corners in CORNERS[name]]
ALL.append(Motion(check_segments=False))


def test_the_list_of_motions_holds_each_once():
    assert set(MOTIONS) == set(ALL)
    assert len(MOTIONS) == len(ALL)


def needs(motion, step):
    """(required, either) of one step, as sets of cells."""
    table = move_table(motion)
    k = table.steps.tolist().index(list(step))
    return tuple({tuple(cell) for cell in cells[k].tolist()} for cells in (table.required, table.either))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "grid9"}, "motion 'grid9' is unknown; did you mean 'grid"),
        ({"name": "layerd"}, "did you mean 'layered'"),
        ({"name": "grid8", "corners": "bth"}, "corners = 'bth': .* did you mean 'both'"),
        ({"name": "grid26", "corners": "one"}, "the grid26 motion has no such rule; .* valid: both, cut"),
        ({"corners": "cut"}, "the layered motion has no such rule"),
        ({"name": "grid8", "check_segments": False}, "no move of the grid8 motion skips a cell"),
    ],
)
def test_an_option_that_a_motion_does_not_have_is_named(arguments, message):
    with pytest.raises(ParameterError, match=message):
        Motion(**arguments)


@pytest.mark.parametrize(("name", "moves"), [("layered", 25), ("grid4", 4), ("grid8", 8), ("grid26", 26)])
def test_every_motion_has_its_moves_once(name, moves):
    steps = move_table(Motion(name)).steps
    assert steps.shape == (moves, 3)
    assert len(np.unique(steps, axis=0)) == moves
    assert (steps != 0).any(axis=1).all()


@pytest.mark.parametrize("motion", ALL)
def test_every_move_needs_its_end_free(motion):
    table = move_table(motion)
    ends = (table.required == table.steps[:, None]).all(axis=2)
    assert ends[:, -1].all()
    assert all(not array.flags.writeable for array in table)


@pytest.mark.parametrize("motion", [LAYERED, Motion(check_segments=False)])
def test_a_layered_move_needs_what_its_segment_crosses(motion):
    table = move_table(motion)
    assert (table.required == np.stack([table.before, table.after, table.steps], axis=1)).all()
    assert (table.either == table.steps[:, None]).all()


def test_a_diagonal_needs_its_sides_as_the_corner_rule_says():
    end, sides = (1, -1, 0), {(1, 0, 0), (0, -1, 0)}
    assert needs(Motion("grid8"), end) == ({end} | sides, {end})
    assert needs(Motion("grid8", corners="one"), end) == ({end}, sides)
    assert needs(Motion("grid8", corners="cut"), end) == ({end}, {end})


def test_a_diagonal_in_space_needs_the_box_it_spans():
    box = {(x, y, z) for x in (0, -1) for y in (0, 1) for z in (0, 1)} - {(0, 0, 0)}
    assert needs(Motion("grid26"), (-1, 1, 1))[0] == box
    assert needs(Motion("grid26"), (0, 1, 1))[0] == {cell for cell in box if not cell[0]}
    assert needs(Motion("grid26", corners="cut"), (-1, 1, 1)) == ({(-1, 1, 1)}, {(-1, 1, 1)})


@pytest.mark.parametrize("corners", CORNERS["grid4"])
def test_straight_moves_have_no_corners(corners):
    assert needs(Motion("grid4", corners=corners), (0, -1, 0)) == ({(0, -1, 0)}, {(0, -1, 0)})


def test_steps_are_as_long_as_their_cells_are_wide():
    lengths = step_lengths(Motion("grid26"), (3.0, 4.0, 12.0))
    assert {3.0, 4.0, 5.0, 12.0, 13.0} <= set(lengths.tolist())
