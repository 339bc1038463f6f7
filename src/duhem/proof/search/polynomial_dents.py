"""Where the boundary of a polynomial law bends outward most, and chords of K across it, in any number of forces.

Along each ray the boundary is a root of a polynomial in the distance.  There the least second derivative along a tangent,
lambda = min v . Hess g v over v . grad g = 0, is minimised over the directions of the sphere: many starts in floats, then
Newton's method on a quadratic through nearby values; where K is long, in coordinates in which it is round.  Chords are built
in fractions: dents far below double precision show.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from typing import Any

import sympy as sp

from duhem.expression.number import fraction
from duhem.proof.facts.formula_subject import FormulaSubject
from duhem.proof.facts.parameter_choices import Values
from duhem.proof.facts.subject import fact
from duhem.proof.search.round_coordinates import in_coordinates, round_coordinates
from duhem.proof.search.suggestion import Chord, Point

__all__ = ["chords_across_dents"]

_STARTS, _FOLLOWED, _STEPS = 240, 6, 40  # directions a force, how many of them are followed, and for how long
_NOISE = 1e-12  # a bend above this is taken for one inward
_BESIDE = 3  # of so many others a force is it the lowest
_CLEAR = -1e-4  # a dent that deep needs no more search
_ALL_BUT_FLAT = 0.03  # the least bend of a start beside a minimum that may be a dent; that of a sphere is 1
_CLOSEST = 1e-5  # no quadratic is laid through closer values
_LONG = 15  # times the shortest ray, over the number of forces, is a longest of a long K: of many rays in many forces few come near it
_PRICE = 2  # steps of a direction and a term, twice where K is long
_SHORTEST = 70  # half the length of a chord is that of the ray times a power of 1/2 below this
_FINE = 2**60  # directions are rounded to such fractions


@dataclass(frozen=True)
class _Form:
    """A polynomial with the exponents ``powers`` and the numbers ``factors``; g < 0 at 0."""

    powers: tuple[tuple[int, ...], ...]
    factors: tuple[Fraction, ...]

    @cached_property
    def degrees(self) -> tuple[int, ...]:
        """Of its terms in all variables."""
        return tuple(map(sum, self.powers))

    def at(self, x: Sequence[Fraction]) -> Fraction:
        """Its exact value."""
        return sum((c * _product(x, m) for m, c in zip(self.powers, self.factors, strict=True)), Fraction(0))

    @property
    def terms(self) -> dict[tuple[int, ...], Fraction]:
        """The numbers by exponents."""
        return dict(zip(self.powers, self.factors, strict=True))

    def slope(self, i: int) -> _Form:
        """The derivative by one variable."""
        terms = [(m, c) for m, c in zip(self.powers, self.factors, strict=True) if m[i]]
        return _Form(tuple((*m[:i], m[i] - 1, *m[i + 1 :]) for m, _ in terms), tuple(c * m[i] for m, c in terms))


def _product(x: Sequence[Fraction], m: Sequence[int]) -> Fraction:
    value = Fraction(1)
    for a, k in zip(x, m, strict=True):
        value *= Fraction(a**k)
    return value


def _core(g: sp.Expr) -> sp.Expr:
    """P - c**(1/p) for g = P**p - c, c > 0, p > 0; else g.  For a search: where P is negative g may be undefined."""
    constant, rest = g.as_independent(*(g.atoms(sp.Pow) or {g}), as_Add=True) if g.is_Add else (sp.S.Zero, g)
    if rest.is_Pow and rest.exp.is_Rational and 0 < rest.exp < 1 and constant.is_negative:
        return rest.base - (-constant) ** (1 / rest.exp)
    return g


def _form(subject: FormulaSubject, parameters: Values) -> _Form | None:
    g, forces = _core(subject.formula_at(parameters)), subject.simple.forces
    if not g.is_polynomial(*forces):
        return None
    poly = sp.Poly(g, *forces)
    if poly.get_domain() not in (sp.ZZ, sp.QQ) or poly.total_degree() < 3:
        return None
    terms = [(tuple(map(int, m)), fraction(c)) for m, c in poly.terms()]
    form = _Form(tuple(m for m, _ in terms), tuple(c for _, c in terms))
    return form if dict(terms).get((0,) * len(forces), Fraction(0)) < 0 else None


def chords_across_dents(subject: FormulaSubject, most: int, thorough: bool) -> Iterator[Chord]:
    """Chords at the lowest bends, at so many choices of the parameters; none where g is no polynomial in the forces with g(0) < 0.

    Only ``thorough`` are minima sought wherever they may be; without it the starts alone are looked at, for a dent that is clear,
    and minima where one of them is all but flat: then a dent is found sooner than a proof is given up.
    """
    n, seen, known = len(subject.simple.forces), set[_Form](), _looked_at(subject)
    for parameters in subject.choices(most) if n > 1 else ():
        form = _form(subject, parameters)
        if form in seen:
            continue  # the choices differ in what g does not depend on
        price = _PRICE * _STARTS * n * len(form.powers) * (6 if thorough else 1) if form else 0
        if form is None or not subject.budget.pays(price):
            return
        seen.add(form)
        floats = known.setdefault(form, _Floats(form, n))
        searched = [floats]
        if floats.doubtful(thorough) and floats.long and subject.budget.pays(price):
            searched = [floats.rounder, *searched[:thorough]]
        for direction, along in (found for each in searched for found in each.lowest(thorough)):
            for p, q in _across(form, direction, along):
                yield Chord(parameters, p, q)


@fact
def _looked_at(subject: FormulaSubject) -> dict[_Form, _Floats]:
    """What was found, for whoever looks again."""
    return {}


def _followed(floats: _Floats, starts: Any) -> Any:
    """Each to a minimum near by: the minimum of a quadratic through the values around, as long as that is lower, ever closer."""
    import numpy as np

    found, widths, m = starts.copy(), np.full(len(starts), 0.05), floats.n - 1
    pairs = list(combinations(range(m), 2))
    steps = np.vstack([np.zeros(m), np.eye(m), -np.eye(m), *([np.eye(m)[i] + np.eye(m)[j]] for i, j in pairs)])
    for _ in range(_STEPS):
        going = np.flatnonzero(widths >= _CLOSEST)
        if not len(going):
            break
        here, width = found[going], widths[going]
        frames = width[:, None, None] * np.linalg.svd(here[:, None, :])[2][:, 1:]
        around, values = floats.beside(here, steps @ frames)
        inside = np.isfinite(values).all(axis=1)
        values = np.where(inside[:, None], values, 0.0)
        one, other = values[:, 1 : m + 1], values[:, m + 1 : 2 * m + 1]
        slope, curve = (one - other) / 2, np.zeros((len(going), m, m))
        curve[:, range(m), range(m)] = one + other - 2 * values[:, :1]
        for k, (i, j) in enumerate(pairs):
            curve[:, i, j] = curve[:, j, i] = values[:, 2 * m + 1 + k] - one[:, i] - one[:, j] + values[:, 0]
        sizes, axes = np.linalg.eigh(curve)
        least = 1e-3 * np.maximum(1e-12, np.abs(sizes).max(axis=1))
        step = -np.einsum("pij,pj->pi", axes, np.einsum("pji,pj->pi", axes, slope) / np.maximum(np.abs(sizes), least[:, None]))
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1.0, 3 / np.maximum(length, 1e-300))[:, None]
        tried, lower = floats.beside(here, np.array([1.0, 0.5, 0.2])[:, None] * np.einsum("pi,pin->pn", step, frames)[:, None])
        low, row = values.argmin(axis=1), np.arange(len(going))
        tried, lower = np.concatenate([tried, around[row, low, None]], axis=1), np.column_stack([lower, values[row, low]])
        best = lower.argmin(axis=1)
        better = inside & (lower[row, best] < values[:, 0])
        found[going] = np.where(better[:, None], tried[row, best], here)
        widths[going] = np.where(inside, np.where((length < 1) | ~better, width / 3, width), width / 4)
    return found


class _Floats:
    """The polynomial in floats at many points at once."""

    def __init__(self, form: _Form, n: int, axes: Any = None) -> None:
        import numpy as np

        self.n, self.form, self._axes = n, form, np.eye(n) if axes is None else axes  # L of the forces x = L w
        self._longest = _LONG / n
        self.degrees = np.array(form.degrees)
        self._own = _Terms.of([form.terms])
        slopes = [form.slope(i) for i in range(n)]
        self._slopes = _Terms.of([f.terms for f in slopes])
        self._entries = [(i, j) for i in range(n) for j in range(i + 1)]
        self._bends = _Terms.of([slopes[i].slope(j).terms for i, j in self._entries])

    def doubtful(self, thorough: bool) -> bool:
        """Whether more is worth a look than the starts."""
        lowest = self._starts[1][0]
        return bool(_CLEAR <= lowest < (float("inf") if thorough else _ALL_BUT_FLAT))

    @property
    def long(self) -> bool:
        """Whether K is much longer in one direction than in another."""
        import numpy as np

        distance = self._starts[3]
        met = distance[np.isfinite(distance)]
        return bool(len(met) and met.max() > self._longest * met.min())

    @cached_property
    def rounder(self) -> _Floats:
        """The same in coordinates in which K is round."""
        import numpy as np

        axes = round_coordinates(self.reach, self._starts[0][::3], self._longest)
        if axes is None:
            return self
        terms = in_coordinates(self.form.terms, axes)
        return _Floats(_Form(tuple(terms), tuple(terms.values())), self.n, np.array(axes, dtype=float))

    def lowest(self, thorough: bool) -> list[tuple[Any, Any]]:
        """Directions of boundary points that seem to bend outward, and the tangents along which they do, the lowest first."""
        return [self._of_forces(x, v) for x, v in self._lowest(thorough)]

    def _of_forces(self, direction: Any, tangent: Any) -> tuple[Any, Any]:
        import numpy as np

        x, v = self._axes @ direction, self._axes @ tangent
        return x / np.linalg.norm(x), v / np.linalg.norm(x)

    def _lowest(self, thorough: bool) -> list[tuple[Any, Any]]:
        starts, bends, tangents, _ = self._starts
        if bends[0] < _CLEAR:
            return [(starts[0], tangents[0])]
        if not self.doubtful(thorough):
            return []
        return [(x, v) for x, bend, v in zip(*self._minima[:3], strict=True) if bend < (_NOISE if thorough else -_NOISE)]

    @cached_property
    def _starts(self) -> tuple[Any, Any, Any, Any]:
        """Directions, their bends, the tangents and the distances of the boundary, the lowest first."""
        import numpy as np

        n = self.n
        rng = np.random.default_rng(5)
        diagonals = [np.eye(n)[i] + s * np.eye(n)[j] for i, j in combinations(range(n), 2) for s in (1, -1)]
        starts = np.vstack([np.eye(n), -np.eye(n), diagonals, rng.standard_normal((_STARTS * n, n))])
        return self._sorted(starts / np.linalg.norm(starts, axis=1, keepdims=True))

    @cached_property
    def _minima(self) -> tuple[Any, Any, Any, Any]:
        """The same of minima that are found from the lowest of the starts that are lower than those beside them."""
        import numpy as np

        starts, bends, *_ = self._starts
        low = len(starts) // 4
        near = starts[:low] @ starts.T
        if not (self.degrees % 2).any():
            near = np.abs(near)  # so are the bends on both sides alike
        beside = np.argpartition(-near, _BESIDE * self.n, axis=1)[:, : _BESIDE * self.n + 1]
        lowest = np.flatnonzero((bends[:low, None] <= bends[beside]).all(axis=1))[:_FOLLOWED]
        return self._sorted(_followed(self, starts[lowest]))

    def _sorted(self, directions: Any) -> tuple[Any, Any, Any, Any]:
        import numpy as np

        bends, tangents, distances = self.bends(directions)
        order = np.argsort(bends, kind="stable")
        return directions[order], bends[order], tangents[order], distances[order]

    def beside(self, here: Any, steps: Any) -> tuple[Any, Any]:
        """The directions some steps away from each of several, and their bends."""
        import numpy as np

        x = here[:, None, :] + steps
        x /= np.linalg.norm(x, axis=2, keepdims=True)
        return x, self.bends(x.reshape(-1, self.n))[0].reshape(x.shape[:2])

    def reach(self, u: Any) -> Any:
        """The distance at which each ray first meets the boundary; infinite where it does not."""
        import numpy as np

        terms, top = self._own.parts(u), int(self.degrees.max())
        by_degree = np.stack([terms[:, self.degrees == k].sum(axis=1) for k in range(top + 1)], axis=1)
        if not by_degree[:, 1:top].any():
            with np.errstate(divide="ignore", invalid="ignore"):
                return np.where(by_degree[:, top] > 0, (-by_degree[:, 0] / by_degree[:, top]) ** (1 / top), np.inf)
        ends = []
        for row in by_degree:
            roots = np.roots(row[::-1])
            real = roots[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)].real
            ends.append(real.min() if len(real) else np.inf)
        return np.array(ends)

    def bends(self, u: Any) -> tuple[Any, Any, Any]:
        """r lambda/(u . grad g) at the boundary in each direction, and the tangents and r; infinite where there is none."""
        import numpy as np

        found = self.reach(u)
        there = np.isfinite(found)
        r = np.where(there, found, 1.0)
        x = r[:, None] * u
        gradient, entries = self._slopes.at(x), self._bends.at(x)
        hessian = np.empty((len(u), self.n, self.n))
        for k, (i, j) in enumerate(self._entries):
            hessian[:, i, j] = hessian[:, j, i] = entries[:, k]
        size = np.linalg.norm(gradient, axis=1)
        normal = gradient / np.where(size > 0, size, 1.0)[:, None]
        flat = np.eye(self.n) - normal[:, :, None] * normal[:, None, :]
        out = np.abs(hessian).sum(axis=(1, 2)) + 1  # beyond every tangential value: the normal is not chosen
        values, axes = np.linalg.eigh(flat @ hessian @ flat + out[:, None, None] * normal[:, :, None] * normal[:, None, :])
        rise = (u * gradient).sum(axis=1)
        good = there & (rise > 0)
        return np.where(good, r * values[:, 0] / np.where(good, rise, 1.0), np.inf), axes[:, :, 0], found


@dataclass(frozen=True)
class _Terms:
    """Several polynomials in floats: the exponents in any of them, and the numbers of each."""

    powers: Any
    factors: Any

    @classmethod
    def of(cls, polynomials: Sequence[Mapping[tuple[int, ...], Fraction]]) -> _Terms:
        import numpy as np

        powers = list(dict.fromkeys(m for p in polynomials for m in p))
        return cls(np.array(powers), np.array([[float(p.get(m, 0)) for p in polynomials] for m in powers]))

    def at(self, x: Any) -> Any:
        """Their values at each row of x."""
        return self._monomials(x) @ self.factors

    def parts(self, x: Any) -> Any:
        """The terms of the only one."""
        return self._monomials(x) * self.factors[:, 0]

    def _monomials(self, x: Any) -> Any:
        import numpy as np

        table = x[:, :, None] ** np.arange(self.powers.max() + 1)
        found = table[:, 0, self.powers[:, 0]]
        for i in range(1, x.shape[1]):
            found = found * table[:, i, self.powers[:, i]]
        return found


def _across(form: _Form, direction: Any, along: Any) -> Iterator[tuple[Point, Point]]:
    """Two points along a tangent, at which g is lower than between them, the farthest apart first."""
    u, v = ([Fraction(round(float(c) * _FINE), _FINE) for c in vector] for vector in (direction, along))
    if (distance := _distance(form, u)) is None:
        return
    x = [distance * c for c in u]
    gradient = [form.slope(i).at(x) for i in range(len(x))]
    if (rise := _dot(u, gradient)) <= 0:
        return
    lean = _dot(v, gradient) / rise
    tangent = [a - lean * b for a, b in zip(v, u, strict=True)]
    for k in range(1, _SHORTEST):
        t = distance * Fraction(1, 2**k)
        one, other = (form.at([a + s * t * b for a, b in zip(x, tangent, strict=True)]) for s in (1, -1))
        if one + other >= 0:
            continue
        out = -(one + other) / rise / 4
        p, q = (_rounded([a + out * c + s * t * b for a, b, c in zip(x, tangent, u, strict=True)], out / 1000) for s in (1, -1))
        if _leaves(form, p, q):
            yield p, q


def _leaves(form: _Form, p: Point, q: Point) -> bool:
    """Whether the chord does."""
    return max(form.at(p), form.at(q)) <= 0 < form.at([(a + b) / 2 for a, b in zip(p, q, strict=True)])


def _distance(form: _Form, u: Sequence[Fraction]) -> Fraction | None:
    """Where the ray in direction u first meets the boundary, to some eighty digits."""
    import numpy as np

    by_degree = [Fraction(0)] * (max(form.degrees) + 1)
    for m, c, k in zip(form.powers, form.factors, form.degrees, strict=True):
        by_degree[k] += c * _product(u, m)
    roots = np.roots([float(c) for c in reversed(by_degree)])
    real = roots[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0)].real
    if not len(real):
        return None
    r = Fraction(float(real.min()))
    for _ in range(5):
        value = sum((c * r**k for k, c in enumerate(by_degree)), Fraction(0))
        slope = sum((k * c * r ** (k - 1) for k, c in enumerate(by_degree) if k), Fraction(0))
        if slope <= 0:
            return None
        r = Fraction(round((r - value / slope) * 2**260), 2**260)
    return r if r > 0 else None


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def _rounded(point: Sequence[Fraction], tolerance: Fraction) -> Point:
    """The point in the coarsest decimals within the tolerance."""
    digits = 1
    while Fraction(1, 10**digits) > tolerance:
        digits += 1
    return tuple(Fraction(round(c * 10**digits), 10**digits) for c in point)
