"""A claim decided for all values of some parameters: a tree of comparisons, of which each leaf is proved, refuted, outside or open.

A node compares two formulas of the parameters that have a value whatever these are.  So a comparison holds or fails, and the leaves cover
the domain by construction: no geometry is checked.  A leaf is about the law with the comparisons on the way to it, or their opposites,
as further constraints; where one holds a parameter against a number it is an end of the range of that.  A leaf is proved by the rules of
:mod:`claims`, or refuted by a family of witnesses (:mod:`parameter_cells`), for all values of the parameters in it.  It is outside where no
values meet its ranges and constraints.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from typing import Any, NamedTuple

from duhem.proof.kernel.bounds import Bounds, EmptyError
from duhem.proof.kernel.certificate import check_version, law_of
from duhem.proof.kernel.constant_value import exact_value
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import AGAINST, Reader
from duhem.proof.kernel.domain import gap
from duhem.proof.kernel.obligations import constraints, numbers
from duhem.proof.kernel.parameter_cells import family_fails, proof_fails, settled
from duhem.proof.kernel.stated_law import StatedLaw, as_list, as_object, without_more
from duhem.proof.kernel.term import COMPARISONS, UNREADABLE, NotWritten, Term, in_words, number, parse

__all__ = ["SCHEMA", "TreeLeaf", "ends", "law_where", "not_outside", "opposite", "read_comparison", "recheck_tree"]

SCHEMA = "duhem region certificate 2"
_MOST_DEPTH = 200
_SAID = {
    "open": (),
    "outside": (),
    "refuted": ("rule", "evidence"),
    "proved": ("rule", "evidence", "needs"),
}  # of a leaf, beside its verdict


class TreeLeaf(NamedTuple):
    """A leaf: the comparisons that hold there, what is said of it, and ``reason`` where that is not confirmed."""

    where: tuple[str, ...]
    verdict: str
    reason: str

    @property
    def said(self) -> str:
        """The leaf in words."""
        return " and ".join(self.where) or "everywhere"


def read_comparison(text: str, names: Collection[str]) -> Term:
    """A comparison of formulas of ``names``, solved for its name where it has only one and is affine in it.

    NotWritten for anything else, and for what has not a value for all real values of these.
    """
    found = parse(text)
    if refused := numbers(text):
        raise NotWritten(refused)
    reader = Reader(over(StatedLaw(("",), None, number(0), None, dict.fromkeys(names, Bounds(None, None)), ())))
    if found.op not in COMPARISONS or not found.names() <= {*names, "pi"} or reader.undecided(found) is not None:
        raise NotWritten("a tree is divided by what is no comparison of its parameters, or has not always a value")
    found = found._replace(args=tuple(map(_in_short, found.args)))
    poly = reader.domain.polynomial(gap(found))
    slopes = [(m[0][0], c) for m, c in poly.items() if [n for _, n in m] == [1] and m[0][0].names() <= {*names}]
    if len(slopes) != 1 or len(poly) > 1 + (() in poly) or slopes[0][0].op != "name":
        return found
    ((x, c),) = slopes
    return Term((">" if c > 0 else "<") + "=" * found.op.endswith("="), (x, number(-poly.get((), Fraction(0)) / c)))


def _in_short(side: Term) -> Term:
    """A fraction as one number."""
    with suppress(NotWritten):
        return side if side.names() else number(exact_value(side))
    return side


def opposite(comparison: str) -> str:
    """What holds where a comparison does not."""
    op = parse(comparison).op
    left, right = comparison.split(op)
    return f"{left.strip()} {AGAINST[op]} {right.strip()}"


def law_where(law: StatedLaw, comparison: Term) -> StatedLaw:
    """The law where its parameters meet one more comparison, as it is read; that with a number is an end of a range."""
    (left, right), op = comparison.args, comparison.op
    if left.op != "name" or right.op != "number":
        return law._replace(constraints=(*law.constraints, comparison))
    own, sharp = law.parameters[left.name], len(op) == 1
    own = own.above(right.value, sharp) if op.startswith(">") else own.below(right.value, sharp)
    return law._replace(parameters={**law.parameters, left.name: own})


def not_outside(law: StatedLaw) -> str:
    """Why it is not shown that no parameters meet the ranges and constraints of a law; "" if it is.

    It is where these leave no range to a parameter, or where the others show the opposite of one constraint.
    """
    rest = ((c, law._replace(constraints=tuple(other for other in law.constraints if other is not c))) for c in law.constraints)
    try:
        if not (undecided := constraints(law)):
            over(law)
            undecided = "" if any(over(others).decided(c) is False for c, others in rest) else "parameters may lie there"
    except EmptyError:
        return ""
    return undecided


def ends(name: str, own: Bounds) -> Iterator[str]:
    """The range of a parameter as comparisons."""
    if own.low is not None:
        yield f"{name} {'>' if own.open else '>='} {own.low}"
    if own.high is not None:
        yield f"{name} {'<' if own.open_high else '<='} {own.high}"


def recheck_tree(document: Mapping[str, Any]) -> tuple[TreeLeaf, ...]:
    """Every leaf of a certificate, in order; NotWritten where it is none."""
    try:
        check_version(document["schema"], SCHEMA)
        without_more(document, {"schema", "law", "inhabited", "claim", "parameters", "tree", "steps", "sha256"})
        law, claim, names = law_of(document), document["claim"], as_list(document["parameters"])
        if not isinstance(law, StatedLaw) or not names or len({*names}) < len(names) or not {*names} <= {*law.parameters}:
            raise NotWritten("its parameters are none of the law")
        if {*names} & {variable for variable, _ in law.variables}:
            raise NotWritten("a parameter is a variable of the state")
        if not law.around_zero:
            raise NotWritten("zero force is outside the ranges of the forces")
        return tuple(_leaves(law, claim, names, as_object(document["tree"])))
    except UNREADABLE as fault:
        raise NotWritten(f"{'' if isinstance(fault, NotWritten) else 'it is no certificate: '}{in_words(fault)}") from None


def _leaves(
    law: StatedLaw, claim: str, names: Collection[str], node: Mapping[str, Any], way: tuple[str, ...] = (), depth: int = 0
) -> Iterator[TreeLeaf]:
    if depth > _MOST_DEPTH:
        raise NotWritten("a tree is too deep")
    if "split" in node:
        without_more(node, {"split", "holds", "fails"})
        for text, key in ((node["split"], "holds"), (opposite(node["split"]), "fails")):
            here = law_where(law, read_comparison(text, names))
            told = way if here.constraints == law.constraints else (*way, text)  # the ends of ranges are said as they are in the end
            yield from _leaves(here, claim, names, as_object(node[key]), told, depth + 1)
        return
    if node["verdict"] not in _SAID or set(node) != {"verdict", *_SAID[node["verdict"]]}:
        raise NotWritten("a leaf does not say what holds on it")
    reason = ""
    if node["verdict"] == "proved":
        reason = proof_fails(claim, settled(law, names), node)
    elif node["verdict"] == "refuted":
        reason = family_fails(claim, node["rule"], law, names, as_object(node["evidence"]))
    elif node["verdict"] == "outside":
        reason = not_outside(law)
    yield TreeLeaf((*(end for name in names for end in ends(name, law.parameters[name])), *way), node["verdict"], reason)
