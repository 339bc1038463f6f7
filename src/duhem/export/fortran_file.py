"""What calls the C file from Fortran: a module with its interface, and a subroutine as finite-element programs call them.

The subroutines have the arguments of FRIC and UMAT in their order (Abaqus User Subroutines Reference Guide); no file of Abaqus is
needed to compile them.
"""

from __future__ import annotations

from collections.abc import Sequence

from duhem.export.c_file import exported, header, identifier
from duhem.law.formula_law import Criterion
from duhem.proof.verification import Verification

__all__ = ["UMAT_HEAD", "fortran_file", "fortran_text", "places"]

_ABAQUS = ("xx", "yy", "zz", "xy", "xz", "yz")  # its order of the components of a stress

_MODULE = """\
module {name}_law
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  private
  public :: {name}_increment
  interface
    function {name}_increment(trial, pressure, stiffness, parameters, stress, slip, dissipation, tangent) &
        bind(c, name="{name}_increment") result(status)
      import :: c_double, c_int
      real(c_double), intent(in) :: trial({d}), stiffness({d}, {d}), parameters(*)
      real(c_double), value :: pressure
      real(c_double), intent(out) :: stress({d}), slip({d}), dissipation, tangent({d}, {d})
      integer(c_int) :: status
    end function
  end interface
end module"""

_FRIC = """\
! PROPS: the stiffness row by row, then the parameters.  PRESS is above 0 in compression; where it is not, nothing is carried.
! TAU in the order {order}.  DDTDDP is taken by differences.
! Where the increment is not solved PNEWDT asks for half the step.  Where its tangent alone is not known (status 5) the answer
! stands, and the tangent is the stiffness, as where nothing slips.
subroutine fric(lm, tau, ddtddg, ddtddp, dslip, sed, sfd, ddtddt, pnewdt, statev, dgam, taulm, press, dpress, ddpddh, slip, &
    kstep, kinc, time, dtime, noel, ciname, slname, msname, npt, node, npatch, coords, rcoord, drot, temp, predef, nfdir, mcrd, &
    npred, nstatv, chrlnm, props, nprops)
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use {name}_law, only: {name}_increment
  implicit none
  integer :: lm, kstep, kinc, noel, npt, node, npatch, nfdir, mcrd, npred, nstatv, nprops
  character(len=80) :: ciname, slname, msname, chrlnm
  real(c_double) :: tau(nfdir), ddtddg(nfdir, nfdir), ddtddp(nfdir), dslip(nfdir), sed, sfd, ddtddt(nfdir, 2), pnewdt, statev(*), &
    dgam(nfdir), taulm(nfdir), press, dpress, ddpddh, slip(nfdir), time(2), dtime, coords(mcrd), rcoord(mcrd), drot(2, 2), &
    temp(2), predef(2, *), props(nprops)
  real(c_double) :: k({d}, {d}), trial({d}), found({d}), step({d}), tangent({d}, {d}), &
    low({d}), high({d}), unused({d}), slope({d}, {d}), loss, h
  integer(c_int) :: status, below, above
  if (nfdir /= {d} .or. nprops < {props}) error stop "{name}: {d} directions, {props} numbers in PROPS"
  lm = 0
  k = reshape(props(1:{square}), [{d}, {d}])
  trial = tau + matmul(k, dgam)
  ddtddt = 0
  if (press <= 0) then
    tau = 0
    ddtddg = 0
    ddtddp = 0
    dslip = dgam
    sfd = 0
    return
  end if
  status = {name}_increment(trial, -press, k, props({first}:), found, step, loss, tangent)
  if (status > 1 .and. status /= 5) then
    pnewdt = 0.5_c_double
    return
  end if
  tau = found
  dslip = step
  sfd = loss
  ddtddg = tangent
  if (status == 5) ddtddg = k
  ddtddp = 0
  h = 1.0e-6_c_double * press
  below = {name}_increment(trial, h - press, k, props({first}:), low, unused, loss, slope)
  above = {name}_increment(trial, -h - press, k, props({first}:), high, unused, loss, slope)
  if ((below <= 1 .or. below == 5) .and. (above <= 1 .or. above == 5)) ddtddp = (high - low) / (2 * h)
end subroutine"""

UMAT_HEAD = """\
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  use {name}_law, only: {name}_{entry}
  implicit none
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  character(len=80) :: cmname
  real(c_double) :: stress(ntens), statev(*), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt, &
    stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), pnewdt, &
    celent, dfgrd0(3, 3), dfgrd1(3, 3)
"""
"""The arguments of UMAT, as Abaqus declares them, for a routine NAME_ENTRY."""

_UMAT = """\
! PROPS: the stiffness row by row, then the parameters; the stress in the order {order}, shear strains those of engineers.
! SSE and SPD are increased.  Where the increment is not solved PNEWDT asks for half the step.  Where its tangent alone is not
! known (status 5) the answer stands, and the tangent is the stiffness, as where nothing slips.
{head}  integer, parameter :: place({d}) = [{places}]
  real(c_double) :: k({d}, {d}), trial({d}), found({d}), slip({d}), tangent({d}, {d}), loss
  integer(c_int) :: status
  if (ntens /= {d} .or. nprops < {props}) error stop "{name}: {d} components, {props} numbers in PROPS"
  k = reshape(props(1:{square}), [{d}, {d}])
  trial = stress + matmul(k, dstran)
  status = {name}_increment(trial(place), 0.0_c_double, k(place, place), props({first}:), found, slip, loss, tangent)
  if (status > 1 .and. status /= 5) then
    pnewdt = 0.5_c_double
    return
  end if
  ddsdde(place, place) = tangent
  if (status == 5) ddsdde = k
  sse = sse + 0.5_c_double * (dot_product(stress(place) + found, dstran(place) - slip))
  spd = spd + loss
  stress(place) = found
end subroutine"""


def fortran_file(verification: Verification) -> str:
    """The Fortran of the law that was verified, to be linked with its C file.  Errors as :func:`duhem.export.c_file.exported`."""
    law, made = exported(verification)
    d, name = len(law.forces), identifier(law.name)
    where = places(law, law.forces)
    order = [law.forces[where.index(i)] for i in range(d)]
    wrapper = (_FRIC if law.pressure else _UMAT).format(
        head=UMAT_HEAD.format(name=name, entry="increment"),
        name=name,
        d=d,
        square=d * d,
        first=d * d + 1,
        props=d * d + len(made.parameters),
        places=", ".join(str(place + 1) for place in where),
        order=", ".join(order),
    )
    return fortran_text(law, header(verification, law, made.parameters), _MODULE.format(name=name, d=d), "", wrapper)


def fortran_text(law: Criterion, head: Sequence[str], *text: str) -> str:
    """The file of a routine: its head as a comment, and the rest."""
    first = f"To be linked with the C file of the same law (duhem export {law.name} --to c), which it calls."
    return "\n".join([*(f"! {line}".rstrip() for line in (first, "", *head)), "", *text]) + "\n"


def places(law: Criterion, forces: Sequence[str]) -> list[int]:
    """Where the caller has each of the forces that it knows."""
    if law.stress is None or law.stress.kind == "principal":
        return list(range(len(forces)))
    ends = [component.removeprefix(f"{law.stress.name}_") for component in forces]
    return [[end for end in _ABAQUS if end in ends].index(end) for end in ends]
