"""``duhem simulate``: a scene along its loading path."""

from __future__ import annotations

from time import monotonic

import click

from duhem.cli.output import FAILED, HELD, INTERRUPTED, USAGE, Progress, say, wrote

__all__ = ["simulate"]


@click.command()
@click.argument("scene", type=click.Path(dir_okay=False))
@click.option("--out", metavar="FILE", help="Write the history as .csv or .parquet; left out, the scene's table, else standard output.")
@click.option("--plot", metavar="FILE", help="Draw stress path, hysteresis and energies (.png, .pdf, .svg, ...).")
@click.option("--explain", is_flag=True, help="Print what the scene needs and what is left out, and stop.")
@click.option("--resume", is_flag=True, help="Go on with a run that was stopped.")
def simulate(scene: str, out: str | None, plot: str | None, explain: bool, resume: bool) -> int:
    """Drive a law along the loading path of SCENE, a TOML file.

    A step whose closest point of K cannot be vouched for ends the run: on a K that is not shown to be convex, where a nearer point
    of K is found; elsewhere a line says in how many steps the slip is stationary and no more, and convex = "require" in [method]
    refuses such a K.  The exact integrator follows the slip along the boundary and asks for no closest point; --explain says where
    K is not convex.  A pressure outside the range that the law declares is refused; a stress that leaves one ends the run, and what
    came before is kept as after an interruption.

    A run that is interrupted (Ctrl-C, SIGTERM) keeps what is done in FILE.partial, and --resume goes on from there.  So it does after a
    run that was killed, from what was kept last: every minute, or as often as the scene says, and of many points after each share
    of them.
    """
    from duhem.left_out import LeftOut
    from duhem.path import scene_file
    from duhem.path.scene import Stopped, check_outputs, perform, perform_many
    from duhem.projection.result import NOT_SHOWN
    from duhem.vouched.histories import looked_into

    try:
        chosen = scene_file.read(scene)
    except scene_file.SceneFaults as fault:
        for each in fault.faults:
            click.echo(f"duhem: {each}", err=True)
        return USAGE
    table = chosen.table if out is None else out  # an empty name is refused, not taken for none
    figure = chosen.plot if plot is None else plot
    many = chosen.many
    check_outputs(table, figure, resume, [scene, *chosen.inputs], many)
    if explain:
        chosen = looked_into(chosen)
        for part in chosen.parts(table, figure):
            say(f"{'left out' if isinstance(part, LeftOut) else 'needed'}: {part.part} ({part.reason})")
        return HELD
    with Progress("simulating") as progress:
        began = last = monotonic()

        def on_step(done: int, steps: int) -> None:
            nonlocal last
            if (now := monotonic()) - last > 0.2 and now - began > 1.0:
                last = now
                progress.show(f"{done} of {steps} {'points' if many else 'steps'}")

        try:
            chosen = looked_into(chosen)
            if many:
                came = perform_many(chosen, table, resume, say, on_step)
                progress.show("")
                if came.stationary:
                    click.echo(f"duhem: in the slips of {came.stationary} of {came.points} points {NOT_SHOWN}", err=True)
                if came.ended:
                    click.echo(f"duhem: {came.ended} points end early, at a step that cannot be vouched for or leaves a range", err=True)
                wrote(f"the histories of {came.points} points", table)
                return FAILED if came.ended else HELD
            history = perform(chosen, table, resume, on_step)
        except Stopped as stop:
            progress.show("")
            click.echo(f"duhem: {stop}", err=True)
            return INTERRUPTED
    if table is None:
        say(history.to_text().removesuffix("\n"))
    if figure is not None:
        history.plot(figure, units=(chosen.stress_unit, chosen.length_unit))
    wrote(f"the history of {len(history)} knots", table)
    wrote("the picture", figure)
    if (remark := history.remark()) is not None:
        click.echo(f"duhem: {remark}", err=True)
    return HELD
