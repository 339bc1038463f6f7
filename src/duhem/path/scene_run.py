"""A scene's run with what it writes; an interrupted run keeps what is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.util import find_spec

from duhem.errors import InputError, MissingExtraError
from duhem.path import kept_part
from duhem.path.history import History
from duhem.path.scene import Scene
from duhem.path.simulate import Interrupted, LeftDomain, LeftPrecision
from duhem.show import figure
from duhem.show.place import check_places

__all__ = ["Stopped", "check_outputs", "perform"]


class Stopped(KeyboardInterrupt):
    """A run that was interrupted; its text says what is kept and how to go on."""


def check_outputs(table: str | None, plot: str | None, resume: bool, inputs: Sequence[str] = ()) -> None:
    """Whether the files can be written in these formats with what is installed, before a long run and not after it.

    None is one of the ``inputs``, and what may stand where the part of a run is kept is such a part.
    """
    if table is not None and not table.endswith((".csv", ".parquet")):
        raise InputError("the table is neither .csv nor .parquet", where=table, remedy="end its name in .csv or .parquet")
    if table is None and resume:
        raise InputError("there is no table to go on with", where="--resume", remedy="name it with --out or in [output]")
    if table is not None and table.endswith(".parquet") and find_spec("pyarrow") is None:
        raise MissingExtraError("pyarrow", "parquet")
    check_places([table, plot], inputs)
    if table is not None:
        kept_part.check_kept(table, inputs)
    if plot is not None:
        figure.check(plot)


def perform(scene: Scene, table: str | None, resume: bool, on_step: Callable[[int, int], None] | None = None) -> History:
    """Run the scene and write ``table``; Stopped with the part kept beside it if interrupted, from which ``resume`` goes on."""
    start = kept_part.recall(table, scene.plan(), scene.fingerprint) if table is not None and resume else None
    try:
        history = scene.run(start, on_step)
    except Interrupted as stop:
        assert isinstance(stop.history, History)  # of one path
        steps = (len(scene.path.time) - 1) * scene.substeps
        done = f"interrupted after {len(stop.history) - 1} of {steps} steps"
        if table is None:
            raise Stopped(f"{done}; name a table with --out to keep what is done") from None
        kept = kept_part.keep(stop.history, table, scene.fingerprint)
        raise Stopped(f"{done}, kept in {kept}; go on with --resume") from None
    except (LeftPrecision, LeftDomain) as fault:
        if table is None:
            raise
        kept = kept_part.keep(fault.history, table, scene.fingerprint)
        raise InputError(f"{fault.what}; the steps before are kept in {kept}", where=fault.where, remedy=fault.remedy) from None
    if table is not None:
        (history.to_parquet if table.endswith(".parquet") else history.to_csv)(table)
        kept_part.beside(table).unlink(missing_ok=True)
    return history
