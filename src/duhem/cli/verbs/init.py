"""``duhem init``: a criterion file to start from."""

from __future__ import annotations

from pathlib import Path

import click

from duhem.cli.output import say
from duhem.errors import InputError

__all__ = ["init"]


@click.command()
@click.argument("name")
@click.option("--scene", is_flag=True, help="Write a scene for duhem simulate instead of a criterion file.")
def init(name: str, scene: bool) -> None:
    """Write NAME.toml, a commented criterion file or scene."""
    stem = name.removesuffix(".toml")
    path = Path(f"{stem}.toml")
    try:
        content, then = _content(stem, scene)
        with path.open("x", encoding="utf-8") as stream:
            stream.write(content)
    except FileExistsError:
        raise InputError("the file exists already", where=f"{path}", remedy="choose another name or move the file away") from None
    except OSError as fault:
        path.unlink(missing_ok=True)  # the half that found room
        raise InputError(f"the file cannot be written: {fault.strerror}", where=f"{path}", remedy="write where you may") from None
    say(f"wrote {path}; {then} {path}")


def _content(stem: str, scene: bool) -> tuple[str, str]:
    """What to write, and what to do with it."""
    if scene:
        from duhem.path import scene_file

        return scene_file.template(stem), "run it with: duhem simulate"
    from duhem.law import catalogue

    return catalogue.template(stem), "verify it with: duhem verify"
