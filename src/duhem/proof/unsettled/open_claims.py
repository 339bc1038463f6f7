"""What is said of a claim that stays open: the inequality, the part of the formula that no rule reads, the closest place, and what helps.

A suggestion was tried on the law, and the claim was then proved, or refuted as it says.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import chain, islice
from typing import Any, NamedTuple

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import law_as_text
from duhem.proof.claims import EVERY
from duhem.proof.decide import Budget
from duhem.proof.facts.formula_subject import FormulaSubject, RateSubject
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.facts.subject import Subject
from duhem.proof.kernel.curvature import within_ranges
from duhem.proof.kernel.state import epigraph
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import UNREADABLE, Term, parse
from duhem.proof.search.boundary_points import scouts
from duhem.proof.search.margins import least_margin
from duhem.proof.unsettled.blocked import Blocked, blocked, required
from duhem.proof.unsettled.forms import equal_forms, other_forms
from duhem.proof.unsettled.limits import holds_a_place, keeps_k, named_around, same_points, with_values, with_values_at_rest
from duhem.proof.unsettled.ranges import Ranges, around_the_boundary, away_from_zero
from duhem.proof.unsettled.term_text import Names, in_text, names_of
from duhem.proof.unsettled.trials import Attempts, Rewriting, that_help
from duhem.proof.verdict import Evidence, Unsettled, Verdict

__all__ = ["STATEMENT", "THEORY", "OpenClaims"]

_OPEN = (Verdict.TESTED, Verdict.UNDECIDED)
_INEQUALITIES = {
    "origin": "g <= 0 at zero force",
    "convexity": "v . Hess g v >= 0 for all v with v . grad g = 0, wherever g = 0",
    "smoothness": "grad g != 0 and continuous wherever g = 0",
    "normality": "flow . (tau - sigma) <= 0 for all tau in K, wherever g = 0",
    "dissipation": "force . flow >= 0 wherever g = 0",
    "state_laws": "v . Hess psi v >= 0 for all v, in every state",
    "homogeneity": "g(r sigma, r sigma_n) <= 0 for all r > 0 wherever g(sigma, sigma_n) <= 0",
}
_OF_A_CURVE = {
    "origin": "T winds around 0",
    "convexity": "T' x T'' > 0 at every angle, and the tangent turns once",
    "smoothness": "T' != 0 at every angle, and T does not cross itself",
    "normality": "d . T' = 0 and d x T' > 0 at every angle",
    "dissipation": "T . d >= 0 at every angle",
}
_OF_RATES = {
    "normality": "(force - other force) . (rate - other rate) >= 0 for any two rates, and the forces have a potential",
    "dissipation": "force . rate >= 0 at all rates",
}
_OF_A_POTENTIAL = {
    "origin": "Phi* = 0 at zero force, and Phi* >= 0 at all forces",
    "convexity": "v . Hess Phi* v >= 0 for all v, at all forces",
    "smoothness": "Phi* is C^1 at all forces",
    "normality": "Phi*(tau) - Phi*(sigma) >= grad Phi*(sigma) . (tau - sigma) for all tau and sigma",
    "dissipation": "force . grad Phi* >= 0 at all forces",
}
_WHOLE = "is the whole formula: the rules do not show the claim, and no smaller part of it is known to keep them from that"
_OF_G = ("origin", "convexity", "smoothness", "duality")  # claims about g alone
_OF_ANY_K = ("origin", "state_laws", "thermal")  # of an empty K they are not proved, or they are about something else
_STEPS = 3_000_000
DecideLaw = Callable[[Criterion, str, Budget], Verdict]  # the verdict on a claim of a law
_CHOICES, _MOST_FORMS = 6, 12  # of parameters; looked at of one law
_LONGEST = 240  # letters of a part that is told
_DIGITS = 6
_NOISE = 1e-4  # of margins in floats, where slopes may be steep
STATEMENT = "what duhem verify says of a claim that it neither proved nor refuted, and what you can do"
THEORY = """\
A claim is open if its verdict is tested or undecided: no rule proved it, and no counterexample was found.  It may hold or not.  duhem
verify then says four things of it.

Open: the inequality that would have to be shown, in forces and parameters.

No rule reads: the smallest part of the formula that keeps the rules from a proof, and what is lacking.

Closest: the point of the boundary, and values of the parameters, at which a search in floating-point numbers found the least margin.
Near 0 the law is at the limit there; below 0 it may violate the claim: fix the parameters with --set at this place, and verify again.

