"""Forces as functions of the rates: whether force . rate is >= 0, and whether the forces are the gradient of a convex potential.

A formula is read where each rate is w, -w or 0, with a w > 0 of its own: these places cover everything, and most is known of constants.

A force of its own rate x alone does not decrease if it is C^1 with a slope >= 0; or if it is so for x > 0 and for x < 0, and >= 0, <= 0
and 0 where x is.  It then lies in the subdifferential of a convex potential (Rockafellar 1970, theorem 24.2).

Let c_i > 0 be constants and w the size of the rates, w^2 = sum_i c_i x_i^2; let f_i = c_i x_i G(w) where w > 0, and f = 0 where w = 0.
If F(w) = w G(w) is C^1 and >= 0 for w > 0, and does not decrease, then its integral from 0 on is convex in w and does not decrease.  As w
is a norm of the rates, this integral is a convex potential of theirs (Rockafellar 1970, theorem 5.1).  It is least at w = 0, so that 0 is
a subgradient there; elsewhere its gradient is F(w) dw/dx_i = F(w) c_i x_i/w = f_i.

A product of parts a_k > 0 does not decrease where sum_k a_k'/a_k >= 0, which is its slope divided by it.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from itertools import product

from duhem.proof.kernel.bounds import POSITIVE, ZERO, Bounds
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import multiplied_through, signs_as_sizes, vanishes
from duhem.proof.kernel.polynomial import Polynomial, in_powers, total, written
from duhem.proof.kernel.regularity import smooth_everywhere
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import HALF, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["forces_dissipate", "forces_increase", "never_negative_on_each_side"]

_SIZE = Term("name", name="size of the rates")  # no name of a law has blanks
_MOST = 3  # forces that are read on both sides
_ABOVE_ZERO = Bounds(Fraction(0), None, True)
_ZERO = number(0)


def forces_dissipate(law: StatedLaw) -> bool:
    """Whether the sum of force . rate is >= 0; the forces have values at all rates."""
    domain = over(law)
    return domain.never_negative(signs_as_sizes(law.g, domain)) or never_negative_on_each_side(law.g, law)


def never_negative_on_each_side(term: Term, law: StatedLaw) -> bool:
    """Whether a formula has a value for all forces, and one >= 0, where each of these is > 0, < 0 or 0."""
    sizes = {Term("name", name=x): Term("name", name=f"size of {x}") for x in law.forces if x in term.names()}
    if len(sizes) > _MOST or term.large or Reader(over(law)).undecided(term) is not None:
        return False
    domain = _with_sizes(law, (), *sizes.values())
    ways = product(*(((x, size), (x, minus(size)), (x, _ZERO)) for x, size in sizes.items()))
    return all(domain.never_negative(term.put(dict(way))) for way in ways)


def _with_sizes(law: StatedLaw, forces: tuple[str, ...], *sizes: Term) -> StatedDomain:
    """The domain of a law with such forces, and with sizes > 0 as parameters."""
    return over(law._replace(forces=forces, parameters={**law.parameters, **{x.name: _ABOVE_ZERO for x in sizes}}))


def forces_increase(law: StatedLaw) -> bool:
    """Whether each force is a function of its own rate that does not decrease, or all of them are one of the size of the rates."""
    forces = law.flow or ()
    if all(not force.names() & ({*law.forces} - {rate}) for rate, force in zip(law.forces, forces, strict=True)):
        return all(_increases(Term("name", name=rate), force, law) for rate, force in zip(law.forces, forces, strict=True))
    return _increases_with_size(law, forces)


def _increases(rate: Term, force: Term, law: StatedLaw) -> bool:
    """Whether a force of one rate does not decrease, as a whole or on either side of 0."""
    domain = over(law)
    if smooth_everywhere(force, domain) and domain.never_negative(gradient(force, (rate.name,))[0]):
        return True
    return _is_zero(force.put({rate: _ZERO}), domain) and all(
        _rises_from_zero(product_of(number(way), force.put({rate: product_of(number(way), _SIZE)})), law) for way in (1, -1)
    )


def _is_zero(force: Term, domain: StatedDomain) -> bool:
    return domain.facts(force).defined and domain.facts(force).sign == ZERO


def _increases_with_size(law: StatedLaw, forces: tuple[Term, ...]) -> bool:
    """Whether the forces are c_i x_i G(w), and w G(w) is >= 0 and does not decrease."""
    whole, domain = over(law), _with_sizes(law, law.forces, _SIZE)
    rates = [Term("name", name=x) for x in law.forces]
    weights = next(filter(None, (_weights(part, rates, whole) for force in forces for part in force.parts())), None)
    if weights is None or not all(_is_zero(force.put(dict.fromkeys(rates, _ZERO)), whole) for force in forces):
        return False
    shares = list[Term]()
    for x, weight, force in zip(rates, weights, forces, strict=True):
        powers = in_powers(domain.polynomial(_decided(_in_size(force, rates, weights, whole), domain)), x)
        if len(powers) != 2 or powers[0]:
            return False
        shares.append(product_of(written(powers[1]), Term("**", (weight, number(-1)))))
    if not all(domain.constant(g) and vanishes(sum_of(g, minus(shares[0])), domain) for g in shares):
        return False
    along = product_of(_SIZE, Term("**", (weights[0], number(Fraction(-1, 2)))))  # there the first force is c_1^(1/2) F(w)
    return _rises_from_zero(forces[0].put(dict.fromkeys(rates, _ZERO) | {rates[0]: along}), law)


def _weights(part: Term, rates: list[Term], domain: StatedDomain) -> list[Term] | None:
    """The c_i > 0 where a part is a norm, or a sum, of sum_i c_i x_i^2 and a constant; None for any other."""
    if part.op not in ("norm", "+") or (split := _squares(part, rates, domain)) is None:
        return None
    found = [written(c) for c in split[1:]]
    return found if all(domain.facts(c).defined and domain.facts(c).sign == POSITIVE for c in found) else None


def _squares(part: Term, rates: list[Term], domain: StatedDomain) -> list[Polynomial] | None:
    """Constants a and c_i where a part, or the square of a norm, is a + sum_i c_i x_i^2; None where it is none."""
    with suppress(NotWritten):
        poly = domain.polynomial(sum_of(*(product_of(a, a) for a in part.args)) if part.op == "norm" else part)
        found: list[Polynomial] = [{} for _ in range(len(rates) + 1)]
        for m, c in poly.items():
            own = [(rates.index(x), n) for x, n in m if x in rates]
            if any(not domain.constant(x) for x, _ in m if x not in rates) or (own and (len(own) > 1 or own[0][1] != 2)):
                return None
            i = own[0][0] + 1 if own else 0
            found[i] = total(found[i], {tuple((x, n) for x, n in m if x not in rates): c})
        return found
    return None


def _in_size(term: Term, rates: list[Term], weights: list[Term], domain: StatedDomain) -> Term:
    """The same with a + b w^2 for a + b sum_i c_i x_i^2, wherever that stands, and its root for a norm."""
    if domain.constant(term) or not term.args:
        return term
    split = _squares(term, rates, domain) if term.op in ("norm", "+", "*", "**") else None
    if split is not None:
        at_rest, *found = map(written, split)
        share = product_of(found[0], Term("**", (weights[0], number(-1))))
        if all(vanishes(sum_of(c, minus(product_of(share, weight))), domain) for c, weight in zip(found, weights, strict=True)):
            square = sum_of(at_rest, product_of(share, _SIZE, _SIZE))
            return Term("**", (square, HALF)) if term.op == "norm" else square
    return term._replace(args=tuple(_in_size(a, rates, weights, domain) for a in term.args))


def _decided(term: Term, domain: StatedDomain) -> Term:
    """The same with what is chosen for each choice that the signs decide, and plain words for sizes of known sign."""
    return domain.plain(term._replace(args=tuple(_decided(a, domain) for a in term.args)))


def _rises_from_zero(force: Term, law: StatedLaw) -> bool:
    """Whether a function of the size w is C^1 and >= 0 for w > 0, and does not decrease."""
    domain = _with_sizes(law, (), _SIZE)
    force = _decided(force, domain)
    moving = over(law._replace(forces=(_SIZE.name,))).where({_SIZE: True})
    settled = Reader(domain).undecided(force) is None and smooth_everywhere(force, moving)
    return settled and domain.never_negative(force) and _does_not_fall(force, domain)


def _does_not_fall(force: Term, domain: StatedDomain) -> bool:
    """Whether the slope of a function of the size is >= 0: as a whole, of each of its terms, or divided by a product of parts > 0.

    A factor that is a sum >= 0, and does not fall by itself, makes a product >= 0 fall nowhere.
    """
    if force.op == "+":
        return all(_does_not_fall(a, domain) for a in force.args)
    if force.op != "*" or not domain.never_negative(force):
        return domain.never_negative(gradient(force, (_SIZE.name,))[0])
    left = [f for f in factors(force) if not (f.op == "+" and domain.never_negative(f) and _does_not_fall(f, domain))]
    if domain.never_negative(gradient(product_of(*left), (_SIZE.name,))[0]):
        return True
    with suppress(NotWritten):
        share = written(multiplied_through(domain.polynomial(_slope_by_itself(product_of(*left), domain)), domain, signed=True))
        return domain.never_negative(share)
    return False


def _slope_by_itself(part: Term, domain: StatedDomain) -> Term:
    """The slope by the size divided by the part; NotWritten where a factor in which the size stands is not shown to be > 0."""
    if _SIZE.name not in part.names():
        return _ZERO
    if part.op == "*" and not part.large:
        return sum_of(*(_slope_by_itself(f, domain) for f in factors(part)))
    if part.large or domain.facts(part).sign != POSITIVE:
        raise NotWritten("a factor may be 0, or is too long")
    if part.op == "**" and _SIZE.name not in part.args[1].names() and domain.facts(part.args[0]).sign == POSITIVE:
        return product_of(part.args[1], _slope_by_itself(part.args[0], domain))
    return product_of(gradient(part, (_SIZE.name,))[0], Term("**", (part, number(-1))))
