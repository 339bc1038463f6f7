"""What is measured, one law with numbers in place at one stiffness; and who is: the methods that apply, or why they are left out.

Other programs that find the same closest point are methods beside duhem's own, measured where they are installed and never needed.  What
a program needs is imported where it is asked.  The programs for quadratic programs take sets bounded by planes:

    minimise sigma . k^-1 sigma/2 - (k^-1 trial) . sigma   subject to   n_i . sigma <= b_i(sigma_n)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.benchmark.reference import Closest
from duhem.errors import InputError
from duhem.expression.jets import formula
from duhem.expression.numpy_ import compiled
from duhem.expression.rays import exits
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_fixed
from duhem.law.state import check_stateless
from duhem.omitted import LeftOut
from duhem.projection import conic_solvers
from duhem.projection.half_spaces import planes
from duhem.projection.in_blocks import cores
from duhem.projection.increment import Increment, increment
from duhem.projection.method import Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array, Projection, Solution
from duhem.projection.scaled_formula import level_of, power_of_two

__all__ = ["JAXMAT", "PEERS", "SLSQP", "Contender", "Peer", "PeerOptions", "Specimen", "applicable"]

Tolerances = Sequence[float | None]

_RADII = np.ldexp(1.0, np.arange(-1070, 1021))


@dataclass(frozen=True)
class Contender:
    """One way to the closest point: a method with its options, under the name it has in tables."""

    name: str
    method: Method[Any]
    options: Options

    @classmethod
    def of(cls, name: str, method: str, **options: Any) -> Contender:
        """One of duhem's own methods."""
        found = METHODS[method]()
        return cls(name, found, found.options_of(options))

    def solve(self, question: Increment) -> Solution:
        """The method's answer to a checked question, unjudged."""
        return self.method.solve(question, self.options)

    def again(self, question: Increment, into: Solution) -> Solution:
        """The same into the arrays of an earlier solution of as many points; InputError for a method that cannot."""
        return self.method.solve(question, self.method.options_of({**vars(self.options), "into": into}))

    def project(self, specimen: Specimen, trial: Array, pressure: Any, stiffness: Array | None = None) -> Projection:
        """The increment with statuses and residuals, as users get it."""
        k = specimen.stiffness if stiffness is None else stiffness
        return Projector.of(specimen.law, k, method=self.method)(trial, pressure, **vars(self.options))

    @property
    def peer(self) -> bool:
        """Whether it is another program."""
        return any(self.method is peer.method for peer in PEERS)


def applicable(question: Increment, tolerances: Tolerances = (None,), peers: bool = False) -> tuple[list[Contender], list[LeftOut]]:
    """Every method that applies to the law, the conic solvers once for each tolerance (None: the tightest that is met).

    ``peers``: other programs too, as they come.
    """
    found, left_out = list[Contender](), list[LeftOut]()
    for name, imported in METHODS.items():
        if (reason := imported().applies(question)) is not None:
            left_out.append(LeftOut(name, reason))
            continue
        for entry in _VARIANTS[name](question, tolerances) if name in _VARIANTS else (Contender.of(name, name),):
            if isinstance(entry, Contender):
                found.append(entry)
            else:
                left_out.append(entry)
    for peer in PEERS if peers else ():
        if (reason := peer.missing or peer.method.applies(question)) is not None:
            left_out.append(LeftOut(peer.method.name, reason))
        else:
            found.append(Contender(peer.method.name, peer.method, PeerOptions()))
    return found, left_out


def _closed_form(question: Increment, _: Tolerances) -> Iterator[Contender | LeftOut]:
    """The closed form in NumPy, and compiled."""
    yield Contender.of("closed-form", "closed-form", compiled=False)
    if question.trial.shape[1] == 2:
        yield _compiled("closed-form")


def _newton(question: Increment, _: Tolerances) -> Iterator[Contender | LeftOut]:
    """Newton's method in NumPy, and the loop that is compiled for the law."""
    yield Contender.of("newton", "newton", compiled=False)
    if METHODS["closed-form"]().applies(question) is None:
        yield LeftOut("newton, numba", "the law has a closed form")
    else:
        yield _compiled("newton")


def _compiled(name: str) -> Contender | LeftOut:
    if find_spec("numba") is None:
        return LeftOut(f"{name}, numba", 'numba is not installed, pip install "duhem[fast]"')
    return Contender.of(f"{name}, numba", name, compiled=True)


