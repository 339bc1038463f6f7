"""``duhem list``, ``init`` and ``doctor``: what there is, how to start, what is installed."""

from __future__ import annotations

from pathlib import Path

import click

from duhem.cli.exit_code import FAILED, HELD
from duhem.cli.output import say
from duhem.errors import InputError

__all__ = ["doctor", "init", "list_laws"]


@click.command("list")
def list_laws() -> None:
    """List the laws that can be named."""
    from duhem.law import catalogue

    names = catalogue.names()
    width = max(map(len, names))
    for name in names:
        say(f"{name:<{width}}  {catalogue.summary(name)}".rstrip())


@click.command()
@click.argument("name")
def init(name: str) -> None:
    """Write NAME.toml, a commented criterion file to start from."""
    from duhem.law import catalogue

    stem = name.removesuffix(".toml")
    content, path = catalogue.template(stem), Path(f"{stem}.toml")
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(content)
    except FileExistsError:
        raise InputError("the file exists already", where=f"{path}", remedy="choose another name or move the file away") from None
    except OSError as fault:
        raise InputError(f"the file cannot be written: {fault.strerror}", where=f"{path}", remedy="write where you may") from None
    say(f"wrote {path}; verify it with: duhem verify {path}")


@click.command()
def doctor() -> int:
    """List installed and missing parts.

    Ends with facts about the machine that help with a bug report.
    """
    from duhem.cli import installation as parts

    say(parts.report())
    return FAILED if parts.missing() else HELD
