"""Identities about a law's formula, as evidence for the kernel: convex sums, a boundary that rises outward and curves inward.

They speak of the law as stated, not of an equivalent slice of it.  Where the formula is not made of polynomials none is found.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from math import comb, prod
from typing import TYPE_CHECKING, Any

import sympy as sp

from duhem.expression import Where
from duhem.expression.branches import smooth_below, thick
from duhem.expression.invariance import invariant_directions
from duhem.law.formula_law import Criterion
from duhem.proof.decide import Budget
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import fact
from duhem.proof.statement import Face, faces

if TYPE_CHECKING:
    from duhem.proof.search.identities import Polynomial

__all__ = ["composed_of_sums", "convex_sums", "directions", "inward", "outward", "parallel", "steep"]

_GOAL, _BOUNDARY, _TANGENT = "the goal", "the boundary", "the tangent"
_MOST_PIECES, _MOST_MONOMIALS, _LONGEST = 64, 150, 20_000
_MOST_STEPS = 50_000_000  # of one identity: more than any of a known law takes, some seconds
Identities = tuple[Mapping[str, Any], ...]


@fact
def outward(subject: FormulaSubject) -> Identities:
    """For every piece of g, why force . flow > 0 (>= 0 for a flow of its own) wherever it is 0 in K; none where one is missing.

    What is no polynomial is left out of a flow of its own.
    """
    forms, found, state = _Forms.of(subject), list[Mapping[str, Any]](), subject.state
    for face in faces(subject.law):
        for g, flow, where in _smooth(forms, face if state is None else face._replace(flow=(state.power,))):
            if g is None or None in flow:
                if face.flow is None:
                    return ()
                continue  # signs may show it
            power: Any = flow[0] if state is not None else forms.along(forms.forces, flow or [g.diff(x) for x in forms.forces])
            known = forms.everywhere(-power, ">=" if face.flow is None else ">", g, where)
            if not known:
                return ()
            found += known
    return tuple(found)


@fact
def steep(subject: FormulaSubject) -> Identities:
    """For every piece of g, why grad g != 0 wherever it is 0; none where one is missing, or g is of more than forces (it takes long)."""
    forms, found = _Forms.of(subject), list[Mapping[str, Any]]()
    for face in faces(subject.law):
        for g, _, where in _smooth(forms, face):
            if g is None or not g.free_symbols <= set(forms.forces):
                return ()
            square = sum((d * d for d in (g.diff(x) for x in forms.forces)), forms.zero)
            if not (known := forms.everywhere(-square, ">=", g, where)):
                return ()
            found += known
    return tuple(found)


@fact
def parallel(subject: FormulaSubject) -> Mapping[str, Any]:
    """For every piece of each face with a flow of its own, why that is a positive multiple of grad g where g = 0 in K.

    ``along``: flow . grad g > 0; ``across``: no component of their vector product is > 0 or < 0.  Empty where one is missing.
    """
    forms, along, across = _Forms.of(subject), list[Mapping[str, Any]](), list[Mapping[str, Any]]()
    for face in faces(subject.law):
        for g, flow, where in _smooth(forms, face) if face.flow is not None else ():
            if g is None or None in flow:
                return {}
            gradient = [g.diff(x) for x in forms.forces]
            products = [flow[i] * gradient[j] - flow[j] * gradient[i] for i, j in combinations(range(len(flow)), 2)]
            goals = [minor for product in products if not product.is_zero for minor in (product, -product)]
            lead = -sum((d * n for d, n in zip(flow, gradient, strict=True)), forms.zero)
            for goal, op, found in ((lead, ">=", along), *((goal, ">", across) for goal in goals)):
                if not (known := forms.everywhere(goal, op, g, where)):
                    return {}
                found += known
    return {"along": along, "across": across}


@fact
def inward(subject: FormulaSubject) -> Identities:
    """Why the second derivative of g along every tangent is >= 0 on the boundary; none where that was not found."""
    forms = _Forms.of(subject)
    if (g := forms.form(forms.settled(subject.law.g))) is None:
        return ()
    tangent, bend = forms.derivatives(g)
    known = forms.refuted(-bend, ">", {_BOUNDARY: g, _TANGENT: tangent})
    return () if known is None else (known,)


@fact
def convex_sums(subject: FormulaSubject) -> Mapping[sp.Expr, Identities]:
    """The sums in g that are convex polynomials in the forces, though perhaps no composition: why, and why >= 0 if a root is taken."""
    forms, found = _Forms.of(subject), dict[sp.Expr, Identities]()
    g = forms.settled(subject.law.g)
    under_roots = {p.base for p in g.atoms(sp.Pow) if not p.exp.is_Integer}
    for f in sorted(g.atoms(sp.Add), key=sp.default_sort_key):
        if (form := forms.form(f)) is None or len(form.terms()) > _MOST_MONOMIALS or _degree(form, forms) % 2:
            continue  # of odd degree it is convex only if it is affine
        if (known := forms.convex(form)) is None:
            continue
        above = forms.refuted(-form, ">", {}) if f in under_roots else None
        found[f] = (known,) if above is None else (known, above)
    return found


def composed_of_sums(subject: FormulaSubject) -> Mapping[str, Any]:
    """Evidence for a composition: the convex sums in g."""
    identities = [known for both in convex_sums(subject).values() for known in both]
    return {"directions": directions(subject.law), "convex sums": identities} if identities else {}


def directions(law: Criterion) -> list[str]:
    """A name for the component of a direction along each force, which the law does not use."""
    prefix = "v_"
    while any(prefix + x in law.symbols() for x in law.forces):
        prefix = "v" + prefix
    return [prefix + x for x in law.forces]


def _smooth(forms: _Forms, face: Face) -> Iterator[tuple[sp.Poly | None, list[sp.Poly | None], list[list[sp.Expr]]]]:
    """The different smooth forms of g and flow on a face, each with what is >= 0 on every branch where it holds."""
    formulas: dict[tuple[sp.Basic, ...], list[list[sp.Expr]]] = {}
    own, flow = forms.settled(face.g), tuple(map(forms.settled, face.flow or ()))
    inside = [-smooth for other in face.others for smooth in smooth_below(forms.settled(other))]
    jumps = any(d.has(Where) for d in flow)  # then who owns the seam is left open: each piece of g with each of the flow
    formulas_apart = (sp.Tuple(own), sp.Tuple(*flow)) if jumps else (sp.Tuple(own, *flow),)
    for parts in product(*(thick(x, _MOST_PIECES) or () for x in formulas_apart)):
        sides = [sign * switch for part in parts for switch, sign in part.signs.items()]
        formulas.setdefault(tuple(x for part in parts for x in part.expr), []).append([*sides, *inside])
    for (g, *components), where in formulas.items():
        yield forms.form(g), list(map(forms.form, components)), where


@dataclass(frozen=True)
class _Forms:
    """A law's formulas as polynomials in ``generators``: forces, components of a direction, then pressure and free parameters.

    A positive parameter that divides stands there as 1/x.
    """

    law: Criterion
    forces: tuple[sp.Symbol, ...]
    generators: tuple[sp.Expr, ...]
    whole: Budget

    @classmethod
    def of(cls, subject: FormulaSubject) -> _Forms:
        law = subject.law
        table, forces = law.symbols(), law.force_symbols()
        formulas = sp.Tuple(law.g, *(d for face in faces(law) for d in face.flow or ()))
        divisors = {p.base for p in formulas.atoms(sp.Pow) if p.exp.is_negative and p.base.is_positive}
        rest = [*([table[law.pressure]] if law.pressure else []), *(1 / x if x in divisors else x for x in law.free())]
        return cls(law, forces, (*forces, *(sp.Symbol(name, real=True) for name in directions(law)), *rest), subject.whole)

    def settled(self, expr: sp.Expr) -> sp.Expr:
        """With the fixed parameters put in place."""
        return expr.subs(self.law.settled())

    def form(self, expr: sp.Expr) -> sp.Poly | None:
        """As a polynomial; None where it is none with rational coefficients, or too long to be multiplied out."""
        if not expr.is_polynomial(*self.forces) or _size(expr)[0] > _LONGEST:
            return None
        try:
            poly = sp.Poly(expr, *self.generators)
        except sp.PolynomialError:  # a force or a parameter in a root or a word
            return None
        return poly if poly.get_domain() in (sp.ZZ, sp.QQ) else None

    def along(self, v: Sequence[sp.Symbol], components: Sequence[sp.Poly | None]) -> sp.Poly:
        """Their scalar product."""
        return sum((sp.Poly(x, *self.generators) * d for x, d in zip(v, components, strict=True)), self.zero)

    def derivatives(self, f: sp.Poly) -> tuple[sp.Poly, sp.Poly]:
        """v . grad f and v . Hess f v."""
        v = self.generators[len(self.forces) : 2 * len(self.forces)]
        first = self.along(v, [f.diff(x) for x in self.forces])
        return first, self.along(v, [first.diff(x) for x in self.forces])

    @property
    def zero(self) -> sp.Poly:
        return sp.Poly(0, *self.generators)

    def everywhere(self, goal: sp.Poly, op: str, boundary: sp.Poly, where: Sequence[Sequence[sp.Expr]]) -> list[Mapping[str, Any]]:
        """Why ``goal`` is never ``op`` 0 on the boundary, everywhere or else on each of the places; none where one is missing."""
        if (known := self.refuted(goal, op, {_BOUNDARY: boundary})) is not None:  # as if the piece were g everywhere
            return [known]
        found = list[Mapping[str, Any]]()
        for conditions in where:
            sides = [form for side in conditions if (form := self.form(side)) is not None]  # fewer conditions, a stronger statement
            if not sides or (known := self.refuted(goal, op, {_BOUNDARY: boundary}, sides)) is None:
                return []
            found.append(known)
        return found

    def refuted(
        self, goal: sp.Poly, op: str, zero: Mapping[str, sp.Poly], sides: Sequence[sp.Poly | None] = (), names: Sequence[str] = ()
    ) -> Mapping[str, Any] | None:
        """Why ``goal`` is never ``op`` 0 in the law's domain where ``zero`` is 0 and ``sides`` are >= 0; ``names`` for the generators."""
        from duhem.proof.search.identities import Condition, identity, text  # numpy, only when something is looked for

        names = names or self.names
        bounds = [*((side, ">=") for side in sides), *((self.form(gap), op) for gap, op in self._domain())]
        given = [Condition(name, _terms(poly), "==") for name, poly in zero.items()]
        given += [Condition(text(_terms(poly), names), _terms(poly), op) for poly, op in bounds if poly is not None]
        return identity(names, Condition(_GOAL, _terms(goal), op), given, self.whole.part(_MOST_STEPS).pays)

    @property
    def names(self) -> list[str]:
        """The generators as the checker spells them."""
        return [x.name if x.is_Symbol else f"(1/{(1 / x).name})" for x in self.generators]

    def convex(self, f: sp.Poly) -> Mapping[str, Any] | None:
        """Why v . Hess f v is never negative.

        A force along which f does not change is set to 0; each of the others then stands for what of it is left by that.
        """
        rows: dict[sp.Symbol, dict[sp.Symbol, Fraction]] = {x: {x: Fraction(1)} for x in self.forces}
        while len(rows) > 1 and (flat := invariant_directions(f.as_expr(), list(rows))):
            along = {x: Fraction(int(c.p), int(c.q)) for x, c in zip(rows, flat[0], strict=True)}
            pivot = next(x for x in reversed(rows) if along[x])
            gone, f = rows.pop(pivot), f.eval(pivot, 0).as_expr().as_poly(*self.generators)
            for x, row in rows.items():
                row.update({y: row.get(y, 0) - along[x] / along[pivot] * c for y, c in gone.items()})
        _, bend = self.derivatives(f)
        if bend.is_zero:
            return None
        from duhem.proof.search.identities import text

        n, names = len(self.forces), self.names
        for i, x in enumerate(self.forces):
            if len(rows) < n and x in rows:
                left = {tuple(int(y is z) for z in self.forces): c for y, c in rows[x].items() if c}
                names[i], names[n + i] = (f"({text(left, part)})" for part in (self.names[:n], self.names[n : 2 * n]))
        return self.refuted(-bend, ">", {}, names=names)

    def _domain(self) -> Iterable[tuple[sp.Expr, str]]:
        """What is > 0 or >= 0 of the pressure and the free parameters, each once."""
        signs = ((x if x.is_positive else -x, ">") for x in self.generators[2 * len(self.forces) :] if x.is_nonpositive or x.is_positive)
        stated = (*(r for x, own in self.law.free().items() if x in self.generators for r in own.relations(x)), *self.law.constraints)
        strict = (sp.StrictGreaterThan, sp.StrictLessThan)
        return dict.fromkeys((*signs, *((c.gts - c.lts, ">" if isinstance(c, strict) else ">=") for c in stated)))


def _size(expr: sp.Expr) -> tuple[int, int]:
    """How many terms a polynomial has at most when it is multiplied out, and of which degree; both only up to one too many."""
    if expr.is_number:
        return 1, 0
    parts, (length, degree) = [_size(part) for part in expr.args], (1, 1)
    if expr.is_Add:
        length, degree = sum(n for n, _ in parts), max(k for _, k in parts)
    elif expr.is_Mul:
        length, degree = prod(n for n, _ in parts), sum(k for _, k in parts)
    elif expr.is_Pow and expr.exp.is_Integer and expr.exp > 0:
        n, power = parts[0][0], min(int(expr.exp), _LONGEST + 1)
        length, degree = comb(n + power - 1, power), parts[0][1] * power
    degree = min(degree, _LONGEST + 1)
    return min(length, comb(len(expr.free_symbols) + degree, degree), _LONGEST + 1), degree


def _degree(poly: sp.Poly, forms: _Forms) -> int:
    """In the forces."""
    return max(sum(m[: len(forms.forces)]) for m in poly.monoms())


def _terms(poly: sp.Poly) -> Polynomial:
    return {tuple(map(int, m)): Fraction(int(c.p), int(c.q)) for m, c in poly.terms() if c}
