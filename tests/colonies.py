"""Colonies for the tests of what ants do: rules and parameters drawn at random, the world each paper is made for."""

from hypothesis import strategies as st

from antgym.planners.rules import PAPERS, TARGETS, TRAPS, Rules

RULES = [
    *PAPERS.values(),
    Rules(target="current", w1=2, w2=1, q0=0.5),
    Rules(trap="lookahead", w1=1, w2=0),
    PAPERS["max_min"]._replace(q0=0.3, elite=2.0, ranked=1),
    PAPERS["ant_colony_system"]._replace(trap="lookahead", greedy="plain"),
]
PARAMETERS = st.tuples(
    st.floats(0.0, 5.0), st.floats(0.0, 10.0), st.floats(0.01, 1.0), st.floats(-6, 6).map(lambda e: 10.0**e)
)
CELLS = [(15.0, 10.0, 7.5), (0.1, 0.7, 334.503)]  # the second is nothing float32 can hold


@st.composite
def any_rules(draw):
    """Any rules that find_rules() takes, published or not."""
    flag, share = st.booleans(), st.sampled_from([0.0, 0.3])
    rules = Rules(
        target=draw(st.sampled_from(TARGETS)),
        w1=draw(st.sampled_from([0.0, 1.0, 4.0])),
        w2=draw(st.sampled_from([0.0, 2.0])),
        z2=draw(st.sampled_from([0.0, 1.5])),
        z3=draw(st.sampled_from([0.0, 0.7])),
        clearance=draw(st.sampled_from([(0.5, 2.5), (1.0, 1.8)])),
        q0=draw(st.sampled_from([0.0, 0.6])),
        greedy=draw(st.sampled_from(["weighted", "plain"])),
        ranked=draw(st.sampled_from([0, 1, 2, 4])),
        elite=draw(st.sampled_from([0.0, 2.0])),
        deposit=draw(st.sampled_from(["length", "edge"])),
        selective=draw(flag),
        local=draw(share),
        local_to=draw(st.sampled_from([0.0, 1.0])),
        pheromone_on=draw(st.sampled_from(["edge", "node"])),
        trap=draw(st.sampled_from(TRAPS)),
    )
    rules = rules._replace(clipped=rules.target == "current" and draw(flag))
    if rules.local == 0 and rules.pheromone_on == "edge" and draw(flag):
        rules = rules._replace(initial="degree")
    return rules._replace(**draw(st.sampled_from([{}, {"limits": True}, {"best_only": True}])))


def world_of(name, valley, room):
    """The world that a paper's rules were made for."""
    return room if name.startswith(("zhang2011", "wei2018")) else valley
