"""A step of a law with a state as one C99 file, and the UMAT that calls it."""

from __future__ import annotations

from duhem.errors import InputError
from duhem.export.c_file import c_text, check_convex, described, identifier
from duhem.export.fortran_file import UMAT_HEAD, fortran_text, places
from duhem.export.state_routine import state_law, state_routine
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed
from duhem.path.state_step import KKT
from duhem.proof.verification import Verification

__all__ = ["state_c_file", "state_fortran_file"]

_STEP = (
    "The routine computes one implicit step.  before and after are the observables at its ends, dt is its time, and temperature and "
    "pressure are those at its end.  stress is the derivative of psi by the observables, and state has the internal variables, which the "
    "routine replaces if it solves the step.  dissipation is that of the step, and tangent = d stress/d after.  Arguments that the law "
    "does not need may be 0."
)
_STATUS = (
    "0  nothing flows",
    "1  something flows",
    f"2  not solved to {KKT:g} of the terms, or a variable comes to a bound of its range: take a shorter step",
    "3  invalid input: a number that is not finite, a time below 0, a pressure above 0, or a parameter, pressure or variable outside its "
    "range",
    "5  solved, but the step has no tangent",
    "With status 2 and 3 all results are nan and the state is as before.  With status 5 a part of the tangent is nan.",
)
_LIMITS = (
    "The energy contains the stiffness.  The state is that of one point: the routine keeps nothing between calls.",
    "The tangent is not symmetric if the law has a flow of its own.",
    "Compile without -ffast-math, because the code uses infinities and nan.",
)


def _head(verification: Verification, law: Criterion, parameters: tuple[str, ...]) -> list[str]:
    own = state_law(law)
    seen, inner = own.names[: own.observables], own.names[own.observables : own.observables + own.internal]
    arrays = (
        f"before[{len(seen)}] and after[{len(seen)}]: {', '.join(seen)}; stress[{len(seen)}]: {', '.join(prescribed(law))}; "
        f"state[{len(inner)}]: {', '.join(inner)}; tangent[{len(seen) ** 2}] row by row"
    )
    return described(verification, law, parameters, _STEP, arrays, _STATUS, _LIMITS)


def state_c_file(verification: Verification) -> str:
    """The C file of the law that was verified; its one function with a name outside is NAME_step.  InputError for what has no routine."""
    law = _law(verification)
    made, own, name = state_routine(law), state_law(law), identifier(law.name)
    o, i = own.observables, own.internal
    signature = (
        f"int {name}_step(const double before[{o}], const double after[{o}], double pressure, double temperature, double dt,\n"
        f"    const double parameters[], double state[{i}], double stress[{o}], double *psi, double *dissipation, double tangent[{o * o}])"
    )
    call = "step(before, after, pressure, temperature, dt, parameters, state, stress, psi, dissipation, tangent)"
    return c_text(_head(verification, law, made.parameters), made, signature, call)


_UMAT = """\
module {name}_law
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: {name}_step
  interface
    function {name}_step( &
        before, after, pressure, temperature, dt, parameters, state, stress, psi, dissipation, tangent) &
        bind(c, name="{name}_step") result(status)
      import :: c_double, c_int
      real(c_double), intent(in) :: before({o}), after({o}), parameters(*)
      real(c_double), value :: pressure, temperature, dt
      real(c_double), intent(inout) :: state({i})
      real(c_double), intent(out) :: stress({o}), psi, dissipation, tangent({o}, {o})
      integer(c_int) :: status
    end function
  end interface
end module

! PROPS: the parameters.  STATEV: {inner}, 0 at the start unless the range of a variable excludes it.
! Strains in the order {order}, shear strains those of engineers.  SSE is psi, and SPD is increased.
! Where the step is not solved PNEWDT asks for half of it.
{head}  integer, parameter :: place({o}) = [{places}]
  real(c_double) :: state({i}), found({o}), slope({o}, {o}), psi, loss
  integer(c_int) :: status
  if (ntens /= {o} .or. nstatv < {i} .or. nprops < {props}) &
    error stop "{name}: {o} components, {i} numbers in STATEV, {props} in PROPS"
  state = statev(1:{i})
  status = {name}_step( &
    stran(place), stran(place) + dstran(place), 0.0_c_double, temp + dtemp, dtime, props, state, found, psi, loss, slope)
  if (status > 1) then
    pnewdt = 0.5_c_double
    return
  end if
  statev(1:{i}) = state
  stress(place) = found
  ddsdde(place, place) = transpose(slope)
  sse = psi
  spd = spd + loss
end subroutine"""


def state_fortran_file(verification: Verification) -> str:
    """The UMAT of the law that was verified, to be linked with its C file.  InputError for a law with a pressure, or without a routine."""
    law = _law(verification)
    if law.pressure is not None:
        what = f"{law.name} has a state and a pressure, and FRIC does not give the displacement of which its stress is a function"
        raise InputError(what, where="--to fortran", remedy="use --to c, and call NAME_step from your own routine")
    made, own, name = state_routine(law), state_law(law), identifier(law.name)
    forces = prescribed(law)
    where = places(law, forces)
    text = _UMAT.format(
        head=UMAT_HEAD.format(name=name, entry="step"),
        name=name,
        o=own.observables,
        i=own.internal,
        inner=", ".join(own.names[own.observables : own.observables + own.internal]),
        order=", ".join(forces[where.index(k)] for k in range(len(forces))),
        places=", ".join(str(place + 1) for place in where),
        props=len(made.parameters),
    )
    return fortran_text(law, _head(verification, law, made.parameters), text)


def _law(verification: Verification) -> Criterion:
    law = verification.criterion
    assert isinstance(law, Criterion)  # a boundary curve has no variables
    check_convex(verification)
    return law
