"""One law's increment, or its step where it has a state, as one C99 file that needs nothing but the mathematical library.

A Fortran file calls it: a module with its interface, and a subroutine as finite-element programs call them, with the arguments of FRIC
and UMAT in their order (Abaqus User Subroutines Reference Guide).  No file of Abaqus is needed to compile it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from duhem.errors import InputError
from duhem.export.routine import Routine, routine
from duhem.export.state_routine import state_law, state_routine
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed
from duhem.path.state_step import KKT
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification
from duhem.show.page import PAGE
from duhem.version import __version__

__all__ = ["c_file", "c_functions_of", "fortran_file", "identifier", "places"]

# -- the head: the law, its arguments, what was proved of it, and the limits of the routine ----------------------------

_LONGEST = 40  # Fortran's names have 63 characters, endings included


def identifier(law: str) -> str:
    """The law's name as C and Fortran can have it."""
    name = re.sub(r"[^a-z0-9]+", "_", law.lower()).strip("_")[:_LONGEST]
    return name if name[:1].isalpha() else f"law_{name}".rstrip("_")


def _header(verification: Verification, law: Criterion, parameters: Sequence[str]) -> list[str]:
    """Lines as wide as a page, none of which can end a comment; ``parameters`` are those that are arguments."""
    if law.variables:
        own = state_law(law)
        seen, inner = own.names[: own.observables], own.names[own.observables : own.observables + own.internal]
        arrays = (
            f"before[{len(seen)}] and after[{len(seen)}]: {', '.join(seen)}; stress[{len(seen)}]: {', '.join(prescribed(law))}; "
            f"state[{len(inner)}]: {', '.join(inner)}; tangent[{len(seen) ** 2}] row by row"
        )
        what, status, limits = _STEP, _STEP_STATUS, _STEP_LIMITS
    else:
        d = len(law.forces)
        arrays = (
            f"trial[{d}], stress[{d}] and slip[{d}] in the order of the forces; stiffness[{d * d}] symmetric positive definite, "
            f"tangent[{d * d}] symmetric, both row by row"
        )
        what, status, limits = _INCREMENT, _STATUS, _LIMITS
    fixed = [f"{name} {domain.describe()}" for name, domain in law.parameters.items() if domain.value is not None]
    places = [f"parameters[{i}] is {law.parameters[name].stated(name)}" for i, name in enumerate(parameters)]
    set_ = f"Phi* = {formula(law.g)}" if law.viscous else f"K = {{{formula(law.g)} <= 0}}"
    lines = [
        *_said(f"{law.name}: {law.summary}" if law.summary else law.name),
        *_said(set_, "potential" if law.viscous else "criterion"),
        *_said("" if law.energy is None else formula(law.energy), "psi"),
        *_said(law.source, "source"),
        *_said(", ".join(law.forces), "forces"),
        *_said(f"{law.pressure} <= 0 in compression" if law.pressure else "none; the routine ignores this argument", "pressure"),
        *_said("; ".join(fixed), "fixed"),
        *_said("; ".join(places) or "none; you may pass a null pointer", "arguments"),
        *_said(", ".join(formula(c) for c in law.constraints), "constraints"),
        *_said(", ".join(own.stated(name) for name, own in law.domain.items()), "ranges"),
        "",
        *_said(what),
        *_said("one coherent system, for example Pa, m, Pa/m and J/m^2", "units"),
        *_said(arrays, "arrays"),
        "",
        *_said("Status returned:"),
        *(line for text in status for line in _said(text, "")),
        "",
        *_said(f"Verdicts of duhem {__version__}:"),
        *(line for result in verification.results for line in _said(_verdict(result.verdict, result.trust, result.scope), result.claim)),
        *_said(f"{verification.certificate()['sha256']} (of the law as fixed here: duhem verify LAW --certificate FILE)", "sha256"),
        "",
        *_said("Limits:"),
        *(line for text in limits for line in _said(text, "")),
    ]
    return [line.rstrip() for line in lines]