def _conic(_: Increment, tolerances: Tolerances) -> Iterator[Contender | LeftOut]:
    """Each conic solver at each tolerance."""
    installed = conic_solvers.installed()
    for solver in conic_solvers.KNOWN:
        if solver not in installed:
            yield LeftOut(f"cvxpy {solver}", f"not installed, pip install {solver.lower()}")
            continue
        for tolerance in tolerances:
            yield Contender.of(f"cvxpy {solver}", "cvxpy", solver=solver, tolerance=tolerance)
    for solver in installed:
        if solver not in conic_solvers.KNOWN:
            yield LeftOut(f"cvxpy {solver}", "no solver of second-order cones known to duhem")


# Methods that are measured in several ways; any other is measured once, as it comes.
_VARIANTS: Mapping[str, Callable[[Increment, Tolerances], Iterator[Contender | LeftOut]]] = {
    "closed-form": _closed_form,
    "newton": _newton,
    "cvxpy": _conic,
}


@dataclass(frozen=True)
class Specimen:
    """A law with numbers in place and the stiffness (d, d) in Pa/m it is measured at.

    ``law`` has its parameters at the doubles that the methods read, taken exactly; ``declared`` as they were given.
    """

    declared: Criterion
    law: Criterion
    stiffness: Array

    @classmethod
    def of(cls, law: Criterion, stiffness: Sequence[float] | None = None) -> Specimen:
        """``law`` with every parameter at a double, taken exactly, as the methods will read it; k = diag(1, 2, ...) if left out.

        Raises InputError for a parameter without value and for a law whose increments are more than closest points of K.
        """
        check_stateless(law, "a benchmark of single increments")
        check_fixed(law)
        d = len(law.forces)
        k = np.diag(np.arange(1.0, d + 1) if stiffness is None else np.asarray(stiffness, dtype=np.float64))
        trial = np.zeros((1, d))
        asked = increment(law, trial, None if law.pressure is None else -1.0, k, None)
        exact = {name: Domain.fixed(Fraction(value)) for name, value in asked.parameters.items()}
        return cls(law, replace(law, parameters=exact), k)  # same signs, so the symbols stay

    @property
    def pressure(self) -> float | None:
        """The pressure sigma_n = -1 of the plain cases, in the unit of the parameters; None for a law without."""
        return None if self.law.pressure is None else -1.0

    def question(self, trial: Array, pressure: Array | float | None) -> Increment:
        """The checked increments."""
        return increment(self.law, trial, pressure, self.stiffness, None)

    @property
    def unloaded(self) -> Increment:
        """The increment without forces, whose law, formula and stiffness are those of all."""
        return self.question(np.zeros((1, len(self.law.forces))), self.pressure)

    def reference(self) -> Closest:
        """The closest point in many digits."""
        question = self.unloaded
        return Closest(question.g, self.law.force_symbols(), question.pressure_symbol, question.stiffness.tolist())

    def radius(self, direction: Array, pressure: float | None) -> float:
        """How far K reaches along ``direction`` from the origin, in doubles; 0 where the origin is outside, inf where it never ends."""
        question = self.unloaded
        others = {} if pressure is None or question.pressure_symbol is None else {question.pressure_symbol: pressure}
        (last,), (first,) = exits(question.g, self.law.force_symbols(), direction[None], _RADII, others)
        return 0.0 if last < _RADII[0] else float("inf") if last == first else float(last)

    def width(self) -> float:
        """How far K reaches along the axes, either way: the median of where it ends, 1 where it does nowhere."""
        axes = np.eye(len(self.law.forces))
        reach = [self.radius(way, self.pressure) for axis in axes for way in (axis, -axis)]
        return float(np.median([r for r in reach if 0.0 < r < 1e300] or [1.0]))

    def describe(self) -> str:
        """The law's parameters and the stiffness in words."""
        values = ", ".join(f"{name} = {float(domain.value):g}" for name, domain in self.law.parameters.items() if domain.value is not None)
        k = ", ".join(f"{x:g}" for x in np.diagonal(self.stiffness))
        return f"{values + '; ' if values else ''}stiffness {k}"


# -- other programs ----------------------------------------------------------------------------------------------------


_STEPS = 500

_BLOCK = 10_000  # programs held at once

