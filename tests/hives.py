"""Hives for the tests of what bees do: rules and parameters drawn at random."""

from hypothesis import strategies as st

from antgym.planners.bee_rules import BEE_PAPERS, BeeRules

SOUND = [name for name, rules in BEE_PAPERS.items() if not rules.printed]
BEE_PARAMETERS = st.tuples(
    st.floats(1.0, 30.0),
    st.floats(0.0, 2.0),
    st.floats(0.0, 2.0),
    st.sampled_from([0.0, 3.0, 12.0, 1e9]),
)


@st.composite
def any_bee_rules(draw):
    """Any rules that find_bee_rules() takes, published or not."""
    flag = st.booleans()
    return BeeRules(
        points=draw(st.integers(1, 5)),
        away=draw(flag),
        scout=draw(st.sampled_from(["new", "neighbour"])),
        elite=draw(flag),
        tabu=draw(st.sampled_from([0, 1, 3])),
        redraws=draw(st.sampled_from([0, 2])),
        pull=draw(st.sampled_from([0.0, 1.5])),
        printed=draw(flag),
        weight=draw(st.sampled_from([0.3, 0.5, 1.0])),
        hit=draw(st.sampled_from([0.0, 10.0])),
    )
