"""``duhem init``: a criterion file to start from."""

from __future__ import annotations

from pathlib import Path

import click

from duhem.cli.output import say
from duhem.errors import InputError

__all__ = ["init"]


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
        path.unlink(missing_ok=True)  # the half that found room
        raise InputError(f"the file cannot be written: {fault.strerror}", where=f"{path}", remedy="write where you may") from None
    say(f"wrote {path}; verify it with: duhem verify {path}")