Try: what helps.  duhem changed the law (a constraint, a range of a force, another form of g with the same K, a value for a part that has
none, a narrower parameter, fixed parameters) and asked again.  It suggests a change only if the claim was settled then: proved, of a K
that is not empty, or refuted.  A claim that is refuted with fixed parameters is false for the law."""


class _OpenClaim(NamedTuple):
    """An open claim, with what was found of the others, and the law as the kernel reads it."""

    claim: str
    law: Law
    text: Mapping[str, Any]
    subject: Subject
    settled: Mapping[str, Evidence]


class OpenClaims:
    """What is said of the claims of one law that stay open; what was tried for one of them is known for the next.

    ``decide`` gives the verdict on a changed law.
    """

    def __init__(self, law: Law, decide: DecideLaw | None = None) -> None:
        self._law, self._decide, self._tried = law, decide, Attempts()
        self._forms: dict[Subject, list[Rewriting]] = {}

    def unsettled(self, claim: str, subject: Subject, settled: Mapping[str, Evidence]) -> Unsettled | None:
        """Say what is open of a claim that is neither proved nor refuted; None for any other claim."""
        evidence, law = settled[claim], self._law
        if evidence.verdict not in _OPEN:
            return None
        inequality = _inequality(claim, law)
        if isinstance(subject, GraphSubject):  # its detail names what is open
            return Unsettled(inequality)
        try:
            return self._explained(inequality, _OpenClaim(claim, law, law_as_text(law), subject, settled))
        except Exception:  # the verdicts stand, whatever goes wrong in what is said beside them
            return Unsettled(inequality)

    def _explained(self, inequality: str, asked: _OpenClaim) -> Unsettled:
        claim, law, subject, settled = asked.claim, asked.law, asked.subject, asked.settled
        subject.allow(_STEPS)
        place, measure, margin = _closest(asked)
        bad = {x: place[x] for x in _free(law) if x in place} if margin is not None and margin < 0 else {}
        names, found = names_of(law), None
        with suppress(*UNREADABLE, TooDearError), within(_STEPS):
            if claim == "duality" and isinstance(subject, FormulaSubject) and subject.support is not None:
                found = required([parse(formula(x)) for x in subject.support.requires], StatedLaw.read(asked.text))
            elif claim in _INEQUALITIES and "boundary" not in asked.text:
                read = StatedLaw.read(asked.text)
                found = None if read.of_rates else Blocked(read.g, _WHOLE)
                found = blocked(claim, read) or found
        actions, own = list[str](), _everything(asked, self._decide)
        proved = frozenset(name for name, evidence in settled.items() if evidence.verdict is Verdict.PROVED and name != claim)
        with suppress(*UNREADABLE):
            first = [{name: Fraction(value) for name, value in bad.items()}] if bad and own else []
            choices, forms = partial(_with_k, asked), partial(self._same, asked, names)
            actions = that_help(claim, asked.text, proved, found, choices, forms, own, first, self._tried, partial(_ranges, asked))
        part, why = (None, None) if found is None else _quoted(found, asked, names)
        return Unsettled(inequality, part, why, place, measure, margin, tuple(actions))

    def _same(self, asked: _OpenClaim, names: Names) -> list[Rewriting]:
        """Forms of g with which K seems to be as it was, each made once."""
        if asked.subject not in self._forms:
            same, values = [*_same_k(asked, names)], [] if asked.claim == "duality" else _with_values(asked, names)
            self._forms[asked.subject] = [*_equal_forms(asked, names), *same[:1], *values, *same[1:]]
        return [form for form in self._forms[asked.subject] if (form.of == "energy") == (asked.claim == "state_laws")]


def _inequality(claim: str, law: Law) -> str:
    """What would have to be shown."""
    if not isinstance(law, Criterion):
        return _OF_A_CURVE.get(claim, EVERY[claim].statement)
    own = _OF_RATES if law.forces_of_rates else _OF_A_POTENTIAL if law.viscous else {}
    return {**_INEQUALITIES, **own}.get(claim, EVERY[claim].statement)


def _quoted(found: Blocked, asked: _OpenClaim, names: Names) -> tuple[str, str]:
    """The part that no rule reads as the law has it, with the word for a tensor that has it in its formula, and what is lacking."""
    text = in_text(found.part, names)
    if len(text) > _LONGEST:
        text = f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 2 :]}"
    told, own = asked.text, [names[x] for x in found.part.parts() if x in names]
    formulas = [told.get("g"), told.get("energy"), *(surface["g"] for surface in told.get("surfaces", ()))]
    with suppress(*UNREADABLE):
        around = [x for formula in map(parse, filter(None, formulas)) for x in _around(formula, found.part, names)]
        words = any("(" in str(name) for name in own)  # a word for a tensor may be what another, or a definition, is made of
        text += "".join(f" in {in_text(x, names)}" for x in around[:1] if words or "(" in in_text(x, names))
    return text, found.why


def _around(formula: Term, part: Term, names: Names) -> list[Term]:
    """The parts with a name that hold a part, the smallest first, after a softplus of which it is the exponential."""
    softplus = (x for x in formula.parts() if x.op == "log" and part.op == "exp" and part in x.args[0].args)
    return [*softplus, *named_around(formula, part, names)]


def _with_values(asked: _OpenClaim, names: Names) -> Iterator[Rewriting]:
    """Forms of g in which parts that have no value at a tip have one, and with which K seems to be as it was."""
    with suppress(*UNREADABLE, TooDearError), within(_STEPS):
        subject, read = asked.subject, None if "boundary" in asked.text else StatedLaw.read(asked.text)
        if read is not None and read.of_rates:
            at_rest = with_values_at_rest(read, names)
            yield from [Rewriting(*at_rest, at_tip=True, of="forces_of_rates")] if at_rest else []
        elif read is not None and "g" in asked.text and isinstance(subject, FormulaSubject):
            height = f" - {subject.law.forces[-1]}" if read.viscous else ""  # K is {Phi* <= z} then
            forms = ((told, in_text(form, {})) for told, form in with_values(read, names))
            yield from (Rewriting(told, g, at_tip=True) for told, g in forms if keeps_k(subject, f"{g}{height}"))


def _equal_forms(asked: _OpenClaim, names: Names) -> Iterator[Rewriting]:
    """Forms of the energy, of g and of a potential of rates that have the value that these have."""
    with suppress(*UNREADABLE, TooDearError), within(_STEPS):
        if "boundary" not in asked.text and isinstance(read := StatedLaw.read(asked.text), StatedLaw):
            stored = epigraph(read)
            for of, term, law in (("energy", read.energy, stored), ("g", read.g, read)):
                if term is None or law is None or law.of_rates:
                    continue
                for part, new in islice(equal_forms(term, within_ranges(law)), _MOST_FORMS):
                    where = " in psi" if of == "energy" else ""
                    told = f"write {in_text(new, names)} for {in_text(part, names)}{where}, which is the same"
                    yield Rewriting(told, in_text(term.put({part: new}), {}), of=of)


def _same_k(asked: _OpenClaim, names: Names) -> Iterator[Rewriting]:
    """Forms of g with another formula for one part, and with which K seems to be as it was."""
    subject, law = asked.subject, asked.law
    associated = (
        isinstance(law, Criterion) and not (law.viscous or law.forces_of_rates) and all(surface.flow is None for surface in law.surfaces)
    )
    # what is false of K is not true of the same K, and other forms would be said to prove it
    false_of_k = any(asked.settled[name].verdict is Verdict.REFUTED for name in ("origin", "convexity") if name in asked.settled)
    with suppress(*UNREADABLE, TooDearError), within(_STEPS):
        if associated and isinstance(subject, FormulaSubject) and isinstance(read := StatedLaw.read(asked.text), StatedLaw):
            for part, new, known in islice(other_forms(read), _MOST_FORMS):
                g = in_text(read.g.put({part: new}), {})
                told = f"write {in_text(new, names)} for {in_text(part, names)}"
                if known:
                    yield Rewriting(f"{told}: K stays the same", g)
                elif not false_of_k and (compared := same_points(subject, g)):
                    yield Rewriting(f"{told}: K is the same at {compared} points that were compared", g)


def _choices(asked: _OpenClaim) -> Iterator[dict[str, Fraction]]:
    """Values of the law's free parameters, as its subject chooses them."""
    subject, free = asked.subject, _free(asked.law)
    for values in subject.choices(_CHOICES):
        at = subject.values_at(values, subject.nowhere) if isinstance(subject, FormulaSubject) else values
        named = {str(x): value for x, value in at.items()}
        if all(name in named for name in free):
            yield {name: named[name] for name in free}


