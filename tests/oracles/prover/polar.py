"""Verdicts from the polar form: curvature inside the arcs, jumps at the seams, Euler's relation for the dissipation."""

from __future__ import annotations

from duhem.proof.decide import Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.curvature import curvature
from tests.oracles.prover.polar_form import PolarForm, polar_form
from tests.oracles.prover.where import interior

__all__ = ["convexity", "dissipation", "origin", "smoothness"]


def convexity(subject: FormulaSubject) -> Evidence | None:
    """gamma'' + gamma >= 0 as a measure on the circle: the boundary r = 1/gamma(theta) bends inwards nowhere."""
    form = polar_form(subject)
    if form is None:
        return None
    used: set[str] = set()
    for arc in form.arcs:
        if curvature(form.gauge(arc), subject).convex:
            used.add("composition")
            continue
        answer = subject.ask(form.curvature(arc), Sense.NONNEGATIVE, *interior(arc), circle=(form.x, form.y))
        if answer.holds is not True:
            return None
        used.add(answer.method)
    if not _jumps(form, Sense.NONNEGATIVE):
        return None
    arcs = "all round" if len(form.arcs) == 1 else f"on each of {len(form.arcs)} arcs, and gamma' never jumps down where two meet"
    method, proof = f"polar-curvature ({', '.join(sorted(used))})", Proof("polar-curvature")
    detail = f"the boundary r = 1/gamma(theta) bends inwards nowhere: gamma'' + gamma >= 0 {arcs}"
    return Evidence(Verdict.PROVED, method, detail, proof=proof)


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """The boundary of a star-shaped set is C^1 where its gauge is C^1 and positive."""
    form = polar_form(subject)
    if form is None or not form.differentiable() or not _jumps(form, Sense.ZERO):
        return None
    seams = "no seam" if len(form.arcs) == 1 else "gamma' equal on both sides of each seam"
    return Evidence(Verdict.PROVED, "polar-seams", f"gamma > 0 is smooth on each arc, {seams}", proof=Proof("polar-seams"))


def origin(subject: FormulaSubject) -> Evidence | None:
    """A star-shaped set contains the point it is star-shaped about."""
    if subject.at_origin is not None or polar_form(subject) is None:
        return None
    detail = "K is star-shaped about 0 (if the formula is 0/0 at 0, K is closed there)"
    return Evidence(Verdict.PROVED, "polar-form", detail, proof=Proof("polar-form"))


def dissipation(subject: FormulaSubject) -> Evidence | None:
    """Euler: sigma . grad g > 0 on the boundary of g = A - B with A, B > 0 homogeneous of degrees a > b."""
    if not subject.problem.associated or polar_form(subject) is None:
        return None
    detail = "g = A - B with A, B > 0 homogeneous of degrees a > b, so sigma . grad g = (a - b) A > 0 on the boundary"
    return Evidence(Verdict.PROVED, "euler", detail, proof=Proof("euler"))


def _jumps(form: PolarForm, sense: Sense) -> bool:
    return all(
        form.subject.ask(form.slope(after) - form.slope(before), sense, *where, circle=(form.x, form.y)).holds is True
        for before, after, where in form.seams()
    )
