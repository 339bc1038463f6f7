"""The claims, in the order in which they rest on each other: what each states, what it rests on, and the methods that may try it.

Two more are asked on request: they are about forces and pressure together.

Methods are tried in order, the cheapest sound one first; the kernel's rules, which decide what is proved, are among them twice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Generic, Protocol, TypeVar

from duhem.errors import InputError
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.proof.decide import Budget
from duhem.proof.facts.curve_subject import CurveSubject
from duhem.proof.facts.formula_subject import FormulaSubject, RateSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.methods import coupled, curves, evidence, refuters
from duhem.proof.verdict import Evidence, Verdict

__all__ = [
    "CHEAP", "CLAIMS", "COUPLED", "DEAR", "EVERY", "SPELLED_OTHERWISE", "Claim", "Consequence", "Finder", "Kernel", "OnMethod",
    "ProofMethod", "Rules", "asked_of", "words",
]  # fmt: skip

S = TypeVar("S", bound=Subject)
Settled = Mapping[str, Evidence]  # claims decided before, by name
Confirms = Callable[[Evidence], bool]
OnMethod = Callable[[str, str, Budget], None]  # told of a claim, a method, and the steps that it may take


class Kernel(Protocol):
    """Who decides what is proved, by rules of its own."""

    def proof(self, claim: str, steps: int, as_written: bool | None = None) -> Evidence | None:
        """The first of its rules that proves the claim without evidence, each within so many steps; None where none does.

        ``as_written`` says what a rule reads: True the law as its text says it, False the law in its normal form, None both.
        """

    def confirms(self, claim: str, evidence: Evidence) -> bool:
        """Whether it accepts a proof of the claim."""


@dataclass(frozen=True)
class Rules:
    """The kernel's rules that need no evidence, as a method of proof of either kind of law; each may cost so many ``steps``.

    ``as_written`` says what they read: True the law as its text says it, False the law in its normal form, None both.
    """

    steps: int
    takes: type[Any] = Subject
    as_written: bool | None = None


@dataclass(frozen=True)
class ProofMethod(Generic[S]):
    """A method of proof or refutation: ``run`` answers, or passes with None, for the kind of law it ``takes``."""

    takes: type[S]
    run: Callable[[S], Evidence | None]


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
CHEAP, SPELLED_OTHERWISE = Rules(500_000, as_written=True), Rules(500_000, FormulaSubject, as_written=False)
DEAR = Rules(10_000_000, FormulaSubject)
OF_GRAPH = Rules(200_000_000, GraphSubject)
_NO_DUAL = ProofMethod(GraphSubject, refuters.duality_of_graph_left_out)
WITHOUT_K = ProofMethod(RateSubject, refuters.without_k)


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
    methods: tuple[Method, ...]
    needs: tuple[str, ...] = ()
    steps: int = 16_000_000

    @property
    def theory(self) -> str:
        """What the claim says and how it is decided, in paragraphs: the section of ``theory.txt`` under its name."""
        text = Path(__file__).with_name("theory.txt").read_text("utf-8")
        return text.partition(f"# {self.name}\n")[2].partition("\n# ")[0].strip()

    def examine(self, subject: Subject, settled: Settled, kernel: Kernel | None = None, on_method: OnMethod | None = None) -> Evidence:
        """The first answer, or ``undecided`` when every method passed.

        Of a law that may be undefined somewhere only a proof that the ``kernel`` confirms counts: it asks itself what its rule needs.
        ``on_method`` is told of each method for this kind of law before it tries, and of the steps that it may take.
        """
        subject.allow(self.steps)
        confirms: Confirms = (lambda _: False) if kernel is None else partial(kernel.confirms, self.name)
        stopped = list[str]()
        for method in self.methods:
            if not isinstance(subject, method.takes):
                continue
            if on_method is not None:
                on_method(self.name, words(method, self.name), subject.budget)
            found = None
            try:
                match method:
                    case Rules():
                        found = None if kernel is None else kernel.proof(self.name, method.steps, method.as_written)
                    case Finder():
                        found = next(filter(confirms, method.run(subject)), None)
                    case _:
                        found = method.run(subject, settled) if isinstance(method, Consequence) else method.run(subject)
                        found = found if found is not None and self._counts(found, subject, confirms) else None
            except InputError as fault:  # a number of the law is too large for double precision, at parameters that the method tries
                stopped.append(fault.what)
            if found is not None:
                break
        else:
            found = Evidence(Verdict.UNDECIDED, "none", "no rule proves it, and no counterexample was found")
        if not stopped or found.verdict in (Verdict.PROVED, Verdict.REFUTED):
            return found
        return replace(found, detail=f"{found.detail}; not all methods could try: {stopped[0]}")

    def provers_first(self) -> Claim:
        """The same claim for who needs a proof: the first refuter alone comes before what finds one, for it sees what is plainly false.

        Normal forms are read once, so that steps are left for the refuters.
        """
        later = [method for method in self.methods if isinstance(method, ProofMethod) and method is not WITHOUT_K][1:]
        methods = (replace(method, as_written=True) if method is DEAR else method for method in self.methods)
        return replace(self, methods=tuple(sorted(methods, key=lambda method: method in later)))

    def _counts(self, found: Evidence, subject: Subject, confirms: Confirms) -> bool:
        if found.witness is not None:
            return subject.may_refute(self.name, found.witness.points)
        return found.verdict is not Verdict.PROVED or subject.may_prove(self.name) or confirms(found)


_ALL = (
    Claim(
        name="origin",
        statement="0 is in K(sigma_n) for every sigma_n < 0",
        methods=(
            ProofMethod(Subject, refuters.origin_out_of_range),
            CHEAP,
            WITHOUT_K,
            ProofMethod(FormulaSubject, refuters.origin_at_parameters),
            DEAR,
            ProofMethod(FormulaSubject, refuters.origin_undefined),
            OF_GRAPH,
            ProofMethod(GraphSubject, refuters.origin_of_graph),
            ProofMethod(CurveSubject, curves.origin_refuted),
        ),
    ),
    Claim(
        name="convexity",
        statement="K(sigma_n) = {g <= 0} is convex for every sigma_n < 0",
        methods=(
            CHEAP,
            WITHOUT_K,
            ProofMethod(FormulaSubject, refuters.convexity_at_clear_dents),
            Finder(FormulaSubject, evidence.convexity_by_sums),
            SPELLED_OTHERWISE,
            ProofMethod(FormulaSubject, refuters.convexity_at_deepest_dents),
            ProofMethod(FormulaSubject, refuters.convexity_at_far_points),
            ProofMethod(FormulaSubject, refuters.convexity_by_scouting),
            ProofMethod(FormulaSubject, refuters.convexity_between_exact_rays),
            ProofMethod(FormulaSubject, refuters.convexity_beside_edges),
            DEAR,
            ProofMethod(FormulaSubject, refuters.convexity_at_dents),
            ProofMethod(FormulaSubject, refuters.convexity_at_seams),
            Finder(FormulaSubject, evidence.convexity_on_boundary),
            Finder(FormulaSubject, evidence.convexity_in_a_box),
            ProofMethod(FormulaSubject, refuters.convexity_by_thorough_scouting),
            ProofMethod(FormulaSubject, refuters.convexity_by_sampling),
            OF_GRAPH,
            ProofMethod(GraphSubject, refuters.convexity_of_graph),
            Finder(GraphSubject, evidence.convexity_in_a_box),
            ProofMethod(GraphSubject, refuters.convexity_of_graph_left_open),
            ProofMethod(CurveSubject, curves.convexity_refuted),
        ),
    ),
    Claim(
        name="smoothness",
        statement="the boundary of K(sigma_n), sigma_n < 0, is C^1 in the forces: the outward unit normal is continuous along g = 0",
        methods=(
            CHEAP,
            WITHOUT_K,
            Finder(FormulaSubject, evidence.smoothness_by_sums),
            Finder(FormulaSubject, evidence.smoothness_of_an_interval),
            SPELLED_OTHERWISE,
            ProofMethod(FormulaSubject, refuters.smoothness_at_sharp_points),
            ProofMethod(FormulaSubject, refuters.smoothness_at_corners),
            DEAR,
            Finder(FormulaSubject, evidence.smoothness_by_identities),
            Finder(FormulaSubject, evidence.smoothness_in_a_box),
            ProofMethod(FormulaSubject, refuters.smoothness_at_switches),
            OF_GRAPH,
            ProofMethod(GraphSubject, refuters.smoothness_at_corners),
            Finder(GraphSubject, evidence.smoothness_in_a_box),
        ),
    ),
    Claim(
        name="normality",
        statement="the flow direction lies in the normal cone of K at every boundary point",
        methods=(
            CHEAP,
            ProofMethod(RateSubject, refuters.normality_of_rates),
            Consequence(FormulaSubject, refuters.normality_at_chord),
            SPELLED_OTHERWISE,
            ProofMethod(FormulaSubject, refuters.normality_at_points),
            Finder(FormulaSubject, evidence.normality_parallel),
            ProofMethod(FormulaSubject, refuters.normality_by_sampling),
            ProofMethod(CurveSubject, curves.normality_by_deviation),
            ProofMethod(CurveSubject, curves.normality_refuted),
        ),
        needs=("convexity",),
    ),
    Claim(
        name="dissipation",
        statement="force . flow >= 0 at every boundary point",
        methods=(
            CHEAP,
            ProofMethod(RateSubject, refuters.dissipation_of_rates),
            Finder(FormulaSubject, evidence.dissipation_of_potential),
            Finder(FormulaSubject, evidence.dissipation_by_shares),
            SPELLED_OTHERWISE,
            ProofMethod(FormulaSubject, refuters.dissipation_in_states),
            ProofMethod(FormulaSubject, refuters.dissipation_at_points),
            DEAR,
            Finder(FormulaSubject, evidence.dissipation_by_identities),
            Finder(FormulaSubject, evidence.dissipation_in_a_box),
            ProofMethod(FormulaSubject, refuters.dissipation_by_sampling),
            ProofMethod(CurveSubject, curves.dissipation_refuted),
        ),
        needs=("origin", "normality"),
    ),
    Claim(
        name="duality",
        statement="the dissipation potential in closed form is the support function of K",
        methods=(WITHOUT_K, ProofMethod(FormulaSubject, evidence.duality), ProofMethod(CurveSubject, curves.duality), _NO_DUAL),
    ),
    Claim(
        name="state_laws",
        statement="sigma = dpsi/du = -dpsi/du_in, psi convex in (u, u_in) and concave in the temperature",
        methods=(
            CHEAP,
            ProofMethod(FormulaSubject, evidence.state_laws_not_stated),
            ProofMethod(FormulaSubject, refuters.energy_of_two_forces),
            ProofMethod(FormulaSubject, refuters.energy_at_bends),
            ProofMethod(FormulaSubject, refuters.energy_in_temperature),
            Finder(FormulaSubject, evidence.convexity_by_sums),
            DEAR,
        ),
    ),
    Claim(
        name="thermal",
        statement="D_th >= 0: heat flows from the warmer to the colder, for all temperatures > 0",
        methods=(CHEAP, ProofMethod(Subject, evidence.without_heat), ProofMethod(FormulaSubject, refuters.heat_uphill), DEAR),
    ),
)
_TOGETHER = (
    Claim(
        name="homogeneity",
        statement="K(sigma_n) = |sigma_n| K(-1) for every sigma_n < 0",
        methods=(CHEAP, SPELLED_OTHERWISE, WITHOUT_K, ProofMethod(FormulaSubject, coupled.homogeneity_along_rays)),
    ),
    Claim(
        name="bipotential",
        statement="b = I(sigma in p K(-1)) + I(v_n >= 0) + p Phi_1(d) >= sigma . d - p v_n, p = |sigma_n|, and equal on the law alone",
        methods=(
            Consequence(Subject, coupled.bipotential_of_no_cone),
            Finder(Subject, coupled.bipotential),
            Consequence(Subject, coupled.bipotential_left_open),
        ),
        needs=("homogeneity", "origin", "convexity", "normality", "duality"),
    ),
)
CLAIMS: Mapping[str, Claim] = MappingProxyType({claim.name: claim for claim in _ALL})
COUPLED: Mapping[str, Claim] = MappingProxyType({claim.name: claim for claim in _TOGETHER})
EVERY: Mapping[str, Claim] = MappingProxyType({**CLAIMS, **COUPLED})


def asked_of(law: Law | None) -> tuple[str, ...]:
    """The claims decided where none is named, without a law those of every law: the thermal one is asked of a law with heat alone."""
    heated = isinstance(law, Criterion) and bool(law.heat)
    return tuple(name for name in CLAIMS if heated or name != "thermal")
