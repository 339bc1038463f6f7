"""Answers from the degrees of a formula in the forces: what is of degree k becomes r^k times itself at r times the forces, r > 0.

:func:`by_degree` splits a formula into its parts G_k.  The other functions answer yes or no, each for one argument below; they leave
the signs of the sums to the domain.  False, or NotWritten, means only that this argument does not apply.

What a word makes of parts of degree 0 is of degree 0, unless it chooses between them.

With G_k the part of degree k, d g(r sigma)/dr at r = 1 is the sum of k G_k (Euler), where log y is of degree 0 but adds k, the degree of
y, times what it is multiplied by.  Where g = 0 it is the sum of (k - m) G_k as well, for every m; one of these sums that is positive
everywhere shows that g rises outward on its zeros.  So does one that is >= 0, of power, where grad g tends to 0 nowhere on g = 0.  The
power of a flow that is the gradient of a potential is such a sum too, and so is its limit where gradients meet.  Where all of g is of one
degree, g keeps its sign along each ray: K is a cone, and sigma . n = 0 for every normal n at sigma, as it is where a choice of formulas
changes that each ray keeps.

A flow of the law's own whose power is a constant times g and something >= 0 has power >= 0 wherever g = 0.  Where a tip of g is 0, as at
the apex of a cone, g has a cone of normals, and the formula of a flow like the gradient of a potential no value; see
:mod:`definedness`.  The power of a mean of its limits from around is >= 0 too, g being continuous.
"""

from __future__ import annotations

from collections.abc import Collection

from duhem.proof.kernel.boundary import falls_from_zero, is_a_graph
from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import undecided_beside
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain, gap
from duhem.proof.kernel.identity import in_order, signs_as_sizes, vanishes, written_in_order
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.pieces import chooses
from duhem.proof.kernel.polynomial import Monomial, Polynomial, joined, written
from duhem.proof.kernel.regularity import tips
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, minus, number, product_of, sum_of

__all__ = ["by_degree", "flows_with_a_share_of_g", "grows_along_rays", "is_cone", "potential_flows_outward"]

_JUMPING = ("where", "atan2")
_ALIKE = ("abs", "pos", "neg", "norm", "max", "min", "eigmax")


def grows_along_rays(g: Term, domain: StatedDomain) -> bool:
    """Whether d g(r sigma)/dr > 0 at r = 1 wherever g = 0, or >= 0 and grad g != 0; of a choice that no ray changes, each value's."""
    if g.op == "where" and g.args[0].op in COMPARISONS:
        return len(by_degree(gap(g.args[0]), domain)) == 1 and all(grows_along_rays(value, domain) for value in g.args[1:])
    poly = domain.polynomial(g)
    logs = {x: _degree_of_all(x.args, domain) for m in poly for x, _ in m if x.op == "log" and not domain.constant(x)}
    more = [product_of(logs[x], written({joined(m, ((x, -1),)): c * n})) for m, c in poly.items() for x, n in m if x in logs]
    parts = by_degree(g, domain, logs)
    without = [{k: written_in_order(domain.polynomial(sum_of(k, minus(m)))) for k in parts if k != m} for m in parts]
    sums = [sum_of(*more, *(product_of(c, parts[k]) for k, c in rates.items())) for rates in without]
    signs = [domain.facts(x).sign & domain.facts(written(domain.without_quotients(domain.polynomial(x)))).sign for x in sums]
    return POSITIVE in signs or (any(not sign & NEGATIVE for sign in signs) and _is_steep(g, domain))


def _is_steep(g: Term, domain: StatedDomain) -> bool:
    """Whether no limit of grad g is 0 where g = 0: g is h + c z, z a force, or convex and somewhere < 0 (they are subgradients)."""
    law = domain.law._replace(g=g)
    return is_a_graph(law) or (over(law).facts(g).convex and falls_from_zero(law))


def is_cone(g: Term, domain: StatedDomain) -> bool:
    """Whether g keeps its sign along each ray from 0, every part of a maximum being of one degree."""
    if g.op in ("max", "min"):
        return all(is_cone(part, domain) for part in g.args)
    try:
        return len(by_degree(g, domain)) == 1
    except (NotWritten, ValueError):
        return False