_SAME = 1e-12  # of the yield stress


@dataclass(frozen=True)
class PeerOptions(Options):
    """``tolerance``: at which the program stops, in its own meaning of the word; left out, the program's default."""

    tolerance: float | None = None

    def __post_init__(self) -> None:
        if self.tolerance is not None and not (math.isfinite(self.tolerance) and self.tolerance > 0.0):
            raise InputError(f"the tolerance {self.tolerance} is not a positive number", where="tolerance", remedy="give one such as 1e-9")


def answered(question: Increment, stress: Array, failed: NDArray[np.bool_]) -> Solution:
    """The stresses (N, d) in Pa with the slip k^-1 (trial - stress) and the multiplier that explains it best.

    Peers return a stress, or multipliers of their own.  With n = dg/dsigma a slip along n has lambda = slip . stress/(n . stress),
    which at a corner of a gauge is the sum over its faces.  A point is ``failed`` where the program says so, or has no number.
    """
    slip: Array = np.asarray(np.linalg.solve(question.stiffness, (question.trial - stress).T).T, dtype=np.float64)
    level_ = level_of(question)
    with np.errstate(all="ignore"):
        size = power_of_two(np.abs(stress).max(axis=1, initial=0.0))
        normal = level_.gradient(stress, question.pressure, size)
        share = np.einsum("nd,nd->n", slip, stress) / np.einsum("nd,nd->n", normal, stress)
        multiplier = np.where((slip == 0.0).all(axis=1), 0.0, level_.own(share, size))
    return Solution(stress, slip, multiplier, failed | ~np.isfinite(stress).all(axis=1))


def _by_slsqp(question: Increment, options: PeerOptions) -> Solution:
    """SciPy's sequential quadratic programming, point by point: what is written where no library is at hand.

        minimise (trial - sigma) . k^-1 (trial - sigma)/2   subject to   -g(sigma, sigma_n) >= 0

    from the trial stress, with the gradients of both (D. Kraft 1988, DFVLR-FB 88-28).  Formula and gradient are duhem's programs over
    arrays of one point, slower than a function written by hand.
    """
    from scipy.optimize import minimize

    law = question.law
    jets = formula(question.g, law.force_symbols(), [law.symbols()[law.pressure]] if law.pressure else [])
    compliance = np.linalg.inv(question.stiffness)
    stress, failed = question.trial.copy(), np.zeros(len(question.trial), dtype=bool)
    settings = {"maxiter": _STEPS} | ({} if options.tolerance is None else {"ftol": options.tolerance})
    for i, trial in enumerate(question.trial):
        others = [question.pressure[i : i + 1]] if law.pressure else []

        def gap(x: Array, others: list[Array] = others) -> float:
            return -float(jets(x[None], others, second=False)[0].value[0])

        def slope(x: Array, others: list[Array] = others) -> Array:
            gradient = jets(x[None], others, second=False)[0].gradient
            assert gradient is not None
            return -gradient[0]

        def way(x: Array, trial: Array = trial) -> tuple[float, Array]:
            pull = compliance @ (x - trial)
            return 0.5 * float((x - trial) @ pull), pull

        if gap(trial) < 0.0:
            held = {"type": "ineq", "fun": gap, "jac": slope}
            found = minimize(way, trial, jac=True, method="SLSQP", constraints=[held], options=settings)
            stress[i], failed[i] = found.x, not found.success
    return answered(question, stress, failed)


SLSQP = Method("scipy SLSQP", lambda question: None, _by_slsqp, PeerOptions)


def _bounded_by_planes(question: Increment) -> str | None:
    return "it takes sets that are bounded by planes" if planes(question) is None else None


def _planes(question: Increment) -> tuple[Array, Array]:
    """Normals (m, d) and offsets (N, m) of a question to which :func:`_bounded_by_planes` does not object."""
    found = planes(question)
    assert found is not None
    return found


def _by_qpax(question: Increment, options: PeerOptions) -> Solution:
    """qpax, interior points for quadratic programs in JAX, all points at once (K. Tracy and Z. Manchester 2024, arXiv 2406.11749).

    In doubles, which JAX has to be asked for.  What is compiled is compiled anew for each number of points.
    """
    import jax

    normals, offsets = _planes(question)
    compliance = np.linalg.inv(question.stiffness)
    with jax.enable_x64(True):
        point, done = _qpax_batch(options.tolerance)(compliance, -question.trial @ compliance, normals, offsets)
        return answered(question, np.array(point, dtype=np.float64), np.array(done) != 1)


