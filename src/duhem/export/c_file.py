"""One law's increment as one C99 file that needs nothing but the mathematical library."""

from __future__ import annotations

from duhem.errors import InputError
from duhem.export.c_file import header, identifier
from duhem.export.routine import Routine, routine
from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification

__all__ = ["c_file", "exported"]

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
