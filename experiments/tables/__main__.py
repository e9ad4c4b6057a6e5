"""The command line of the tables: ``python -m experiments.tables PAPER``."""

from typing import Annotated, Any

from tyro.conf import subcommand

from antgym.console import main, parse
from experiments.tables import liu2020, wei2018, wu2018, zhang2011, zhang_apf

Command = (
    Annotated[liu2020.Arguments, subcommand("liu2020")]
    | Annotated[zhang_apf.Arguments, subcommand("zhang_apf")]
    | Annotated[zhang2011.Arguments, subcommand("zhang2011")]
    | Annotated[wei2018.Arguments, subcommand("wei2018")]
    | Annotated[wu2018.Arguments, subcommand("wu2018")]
)


def script() -> None:
    """Run the command line."""
    command: Any = parse(Command, None, "python -m experiments.tables")
    replays: dict[type, Any] = {
        paper.Arguments: paper.replay for paper in (liu2020, zhang_apf, zhang2011, wei2018, wu2018)
    }
    print(f"\nwritten: {replays[type(command)](command)}")


if __name__ == "__main__":
    main(
        script,
        interrupted="interrupted; nothing was written but finished draws of liu2020, which goes on from them",
    )