@lru_cache(maxsize=4)
def _qpax_batch(tolerance: float | None) -> Callable[..., Any]:
    import jax
    import jax.numpy as jnp
    import qpax

    settings = {} if tolerance is None else {"solver_tol": tolerance}

    def one(quadratic: Any, linear: Any, normals: Any, offsets: Any) -> tuple[Any, Any]:
        d = linear.shape[0]
        point, _, _, _, done, _ = qpax.solve_qp(quadratic, linear, jnp.zeros((0, d)), jnp.zeros(0), normals, offsets, **settings)
        return point, done

    batched: Callable[..., Any] = jax.jit(jax.vmap(one, in_axes=(None, 0, None, 0)))
    return batched


QPAX = Method("qpax", _bounded_by_planes, _by_qpax, PeerOptions)


def _by_proxqp(question: Increment, options: PeerOptions) -> Solution:
    """ProxQP, an augmented Lagrangian for quadratic programs, all points in parallel.

    Source: A. Bambade et al. (2022), Robotics: Science and Systems.  Its dense back end, on every core that may be used; setting up the
    programs from Python is part of the time.  By default it stops without a look at the duality gap; where a tolerance is given, the
    gap has to meet it too.
    """
    from proxsuite import proxqp

    normals, offsets = _planes(question)
    n, d = question.trial.shape
    compliance, count = np.linalg.inv(question.stiffness), len(normals)
    linear, below = -question.trial @ compliance, np.full(count, -np.inf)
    stress, failed = np.empty((n, d)), np.zeros(n, dtype=bool)
    for start in range(0, n, _BLOCK):
        block = range(start, min(start + _BLOCK, n))
        programs = proxqp.dense.BatchQP(len(block))
        for i in block:
            program = programs.init_qp_in_place(d, 0, count)
            if options.tolerance is not None:
                program.settings.eps_abs = program.settings.eps_duality_gap_abs = options.tolerance
                program.settings.check_duality_gap = True
            program.init(compliance, linear[i], None, None, normals, below, offsets[i])
        proxqp.dense.solve_in_parallel(programs, cores())
        for i in block:
            results = programs.get(i - start).results
            stress[i], failed[i] = results.x, results.info.status != proxqp.PROXQP_SOLVED
    return answered(question, stress, failed)


PROXQP = Method("proxqp", _bounded_by_planes, _by_proxqp, PeerOptions)


def _differences(s: Array) -> Array:
    return np.abs(s - np.roll(s, -1, axis=1))


def _power_mean(s: Array, a: float) -> Array:
    return np.asarray((_differences(s) ** a).sum(axis=1) / 2.0) ** (1.0 / a)


def _surface(question: Increment) -> tuple[str, float, float] | None:
    """The surface of jaxmat that the law is, its exponent (0 for none) and the yield stress; None for no such surface."""
    law = question.law
    return None if len(law.forces) != 3 or law.pressure is not None else _surface_of(question.g, law.force_symbols())


@lru_cache(maxsize=64)
def _surface_of(formula: sp.Expr, forces: tuple[sp.Symbol, ...]) -> tuple[str, float, float] | None:
    """Looked for once a law, and not where the routine is timed."""
    g = compiled(formula, forces)
    limit = -float(g(0.0, 0.0, 0.0))
    if not limit > 0.0:
        return None
    stresses = np.random.default_rng(7).normal(size=(60, 3)) * limit
    values = g(*stresses.T) + limit
    roots = {float(1 / node.exp) for node in formula.atoms(sp.Pow) if node.exp.is_Rational and 0 < node.exp < 1}
    known: list[tuple[str, float, Array]] = [
        ("vonMises", 0.0, _power_mean(stresses, 2.0)),
        ("Tresca", 0.0, _differences(stresses).max(axis=1)),
        *(("Hosford", a, _power_mean(stresses, a)) for a in sorted(roots)),
    ]
    for name, a, equivalent in known:
        if np.abs(values - equivalent).max() <= _SAME * np.abs(equivalent).max():
            return name, a, limit
    return None


