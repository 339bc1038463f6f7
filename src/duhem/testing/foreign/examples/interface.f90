! Frictional interface with cohesion as a UMAT: one normal component (NDI = 1, tension positive) and two shears (NSHR = 2).
!
!     gfortran -cpp -O2 -shared -fPIC interface.f90 -o interface.so
!
!     from duhem.testing import conformance
!     from duhem.testing.foreign import umat
!     material = umat("interface.so", [kn, kt, mu, c], [[kn, 0, 0], [0, kt, 0], [0, 0, kt]], variables=[0.0], direct=1)
!     print(conformance(None, material))
!
! PROPS: normal and tangential stiffness, coefficient of friction, cohesion.  |shear| <= c + mu max(-normal, 0); slip along the
! interface, so that the flow is not normal and the tangent not symmetric.  STATEV(1) is the accumulated slip.  SSE and SPD are
! increased.  -DBUG=1 to 5 puts in one of five classic bugs.
#ifndef BUG
#define BUG 0
#endif
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, jstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, jstep(4), kinc
  character(len=80) :: cmname
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt, &
    stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), pnewdt, &
    celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: kn, kt, mu, c, limit, size, slip, way(2)
  integer :: i
#if BUG == 1
  real(dp), save :: worn = 0  ! a local variable that is kept from call to call
#endif

  if (ntens /= 3 .or. nprops /= 4) error stop "interface: 3 components, 4 numbers in PROPS"
  kn = props(1)
  kt = props(2)
  mu = props(3)
  c = props(4)
#if BUG == 2
  stress = 0  ! the stress at the beginning of the step forgotten
#endif
  stress(1) = stress(1) + kn * dstran(1)
  stress(2:3) = stress(2:3) + kt * dstran(2:3)
  limit = c + mu * max(-stress(1), 0.0_dp)
#if BUG == 1
  limit = limit / (1 + 0.1_dp * worn)
#endif
  size = norm2(stress(2:3))
  ddsdde = 0
  ddsdde(1, 1) = kn
  if (size <= limit .and. limit > 0) then  ! with nothing to hold it, an interface has no stiffness
    ddsdde(2, 2) = kt
    ddsdde(3, 3) = kt
  else
    size = max(size, tiny(size))
    way = stress(2:3) / size
    slip = (norm2(stress(2:3)) - limit) / kt
#if BUG == 1
    worn = worn + 1
#endif
    stress(2:3) = limit * way
    statev(1) = statev(1) + slip
    do i = 2, 3
      ddsdde(i, 2:3) = -kt * limit / size * way(i - 1) * way
      ddsdde(i, i) = ddsdde(i, i) + kt * limit / size
#if BUG != 3  /* 3: the coupling to the normal component left out, which makes the tangent symmetric */
      if (stress(1) < 0) ddsdde(i, 1) = -mu * kn * way(i - 1)
#endif
    end do
#if BUG == 4
    spd = spd - limit * slip  ! the dissipation with the sign of a work done on the surroundings
#else
    spd = spd + limit * slip
#endif
  end if
#if BUG == 5
  sse = stress(1)**2 / kn + dot_product(stress(2:3), stress(2:3)) / kt  ! the half forgotten
#else
  sse = (stress(1)**2 / kn + dot_product(stress(2:3), stress(2:3)) / kt) / 2
#endif
end subroutine
