! PROPS: the stiffness row by row, then the parameters; the stress in the order {order}, shear strains those of engineers.
! SSE and SPD are increased.  Where the increment is not solved PNEWDT asks for half the step.  Where its tangent alone is not
! known (status 5) the answer stands, and the tangent is the stiffness, as where nothing slips.
{head}
  integer, parameter :: place({d}) = [{places}]
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
end subroutine
