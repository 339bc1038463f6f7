/* Von Mises plasticity with linear isotropic hardening in three dimensions, radial return, for one increment of strain.
 *
 *     cc -std=c99 -O2 -shared -fPIC mises.c -o mises.so -lm
 *
 *     from duhem.testing import conformance
 *     from duhem.testing.foreign import shared_material
 *     material = shared_material("mises.so", "int mises(const double *increment, double *stress, double *variables, "
 *         "double *stored, double *dissipated, double *tangent, double duration, double E, double nu, double yield, double H)",
 *         stiffness, variables=[0.0], parameters={"E": 2.1e11, "nu": 0.3, "yield": 2.5e8, "H": 1e9})
 *     print(conformance(None, material))
 *
 * Components 11, 22, 33, 12, 13, 23, shear strains those of engineers; the state is the accumulated plastic strain p.  Stored is
 * what is elastic, H p^2/2 included; dissipated is yield p.   -DBUG=1 to 5 puts in one of five classic bugs. */

#include <math.h>

#ifndef BUG
#define BUG 0
#endif

static double energy(const double *s, double E, double nu, double H, double p) { /* elastic, and stored by hardening */
    const double trace = s[0] + s[1] + s[2];
    double square = 0;
    for (int i = 0; i < 6; i++) square += s[i] * s[i] * (i < 3 ? 1 : 2);
    return ((1 + nu) * square - nu * trace * trace) / (2 * E) + H * p * p / 2;
}

int mises(const double *increment, double *stress, double *variables, double *stored, double *dissipated, double *tangent,
          double duration, double E, double nu, double yield, double H) {
    const double G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu)), trace = increment[0] + increment[1] + increment[2];
    double n[6], size = 0, shear = G;
#if BUG == 1 /* shear strains of engineers taken for those of the tensor */
    shear = 2 * G;
#endif
    for (int i = 0; i < 6; i++) stress[i] += i < 3 ? lame * trace + 2 * G * increment[i] : shear * increment[i];
    const double mean = (stress[0] + stress[1] + stress[2]) / 3;
    for (int i = 0; i < 6; i++) {
        n[i] = stress[i] - (i < 3 ? mean : 0); /* the deviator, and from here its direction */
        size += n[i] * n[i] * (i < 3 ? 1 : 2);
    }
    const double equivalent = sqrt(1.5 * size), p = variables[0];
    double limit = yield + H * p, dp = 0;
#if BUG == 2 /* a rate dependence left in */
    if (duration > 0) limit *= 1 + 0.01 * log(1 + 1 / duration);
#endif
    (void)duration;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) tangent[6 * i + j] = (i < 3 && j < 3 ? lame : 0) + (i == j ? (i < 3 ? 2 * G : shear) : 0);
    if (equivalent > limit) {
        dp = (equivalent - limit) / (3 * G + H);
        double share = 3 * G * dp / equivalent;
        for (int i = 0; i < 6; i++) {
            stress[i] -= share * n[i];
            n[i] /= sqrt(size);
        }
#if BUG == 3 /* the continuum tangent instead of the consistent one */
        share = 0;
#endif
        const double along = 2 * G * (3 * G / (3 * G + H) - share);
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++) {
                const double deviator = (i == j ? (i < 3 ? 1 : 0.5) : 0) - (i < 3 && j < 3 ? 1.0 / 3 : 0);
                tangent[6 * i + j] -= 2 * G * share * deviator + along * n[i] * n[j];
            }
    }
#if BUG != 4 /* 4: the accumulated plastic strain is not kept */
    variables[0] = p + dp;
#endif
    *stored = energy(stress, E, nu, H, variables[0]);
#if BUG == 5 /* the plastic work of the trial stress taken for what is dissipated */
    *dissipated += equivalent * dp;
#else
    *dissipated += yield * dp;
#endif
    return 0;
}