_INCREMENT = (
    "The routine computes one slip increment.  K is the set of admissible stresses.  trial = k (u - u_in) is the stress without further "
    "slip, with the stiffness k, the displacement u and the slip u_in.  stress is the point of K that is closest to trial, where k^-1 "
    "measures the distance.  slip = k^-1 (trial - stress) is the increment of u_in, dissipation = stress . slip, tangent = d stress/d u."
)
_STATUS: tuple[str, ...] = (
    "0  stick: stress = trial",
    "1  slip",
    "2  not solved: the routine found no point that fulfils the optimality conditions.  It starts at zero stress, or at another point "
    "inside K if zero stress is not inside.  At the tip of a round cone it may fail, more often if the cone is thin or has more than "
    "three forces.  duhem.project has a more general search",
    "3  invalid input: a number that is not finite, a stiffness that is not symmetric positive definite, a pressure above 0, "
    "or a parameter or pressure outside its range",
    "4  solved, but the stress lies outside a range that the law declares for it",
    "5  slip, but the tangent is not known: degenerate corner (the active surfaces are not unique), a root in the formula is 0 there, or "
    "K has an edge there where two eigenvalues are equal",
    "With status 2 and 3 all results are nan.  With status 5 only the tangent is nan; with status 4 it may be nan.  Where the stress has "
    "no derivative, the routine returns one of several possible tangents.",
)
_LIMITS: tuple[str, ...] = (
    "The routine checks the optimality conditions in double precision only.  duhem.project also checks every answer in more digits.",
    "The routine does not search for points that Newton's method does not find.  They have the status 2.",
    "The routine does not compute d stress/d pressure.",
    "Compile without -ffast-math, because the code uses infinities and nan.",
)
_STEP = (
    "The routine computes one implicit step.  before and after are the observables at its ends, dt is its time, and temperature and "
    "pressure are those at its end.  stress is the derivative of psi by the observables, and state has the internal variables, which the "
    "routine replaces if it solves the step.  dissipation is that of the step, and tangent = d stress/d after.  Arguments that the law "
    "does not need may be 0."
)
_STEP_STATUS: tuple[str, ...] = (
    "0  nothing flows",
    "1  something flows",
    f"2  not solved to {KKT:g} of the terms, or a variable comes to a bound of its range: take a shorter step",
    "3  invalid input: a number that is not finite, a time below 0, a pressure above 0, or a parameter, pressure or variable outside its "
    "range",
    "5  solved, but the step has no tangent",
    "With status 2 and 3 all results are nan and the state is as before.  With status 5 a part of the tangent is nan.",
)
_STEP_LIMITS: tuple[str, ...] = (
    "The energy contains the stiffness.  The state is that of one point: the routine keeps nothing between calls.",
    "The tangent is not symmetric if the law has a flow of its own.",
    "Compile without -ffast-math, because the code uses infinities and nan.",
)


def _verdict(verdict: str, trust: str | None, scope: str) -> str:
    return f"{verdict.replace('_', ' ')}{f', {trust}' if trust else ''}: {scope}"


def _said(text: str, title: str | None = None) -> list[str]:
    """A sentence beside its title, nothing where there is none; without what has a meaning in a comment."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    plain = re.sub(r"\?(?=\?)", "? ", plain.replace("*/", "* /").replace("/*", "/ *"))
    first = "" if title is None else f"  {title:<13}"
    return PAGE.hanging(plain, first, " " * len(first)) if text else []


# -- the C file --------------------------------------------------------------------------------------------------------

_GUARD = """\
#ifdef __FAST_MATH__
#error "infinities and nan mean something here: compile without -ffast-math"
#endif

#include <float.h>
#include <math.h>"""


def c_functions_of(law: Criterion) -> Routine:
    """The increment of the law, or its step where it has a state, as C functions.  InputError for a law that has none."""
    return state_routine(law) if law.variables else routine(law)


def _exported(verification: Verification) -> tuple[Criterion, Routine]:
    """The law, and its increment or step as C functions.

    InputError where K is not proved to be convex: the conditions of the optimum that are tested hold at other points too then.
    """
    law = verification.criterion
    if not isinstance(law, Criterion):
        raise InputError(f"{law.name} is a boundary curve and has no formula g", where="law", remedy="export a law with a formula g")
    made = c_functions_of(law)
    if (found := verification["convexity"].verdict) is not Verdict.PROVED:
        remedy = "use --set to choose parameters for which K is convex; duhem verify LAW gives details"
        raise InputError(
            f"convexity is {found.replace('_', ' ')}, but the routine is right only for a convex K",
            where=law.name,
            remedy=remedy,
        )
    return law, made


