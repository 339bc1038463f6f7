"""The symbols a derivation speaks in, and how each is written in LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import sympy as sp

from duhem.derivation.support_function import compression, rate_symbols
from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.invariants import Stress
from duhem.expression.verbatim import Verbatim
from duhem.law.formula_law import Criterion
from duhem.show.notation import latex_name

__all__ = ["STIFFNESSES", "Names"]

STIFFNESSES = ("orthotropic", "full", "isotropic")


@dataclass(frozen=True)
class Names(Verbatim):
    """One symbol per force for each quantity of the theory, none of which clashes with a name of the law.

    ``total``, ``elastic``, ``inelastic``: displacements u, u_e, u_in; ``speed``, ``rates``: their rates du/dt and
    du_in/dt; ``normal``: outward normal; ``trial``: trial stress of a step; ``elastic_step``, ``slip_step``: increments of
    u_e and u_in over a step; ``other``: any admissible stress; ``multiplier``, ``step``: the
    multiplier's rate and its increment over a step; ``multipliers``, ``steps``: one of each for every surface of the law.
    """

    law: Criterion
    forces: tuple[sp.Symbol, ...]
    total: tuple[sp.Symbol, ...]
    elastic: tuple[sp.Symbol, ...]
    inelastic: tuple[sp.Symbol, ...]
    speed: tuple[sp.Symbol, ...]
    rates: tuple[sp.Symbol, ...]
    normal: tuple[sp.Symbol, ...]
    trial: tuple[sp.Symbol, ...]
    elastic_step: tuple[sp.Symbol, ...]
    slip_step: tuple[sp.Symbol, ...]
    other: tuple[sp.Symbol, ...]
    multiplier: sp.Symbol
    step: sp.Symbol
    multipliers: tuple[sp.Symbol, ...]
    steps: tuple[sp.Symbol, ...]
    stiffness: sp.ImmutableMatrix
    latex: dict[sp.Symbol, str] = field(repr=False)

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
                name += "0"
            taken.add(name)
            made = symbol(name, **sign)
            latex[made] = written
            return made

        def each(stem: str, written: str) -> tuple[sp.Symbol, ...]:
            return tuple(fresh(f"{stem}_{t}", written.replace("?", _latex_tail(t))) for t in tails)

        surfaces = range(1, len(law.surfaces) + 1)
        latex |= {r: rf"\dot u^{{\mathrm{{in}}}}_{{{_latex_tail(t)}}}" for r, t in zip(rates, tails, strict=True)}
        return cls(
            law=law,
            forces=law.force_symbols(),
            total=each("u", "u_{?}"),
            elastic=each("ue", r"u^{\mathrm{e}}_{?}"),
            inelastic=each("uin", r"u^{\mathrm{in}}_{?}"),
            speed=each("v", r"\dot u_{?}"),
            rates=rates,
            normal=each("n", "n_{?}"),
            elastic_step=each("Delta_ue", r"\Delta u^{\mathrm{e}}_{?}"),
            slip_step=each("Delta_uin", r"\Delta u^{\mathrm{in}}_{?}"),
            trial=each("trial", r"\sigma^{\mathrm{tr}}_{?}"),
            other=each("tau", r"\tau_{?}"),
            multiplier=fresh("lambda_dot", r"\dot\lambda", nonnegative=True),
            step=fresh("Delta_lambda", r"\Delta\lambda", nonnegative=True),
            multipliers=tuple(fresh(f"lambda_dot_{i}", rf"\dot\lambda_{{{i}}}", nonnegative=True) for i in surfaces),
            steps=tuple(fresh(f"Delta_lambda_{i}", rf"\Delta\lambda_{{{i}}}", nonnegative=True) for i in surfaces),
            stiffness=_stiffness(stiffness, tails, fresh, law.stress),
            latex=latex,
        )


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
