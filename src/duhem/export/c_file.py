"""One law's increment as one C99 file that needs nothing but the mathematical library, and what stands at the head of an exported file."""

from __future__ import annotations

import re
from collections.abc import Sequence

from duhem.errors import InputError
from duhem.export.routine import Routine, routine
from duhem.expression.text import formula
from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification
from duhem.show.page import PAGE
from duhem.version import __version__

__all__ = ["c_file", "exported", "header", "identifier"]

# -- the head: the law, its arguments, what was proved of it, and what the file leaves out ------------------------------

_LONGEST = 40  # Fortran's names have 63 characters, endings included


def identifier(law: str) -> str:
    """The law's name as C and Fortran can have it."""
    name = re.sub(r"[^a-z0-9]+", "_", law.lower()).strip("_")[:_LONGEST]
    return name if name[:1].isalpha() else f"law_{name}".rstrip("_")


def header(verification: Verification, law: Criterion, parameters: Sequence[str]) -> list[str]:
    """Lines as wide as a page, none of which can end a comment; ``parameters`` are those that are arguments."""
    fixed = [f"{name} {domain.describe()}" for name, domain in law.parameters.items() if domain.value is not None]
    places = [f"parameters[{i}] is {law.parameters[name].stated(name)}" for i, name in enumerate(parameters)]
    d = len(law.forces)
    lines = [
        *_said(f"{law.name}: {law.summary}" if law.summary else law.name),
        *_said(f"K = {{{formula(law.g)} <= 0}}", "criterion"),
        *_said(law.source, "source"),
        *_said(", ".join(law.forces), "forces"),
        *_said(f"{law.pressure} <= 0 in compression" if law.pressure else "none; the argument is not read", "pressure"),
        *_said("; ".join(fixed), "fixed"),
        *_said("; ".join(places) or "none; may be a null pointer", "arguments"),
        *_said(", ".join(formula(c) for c in law.constraints), "with"),
        *_said(", ".join(own.stated(name) for name, own in law.domain.items()), "ranges"),
        "",
        *_said(_INCREMENT),
        *_said("one coherent system, for example Pa, m, Pa/m and J/m^2", "units"),
        *_said(f"trial[{d}], stress[{d}] and slip[{d}] in the order of the forces; {_STIFFNESS.format(n=d * d)}", "arrays"),
        "",
        *_said("Status returned:"),
        *(line for text in _STATUS for line in _said(text, "")),
        "",
        *_said(f"Verdicts of duhem {__version__}:"),
        *(line for result in verification.results for line in _said(_verdict(result.verdict, result.trust, result.scope), result.claim)),
        *_said(f"{verification.certificate()['sha256']} (of the law as fixed here: duhem verify LAW --certificate FILE)", "sha256"),
        "",
        *_said("Left out:"),
        *(line for text in _LEFT_OUT for line in _said(text, "")),
    ]
    return [line.rstrip() for line in lines]


_INCREMENT = (
    "One slip increment: the stress of K that is nearest to trial = k (u - u_in) in the energy of the stiffness k, "
    "slip = k^-1 (trial - stress) its step of u_in, dissipation = stress . slip, tangent = d stress/d u."
)
_STIFFNESS = "stiffness[{n}] symmetric positive definite, tangent[{n}] symmetric, both row by row"
_STATUS = (
    "0  sticks: the trial is the answer",
    "1  slips",
    "2  not solved: no point was shown to be optimal.  The search begins at zero stress, or at a point inside K that it looks for where "
    "zero stress is none; where the stress is the tip of a cone that is round, it ends without one.  duhem.project has a more general "
    "search",
    "3  no question: a number that is not finite, a stiffness that is not symmetric positive definite, a pressure above 0, "
    "a parameter, or a pressure, outside its range",
    "4  solved, and the stress lies outside a range that the law declares for it",
    "5  slips, and the tangent is not known: more pieces meet at the stress than press, a root within the formula is 0 there, or K has an "
    "edge there where two eigenvalues are equal",
    "With 2 and 3 all results are nan, with 5 the tangent alone; with 4 it may be.  Where the stress has no derivative the "
    "tangent is one of several.",
)
_LEFT_OUT = (
    "the judge of duhem.project, which holds every answer against the formula in more digits: here the conditions of the optimum "
    "in doubles decide",
    "the search for points that Newton's method does not find: they have the status 2",
    "d stress/d pressure",
    "compile without -ffast-math: infinities and nan mean something here",
)


def _verdict(verdict: str, trust: str | None, scope: str) -> str:
    return f"{verdict.replace('_', ' ')}{f', {trust}' if trust else ''}: {scope}"


def _said(text: str, title: str | None = None) -> list[str]:
    """A sentence beside its title, nothing where there is none; without what has a meaning in a comment."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    plain = re.sub(r"\?(?=\?)", "? ", plain.replace("*/", "* /").replace("/*", "/ *"))
    first = "" if title is None else f"  {title:<13}"
    return PAGE.hanging(plain, first, " " * len(first)) if text else []


# -- the file -----------------------------------------------------------------------------------------------------------

_GUARD = """\
#ifdef __FAST_MATH__
#error "infinities and nan mean something here: compile without -ffast-math"
#endif

#include <float.h>
#include <math.h>"""


def exported(verification: Verification) -> tuple[Criterion, Routine]:
    """The law, and its increment as C functions.

    InputError where K is not proved to be convex: the conditions of the optimum that are tested hold at other points too then.
    """
    law = verification.criterion
    if not isinstance(law, Criterion):
        raise InputError(f"{law.name} is a boundary curve and has no formula g", where="law", remedy="export a law that has one")
    made = routine(law)
    if (found := verification["convexity"].verdict) is not Verdict.PROVED:
        remedy = "--set parameters to where it is; duhem verify LAW says more"
        raise InputError(
            f"convexity is {found.replace('_', ' ')}, and only of a convex K is the answer sure", where=law.name, remedy=remedy
        )
    return law, made


def c_file(verification: Verification) -> str:
    """The C file of the law that was verified; its one function with a name outside is NAME_increment.  Errors as :func:`exported`."""
    law, made = exported(verification)
    d, name = len(law.forces), identifier(law.name)
    signature = (
        f"int {name}_increment(const double trial[{d}], double pressure, const double stiffness[{d * d}], const double parameters[],\n"
        f"    double stress[{d}], double slip[{d}], double *dissipation, double tangent[{d * d}])"
    )
    comment = "\n".join(f" * {line}".rstrip() for line in header(verification, law, made.parameters))
    call = "return increment(trial, pressure, stiffness, parameters, stress, slip, dissipation, tangent);"
    whole = f"{signature};\n\n{signature}\n{{\n    {call}\n}}"
    return "\n\n".join([f"/*\n{comment}\n */", _GUARD, made.text, whole]) + "\n"