def c_file(verification: Verification) -> str:
    """The C file of the law that was verified; its one function with a name outside is NAME_increment, or NAME_step of a law with a state.

    InputError for a law that has no routine, and where K is not proved to be convex.
    """
    law, made = _exported(verification)
    d, name = len(law.forces), identifier(law.name)
    if law.variables:
        own = state_law(law)
        o, i = own.observables, own.internal
        signature = (
            f"int {name}_step(const double before[{o}], const double after[{o}], double pressure, double temperature, double dt,\n"
            f"    const double parameters[], double state[{i}], double stress[{o}], double *psi, double *dissipation, "
            f"double tangent[{o * o}])"
        )
        call = "step(before, after, pressure, temperature, dt, parameters, state, stress, psi, dissipation, tangent)"
    else:
        signature = (
            f"int {name}_increment(const double trial[{d}], double pressure, const double stiffness[{d * d}], const double parameters[],\n"
            f"    double stress[{d}], double slip[{d}], double *dissipation, double tangent[{d * d}])"
        )
        call = "increment(trial, pressure, stiffness, parameters, stress, slip, dissipation, tangent)"
    said = "\n".join(f" * {line}".rstrip() for line in _header(verification, law, made.parameters))
    whole = f"{signature};\n\n{signature}\n{{\n    return {call};\n}}"
    return "\n\n".join([f"/*\n{said}\n */", _GUARD, made.text, whole]) + "\n"


# -- the Fortran file --------------------------------------------------------------------------------------------------


_ABAQUS = ("xx", "yy", "zz", "xy", "xz", "yz")  # its order of the components of a stress


def fortran_file(verification: Verification) -> str:
    """The Fortran of the law that was verified, to be linked with its C file.

    Errors as :func:`c_file`, and InputError for a law with a state and a pressure.
    """
    law, made = _exported(verification)
    if law.variables and law.pressure is not None:
        what = f"{law.name} has a state and a pressure, and FRIC does not give the displacement of which its stress is a function"
        raise InputError(what, where="--to fortran", remedy="use --to c, and call NAME_step from your own routine")
    d, name = len(law.forces), identifier(law.name)
    forces = prescribed(law) if law.variables else law.forces
    where = places(law, forces)
    told = {
        "head": _fortran("umat_arguments", name=name, entry="step" if law.variables else "increment"),
        "name": name,
        "places": ", ".join(str(place + 1) for place in where),
        "order": ", ".join(forces[where.index(k)] for k in range(len(forces))),
    }
    if law.variables:
        own = state_law(law)
        o, i = own.observables, own.internal
        text = [_fortran("state_umat", **told, o=o, i=i, inner=", ".join(own.names[o : o + i]), props=len(made.parameters))]
    else:
        sizes = {"d": d, "square": d * d, "first": d * d + 1, "props": d * d + len(made.parameters)}
        text = [_fortran("law_module", name=name, d=d), "", _fortran("fric" if law.pressure else "umat", **told, **sizes)]
    first = f"To be linked with the C file of the same law (duhem export {law.name} --to c), which it calls."
    head = (first, "", *_header(verification, law, made.parameters))
    return "\n".join([*(f"! {line}".rstrip() for line in head), "", *text]) + "\n"


def _fortran(kind: str, **told: object) -> str:
    """The text of that kind that stands beside this module, with what is said of the law in its places."""
    return Path(__file__).with_name(f"{kind}.f90").read_text("utf-8").rstrip("\n").format(**told)


def places(law: Criterion, forces: Sequence[str]) -> list[int]:
    """Where the caller has each of the forces that it knows."""
    if law.stress is None or law.stress.kind == "principal":
        return list(range(len(forces)))
    ends = [component.removeprefix(f"{law.stress.name}_") for component in forces]
    return [[end for end in _ABAQUS if end in ends].index(end) for end in ends]
