"""``duhem import``: a learned law as a criterion file with its numbers beside it."""

from __future__ import annotations

from pathlib import Path

import click

from duhem.cli.output import say
from duhem.errors import InputError
from duhem.show.place import check_places, write

__all__ = ["import_"]


@click.command("import")
@click.argument("file", type=click.Path(dir_okay=False))
@click.option("--kind", type=click.Choice(("icnn", "mlp", "polynomial")), help="What was learned; in an .onnx or .pt2 file, any network.")
@click.option("--out", metavar="LAW.toml", required=True, help="The criterion file to write, with tables beside it.")
@click.option("--stress", type=click.Choice(("3d", "plane", "principal")), help="The inputs are the components of a stress of this kind.")
@click.option("--forces", metavar="A,B,...", help="The names of the inputs, where they are no components of a stress.")
@click.option(
    "--activation", type=click.Choice(("softplus", "relu", "tanh")), help="Of the hidden layers in an .npz file. By default, softplus."
)
@click.option("--level", default="0", show_default=True, metavar="C", help="K is where the output is at most C.")
def import_(file: str, kind: str | None, out: str, stress: str | None, forces: str | None, activation: str | None, level: str) -> None:
    """Write a network or a polynomial in FILE, an .npz file of NumPy, a .pt2 file of PyTorch or an .onnx file, as a criterion file.

    Arrays in an .npz file: Wx0, b0, Wz1, Wx1, b1, ... of an input-convex network; W0, b0, W1, b1, ... of a plain one (rows are outputs, the
    last layer has one output and no activation); coefficients (n) and exponents (n x inputs) of a polynomial. In a .pt2 file
    (torch.export.save) and in an .onnx file, which needs the extra learned, layers may stand in any order. Every weight is kept exactly.
    """
    from duhem.expression.abbreviations import Stress
    from duhem.expression.number import exact_number
    from duhem.law.learned import arrays_of, learned
    from duhem.law.network import onnx_network, pt2_network

    if (stress is None) == (forces is None):
        raise InputError("the inputs are not named", where="--stress", remedy="give either --stress or --forces")
    names = Stress("sigma", stress) if stress is not None else [name.strip() for name in (forces or "").split(",")]
    place = Path(out)
    level = f"{exact_number(level)}"
    if file.endswith((".onnx", ".pt2")):
        if kind == "polynomial" or activation is not None:
            raise InputError("such a file has a network and its activations", where=file, remedy="leave out --kind and --activation")
        read = onnx_network if file.endswith(".onnx") else pt2_network
        made = read(file, place.stem, forces=names, level=level, stem=place.stem)
    elif kind is None:
        raise InputError("the file does not say what was learned", where="--kind", remedy="give icnn, mlp or polynomial")
    else:
        made = learned(arrays_of(file), kind, place.stem, forces=names, activation=activation or "softplus", level=level, stem=place.stem)
    tables = {place.with_name(name): text for name, text in made.tables.items()}
    check_places([place, *tables], [file])
    for path, text in tables.items():
        write(path, text)
    write(place, made.text)
    say(f"wrote {place} and {len(tables)} tables beside it; verify it with: duhem verify {place}")
