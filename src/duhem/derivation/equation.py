"""A derivation as a value: numbered, named relations in order, each computed, none stored, and the symbols that they speak in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair

from duhem.derivation.support_function import compression, rate_symbols
from duhem.errors import InputError, faults_at
from duhem.expression import symbol
from duhem.expression.abbreviations import Stress
from duhem.expression.number import exact_number
from duhem.expression.unevaluated import Verbatim
from duhem.law.formula_law import Criterion
from duhem.law.state import variables_of
from duhem.omitted import LeftOut
from duhem.show.page import Page
from duhem.show.printing import Shown, latex, latex_name, markdown, sheet, text

__all__ = ["STIFFNESSES", "Belongs", "Derivation", "Equation", "Names", "columns", "dot", "equal", "put"]

STIFFNESSES = ("orthotropic", "full", "isotropic")
_NONE, _POWER = sp.ImmutableMatrix(), sp.Symbol("D", real=True)


def equal(left: object, right: object) -> sp.Basic:
    """left = right, kept as written."""
    return sp.Eq(left, right, evaluate=False)


def columns(left: Iterable[Any], right: Iterable[Any]) -> sp.Basic:
    """left = right of column vectors, given by their entries."""
    return equal(*(sp.ImmutableMatrix(sp.Matrix(list(entries))) for entries in (left, right)))


def dot(one: Iterable[Any], other: Iterable[Any]) -> sp.Expr:
    """The sum of products, entry by entry."""
    return sp.Add(*(a * b for a, b in zip(one, other, strict=True)))


def put(expr: Any, swap: Mapping[Any, sp.Expr]) -> Any:
    """Symbols replaced, with every relation kept as written: SymPy would turn some into true."""
    if isinstance(expr, Relational | sp.And | sp.Piecewise):
        return type(expr)(*(put(a, swap) for a in expr.args), evaluate=False)
    if isinstance(expr, ExprCondPair):
        return ExprCondPair(*(put(a, swap) for a in expr.args))
    if isinstance(expr, sp.MatrixBase):
        return expr.applyfunc(lambda entry: put(entry, swap))
    if expr.args and expr.has(sp.Piecewise):
        return expr.func(*(put(a, swap) for a in expr.args))
    return expr.xreplace(swap)


@dataclass(frozen=True)
class State(Verbatim):
    """The symbols of a state: the ``rate`` of each variable by its name, and what the inequality of Clausius and Duhem speaks of.

    ``variables``: chi; ``energy``, ``energy_rate``, ``entropy``, ``entropy_rate``: psi_C and s_C with their rates; ``total``, ``thermal``:
    D and D_th of Antoni et al. (2007), Eqs. 22, 23, where D = D_intr + D_th; ``capacity``: c_C = -T d2 psi_C/dT2; ``bodies``: of each body
    its temperature T_k and the heat q_k . n_k that flows from it into the interface.
    """

    rate: dict[str, sp.Symbol]
    variables: sp.Symbol
    energy: sp.Symbol
    energy_rate: sp.Symbol
    entropy: sp.Symbol
    entropy_rate: sp.Symbol
    total: sp.Symbol
    thermal: sp.Symbol
    capacity: sp.Symbol
    bodies: tuple[tuple[sp.Expr, sp.Expr], ...]


@dataclass(frozen=True)
class Names(Verbatim):
    """One symbol per force for each quantity of the theory, none of which clashes with a name of the law.

    ``total``, ``elastic``, ``inelastic``: displacements u, u_e, u_in; ``speed``, ``rates``: their rates du/dt and
    du_in/dt; ``normal``: outward normal; ``trial``: trial stress of a step; ``elastic_step``, ``slip_step``: increments of
    u_e and u_in over a step; ``other``: any admissible stress; ``multiplier``, ``step``: the
    multiplier's rate and its increment over a step; ``multipliers``, ``steps``: one of each for every surface of the law;
    ``power``: the intrinsic dissipation.  A law with a ``state`` has displacements and their rates there, and no names for a step.
    """

    law: Criterion
    forces: tuple[sp.Symbol, ...]
    rates: tuple[sp.Symbol, ...]
    normal: tuple[sp.Symbol, ...]
    other: tuple[sp.Symbol, ...]
    multiplier: sp.Symbol
    multipliers: tuple[sp.Symbol, ...]
    latex: dict[sp.Symbol, str] = field(repr=False)
    total: tuple[sp.Symbol, ...] = ()
    elastic: tuple[sp.Symbol, ...] = ()
    inelastic: tuple[sp.Symbol, ...] = ()
    speed: tuple[sp.Symbol, ...] = ()
    trial: tuple[sp.Symbol, ...] = ()
    elastic_step: tuple[sp.Symbol, ...] = ()
    slip_step: tuple[sp.Symbol, ...] = ()
    step: sp.Symbol = sp.S.Zero
    steps: tuple[sp.Symbol, ...] = ()
    stiffness: sp.ImmutableMatrix = _NONE
    power: sp.Symbol = _POWER
    state: State | None = None

    @property
    def beside(self) -> tuple[sp.Expr, ...]:
        """The rates without a multiplier, by force."""
        driven = variables_of(self.law).driven()
        return tuple(self.law.rates.get(driven.get(force, ""), sp.S.Zero) for force in self.law.forces)

    @property
    def plastic(self) -> tuple[sp.Expr, ...]:
        """The rates less those without a multiplier, by force."""
        return tuple(rate - other for rate, other in zip(self.rates, self.beside, strict=True))

    def shown(self, expr: sp.Expr) -> sp.Expr:
        """The expression in |pressure|, which is how the theory is written."""
        return expr.xreplace(compression(self.law)[0])

    @classmethod
    def of(cls, law: Criterion, stiffness: str = "orthotropic") -> Names:
        """Names for a law; an unknown kind of stiffness raises InputError."""
        if stiffness not in STIFFNESSES:
            raise InputError(f"unknown stiffness {stiffness!r}", where=law.name, remedy=f"choose one of {', '.join(STIFFNESSES)}")
        rates = rate_symbols(law)
        taken = {*law.symbols(), *(r.name for r in rates)}
        tails = [force.removeprefix("sigma_") for force in law.forces]
        latex = {s: latex_name(name) for name, s in law.symbols().items()}

        def fresh(name: str, written: str, **sign: bool) -> sp.Symbol:
            while name in taken:
                name, written = f"{name}0", rf"\tilde{{{written}}}"
            taken.add(name)
            made = symbol(name, **sign)
            latex[made] = written
            return made

        def each(stem: str, written: str) -> tuple[sp.Symbol, ...]:
            return tuple(fresh(f"{stem}_{t}", written.replace("?", _latex_tail(t))) for t in tails)

        surfaces = range(1, len(law.surfaces) + 1)
        latex |= {r: rf"\dot u^{{\mathrm{{in}}}}_{{{_latex_tail(t)}}}" for r, t in zip(rates, tails, strict=True)}
        common: dict[str, Any] = {
            "law": law,
            "forces": law.force_symbols(),
            "normal": each("n", "n_{?}"),
            "other": each("tau", r"\tau_{?}"),
            "multiplier": fresh("lambda_dot", r"\dot\lambda", nonnegative=True),
            "multipliers": tuple(fresh(f"lambda_dot_{i}", rf"\dot\lambda_{{{i}}}", nonnegative=True) for i in surfaces),
            "latex": latex,
        }
        if law.variables or law.viscous:
            if stiffness != "orthotropic":
                what = f"the stiffness {stiffness!r} is given for a law with a state"
                raise InputError(what, where=law.name, remedy="remove it: the energy of the law says what its stiffness is")
            return cls(**common, **_in_state(law, rates, fresh))
        return cls(
            **common,
            total=each("u", "u_{?}"),
            elastic=each("ue", r"u^{\mathrm{e}}_{?}"),
            inelastic=each("uin", r"u^{\mathrm{in}}_{?}"),
            speed=each("v", r"\dot u_{?}"),
            rates=rates,
            elastic_step=each("Delta_ue", r"\Delta u^{\mathrm{e}}_{?}"),
            slip_step=each("Delta_uin", r"\Delta u^{\mathrm{in}}_{?}"),
            trial=each("trial", r"\sigma^{\mathrm{tr}}_{?}"),
            step=fresh("Delta_lambda", r"\Delta\lambda", nonnegative=True),
            steps=tuple(fresh(f"Delta_lambda_{i}", rf"\Delta\lambda_{{{i}}}", nonnegative=True) for i in surfaces),
            stiffness=_stiffness(stiffness, tails, fresh, law.stress),
        )


def _in_state(law: Criterion, rates: Sequence[sp.Symbol], fresh: Callable[..., sp.Symbol]) -> dict[str, Any]:
    """The rates of the variables, of those with a force in the order of the forces too, and the names of thermodynamics."""
    variables, thermal = variables_of(law), law.temperature is not None
    rate = {name: fresh(f"{name}_rate", rf"\dot{{{latex_name(name)}}}") for name in variables}
    driven = variables.driven()
    table = law.symbols()
    bodies: list[tuple[sp.Expr, sp.Expr]] = []
    for name, conductance in law.heat.items():
        body = table[name] if law.parameters[name].value is None else law.parameters[name].value
        bodies.append((body, conductance * (body - table[str(law.temperature)])))
    for k in (1, 2) if thermal and not law.heat else ():
        bodies.append((fresh(f"T_{k}", f"T_{{{k}}}", positive=True), fresh(f"q_{k}", rf"(\mathbf q_{{{k}}} \cdot \mathbf n_{{{k}}})")))
    total = fresh("D", r"\mathcal{D}")
    state = State(
        rate=rate,
        variables=fresh("chi", r"\chi"),
        energy=fresh("psi_C", r"\psi_C"),
        energy_rate=fresh("psi_C_rate", r"\dot\psi_C"),
        entropy=fresh("s_C", "s_C"),
        entropy_rate=fresh("s_C_rate", r"\dot s_C"),
        total=total,
        thermal=fresh("D_th", r"\mathcal{D}_{\mathrm{th}}"),
        capacity=fresh("c_C", "c_C"),
        bodies=tuple(bodies),
    )
    own = tuple(rate[driven[force]] if force in driven else slip for force, slip in zip(law.forces, rates, strict=True))
    return {"rates": own, "power": fresh("D_intr", r"\mathcal{D}_{\mathrm{intr}}") if thermal else total, "state": state}


def _stiffness(kind: str, tails: Sequence[str], fresh: object, stress: Stress | None) -> sp.ImmutableMatrix:
    assert callable(fresh)
    if kind == "isotropic":  # of tensors: a shear's conjugate is an engineering strain
        alike = [sp.Rational(1, 2) if shear else sp.S.One for shear in (stress.shears if stress else [False] * len(tails))]
        return sp.ImmutableMatrix(fresh("k_t", "k_t", positive=True) * sp.diag(*alike))
    written = [_latex_tail(t) for t in tails]
    if kind == "orthotropic":
        return sp.ImmutableMatrix(sp.diag(*[fresh(f"k_{t}", f"k_{{{w}}}", positive=True) for t, w in zip(tails, written, strict=True)]))
    full = sp.zeros(len(tails))
    for i, s in enumerate(tails):
        for j, t in enumerate(tails[i:], start=i):
            full[i, j] = full[j, i] = fresh(f"k_{s}{t}", f"k_{{{written[i]}{written[j]}}}", **({"positive": True} if i == j else {}))
    return sp.ImmutableMatrix(full)


def _latex_tail(name: str) -> str:
    return name if len(name) == 1 else rf"\mathrm{{{name}}}".replace("_", r"\_")


class Belongs(sp.Function):
    """``Belongs(x, A)``: x is an element of A."""

    nargs = 2


@dataclass(frozen=True, repr=False)
class Equation(Verbatim, Shown):
    """One line: its number in Antoni et al. (2007) or D1, D2, ... where the paper has none; ``note`` is one sentence."""

    number: str
    name: str
    relation: sp.Basic
    note: str
    section: str

    def __repr__(self) -> str:
        return f"<Equation ({self.number}) {self.name}: {self.note}>"

    def _repr_latex_(self) -> str:
        return latex(self)

    @property
    def lhs(self) -> sp.Basic:
        """Left side of the relation."""
        return self.relation.args[0]

    @property
    def rhs(self) -> sp.Basic:
        """Right side of the relation."""
        return self.relation.args[1]

    def at(self, **values: Any) -> sp.Basic:
        """The right side where the symbols of these names have these values, exactly: ``at(d_a=1, mu="0.3")``; decimals are fractions.

        Raises InputError for a name that it does not have and for what is no number.
        """
        known = {symbol.name: symbol for symbol in self.rhs.free_symbols if isinstance(symbol, sp.Symbol)}
        if strange := [name for name in values if name not in known]:
            remedy = f"it has {', '.join(sorted(known)) or 'none'}"
            raise InputError(f"{strange[0]} is no symbol on the right side", where=self.name, remedy=remedy)
        return self.rhs.xreplace({known[name]: _number(name, value) for name, value in values.items()})


def _number(name: str, value: Any) -> sp.Rational:
    with faults_at(name):
        return exact_number(value)


@dataclass(frozen=True, repr=False)
class Derivation(Shown):
    """What follows from one law's formula.  ``derivation["state_law"]`` is the equation of that name.

    ``left_out`` lists part and reason of what the law does not need or has no closed form for.
    """

    law: str
    equations: tuple[Equation, ...]
    left_out: tuple[LeftOut, ...]
    names: Names

    def __getitem__(self, name: str) -> Equation:
        for equation in self.equations:
            if equation.name == name:
                return equation
        raise KeyError(f"{name}; this derivation has: {', '.join(self.titles)}")

    def __contains__(self, name: object) -> bool:
        return name in self.titles

    def __iter__(self) -> Iterator[Equation]:
        return iter(self.equations)

    def __len__(self) -> int:
        return len(self.equations)

    def __repr__(self) -> str:
        return f"<Derivation of {self.law}: {len(self)} equations>"

    def _repr_latex_(self) -> str:
        return "\n".join(rf"$$ {formula.latex} $$" for _, formula in sheet(self).fields if not isinstance(formula, str))

    @property
    def titles(self) -> tuple[str, ...]:
        """Names of the equations, in order."""
        return tuple(equation.name for equation in self.equations)

    def text(self) -> str:
        """Plain text, a line a sentence; formulas in the vocabulary of criterion files."""
        return text(self, Page(None))

    def markdown(self) -> str:
        """Markdown with LaTeX formulas between dollar signs."""
        return markdown(self)

    def latex(self) -> str:
        """A complete LaTeX document that needs amsmath only."""
        return latex(self)