def _moduli(stiffness: Array) -> tuple[float, float] | None:
    """Young's modulus and Poisson's number of k = 2 mu I + lambda 1 1^T, else None."""
    twice_mu, lame = stiffness[0, 0] - stiffness[0, 1], stiffness[0, 1]
    if not np.array_equal(stiffness, twice_mu * np.eye(3) + lame):
        return None
    mu = twice_mu / 2.0
    return float(mu * (3.0 * lame + 2.0 * mu) / (lame + mu)), float(lame / (2.0 * (lame + mu)))


def _has_surface(question: Increment) -> str | None:
    if _surface(question) is None:
        return "its surfaces in principal stresses are those of von Mises, Tresca and Hosford"
    if _moduli(question.stiffness) is None:
        return 'its elasticity is isotropic, give --stiffness "1 1 1"'
    return None


def _by_jaxmat(question: Increment, options: PeerOptions) -> Solution:
    """jaxmat, return mapping of materials in JAX, all points at once: the yield surfaces that it has, under isotropic elasticity.

    The law is held to the surface by its values: g + Y = sigma_eq(s1, s2, s3) at many stresses, Y = -g(0).  One step from a stress-free
    state with the strain k^-1 trial, k = 2 mu I + lambda 1 1^T on principal stresses, ends at the closest point (associated flow, no
    hardening).  In doubles, and with the tolerance that jaxmat has; what is compiled is compiled anew for each number of points.
    """
    if options.tolerance is not None:
        raise InputError("jaxmat is compiled once a process, with its own tolerance", where="tolerance", remedy="remove it")
    surface, moduli = _surface(question), _moduli(question.stiffness)
    assert surface is not None and moduli is not None  # as applies has it
    import jax
    import jax.numpy as jnp
    from jaxmat.tensors import SymmetricTensor2

    n = len(question.trial)
    strain, axes = np.zeros((n, 3, 3)), np.arange(3)
    strain[:, axes, axes] = np.linalg.solve(question.stiffness, question.trial.T).T
    with jax.enable_x64(True):
        material, update = _material(*surface, *moduli)
        try:
            tensor, _ = update(SymmetricTensor2(tensor=jnp.asarray(strain)), material.init_state(n), 0.0)
        except RuntimeError as fault:  # of one point, and there is no answer to any
            raise ArithmeticError(_said(fault)) from None
        stress = np.array(tensor.tensor, dtype=np.float64)[:, axes, axes]
    return answered(question, stress, np.zeros(n, dtype=bool))


def _said(fault: RuntimeError) -> str:
    """The sentence of an error, which stands among the stacks inside and outside of what was compiled."""
    lines = [line for line in str(fault).splitlines() if line.startswith("equinox.EquinoxRuntimeError: ")]
    return (lines or [str(fault)])[-1].removeprefix("equinox.EquinoxRuntimeError: ").partition(". ")[0]


@lru_cache(maxsize=4)
def _material(name: str, a: float, limit: float, young: float, poisson: float) -> tuple[Any, Callable[..., Any]]:
    import equinox as eqx
    import jaxmat.materials as jm

    elasticity = jm.LinearElasticIsotropic(E=young, nu=poisson)
    constant = jm.VoceHardening(sig0=limit, sigu=limit, b=0.0)
    if name == "vonMises":  # it has a routine of its own, with one unknown
        material = jm.vonMisesIsotropicHardening(elasticity=elasticity, yield_stress=constant)
    else:
        surface = jm.Hosford(a=a) if name == "Hosford" else jm.Tresca()
        material = jm.GeneralIsotropicHardening(elasticity=elasticity, yield_stress=constant, plastic_surface=surface)
    return material, eqx.filter_jit(eqx.filter_vmap(material.constitutive_update, in_axes=(0, 0, None)))


JAXMAT = Method("jaxmat", _has_surface, _by_jaxmat, PeerOptions)


@dataclass(frozen=True)
class Peer:
    """Another program, under its method's name in tables; ``package`` is what it imports, and what pip installs."""

    method: Method[PeerOptions]
    package: str

    @property
    def missing(self) -> str | None:
        """What to install, None where it is there."""
        return None if find_spec(self.package) else f"not installed, pip install {self.package}"


PEERS = (Peer(SLSQP, "scipy"), Peer(JAXMAT, "jaxmat"), Peer(QPAX, "qpax"), Peer(PROXQP, "proxsuite"))
