"""The one exception family of antgym: whatever is wrong with an input is said once, at the border."""

from numbers import Real


class AntgymError(ValueError):
    """An input that antgym cannot use; the message names the value, the place and the way out."""


class MapError(AntgymError):
    """A map, a height field or a map file that cannot be used."""


class ScenarioError(AntgymError):
    """A start or goal that is blocked, outside or equal, or a goal that no path reaches."""


class ParameterError(AntgymError):
    """A planner parameter, action or setting outside its range, or an unknown name."""


class ReachError(AntgymError):
    """A path that an arm cannot follow: out of reach, past joint limits, near a singularity, or with a jump."""


class BudgetError(AntgymError):
    """A budget that is not positive, or an attempt to spend what is already spent."""


class LedgerError(AntgymError):
    """A ledger that is damaged, in use, or that does not fit the run that wants to resume it."""


class AgentError(AntgymError):
    """An agent of a stranger that failed: it raised, hung, died, or answered what is no setting."""


class ContractError(AntgymError, AssertionError):
    """An environment that does not keep the contract it is checked against."""


class MissingExtraError(AntgymError, ImportError):
    """An optional dependency that is not installed."""

    def __init__(self, package: str, extra: str) -> None:
        super().__init__(f'{package} is not installed; mend it with: pip install "antgym[{extra}]"')


LEAST_BEGINNING = 3  # letters of a name by which a longer one is known
ALMOST = 0.8  # likeness, from 0 to 1, of a name that is misspelt and no longer one


def is_count(value: object) -> bool:
    """Return whether a value is a whole number of at least one."""
    if type(value) is int:  # by far the most
        return value >= 1
    return isinstance(value, Real) and float(value) >= 1 and float(value).is_integer()


def nearest(name: str, known: "list[str] | tuple[str, ...]") -> str:
    """Return the clause that ends an unknown-name message: the nearest valid name and the whole list.

    Nearest is what the name almost is, or else what it goes on from, as ``"environment"`` does from ``"env"``, or else
    what it shares most with.
    """
    import difflib

    begun = [each for each in known if len(each) >= LEAST_BEGINNING and name.startswith(each)]
    close = (
        difflib.get_close_matches(name, known, n=1, cutoff=ALMOST)
        or sorted(begun, key=len)[-1:]
        or difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    )
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}valid: {', '.join(known)}"
