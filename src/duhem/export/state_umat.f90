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
{head}
  integer, parameter :: place({o}) = [{places}]
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
end subroutine