def _with_k(asked: _OpenClaim, plain: Iterable[Mapping[str, Any]]) -> Iterator[Mapping[str, Any]]:
    """Of plain values, and then of the subject's, those with which K is not empty."""
    return (values for values in chain(plain, _choices(asked)) if _has_k(asked, values))


def _has_k(asked: _OpenClaim, values: Mapping[str, Any]) -> bool:
    """Whether K has a boundary or a place inside in floats with these values, or zero force is shown to lie in it, and none of them is 0.

    Of an empty K much is proved, and with a value 0 K may be zero force alone.
    """
    law, origin = asked.law, asked.settled.get("origin")
    known = asked.claim in _OF_ANY_K or (origin is not None and origin.verdict is Verdict.PROVED and all(values.values()))
    if known or not isinstance(law, Criterion) or law.forces_of_rates or law.viscous:
        return True
    with suppress(InputError):
        there = FormulaSubject(law.fix(values))
        return holds_a_place(there) or any(len(found.boundary) for found in scouts(there, 1))
    return False


def _ranges(asked: _OpenClaim, values: Mapping[str, Any]) -> Iterator[Ranges]:
    """Ranges of the forces around the boundary at some values of the parameters; of a potential of rates such as are plain."""
    if isinstance(asked.law, Criterion) and asked.law.viscous:
        yield from away_from_zero(asked.law)
    elif isinstance(asked.law, Criterion) and "g" in asked.text and not asked.law.forces_of_rates:
        with suppress(InputError):
            yield from around_the_boundary(FormulaSubject(asked.law.fix(values)))