def potential_flows_outward(potential: Term, g: Term, share: Term, domain: StatedDomain) -> bool:
    """Whether sigma . d >= 0 wherever g = 0, d a mean of gradients of the potential around: it is ``share`` g + something >= 0.

    What has a degree is continuous, so that the boundary of K lies on g = 0 and the sum is a limit of itself.
    """
    if not all(domain.facts(part).defined for part in (potential, g, share)) or not domain.constant(share) or not by_degree(g, domain):
        return False
    power = sum_of(*(product_of(written({m: c}), _rate(m, domain)) for m, c in domain.polynomial(potential).items()))
    rest = sum_of(power, minus(product_of(share, g)))
    return domain.nonnegative(rest) or domain.facts(normal(rest, domain)).nonnegative


def flows_with_a_share_of_g(law: StatedLaw, share: Term, rest: Term, scale: Term) -> bool:
    """Whether ``scale`` sigma . d = ``share`` g + ``rest`` with constant scale and share, scale > 0 and rest >= 0, d having a value but
    where a tip of g is 0.  Where the scale may be 0, sigma . d is >= 0 by itself.
    """
    domain = within_ranges(law)
    if law.flow is None or not (domain.constant(share) and domain.constant(scale) and domain.facts(rest).nonnegative):
        return False
    spent = (*law.flow, *([law.power] if law.power else []))
    if undecided_beside(spent, tips(law.g, domain), domain) is not None or chooses(law.g, domain):
        return False
    power = law.power or sum_of(*(product_of(Term("name", name=x), d) for x, d in zip(law.forces, law.flow, strict=True)))
    gap = sum_of(product_of(scale, power), minus(product_of(share, law.g)), minus(rest))
    same = vanishes(in_order(signs_as_sizes(gap, domain), domain), domain)
    known = domain.facts(scale)
    if not (same and known.nonnegative and all(domain.facts(part).defined for part in (law.g, share, rest, scale))):
        return False
    return known.sign == POSITIVE or _never_negative_where_zero(power, scale, law)


def _never_negative_where_zero(power: Term, scale: Term, law: StatedLaw) -> bool:
    """Whether a power is >= 0 for the parameters at which a scale >= 0 is 0."""
    try:
        left = within_ranges(law._replace(constraints=(*law.constraints, Term("<=", (scale, number(0))))))
    except NotWritten:  # the scale is never 0, or more than that is too long
        return False
    return left.never_negative(in_order(power, left))


def by_degree(term: Term, domain: StatedDomain, free: Collection[Term] = ()) -> dict[Term, Term]:
    """The parts of each degree, a constant, multiplied out; NotWritten where something in it has none, and is not ``free``: of degree 0."""
    parts: dict[Term, Polynomial] = {}
    for m, c in domain.polynomial(term).items():
        parts.setdefault(written_in_order(domain.polynomial(_rate(m, domain, free))), {})[m] = c
    return {k: written(part) for k, part in parts.items()}


def _rate(m: Monomial, domain: StatedDomain, free: Collection[Term] = ()) -> Term:
    """The degree of a product, in which powers may have any constant exponents; what is ``free`` counts as of degree 0."""
    return sum_of(*(product_of(number(n), _degree(x, domain)) for x, n in m if x not in free))


def _degree(x: Term, domain: StatedDomain) -> Term:
    if domain.constant(x):
        return number(0)
    if x.op == "name":
        return number(1)
    if x.op == "**" and domain.constant(x.args[1]):
        return product_of(x.args[1], _degree_of_all(x.args[:1], domain))
    if x.op in _ALIKE:
        return _degree_of_all(x.args, domain)
    if x.op not in _JUMPING and all(set(by_degree(a, domain)) <= {number(0)} for a in x.args):
        return number(0)
    raise NotWritten(f"{x.op} has no degree in the forces")


def _degree_of_all(terms: tuple[Term, ...], domain: StatedDomain) -> Term:
    (k,) = {k for term in terms for k in by_degree(term, domain)}  # ValueError unless there is one
    return k
