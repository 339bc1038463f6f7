"""The seven claims, in the order in which they rest on each other: what each states, what it rests on, and the methods that may try it.

Methods are tried in order, the cheapest sound one first; the kernel's rules, which decide what is proved, are among them twice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any, Generic, Protocol, TypeVar

from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.methods import curves, evidence, refuters
from duhem.proof.verdict import CONTRADICTION, Evidence, Verdict

__all__ = ["CHEAP", "CLAIMS", "DEAR", "Claim", "Consequence", "Finder", "Kernel", "ProofMethod", "Rules", "words"]

S = TypeVar("S", bound=Subject)
Settled = Mapping[str, Evidence]  # claims decided before, by name
Confirms = Callable[[Evidence], bool]


class Kernel(Protocol):
    """Who decides what is proved, by rules of its own."""

    def proof(self, claim: str, steps: int) -> Evidence | None:
        """The first of its rules that proves the claim without evidence, each within so many steps; None where none does."""

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        """Whether it accepts a proof of the claim."""


@dataclass(frozen=True)
class Rules:
    """The kernel's rules that need no evidence, as a method of proof of either kind of law; each may cost so many ``steps``."""

    steps: int
    takes: type[Any] = Subject


@dataclass(frozen=True)
class ProofMethod(Generic[S]):
    """A method of proof or refutation: ``run`` answers, or passes with None, for the kind of law it ``takes``.

    A cheap refuter looks ``again`` after a proof that nobody else has confirmed.
    """

    takes: type[S]
    run: Callable[[S], Evidence | None]
    again: bool = False


@dataclass(frozen=True)
class Consequence(Generic[S]):
    """A method that starts from the evidence of the claims its own claim ``needs``."""

    takes: type[S]
    run: Callable[[S, Settled], Evidence | None]


@dataclass(frozen=True)
class Finder(Generic[S]):
    """A method that finds evidence and decides nothing: the first of its proofs that the kernel confirms counts, and no other."""

    takes: type[S]
    run: Callable[[S], Iterable[Evidence]]


Method = Rules | ProofMethod[Any] | Consequence[Any] | Finder[Any]
CHEAP, DEAR = Rules(500_000), Rules(10_000_000, FormulaSubject)


def words(method: Method, claim: str) -> str:
    """What a method is called while it is tried for the claim: its place in the code, in words."""
    if isinstance(method, Rules):
        return "kernel"
    function: Any = method.run
    own, part = function.__module__.rpartition(".")[2], function.__name__.removeprefix(claim)
    return " ".join(f"{own} {part}".removeprefix(claim).replace("_", " ").split()) or claim.replace("_", " ")


@dataclass(frozen=True)
class Claim:
    """``methods`` try in order, each on the kind of law it takes; ``needs`` names the claims to be settled before.

    ``steps`` is what its methods may cost, whatever other claims cost; what is then still open stays undecided.
    """

    name: str
    statement: str
    theory: str
    methods: tuple[Method, ...]
    needs: tuple[str, ...] = ()
    steps: int = 16_000_000

    def examine(
        self, subject: Subject, settled: Settled, kernel: Kernel | None = None, on_method: Callable[[str], None] = lambda _: None
    ) -> Evidence:
        """The first answer, or ``undecided`` when every method passed.

        Of a law that may be undefined somewhere only a proof that the ``kernel`` confirms counts: it asks itself what its rule needs.
        ``on_method`` is told of each method for this kind of law before it tries.
        """
        subject.allow(self.steps)
        confirms: Confirms = (lambda _: False) if kernel is None else partial(kernel.confirms, self.name)
        for method in self.methods:
            if not isinstance(subject, method.takes):
                continue
            on_method(words(method, self.name))
            match method:
                case Rules():
                    found = None if kernel is None else kernel.proof(self.name, method.steps)
                case Finder():
                    found = next(filter(confirms, method.run(subject)), None)
                case _:
                    found = method.run(subject, settled) if isinstance(method, Consequence) else method.run(subject)
                    found = found if found is not None and self._counts(found, subject, confirms) else None
            if found is not None:
                return found
        return Evidence(Verdict.UNDECIDED, "none", "no method decided it within its budget of steps")

    def provers_first(self) -> Claim:
        """The same claim for who needs a proof: the first refuter alone comes before what finds one, for it sees what is plainly false."""
        later = [method for method in self.methods if isinstance(method, ProofMethod)][1:]
        return replace(self, methods=tuple(sorted(self.methods, key=lambda method: method in later)))

    def _counts(self, found: Evidence, subject: Subject, confirms: Confirms) -> bool:
        if found.witness is not None:
            return subject.may_refute(self.name, found.witness.points.values())
        return found.verdict is not Verdict.PROVED or subject.may_prove(self.name) or confirms(found)

    def contradiction(self, subject: Subject, settled: Settled) -> Evidence | None:
        """What is left of a proof that a refuter disagrees with: one of the two is wrong, and who reads it is told so."""
        subject.allow(self.steps)
        again = (m for m in self.methods if isinstance(m, ProofMethod) and m.again and isinstance(subject, m.takes))
        for found in (method.run(subject) for method in again):
            if found is not None and found.witness is not None and subject.may_refute(self.name, found.witness.points.values()):
                where = {**found.witness.parameters, **{role: dict(point) for role, point in found.witness.points.items()}}
                detail = (
                    f"{settled[self.name].method} proved it and {found.method} refutes it at {where}: a defect of duhem, please report it"
                )
                return Evidence(Verdict.UNDECIDED, CONTRADICTION, detail)
        return None


