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
end module
