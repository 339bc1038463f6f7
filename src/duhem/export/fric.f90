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
end subroutine
