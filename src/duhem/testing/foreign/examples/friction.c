/* Coulomb friction with an isotropic stiffness: the closest point of a disk of radius -mu sigma_n, for one increment.
 *
 *     cc -std=c99 -O2 -shared -fPIC friction.c -o friction.so -lm
 *
 *     from duhem.testing import conformance, decades
 *     from duhem.testing.foreign import shared_library
 *     update = shared_library("friction.so", "int friction(const double *trial, double pressure, const double *stiffness, "
 *                             "double mu, double *stress, double *slip, double *tangent)")
 *     print(conformance("coulomb", update, stiffness=decades(-3, 3)))                      # against the law
 *     print(conformance(None, update, {"mu": 0.3}, stiffness=[2.0, 2.0], pressure=-1.0))   # without one
 *
 * -DBUG=1 to 5 puts in one of five classic bugs, to see what is said of them. */

#include <math.h>

#ifndef BUG
#define BUG 0
#endif

int friction(const double *trial, double pressure, const double *stiffness, double mu, double *stress, double *slip, double *tangent) {
    const double k = stiffness[0], size = hypot(trial[0], trial[1]);
    double limit = -mu * pressure;
#if BUG == 1 /* the sign convention of the pressure mistaken: no contact, whatever the pressure */
    limit = pressure > 0 ? mu * pressure : 0;
#elif BUG == 2 /* something kept from call to call: the friction weakens with what slipped elsewhere */
    static double worn = 0;
    limit /= 1 + 0.1 * worn;
#endif
    for (int i = 0; i < 4; i++) tangent[i] = i % 3 ? 0 : k;
    if (size <= limit) {
        for (int i = 0; i < 2; i++) stress[i] = trial[i], slip[i] = 0;
        return 0;
    }
#if BUG == 2
    worn += 1;
#endif
    for (int i = 0; i < 2; i++) {
        const double n = trial[i] / size;
        stress[i] = limit * n;
#if BUG == 3 /* the slip drives, instead of resists */
        stress[i] = -limit * n;
#endif
        slip[i] = (trial[i] - stress[i]) / k;
#if BUG == 4 /* the slip of the trial stress: the elastic part is not taken off */
        slip[i] = trial[i] / k;
#endif
    }
#if BUG != 5 /* 5: the tangent of sticking, always */
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) tangent[2 * i + j] = k * limit / size * ((i == j) - trial[i] * trial[j] / (size * size));
#if BUG == 3
    for (int i = 0; i < 4; i++) tangent[i] = -tangent[i];
#endif
#endif
    return 0;
}