def _everything(asked: _OpenClaim, decide: DecideLaw | None) -> Callable[[str, Mapping[str, Any], Budget], Verdict | None] | None:
    """What decides a claim of the law with changes; None of forces of rates, and of normality to a flow of the law's own."""
    law, own = asked.law, asked.claim
    if decide is None or not isinstance(law, Criterion) or law.forces_of_rates:
        return None
    associated = isinstance(asked.subject, FormulaSubject) and asked.subject.problem.associated

    def verdict(claim: str, text: Mapping[str, Any], budget: Budget) -> Verdict | None:
        with suppress(InputError):  # a variable of the state may not be 0
            return found if (found := decide(_read(law, text), claim, budget)) in (Verdict.PROVED, Verdict.REFUTED) else None
        return None

    return verdict if own in _OF_G or own == "dissipation" or (own == "normality" and associated) else None


def _read(law: Criterion, text: Mapping[str, Any]) -> Criterion:
    """The law with the changes that its text has."""
    own, more = law_as_text(law), dict[str, Any]()
    if text.get("g") != own.get("g"):
        more = {"g": text["g"], "written": "", "surfaces": ()}
    if text["constraints"] != own["constraints"]:
        more |= {"constraints": tuple(text["constraints"]), "written_constraints": ()}
    if (ranges := text.get("domain", {})) != own.get("domain", {}):
        more["domain"] = {name: _domain(entry) for name, entry in ranges.items()}
    narrower = {name: _domain(entry) for name, entry in text["parameters"].items() if entry != own["parameters"][name]}
    return replace(law, **more).within(narrower)


def _domain(entry: Mapping[str, Any]) -> Domain:
    if "value" in entry:
        return Domain.fixed(entry["value"])
    return replace(Domain.between(entry.get("min"), entry.get("max")), positive=entry.get("positive", False))


def _free(law: Law) -> list[str]:
    return [name for name, domain in law.parameters.items() if domain.value is None]


def _closest(asked: _OpenClaim) -> tuple[Mapping[str, str], str | None, float | None]:
    """Parameters, forces and pressure of the least margin, what is measured, and the margin."""
    subject = asked.subject
    if not isinstance(subject, FormulaSubject) or isinstance(subject, RateSubject) or subject.of.viscous:
        return {}, None, None  # there is no K
    found = None
    with suppress(InputError):  # a number in the law is beyond those of floats
        found = least_margin(asked.claim, subject)
    if found is None:
        return {}, None, None
    place = subject.named(subject.values_at(found.scout.parameters, tuple(Fraction(float(x)) for x in found.scout.boundary[found.place])))
    margin = float(f"{found.value:.3g}") if abs(found.value) > _NOISE else 0.0
    return {name: f"{float(value):.{_DIGITS}g}" for name, value in place.items()}, found.measure, margin
