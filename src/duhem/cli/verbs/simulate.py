"""``duhem simulate``: a scene along its loading path."""

from __future__ import annotations

from functools import partial

import click

from duhem.cli.output import FAILED, HELD, INTERRUPTED, USAGE, Progress, aside, deliver, say, wrote

__all__ = ["simulate"]


@click.command()
@click.argument("scene", type=click.Path(dir_okay=False))
@click.option(
    "--out", metavar="FILE", help="Write the history to this .csv or .parquet file (default: the table of the scene, or standard output)."
)
@click.option("--plot", metavar="FILE", help="Draw the stress path, the hysteresis and the energies (.png, .pdf, .svg, ...).")
@click.option("--explain", is_flag=True, help="Only print which parts of the computation the scene needs, and which it does not need.")
@click.option("--resume", is_flag=True, help="Continue a run that was stopped.")
def simulate(scene: str, out: str | None, plot: str | None, explain: bool, resume: bool) -> int:
    """Compute a loading path from SCENE, a TOML file.

    Each step computes the closest point of K, the set of admissible stresses. The run ends if a step has no reliable answer. If K is
    not known to be convex, a computed point may be stationary only: a closer point may exist. A message then counts these steps. The
    run ends if duhem finds a closer point. convex = "require" in [method] rejects a law whose K is not known to be convex. The exact
    integrator follows the slip along the boundary and computes no closest points; --explain tells you if K is not convex.

    duhem rejects a pressure outside the range that the law declares. If the stress leaves its declared range, the run ends and keeps
    its previous steps.

    If you interrupt a run (Ctrl-C, SIGTERM), it keeps its results in FILE.partial, and --resume continues from there. A run that was
    killed continues from its last checkpoint, which is written every minute by default and, for many points, after each group of
    points.
    """
    from duhem.api.histories import looked_into
    from duhem.omitted import LeftOut
    from duhem.path import scene_file
    from duhem.path.scene import Stopped, check_outputs, perform, perform_many
    from duhem.projection.result import NOT_SHOWN

    try:
        chosen = scene_file.read(scene)
    except scene_file.SceneFaults as fault:
        for each in fault.faults:
            aside(each)
        return USAGE
    table = chosen.table if out is None else out  # an empty name is refused, not taken for none
    figure = chosen.plot if plot is None else plot
    many = chosen.many
    check_outputs(table, figure, resume, [scene, *chosen.inputs], many, chosen.law)
    if explain:
        chosen = looked_into(chosen)
        for part in chosen.parts(table, figure):
            say(f"{'not needed' if isinstance(part, LeftOut) else 'needed'}: {part.part} ({part.reason})")
        return HELD
    with Progress("simulating") as progress:

        def on_step(done: int, steps: int) -> None:
            progress.often(lambda: f"{done} of {steps} {'points' if many else 'steps'}", after=1.0)

        try:
            chosen = looked_into(chosen)
            if many:
                came = perform_many(chosen, table, resume, say, on_step)
                progress.show("")
                if came.stationary:
                    aside(f"in the slips of {came.stationary} of {came.points} points, {NOT_SHOWN}")
                if came.ended:
                    aside(f"{came.ended} points end early, at a step without a reliable answer or outside a declared range")
                wrote(f"the histories of {came.points} points", table)
                return FAILED if came.ended else HELD
            history = perform(chosen, table, resume, on_step)
        except Stopped as stop:
            progress.show("")
            aside(stop)
            return INTERRUPTED
    if table is None:
        say(history.to_text().removesuffix("\n"))
    wrote(f"the history of {len(history)} knots", table)
    deliver("the picture", figure, partial(history.plot, units=(chosen.stress_unit, chosen.length_unit)))
    if (remark := history.remark()) is not None:
        aside(remark)
    return HELD
