"""Proofs read off the formula: what each node is follows from its arguments, one theorem a rule."""

from __future__ import annotations

from itertools import islice

import sympy as sp

from duhem.expression import Norm
from duhem.expression.text import formula
from duhem.proof.decide import Question, Sense
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.search.boundary_identities import composed_of_sums
from duhem.proof.verdict import Evidence, Proof, Verdict
from tests.oracles.prover.curvature import convex_in_its_region, curvature
from tests.oracles.prover.deviator import on_axis
from tests.oracles.prover.regularity import regularity
from tests.oracles.prover.star import star_form

__all__ = ["convexity", "smoothness"]


def convexity(subject: FormulaSubject) -> Evidence | None:
    """K is convex if g is quasiconvex by the composition rules (Grant, Boyd, Ye 2006; Agrawal, Boyd 2020)."""
    facts = curvature(subject.simple.g, subject)
    if not facts.quasiconvex:
        facts = convex_in_its_region(subject, facts)
    if not facts.quasiconvex:
        return None
    kind = "convex" if facts.convex else "quasiconvex"
    proof = Proof("composition", composed_of_sums(subject) if facts.by_a_matrix else {})
    return Evidence(Verdict.PROVED, "composition", f"g is {kind}: " + "; ".join(facts.rules or ("g is affine",)), proof=proof)


def smoothness(subject: FormulaSubject) -> Evidence | None:
    """The boundary is C^1 if g is C^1 near it and its gradient does not vanish there.

    The second follows from convexity and a point with g < 0 (no minimum on the boundary), or from Euler's relation.
    """
    if len(subject.simple.forces) == 1 and _interval(subject):
        return Evidence(
            Verdict.PROVED, "one-dimensional", "K is an interval with interior points: at each of its ends the normal is +1 or -1"
        )
    g = subject.simple.g
    facts = regularity(g, subject)
    if not facts.known or facts.kinks or not all(_off_boundary(subject, tip) for tip in facts.tips):
        return None
    cancelled = (
        "every kink lies where the function under it vanishes" if g.has(sp.Abs) or "Pos" in str(g) or "Neg" in str(g) else "g has no kink"
    )
    for look in (_regular, _regular_about_its_centre):
        if (regular := look(subject)) is not None:
            why, proof = regular
            return Evidence(
                Verdict.PROVED, "composition", f"{cancelled}, no tip lies on the boundary, and grad g != 0 on it {why}", proof=proof
            )
    return None


def _interval(subject: FormulaSubject) -> bool:
    """Whether K, with one force, is convex and has an inside; a single point has normals of both signs."""
    (x,), magnitude = subject.simple.forces, subject.simple.magnitude
    size = magnitude if magnitude is not None and magnitude in subject.simple.parameters else sp.S.One
    if not curvature(subject.simple.g, subject).quasiconvex:
        return False
    if subject.at_origin is not None and subject.positive(-subject.at_origin) and subject.continuous:
        return True
    inside = (z for z in (sp.S.Zero, size, -size) if subject.nonnegative(-subject.simple.g.xreplace({x: z})))
    return len(list(islice(inside, 2))) == 2


def _off_boundary(subject: FormulaSubject, tip: sp.Expr) -> bool:
    """Whether g != 0 wherever ``tip`` = 0: g with the tip set to 0 has one strict sign, or g where J2 = 0, by continuity."""
    there = on_axis(subject, subject.simple.g, tip)
    if there is not None and _of_one_sign(there, subject):
        return True
    mark = sp.Dummy("tip", positive=True)
    marked = subject.simple.g.xreplace({tip: mark})
    if not all(_tame(node, mark) for node in sp.preorder_traversal(marked)):
        return False
    return _of_one_sign(marked.xreplace({mark: sp.S.Zero}), subject)


def _of_one_sign(constant: sp.Expr, subject: FormulaSubject) -> bool:
    """Whether no force is in it, and its sign is strict."""
    if constant.free_symbols & set(subject.simple.forces):
        return False
    return subject.positive(-constant) or subject.positive(constant)


def _tame(node: sp.Basic, mark: sp.Symbol) -> bool:
    """Whether setting ``mark`` to 0 inside the node is its limit: sums, products and positive powers only."""
    if not node.has(mark) or node == mark or node.is_Add or node.is_Mul or isinstance(node, Norm):
        return True
    return bool(node.is_Pow and not node.exp.has(mark) and node.exp.is_positive)


def _regular(subject: FormulaSubject) -> tuple[str, Proof | None] | None:
    origin = subject.simple.g.xreplace(dict.fromkeys(subject.simple.forces, sp.S.Zero))
    shape = curvature(subject.simple.g, subject)
    if shape.convex and subject.positive(-origin):
        proof = Proof("composition", composed_of_sums(subject) if shape.by_a_matrix else {})
        return "because g is convex and negative at the origin", proof
    star = star_form(subject)
    if star is not None and not star.lower.free_symbols & set(subject.simple.forces) and subject.positive(star.lower):
        rooted = any(p.base.is_Add and not p.exp.is_Integer for p in subject.law.g.atoms(sp.Pow))
        return "by Euler's relation", Proof("euler", composed_of_sums(subject) if rooted else {})
    return None


def _regular_about_its_centre(subject: FormulaSubject) -> tuple[str, Proof | None] | None:
    """For a K that has the origin on its boundary or outside."""
    shape = curvature(subject.simple.g, subject)
    if not shape.convex or (support := subject.support) is None or not any(support.centre):
        return None
    problem = subject.problem
    centre = dict(zip(problem.forces, support.centre, strict=True))
    value = subject.law.g.xreplace(centre).xreplace(problem.compressed)
    if subject.decided(Question(-value, Sense.POSITIVE, problem.given)).holds is not True:
        return None
    inside = {x.name: formula(c) for x, c in centre.items()}
    proof = Proof("composition", {"inside": inside, **(composed_of_sums(subject) if shape.by_a_matrix else {})})
    return f"because g is convex and negative at ({', '.join(inside.values())})", proof