_ALL = (
    Claim(
        name="origin",
        statement="0 is in K(sigma_n) for every sigma_n < 0",
        theory="""\
The indicator of K, taken as pseudo-potential Phi*, must be least (= 0) at zero force: that is 0 in K, or g(0) <= 0
(Antoni et al. 2007, Eqs. 27, 34).  Then Phi* >= 0 = Phi*(0) and, with normality, the dissipation is never negative.
Decided by evaluating g at the origin and deciding the sign over all parameters; a formula that reads 0/0 there is
taken by closure when its set is star-shaped about 0; else the claim stays open, and it is said where g has no value.
For a law given by a boundary curve T, K holds the points the curve winds around: the turns of T around 0 are counted, or
T x T' > 0, or T . d > 0, so that T turns as often as the flow d does.""",
        methods=(
            CHEAP,
            ProofMethod(FormulaSubject, refuters.origin_at_parameters, again=True),
            DEAR,
            ProofMethod(FormulaSubject, refuters.origin_undefined),
            ProofMethod(CurveSubject, curves.origin_refuted),
        ),
    ),
    Claim(
        name="convexity",
        statement="K(sigma_n) = {g <= 0} is convex for every sigma_n < 0",
        theory="""\
The claim is about the set, not about the function: sqrt(|s|) - 1 is not convex and its set is.  Proved by composition (g is
quasiconvex by the rules of disciplined convex programming, polynomials in it by sums of squares), by polyhedra (K is the polyhedron
of its faces), by the gauge gamma of a star-shaped K in two forces (gamma'' + gamma >= 0 as a measure, jumps of gamma' at seams
included), by fans (one formula in each cone between rays), by the boundary, which rises and curves inward everywhere, kinks
outward included.
Refuted only by two points of K whose midpoint is outside, in exact arithmetic.  They are looked for across dents and kinks, from where
a ball lies farthest along a load, and between exact points of faces, edges and whiskers or beside them.
A boundary curve T bounds a convex set if T' x T'' > 0 and the tangent turns once; refuted by a point inside a triangle of
boundary points that the curve does not wind around.""",
        methods=(
            CHEAP,
            ProofMethod(FormulaSubject, refuters.convexity_at_clear_dents),
            Finder(FormulaSubject, evidence.convexity_by_sums),
            ProofMethod(FormulaSubject, refuters.convexity_at_deepest_dents),
            ProofMethod(FormulaSubject, refuters.convexity_at_far_points),
            ProofMethod(FormulaSubject, refuters.convexity_by_scouting, again=True),
            ProofMethod(FormulaSubject, refuters.convexity_between_exact_rays),
            ProofMethod(FormulaSubject, refuters.convexity_beside_edges),
            DEAR,
            ProofMethod(FormulaSubject, refuters.convexity_at_dents),
            ProofMethod(FormulaSubject, refuters.convexity_at_seams, again=True),
            Finder(FormulaSubject, evidence.convexity_on_boundary),
            ProofMethod(FormulaSubject, evidence.convexity_by_branches),
            ProofMethod(FormulaSubject, refuters.convexity_by_thorough_scouting),
            ProofMethod(FormulaSubject, refuters.convexity_by_sampling),
            ProofMethod(CurveSubject, curves.convexity_refuted),
        ),
    ),
    Claim(
        name="smoothness",
        statement="the boundary of K(sigma_n), sigma_n < 0, is C^1 in the forces: the outward unit normal is continuous along g = 0",
        theory="""\
Where the boundary is C^1 the slip direction is a function of the stress; at a corner it is only confined to a cone.
A kink of abs, pos or neg under an even power, or inside a Euclidean norm, disappears when the function vanishes on it:
that is why Eq. (35) is C^1 across its quadrant seams though its four branches differ.  The tip at zero force, where
g is not differentiable, lies inside K for sigma_n < 0 and does not touch the boundary.
Refuted by a corner held in a box, with two normals that are provably not parallel, or by an exact point from which open cones
about two opposite directions leave K.
A boundary curve is C^1 where it is simple (convex, or T x T' > 0), analytic in its angle and T' is never 0.""",
        methods=(
            CHEAP,
            Finder(FormulaSubject, evidence.smoothness_by_sums),
            ProofMethod(FormulaSubject, refuters.smoothness_at_sharp_points, again=True),
            ProofMethod(FormulaSubject, refuters.smoothness_at_corners, again=True),
            DEAR,
            Finder(FormulaSubject, evidence.smoothness_by_identities),
            ProofMethod(FormulaSubject, evidence.smoothness_on_boundary),
        ),
    ),
    Claim(
        name="normality",
        statement="the flow direction lies in the normal cone of K at every boundary point",
        theory="""\
Normality rule (Moreau 1970; Antoni et al. 2007, Eqs. 28, 36): u_in' in dI_K(sigma), the normal cone of K at sigma in the
tangential plane at frozen sigma_n.  d is in the normal cone at sigma exactly when d . (tau - sigma) <= 0 for all tau in K.
An associated law obeys it by definition when K is convex; when K is not, grad g fails it where a chord leaves K.
A law with a flow of its own obeys it when that flow is a non-negative multiple of grad g on the boundary.
Where K is bounded by several surfaces the slip at a point is a non-negative combination of the flows of those that are 0
there (Koiter 1953): each must be in the normal cone of K wherever its surface is 0 in K.  A surface without a flow slips
along the normals of its own {g <= 0}, which are normals of K, for K lies in that.
Refuted by a boundary point, held between two rational ones, and a point tau of K towards which the flow points.
For a boundary curve the deviation between flow and normal is greatest at an angle found by branch and bound in balls; two
boundary points at exact angles show the violation.""",
        methods=(
            CHEAP,
            Consequence(FormulaSubject, refuters.normality_at_chord),
            Consequence(FormulaSubject, evidence.normality_parallel),
            ProofMethod(FormulaSubject, refuters.normality_at_points, again=True),
            ProofMethod(FormulaSubject, refuters.normality_by_sampling),
            ProofMethod(CurveSubject, curves.normality_by_deviation),
            ProofMethod(CurveSubject, curves.normality_refuted),
        ),
        needs=("convexity",),
    ),
    Claim(
        name="dissipation",
        statement="force . flow >= 0 at every boundary point",
        theory="""\
The intrinsic dissipation of the law reduces to D = sigma . u_in' (Clausius-Duhem, Antoni et al. 2007, Eqs. 22, 23).
It follows from 0 in K and normality (Fenchel: D = Phi*(sigma) + Phi(u_in') >= 0), but does not need them: a star-shaped K
with associated flow dissipates by Euler's relation, as does any g = A - B of degrees a > b with B > 0, and a non-associated
law may dissipate too.
Where g has a tip, as at an apex, and the formula of the flow no value, the slip is any mean of limits of the flow there (Koiter 1953).
Of several surfaces each flow is asked wherever its surface is 0 in K; then every non-negative combination dissipates too.
Refuted by a boundary point, held between two rational ones, where force . flow < 0 over the whole box.
For a boundary curve T with flow d it is the sign of T . d all around.""",
        methods=(
            CHEAP,
            Finder(FormulaSubject, evidence.dissipation_of_potential),
            Finder(FormulaSubject, evidence.dissipation_by_shares),
            ProofMethod(FormulaSubject, refuters.dissipation_at_points, again=True),
            DEAR,
            Finder(FormulaSubject, evidence.dissipation_by_identities),
            ProofMethod(FormulaSubject, evidence.dissipation_on_boundary),
            ProofMethod(FormulaSubject, refuters.dissipation_by_sampling),
            ProofMethod(CurveSubject, curves.dissipation_refuted),
        ),
        needs=("origin", "normality"),
    ),
    Claim(
        name="duality",
        statement="the dissipation potential in closed form is the support function of K",
        theory="""\
The potential dual to the indicator of K is its support function Phi(d) = sup of sigma . d over K (Legendre-Fenchel);
for K = radius {gauge <= 1} it is the radius times the polar gauge (Rockafellar 1970, Theorems 14.5, 15.3).  For Eq. (35):
Phi(d) = |sigma_n| sqrt((mu_a^+- d_a)^2 + (mu_b^+- d_b)^2), each sign that of d_i, and Phi** = Phi.
Where the rules find no closed form nothing is proved or refuted: the verdict is not applicable.""",
        methods=(ProofMethod(FormulaSubject, evidence.duality), ProofMethod(CurveSubject, curves.duality)),
    ),
    Claim(
        name="state_laws",
        statement="sigma = dpsi/du = -dpsi/du_in, psi convex",
        theory="""\
The free energy psi_C = (u - u_in) . k (u - u_in)/2 (Antoni et al. 2007, Eq. 30), here with any symmetric positive
semidefinite stiffness k, gives the stress by differentiation with respect to u and, with the opposite sign, to u_in
(Eqs. 25, 31).  It is convex in (u, u_in) jointly: a sum of squares of linear functions.""",
        methods=(CHEAP,),
    ),
)
CLAIMS: Mapping[str, Claim] = MappingProxyType({claim.name: claim for claim in _ALL})
