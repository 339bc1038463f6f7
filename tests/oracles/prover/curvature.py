"""Convexity by composition: what is known of each node's curvature follows from its arguments by a theorem a rule.

Disciplined convex programming (Grant, Boyd, Ye 2006) with symbolic coefficients and exponents, and quasiconvexity kept
through increasing maps (Agrawal, Boyd 2020): a set {g <= 0} is convex when g is quasiconvex, even where g is not convex.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import Atan2, EigMax, Neg, Norm, Pos, Where, fold
from duhem.law.frozen_mapping import FrozenMapping
from duhem.proof.facts.formula_subject import FormulaSubject
from tests.oracles.prover.bends import bends
from tests.oracles.prover.deviator import asked, meaning
from tests.oracles.prover.even_roots import even, freed, outermost_roots
from tests.oracles.prover.loads import above_within, concave_above_within, loads_of
from tests.oracles.prover.one_side import left_on_one_side
from tests.oracles.prover.power_curvature import MovingParts
from tests.oracles.prover.profile import convex_by_its_profile
from tests.oracles.prover.quadratic_form import semidefinite
from tests.oracles.prover.section import Meaning, Section
from tests.oracles.prover.sector import Ordered, sectors
from tests.oracles.prover.shape import Curvature, total, used
from tests.oracles.prover.spectrum import spectrum
from tests.oracles.prover.word_curvature import WORDS, greatest

__all__ = ["convex_in_its_region", "curvature"]


_UNKNOWN = Curvature()
_SEMIDEFINITE = "a quadratic function with positive semidefinite matrix is convex"
_MOST_ROOTS = 8


def curvature(
    expr: sp.Expr, subject: FormulaSubject, convex: Mapping[sp.Expr, bool] = FrozenMapping(), loads: Collection[sp.Expr] = ()
) -> Curvature:
    """Facts about ``expr`` over the forces of the subject's simple problem, for every parameter of its domain.

    The sums in ``convex`` are known to be convex, though not by these rules; true of those that are >= 0 as well.  It is asked where
    all ``loads`` are >= 0.
    """
    return _CurvatureRules(subject, convex, loads=loads).of(expr)


def convex_in_its_region(subject: FormulaSubject, anywhere: Curvature | None = None) -> Curvature:
    """Facts about g where loads in it allow it to be <= 0; of the maximum that it is, the parts that are no loads together.

    What is known of g ``anywhere`` need not be found again where there are no loads.
    """
    g, forces = subject.simple.g, subject.simple.forces
    rules = _CurvatureRules(subject, FrozenMapping(), loads=tuple(loads_of(g, forces)))
    parts = g.args if isinstance(g, sp.Max) else (g,)
    if not rules.loads and len(parts) == 1 and not g.is_polynomial(*forces):
        return _UNKNOWN
    if not rules.loads and anywhere is not None:
        rules.found[g] = anywhere
    shapes = [rules.in_the_region(part, [other for other in parts if other is not part]) for part in parts]
    quasi = all(shape.quasiconvex for shape in shapes)
    return Curvature(quasiconvex=quasi, rules=used(*shapes, rule="K lies where the loads in g allow it"))


class _CurvatureRules:
    def __init__(
        self,
        subject: FormulaSubject,
        convex: Mapping[sp.Expr, bool],
        others: Collection[sp.Symbol] = (),
        loads: Collection[sp.Expr] = (),
    ) -> None:
        """``others`` are taken for forces too; it is asked where all ``loads`` are >= 0."""
        self.subject, self.convex, self.loads = subject, convex, loads
        self.forces = {*subject.simple.forces, *others}
        self.found: dict[sp.Expr, Curvature] = {}
        self.several = MovingParts(self.of, self.forces, subject)
        self.table: dict[type, Callable[..., Curvature]] = {
            sp.Add: self.add, sp.Mul: self.mul, sp.Pow: self.power, sp.Max: self.maximum, sp.Min: self.minimum,
            sp.log: self.opaque, sp.sin: self.opaque, sp.cos: self.opaque, sp.tan: self.opaque, Atan2: self.opaque, Where: self.opaque,
        }  # fmt: skip
        for word, rule in WORDS.items():
            self.table[word] = partial(self.word, rule)
        for relation in (sp.StrictGreaterThan, sp.GreaterThan, sp.StrictLessThan, sp.LessThan):
            self.table[relation] = self.opaque

    def of(self, expr: sp.Expr) -> Curvature:
        if expr not in self.found:
            try:
                self.found[expr] = fold(expr, self.table, self.leaf)
            except InputError:
                self.found[expr] = _UNKNOWN
        return self.found[expr]

    def in_the_region(self, part: sp.Expr, others: Sequence[sp.Expr]) -> Curvature:
        """A part of a maximum that K lies under, and the others."""
        facts = self.of(part)
        if not facts.quasiconvex and convex_by_its_profile(part, self.loads, self.subject):
            return Curvature(quasiconvex=True, rules=("{Q <= h(t)} is convex for a seminorm sqrt Q and a concave profile sqrt h",))
        if not facts.quasiconvex and part.is_Add and len(part.args) == 2 and any(map(self._below_a_product, part.args, part.args[::-1])):
            return Curvature(quasiconvex=True, rules=("u^n <= c v_1 ... v_m is u <= a geometric mean, concave for v_i >= 0 and m <= n",))
        if not facts.quasiconvex and facts.concave and left_on_one_side(part, others, self.forces, self.subject.positive):
            return Curvature(quasiconvex=True, rules=("what is left of {f <= 0} on one side of where f > 0 is a half-space, f concave",))
        return facts

    def _below_a_product(self, power: sp.Expr, rest: sp.Expr) -> bool:
        """u^n - c v_1 ... v_m, v_i >= 0 and concave, m <= n, c >= 0."""
        if not (power.is_Pow and power.exp.is_Integer and power.exp > 0):
            return False
        scale, moving = rest.as_independent(*self.forces, as_Add=False)
        u, shapes = self.of(power.base), [self.of(v) for v in sp.Mul.make_args(moving)]
        below = u.convex and (power.exp.is_odd or u.affine or u.nonnegative)
        return below and len(shapes) <= power.exp and all(v.concave and v.nonnegative for v in shapes) and self.subject.nonnegative(-scale)

    def leaf(self, node: Any) -> Curvature:
        if node not in self.forces:
            return self.constant(node)
        affine = Curvature(convex=True, concave=True, quasiconvex=True)
        return self._within(node, affine) if self.loads else affine

    def constant(self, node: sp.Expr) -> Curvature:
        low = self.subject.nonnegative(node)
        high = not low and self.subject.nonnegative(-node)
        return Curvature(True, True, True, True, low, high or node.is_zero is True)

    def signed(self, node: Any, facts: Curvature) -> Curvature:
        """The facts, plus the sign SymPy sees; a node without forces is a constant whatever its parts."""
        if not node.free_symbols & self.forces:
            return self.constant(node)
        if not (facts.nonnegative or self._multiplied_out(node)) and node.is_extended_nonnegative:
            facts = replace(facts, nonnegative=True)
        if self.loads:
            facts = self._within(node, facts)
        return facts

    def _multiplied_out(self, node: sp.Expr) -> bool:
        """Whether it is a sum of monomials in the forces: of their signs SymPy sees no more than the rules, and takes long to see it."""
        factors = (f for part in sp.Add.make_args(node) for f in sp.Mul.make_args(part))
        return all(
            f.is_Rational or f in self.forces or (f.is_Pow and f.base in self.forces and f.exp.is_Integer and f.exp > 0) for f in factors
        )

    def _within(self, node: sp.Expr, facts: Curvature) -> Curvature:
        """Signs of loads, and of concave functions of one load, where loads are >= 0."""
        above = self.subject.nonnegative
        if facts.affine and node.is_polynomial(*self.forces):
            low, high = (above_within(side, self.loads, self.forces, above) for side in (node, -node))
            facts = replace(facts, nonnegative=facts.nonnegative or low, nonpositive=facts.nonpositive or high)
        if facts.concave and not facts.nonnegative and concave_above_within(node, self.loads, self.forces, above):
            return replace(facts, nonnegative=True)
        return facts

    def opaque(self, node: Any, *parts: Curvature) -> Curvature:
        if isinstance(node, sp.Expr) and not node.free_symbols & self.forces:
            return self.constant(node)
        return _UNKNOWN

    def word(self, rule: Callable[..., Curvature], node: Any, *args: Curvature) -> Curvature:
        return self.signed(node, rule(*args))

    def add(self, node: Any, *terms: Curvature) -> Curvature:
        convex, concave = all(t.convex for t in terms), all(t.concave for t in terms)
        moving = [t for t in terms if not t.constant]
        facts = Curvature(
            convex=convex,
            concave=concave,
            quasiconvex=convex or (len(moving) == 1 and moving[0].quasiconvex),
            nonnegative=all(t.nonnegative for t in terms),
            nonpositive=all(t.nonpositive for t in terms),
            rules=used(*terms),
        )
        if node in self.convex:
            facts = replace(facts, convex=True, quasiconvex=True, nonnegative=facts.nonnegative or self.convex[node])
            facts = replace(facts, rules=used(facts, rule="a polynomial is convex by sums of squares"))
        elif not convex and semidefinite(node, self.forces, self.subject):
            facts = replace(facts, convex=True, quasiconvex=True, rules=used(facts, rule=_SEMIDEFINITE))
        if node.has(sp.Abs, Pos, Neg) and not (facts.convex and facts.nonnegative):
            facts = self._bent(node, facts)
        return self._together(node, self.signed(node, facts))

    def _together(self, node: Any, facts: Curvature) -> Curvature:
        """By rules that look at more than the parts one by one."""
        if facts.convex or not node.free_symbols & self.forces:
            return facts
        found = self._by_section(node) if self.meaning is not None else None
        if found is None or not found.quasiconvex:
            found = self._by_sector(node)
        return found if found is not None and found.quasiconvex else self._by_spectrum(node, self.even(node, facts))

    def _by_sector(self, node: Any) -> Curvature | None:
        """The parts that are functions of the ordered principal values of a deviator taken together by their degree."""
        if not node.has(EigMax, sp.Max, sp.Min, Where, sp.acos) or self.forces != {*self.subject.simple.forces}:
            return None
        for sector in sectors(node, self.subject.simple.forces, self.meaning, self._linear):
            groups, moving = dict[sp.Expr, sp.Expr](), list[Curvature]()
            for part in sp.Add.make_args(node):
                if not part.free_symbols & self.forces:
                    moving.append(self.constant(part))
                elif (ordered := sector.read(part)) is not None and ordered.degree.is_positive:
                    groups[ordered.degree] = groups.get(ordered.degree, sp.S.Zero) + ordered.p
                elif node.is_Add:
                    moving.append(self.of(part))
            rule = "a function of the ordered principal values is convex where it is so in its sector and no wall of it turns inward"
            for degree, p in groups.items():
                quasi, above = Ordered(degree, p).shape(asked(self.subject), self._opened)
                moving.append(Curvature(convex=quasi and not (degree - 1).is_negative, quasiconvex=quasi, nonnegative=above, rules=(rule,)))
            found = total(moving)
            if groups and found.quasiconvex:
                return found
        return None

    def _linear(self, entry: sp.Expr) -> bool:
        return bool(entry.is_polynomial(*self.forces)) and entry.subs(dict.fromkeys(self.forces, 0)) == 0 and self.of(entry).affine

    @cached_property
    def _opened(self) -> tuple[sp.Basic, ...]:
        """That no parameter is at an end of its range, where no constraint ties them and the formula changes continuously with them."""
        law, g = self.subject.law, self.subject.simple.g
        jumps = any(not x.free_symbols & self.forces for x in (*g.atoms(Atan2), *(choice.args[0] for choice in g.atoms(Where))))
        free = (
            {}
            if law.constraints or jumps
            else {x: law.parameters[x.name] for x in self.subject.simple.parameters if x.name in law.parameters}
        )
        lows = (sp.StrictGreaterThan(x - d.low, 0) for x, d in free.items() if d.low is not None)
        highs = (sp.StrictGreaterThan(d.high - x, 0) for x, d in free.items() if d.high is not None)
        return (*lows, *highs)

    def _by_spectrum(self, node: Any, facts: Curvature) -> Curvature:
        """As a symmetric function of eigenvalues."""
        if facts.quasiconvex or not node.has(EigMax, sp.Max, sp.Min):
            return facts
        found = spectrum(node, self.forces, lambda entry: self.of(entry).affine)
        if found is None:
            return facts
        others = (*(self.forces - {*self.subject.simple.forces}), *found.names)
        shape = _CurvatureRules(self.subject, self.convex, others, self.loads).of(found.freed)
        if not shape.quasiconvex or not found.symmetric():
            return facts
        rules = used(shape, rule="a symmetric convex function of the eigenvalues is convex in the matrix")
        return replace(facts, convex=shape.convex, quasiconvex=True, nonnegative=facts.nonnegative or shape.nonnegative, rules=rules)

    @cached_property
    def meaning(self) -> Meaning | None:
        """What tensor the forces are, if J2 of one stands in the law."""
        return meaning(self.subject) if self.forces == {*self.subject.simple.forces} else None

    def _by_section(self, node: Any) -> Curvature | None:
        """The parts that are functions of J2 and J3 taken together by their degree."""
        groups, moving = dict[sp.Expr, sp.Expr](), list[Curvature]()
        assert self.meaning is not None
        for part in sp.Add.make_args(node):
            if not part.free_symbols & self.forces:
                moving.append(self.constant(part))
            elif (section := self.meaning.read(part)) is not None and section.degree.is_positive:
                groups[section.degree] = groups.get(section.degree, sp.S.Zero) + section.f
            elif not node.is_Add:
                return None
            else:
                moving.append(self.of(part))
        rule = "a function of J2 and J3 is convex where its section is"
        for degree, f in groups.items():
            section = Section(degree, f)
            quasi, above = section.convex(asked(self.subject)), section.nonnegative(asked(self.subject))
            moving.append(Curvature(convex=quasi and not (degree - 1).is_negative, quasiconvex=quasi, nonnegative=above, rules=(rule,)))
        return total(moving)

    def _bent(self, node: Any, facts: Curvature) -> Curvature:
        """With kinks of one x taken together."""
        found, rest = bends(node, self.forces)
        inner = {bend.x: self.of(bend.x) for bend in found}
        if found and rest.is_zero and len(found) == 1 and found[0].nonnegative(self.subject.nonnegative):
            facts = replace(facts, nonnegative=True)
        if found and not facts.convex and all(b.convex(self.subject.nonnegative, inner[b.x].convex, inner[b.x].concave) for b in found):
            other = self.of(rest)
            if other.convex:
                rules = used(*inner.values(), other, rule="a x+ + b x- is convex for a + b >= 0, of a convex x for a >= -b >= 0 too")
                return replace(facts, convex=True, quasiconvex=True, rules=rules)
        return facts

    def even(self, node: Any, facts: Curvature) -> Curvature:
        """With roots in whose place the node is even taken as further forces."""
        if facts.convex or not node.free_symbols & self.forces or not node.has(sp.Pow, Norm):
            return facts
        roots = dict.fromkeys(outermost_roots(node, self.forces, self._convex_root))
        if node in roots or not 0 < len(roots) <= _MOST_ROOTS:
            return facts
        for expr, others in freed(node, roots, self.forces):
            shape = _CurvatureRules(self.subject, self.convex, (*(self.forces - {*self.subject.simple.forces}), *others)).of(expr)
            if not shape.quasiconvex or (facts.quasiconvex and not shape.convex) or not even(expr, others):
                continue
            rules = used(*map(self.of, roots), shape, rule="f(x, r) with f convex, even in r and r convex >= 0 is convex")
            return replace(facts, convex=shape.convex, quasiconvex=True, nonnegative=facts.nonnegative or shape.nonnegative, rules=rules)
        return facts

    def _convex_root(self, root: sp.Expr) -> bool:
        shape = self.of(root)
        return shape.convex and shape.nonnegative and not shape.affine

    def mul(self, node: Any, *factors: Curvature) -> Curvature:
        if not node.free_symbols & self.forces:
            return self.constant(node)
        scale = sp.Mul(*(f for f in node.args if not f.free_symbols & self.forces))
        moving = [(f, s) for f, s in zip(node.args, factors, strict=True) if f.free_symbols & self.forces]
        several = Curvature(nonnegative=all(s.nonnegative for _, s in moving))  # of a product only the sign is followed
        facts = moving[0][1] if len(moving) == 1 else several
        sizes = [(f.args[0], s) for f, s in moving if isinstance(f, sp.Abs)]
        if (
            len(moving) == 2
            and sizes
            and sizes[0][1].convex
            and any(f.is_Pow and f.base == sizes[0][0] and f.exp.is_even and f.exp.is_positive for f, _ in moving)
        ):
            shape = sizes[0][1]  # |x|^3 is kept as x^2 |x|
            facts = Curvature(convex=True, quasiconvex=True, nonnegative=True, rules=used(shape, rule="odd powers of |x| are convex"))
        if len(moving) == 2 and self.several.size_by_its_logarithm([f for f, _ in moving], scale):
            rules = ("x log x is convex for x > 0",)
            return Curvature(convex=True, quasiconvex=True, rules=rules)
        if self.subject.nonnegative(scale):
            return self._together(node, self.signed(node, facts))
        if self.subject.nonnegative(-scale):
            return self.signed(node, facts.negated())
        return self.signed(node, Curvature(convex=facts.affine, concave=facts.affine, quasiconvex=facts.affine, rules=facts.rules))

    def power(self, node: Any, base: Curvature, exponent: Curvature) -> Curvature:
        if not node.free_symbols & self.forces:
            return self.constant(node)
        p = node.exp
        if p.free_symbols & self.forces:
            return _UNKNOWN
        if p.is_Integer and p > 0 and p % 2 == 0:
            if base.affine or (base.convex and base.nonnegative) or (base.concave and base.nonpositive):
                return Curvature(
                    convex=True, quasiconvex=True, nonnegative=True, rules=used(base, rule="even powers of affine functions are convex")
                )
            return Curvature(nonnegative=True)
        if not base.nonnegative:
            return self.signed(node, _UNKNOWN)
        if self.subject.nonnegative(p - 1):
            if base.convex:
                return Curvature(
                    convex=True,
                    quasiconvex=True,
                    nonnegative=True,
                    rules=used(base, rule="x^p is convex and increasing on x >= 0 for p >= 1"),
                )
            return Curvature(quasiconvex=base.quasiconvex, nonnegative=True, rules=base.rules)
        if self.subject.positive(p):
            if norm := self.several.norm(node.base, p):
                return Curvature(convex=True, quasiconvex=True, nonnegative=True, rules=norm)
            concave = (base.concave and self.subject.nonnegative(1 - p)) or self.several.geometric_mean(node.base, p)
            return Curvature(
                concave=concave, quasiconvex=base.quasiconvex, nonnegative=True, rules=used(base, rule="x^p is increasing on x >= 0")
            )
        return Curvature(nonnegative=True)

    def maximum(self, node: Any, *args: Curvature) -> Curvature:
        return self._together(node, self.signed(node, greatest(*args)))

    def minimum(self, node: Any, *args: Curvature) -> Curvature:
        return self.maximum(node, *(x.negated() for x in args)).negated() if node.free_symbols & self.forces else self.constant(node)
