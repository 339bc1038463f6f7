"""What is asked for: a law, one or several of its parameters, a claim, and over which domain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import sympy as sp

from duhem.errors import InputError, meant
from duhem.law.catalogue import load_formula
from duhem.law.curve_law import Law
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain, simple_points
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE
from duhem.proof.recheck import document_of
from duhem.proof.statement import state
from duhem.regions.asked import MOST_STEPS, constraints_on
from duhem.regions.paving import Paving, deciding_parameters
from duhem.regions.places import Place, tree_of
from duhem.regions.result import FoundRegion, ParameterRegion, PavedRegion
from duhem.regions.search import Asked, cells_of
from duhem.show.place import AnyPath

__all__ = ["region", "shape_parameters", "told"]

_STEPS_OF_A_SENTENCE = 4_000_000
_MOST_UNNAMED = 3
_ASKED = ("origin", "convexity", "smoothness", "normality", "dissipation")
Range = str | Domain | tuple[Any, Any]


def region(
    law: str | Law,
    parameters: str | Iterable[str] | None = None,
    claim: str = "convexity",
    over: Mapping[str, Range] | None = None,
    *,
    steps: int = MOST_STEPS,
    resume: AnyPath | Mapping[str, Any] | None = None,
) -> FoundRegion:
    """For which values of one or several parameters a claim holds of a law, exactly where all of its cells are decided.

    ``parameters`` names them; they may be left out where at most three are free and no mere scales, or where convexity is asked of a g with
    a quadratic form, itself or under its only root, the signs of whose minors depend on at most three.  ``over`` maps parameters
    to ranges that take the place of those of the law: ``"0:1"``, ``(0, 1)`` with None for no end, or a Domain, which may leave out 0.
    An end at which the law has no value is left out.  The other parameters are all that they may be: the claim holds if it holds for all
    of them.  ``steps`` bounds the work; what is left then is open, as it is where a region of several parameters is interrupted.  From the
    certificate of such a region to ``resume`` it goes on, and its steps count.  Raises InputError for an unknown law, parameter, claim or
    range, and for a certificate that is about something else or is not confirmed.
    """
    asked = _over(load_formula(law), over or {})
    if claim not in _ASKED:
        raise InputError(f"regions are not known of the claim {claim!r}", where="claim", remedy=meant(str(claim), _ASKED))
    names = _named(asked, parameters, over or {}, claim)
    if len(names) == 1 and resume is not None:
        raise InputError("a region of one parameter is not resumed", where="resume", remedy="leave it out")
    found = _found(asked, names, claim, steps, resume)
    if parameters is None and len(names) == 1 and not found.stretches("proved") and (scales := _absorbed(asked, names[0])):
        scaled = replace(_found(asked.fix(dict.fromkeys(scales, 1)), names, claim, steps), scales=scales)
        found = scaled if scaled.stretches("proved") or not found.exact else found
    return found


def _found(
    law: Criterion, names: tuple[str, ...], claim: str, steps: int, resume: AnyPath | Mapping[str, Any] | None = None
) -> FoundRegion:
    check_domain(law)
    if len(names) == 1:
        question: Any = Asked(law, claim, names, steps)
        cells = cells_of(question)
        found: FoundRegion = ParameterRegion(law, claim, names, cells, question.whole, tree_of(names[0], cells), steps=question.steps)
    else:
        question = Paving(law, claim, names, steps) if resume is None else Paving.resumed(law, claim, names, steps, document_of(resume)[1])
        question.grow()
        whole, tree = Place((), question.whole), question.known["tree"]
        found = PavedRegion(law, claim, names, question.places(), whole, tree, question.stopped, steps=question.steps)
    _, joined = constraints_on(law, names)
    seen = not joined or all(question.admitted(question.over(cell)) for cell, leaf in found.known if leaf["verdict"] == "proved")
    return found if seen else replace(found, joined=joined)


def _named(law: Criterion, parameters: str | Iterable[str] | None, over: Mapping[str, Range], claim: str) -> tuple[str, ...]:
    free = shape_parameters(law, claim) if parameters is None else ()
    names = (parameters,) if isinstance(parameters, str) else tuple(parameters) if parameters is not None else tuple(over) or free
    known = f"its parameters are: {', '.join(law.parameters) or 'none'}"
    for name in names:
        if name not in law.parameters:
            raise InputError(f"unknown parameter {name!r}", where=law.name, remedy=known)
        if name in law.variables:
            raise InputError(f"{name} is a variable of the state", where=law.name, remedy="name a parameter")
        if (value := law.parameters[name].value) is not None:
            raise InputError(f"{name} is fixed at {value}", where=law.name, remedy=f"give its range: --over {name}=LOW:HIGH")
    if not names or len(set(names)) < len(names) or (parameters is None and len(names) > _MOST_UNNAMED):
        what = "several parameters are free" if names else "no parameter is free"
        what = "a parameter is named twice" if len(set(names)) < len(names) else f"{what}{': ' if names else ''}{', '.join(names)}"
        raise InputError(what, where=law.name, remedy=f"name those to ask for, and fix others with --set; {known}")
    return names


def shape_parameters(law: Criterion, claim: str = "convexity") -> tuple[str, ...]:
    """The free parameters that no change of units absorbs (Buckingham's pi theorem); of a law of scales alone, all that are free.

    Where these are several, and convexity is asked of a g that is quadratic or has a quadratic form under its only root: those on which
    the signs of its minors depend, if they are few.
    """
    free = tuple(name for name, own in law.parameters.items() if own.value is None and name not in law.variables)
    scales = _absorbed(law)
    shape = tuple(name for name in free if name not in scales) or free
    return (_of_minors(law) if len(shape) > 1 and claim == "convexity" else ()) or shape


def _of_minors(law: Criterion) -> tuple[str, ...]:
    """The parameters on which it depends whether the quadratic form in g is >= 0; none where they are many."""
    with suppress(*UNREADABLE):
        names = deciding_parameters(StatedLaw.read(law_as_text(law)))
        return names if len(names) <= _MOST_UNNAMED else ()
    return ()


def _absorbed(law: Criterion, but: str = "") -> tuple[str, ...]:
    """The free parameters that a change of units absorbs, which may be set to 1; without the one that is asked for."""
    free = [name for name, own in law.parameters.items() if own.value is None and name not in law.variables]
    if not free or law.forces_of_rates or law.variables:
        return ()
    absorbed = {x.name for x in state(law).dimensionless().slice}
    return tuple(name for name in free if name in absorbed and name != but)


def _over(law: Criterion, ranges: Mapping[str, Range]) -> Criterion:
    """The law over other ranges of some of its parameters, an end left out at which it has no value."""
    known = f"its parameters are: {', '.join(law.parameters) or 'none'}"
    for name, given in ranges.items():
        where = f"--over {name}={given}" if isinstance(given, str) else f"over {name}"
        if name not in law.parameters:
            raise InputError(f"unknown parameter {name!r}", where=where, remedy=known)
        domain = given if isinstance(given, Domain) else _read(given, where)
        if domain.value is not None:
            raise InputError("a range has two different ends", where=where, remedy="fix a parameter with --set")
        law = law.within({name: domain})
        for end, op in ((domain.low, ">"), (domain.high, "<")):
            if end is None or (end == 0 and domain.positive) or _has_values(law, name, end):
                continue
            if end == 0 and end == domain.low:
                law = law.within({name: Domain(high=domain.high, positive=True)})
            else:
                law = replace(law, constraints=(*law.constraints, f"{name} {op} {end}"))  # a text is read on construction
    return law


def _has_values(law: Criterion, name: str, end: sp.Rational) -> bool:
    """Whether g has a value at some plain forces where a parameter is at an end of its range, the others inside of theirs."""
    there = law.within({name: Domain.fixed(end)})
    forces = {x: sp.Rational(k + 2, 2 * k + 3) * (-1) ** k for k, x in enumerate(there.force_symbols())}
    pressure = {} if law.pressure is None else {there.symbols()[law.pressure]: sp.Integer(-1)}
    point = {**next(simple_points(there)), **there.settled(), **pressure, **forces}
    try:
        return bool(sp.N(there.g.xreplace(point)).is_finite)
    except (TypeError, ValueError, ArithmeticError):  # SymPy compares what has no value
        return False


def _read(given: Any, where: str) -> Domain:
    parts = given.split(":") if isinstance(given, str) else list(given) if isinstance(given, tuple | list) else []
    if len(parts) != 2:
        raise InputError("this is no range", where=where, remedy="write LOW:HIGH, such as 0:1, or 0: for no upper end")
    try:
        return Domain.between(*(None if isinstance(part, str) and not part.strip() else part for part in parts))
    except InputError as fault:
        raise InputError(fault.what, where=where, remedy=fault.remedy) from None


def told(law: Law, claim: str, asked: str) -> str:
    """A claim that is not proved of a law over its domain, in one sentence: for which values of its few shape parameters it holds.

    ``asked`` is the law as the command line names it, for the command that finds more.  "" for a law of which nothing is
    known, or whose parameters are mere scales: it is the same law for all their values.
    """
    try:
        if not isinstance(law, Criterion) or claim not in _ASKED or len(names := shape_parameters(law, claim)) > _MOST_UNNAMED:
            return ""
        if {*names} <= {*_absorbed(law)} or (len(names) > 2 and (claim != "convexity" or names != _of_minors(law))):
            return ""
        steps = _STEPS_OF_A_SENTENCE // min(len(names), 2) ** 2
        found = region(law, None, claim, steps=steps)
    except Exception:  # the verdicts stand, whatever goes wrong in what is said beside them
        return ""
    if found.exact and found.short not in ("true", "false"):
        return found.sentence
    more, every = "" if claim == "convexity" else f" --claim {claim}", [", ".join(names[:-1]), names[-1]][-len(names) :]
    which = f"for which {' and '.join(every)} {claim} holds"
    if not found.exact and found.open_share == 1 and len(names) == 1:
        remedy = "first find one value, or another form of the formula, for which it is decided"
        return f"{which} is open: {steps:,} steps decide no range of values; {remedy}"
    return "" if found.exact else f"{which}: duhem region {asked} {' '.join(names)}{more}"
