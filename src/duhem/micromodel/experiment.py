"""The friction test of the paper as a value: predicted against measured, the local friction that both readings allow, errata.

A steel specimen with wedges (period L, height h, angle alpha; 1/tan alpha + 1/tan beta = L/h) under an aluminium one.  The
local coefficient mu = mu_alpha = mu_beta was not measured; mu_a_plus and mu_a_minus grow with it, since dH(x, y)/dx =
(1 + tan^2 y)/(1 - x tan y)^2 > 0, so that a range of either reading is a range of mu.  Whatever is compared is a rational
number: an end of a range is a :class:`Bracket` whose two ends were evaluated exactly.  The errata are where the print
contradicts itself, each with numbers computed from what it says elsewhere.

Source: Antoni et al. (2007), section 3, Eqs. (4), (6)-(10), (13), (15), (16), (35), Figs. 8 and 9.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression.number import exact_number
from duhem.law.catalogue import load_formula
from duhem.micromodel.wedge import F_0, K_N, SLOPE, averages, exact_coefficients, height, mean
from duhem.show.page import PAGE, Page
from duhem.show.printing import text

__all__ = ["STEEL_ON_ALUMINIUM", "Bracket", "Consistency", "Erratum", "Experiment", "Prediction", "Range", "as_text", "errata"]

_REACH = sp.Rational(1, 2**52)


@dataclass(frozen=True)
class Bracket:
    """A number known to lie in [low, high], both rational."""

    low: sp.Rational
    high: sp.Rational

    def __float__(self) -> float:
        return float((self.low + self.high) / 2)


@dataclass(frozen=True)
class Range:
    """From ``low`` to ``high``, each within its bracket."""

    low: Bracket
    high: Bracket

    def __contains__(self, value: object) -> bool:
        """Whether ``value`` is certainly inside."""
        return bool(self.low.high <= exact_number(value) <= self.high.low)

    def __str__(self) -> str:
        return f"{float(self.low):.6f} ... {float(self.high):.6f}"


@dataclass(frozen=True)
class Prediction:
    """Apparent coefficients and tangential loads (N) at one local coefficient, exactly."""

    mu: sp.Rational
    plus: sp.Rational
    minus: sp.Rational
    load_plus: sp.Rational
    load_minus: sp.Rational


@dataclass(frozen=True)
class Consistency:
    """Which local coefficients agree with readings of mu_a_plus and mu_a_minus that are off by at most their scatter.

    ``by_plus`` and ``by_minus`` from one reading each, ``both`` their intersection, None where it is empty for certain.
    """

    by_plus: Range
    by_minus: Range
    both: Range | None


@dataclass(frozen=True)
class Experiment:
    """A friction test along t_a: wedges of ``period`` and ``height`` in m, slope ``tan_alpha``, ``normal_load`` in N, and readings.

    ``measured_plus`` and ``measured_minus`` are the apparent coefficients along +t_a and -t_a; ``mu_low`` to ``mu_high`` the
    local coefficients the authors take as admissible.  Numbers are kept exactly, decimals as rationals.  Raises InputError
    for numbers that are not positive and for wedges that do not close: L/h <= 1/tan alpha.
    """

    period: sp.Rational
    height: sp.Rational
    tan_alpha: sp.Rational
    normal_load: sp.Rational
    measured_plus: sp.Rational
    measured_minus: sp.Rational
    mu_low: sp.Rational
    mu_high: sp.Rational

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            number = exact_number(getattr(self, name))
            object.__setattr__(self, name, number)
            if number <= 0:
                raise InputError(f"{name} = {number} is not positive", where="experiment", remedy="give a positive number")
        if self.period / self.height <= 1 / self.tan_alpha:
            raise InputError(
                "L/h <= 1/tan alpha leaves no second side", where="experiment", remedy="give a longer period or a steeper side"
            )
        if self.mu_low >= self.mu_high or self.mu_high >= self.mu_limit:
            what = f"mu from {self.mu_low} to {self.mu_high} is no range below {self.mu_limit}, where a side stops sliding (Eqs. 4, 16)"
            raise InputError(what, where="experiment", remedy="give mu_low < mu_high below it")

    @property
    def tan_beta(self) -> sp.Rational:
        """Slope of the second side, from 1/tan alpha + 1/tan beta = L/h."""
        return 1 / (self.period / self.height - 1 / self.tan_alpha)

    @property
    def mu_limit(self) -> sp.Rational:
        """Least local coefficient at which a side stops sliding: 1/max(tan alpha, tan beta) (Eqs. 4, 16)."""
        return 1 / max(self.tan_alpha, self.tan_beta)

    def predicted(self, mu: Any) -> Prediction:
        """Coefficients (Eqs. 13, 15) and loads at the local coefficient ``mu``; InputError outside 0 <= mu < mu_limit."""
        local = exact_number(mu)
        if not 0 <= local < self.mu_limit:
            raise InputError(
                f"mu = {local} lies outside [0, {self.mu_limit})", where="experiment", remedy="give a mu at which both sides slide"
            )
        plus, minus = exact_coefficients({"tan_alpha": self.tan_alpha, "tan_beta": self.tan_beta, "mu_alpha": local, "mu_beta": local})
        return Prediction(local, plus, minus, plus * self.normal_load, minus * self.normal_load)

    def local_friction(self, *, plus: Any = None, minus: Any = None) -> Bracket:
        """The mu at which mu_a_plus, or mu_a_minus, takes the given value: a bracket some 1e-16 wide, both ends proved.

        InputError unless one of the two is given and some mu in [0, mu_limit) reaches it.
        """
        if (plus is None) == (minus is None):
            raise InputError("plus and minus are both given, or neither", where="local_friction", remedy="give one of them")
        target = exact_number(minus if plus is None else plus)

        def excess(mu: sp.Rational) -> sp.Rational:
            at = self.predicted(mu)
            return (at.minus if plus is None else at.plus) - target

        return self._root(excess, f"mu_a_{'minus' if plus is None else 'plus'} = {target}")

    def consistent(self, scatter_plus: Any, scatter_minus: Any = None) -> Consistency:
        """The local coefficients that agree with both readings within their scatter (an absolute bound on each; >= 0).

        ``scatter_minus`` left out is ``scatter_plus``.
        """
        sp_, sm = exact_number(scatter_plus), exact_number(scatter_plus if scatter_minus is None else scatter_minus)
        if sp_ < 0 or sm < 0:
            raise InputError("a scatter is negative", where="consistent", remedy="give numbers >= 0")
        by_plus = Range(*(self.local_friction(plus=self.measured_plus + s) for s in (-sp_, sp_)))
        by_minus = Range(*(self.local_friction(minus=self.measured_minus + s) for s in (-sm, sm)))
        low = max(by_plus.low, by_minus.low, key=lambda b: b.low)
        high = min(by_plus.high, by_minus.high, key=lambda b: b.high)
        return Consistency(by_plus, by_minus, Range(low, high) if low.low <= high.high else None)

    def least_scatter(self) -> tuple[Bracket, Bracket]:
        """(mu, s): the least s for which readings off by s each allow a common mu, and that mu.

        There the two misfits are equal and opposite, so mu_a_plus + mu_a_minus equals the sum of the readings.
        """

        def excess(mu: sp.Rational) -> sp.Rational:
            at = self.predicted(mu)
            return at.plus + at.minus - self.measured_plus - self.measured_minus

        mu = self._root(excess, "the sum of the readings")
        gaps = [self.measured_plus - self.predicted(end).plus for end in (mu.low, mu.high)]
        if gaps[0] * gaps[1] < 0:
            return mu, Bracket(sp.S.Zero, max(map(abs, gaps)))
        return mu, Bracket(*sorted(map(abs, gaps)))

    def _root(self, excess: Callable[[sp.Rational], sp.Rational], what: str) -> Bracket:
        """The zero of a growing function: found in double precision, then held between two rationals of exact opposite sign."""
        from scipy.optimize import brentq

        least, most = sp.S.Zero, self.mu_limit * (1 - sp.Rational(1, 2**40))
        if excess(least) > 0 or excess(most) < 0:
            raise InputError(f"no local coefficient gives {what}", where="experiment", remedy="check the readings and the wedges")
        near = sp.Rational(brentq(lambda mu: float(excess(sp.Rational(mu))), 0.0, float(most), xtol=1e-15, rtol=1e-15))
        reach = _REACH
        while True:  # wider until the signs are right, at the latest at the whole range
            low, high = max(least, near - reach), min(most, near + reach)
            if excess(low) <= 0 <= excess(high):
                return Bracket(low, high)
            reach *= 4

    def to_text(self, scatter: Any = "0.01") -> str:
        """Predicted against measured as a table, the local friction that both readings allow, and the errata."""
        return text(self, scatter=exact_number(scatter))


STEEL_ON_ALUMINIUM = Experiment(
    period=sp.Rational(200, 10**6),
    height=sp.Rational(40, 10**6),
    tan_alpha=sp.Integer(1),
    normal_load=sp.Integer(1000),
    measured_plus=sp.Rational(33, 100),
    measured_minus=sp.Rational(29, 100),
    mu_low=sp.Rational(23, 100),
    mu_high=sp.Rational(29, 100),
)


@dataclass(frozen=True)
class Erratum:
    """``printed``: what stands at ``place``; ``follows``: what its own premises give; ``numbers``: ours, each computed here."""

    place: str
    printed: str
    follows: str
    numbers: Mapping[str, Any]


def errata(experiment: Experiment = STEEL_ON_ALUMINIUM) -> tuple[Erratum, ...]:
    """The four, in the order of the paper."""
    return _spring_force(), _differentiability(), _misprinted_load(experiment), _rounded_prediction(experiment)


def _spring_force() -> Erratum:
    as_printed = sp.expand(-(F_0 + K_N * mean({side: height(side) for side in SLOPE})))
    derived = sp.expand(averages(+1).normal)
    return Erratum(
        "Eq. (9)",
        "F_n = -(F_0 + k_n u_n), with F_0 = -k_n (delta - h) <= 0",
        "its mean over a period is not Eq. (10), F_0 - k_n h/2, which follows from F_n = F_0 - k_n u_n; Eqs. (13), (15) stand",
        {
            "mean of Eq. (9) as printed": as_printed,
            "mean of F_0 - k_n u_n": derived,
            "printed less Eq. (10)": sp.expand(as_printed - derived),
        },
    )


def _differentiability() -> Erratum:
    law = load_formula("antoni2007").fix({"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"})
    names = law.symbols()

    def rate(sense: int) -> sp.Rational:
        """g along sense * t_a from the origin at sigma_n = 0, where it is homogeneous: the one-sided derivative."""
        values = {names["sigma_a"]: sp.Integer(sense), names["sigma_b"]: sp.S.Zero, names["sigma_n"]: sp.S.Zero}
        return sp.nsimplify(law.g.xreplace(values | law.settled()).doit())

    return Erratum(
        "section 2.6, before Eq. (35)",
        "the criterion (35) is differentiable",
        "it is, except at sigma_t = 0: there the one-sided derivatives along t_a and -t_a do not add up to zero (Fig. 5 coefficients)",
        {"derivative along +t_a": rate(+1), "derivative along -t_a": rate(-1), "their sum": rate(+1) + rate(-1)},
    )


def _misprinted_load(experiment: Experiment) -> Erratum:
    printed = sp.Integer(229)
    other = printed / experiment.normal_load
    mu = experiment.local_friction(minus=other)
    return Erratum(
        "section 3.2, Fig. 8",
        "tangential loads of 330 N and 229 N, coefficients of 0.33 and 0.29",
        "0.29 is the coefficient of 290 N; 229 N would also contradict the model, whose other coefficient would be too small",
        {
            "229 N over the normal load": other,
            "load of 0.29 (N)": experiment.measured_minus * experiment.normal_load,
            "mu_a_plus where mu_a_minus is that": experiment.predicted(mu.low).plus.n(15),
        },
    )


def _rounded_prediction(experiment: Experiment) -> Erratum:
    quarter, less = experiment.predicted("0.25"), experiment.predicted("0.24")
    return Erratum(
        "section 3.2, Fig. 9",
        "near a local coefficient of 0.25 the calculated coefficients are 0.32 and 0.29",
        "Eqs. (13), (15) give 0.32 and 0.29 at two different local coefficients, both nearer 0.24",
        {
            "mu_a_plus at 0.25": quarter.plus,
            "mu_a_minus at 0.25": quarter.minus,
            "mu_a_plus at 0.24": less.plus.n(6),
            "mu_a_minus at 0.24": less.minus.n(6),
            "mu where mu_a_plus = 0.32": experiment.local_friction(plus="0.32"),
            "mu where mu_a_minus = 0.29": experiment.local_friction(minus="0.29"),
        },
    )


@text.register(Experiment)
def as_text(experiment: Experiment, page: Page = PAGE, *, scatter: sp.Rational) -> str:
    """Everything about ``experiment`` with readings that may be off by ``scatter``."""
    parts = (_specimen(experiment, page), _table(experiment, page), _friction(experiment, scatter, page), _errata(experiment, page))
    return page.report([[*part] for part in parts])


def _specimen(e: Experiment, page: Page) -> Iterator[str]:
    lengths = f"L = {float(e.period) * 1e6:g} um, h = {float(e.height) * 1e6:g} um"
    yield from page.hanging(f"{lengths}, tan alpha = {e.tan_alpha}, tan beta = {e.tan_beta}, load {e.normal_load} N")
    read = f"mu_a_plus = {float(e.measured_plus):g}, mu_a_minus = {float(e.measured_minus):g}"
    yield from page.hanging(f"measured {read} (Antoni et al. 2007, section 3)")


def _table(e: Experiment, page: Page) -> Iterator[str]:
    quarter, (best, _) = sp.Rational(1, 4), e.least_scatter()
    rows: list[tuple[str, ...]] = [
        ("local mu", "mu_a_plus", "mu_a_minus", "load + (N)", "load - (N)", "plus - measured", "minus - measured")
    ]
    for mu in sorted({e.mu_low, sp.Rational(24, 100), best.low, quarter, e.mu_high}):
        at = e.predicted(mu)
        numbers = (mu, at.plus, at.minus, at.load_plus, at.load_minus, at.plus - e.measured_plus, at.minus - e.measured_minus)
        rows.append(tuple(f"{float(x):+.5f}" if i > 4 else f"{float(x):.5f}" for i, x in enumerate(numbers)))
    yield from page.table(rows, "r")


def _friction(e: Experiment, scatter: sp.Rational, page: Page) -> Iterator[str]:
    found = e.consistent(scatter)
    mu, least = e.least_scatter()
    yield from page.hanging(f"local mu that agrees with readings off by at most {float(scatter):g} each (ends proved by exact evaluation)")
    ranges = {
        "mu_a_plus alone": f"{found.by_plus}",
        "mu_a_minus alone": f"{found.by_minus}",
        "both": f"{found.both or 'none'}",
        "the paper (Fig. 9)": f"{float(e.mu_low):.6f} ... {float(e.mu_high):.6f}",
    }
    for title, between in ranges.items():
        yield from page.field(title, between, max(map(len, ranges)))
    apart = f"no mu agrees with both readings if each is off by less than {float(least):.6f}"
    yield from page.item(f"{apart}; with that, mu = {float(mu):.6f}")


def _errata(e: Experiment, page: Page) -> Iterator[str]:
    yield "errata of the print"
    for entry in errata(e):
        yield from page.item(entry.place)
        yield from page.item(f"printed: {entry.printed}", "    ")
        yield from page.item(f"follows: {entry.follows}", "    ")
        for name, value in entry.numbers.items():
            yield from page.item(f"{name} = {_shown(value)}", "      ")


def _shown(value: Any) -> str:
    if isinstance(value, Bracket):
        return f"{float(value):.12f}"
    if isinstance(value, sp.Rational) and not value.is_integer:
        return f"{value} = {float(value):.12g}"
    return str(value)
