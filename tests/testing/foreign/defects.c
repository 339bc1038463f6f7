/* Right routines, and in each of five kinds the mistake that public code was found to have: the number of the mistake comes with PROPS.
 *
 * umat_: von Mises plasticity with linear hardening; PROPS E, nu, R, H, mistake; STATEV p.
 *   1 the components of the tangent are in another code's order
 *   2 an absolute value makes unloading flow
 *   3 the dissipated energy is that of the stress before the step, which large reversals turn negative
 *   4 the error path crashes
 * friction: a disk; mistake 5, an absolute threshold of the limit, below which the trial is returned: so at the tip. */

#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, const double *stran, const double *dstran, const double *time, const double *dtime,
           const double *temp, const double *dtemp, const double *predef, const double *dpred, const char *cmname, const int *ndi,
           const int *nshr, const int *ntens, const int *nstatv, const double *props, const int *nprops, const double *coords,
           const double *drot, double *pnewdt, const double *celent, const double *dfgrd0, const double *dfgrd1, const int *noel,
           const int *npt, const int *layer, const int *kspt, const int *jstep, const int *kinc, size_t length)
{
    const int mistake = (int)props[4];
    const double E = props[0], nu = props[1], R = props[2], H = props[3], G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu));
    double k[36], before[6], n[6], square = 0, lost = 0, mean, energy = 0;
    (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)stran, (void)time, (void)dtime, (void)temp, (void)dtemp;
    (void)predef, (void)dpred, (void)cmname, (void)ndi, (void)nshr, (void)ntens, (void)nstatv, (void)nprops, (void)coords, (void)drot;
    (void)pnewdt, (void)celent, (void)dfgrd0, (void)dfgrd1, (void)noel, (void)npt, (void)layer, (void)kspt, (void)jstep, (void)kinc;
    (void)length;
    memcpy(before, stress, sizeof before);
    for (int i = 0; i < 36; i++) k[i] = (i / 6 < 3 && i % 6 < 3 ? lame : 0) + (i / 6 == i % 6 ? (i / 6 < 3 ? 2 * G : G) : 0);
    for (int i = 0; i < 36; i++) stress[i / 6] += k[i] * dstran[i % 6];
    if (mistake == 4 && fabs(dstran[0]) > 0.005) {
        const char *volatile missing = NULL;
        printf("singular matrix in %d\n", (int)strlen(missing));
    }
    mean = (stress[0] + stress[1] + stress[2]) / 3;
    for (int i = 0; i < 6; i++) {
        n[i] = stress[i] - (i < 3 ? mean : 0);
        square += n[i] * n[i] * (i < 3 ? 1 : 2);
    }
    const double q = sqrt(1.5 * square), limit = R + H * statev[0], over = mistake == 2 ? fabs(q - limit) * (statev[0] > 0) : 0;
    const double beyond = q > limit ? q - limit : over;
    if (beyond > 0) {
        const double dp = beyond / (3 * G + H), share = 3 * G * dp / q;
        for (int i = 0; i < 6; i++) {
            stress[i] -= share * n[i];
            n[i] *= 1.5 / q;
            lost += (mistake == 3 ? before[i] : stress[i]) * dp * n[i] * (i < 3 ? 1 : 2);
        }
        for (int i = 0; i < 36; i++) {
            const int a = i / 6, b = i % 6;
            const double unit = (a == b ? (a < 3 ? 1 : 0.5) : 0) - (a < 3 && b < 3 ? 1.0 / 3 : 0);
            k[i] -= 2 * G * share * unit + 4 * G * G * (1 / (3 * G + H) - dp / q) * n[a] * n[b];
        }
        statev[0] += dp;
    }
    for (int i = 0; i < 36; i++) {
        const int a = i / 6, b = i % 6, other = mistake == 1;
        ddsdde[6 * (other && b > 2 ? 8 - b : b) + (other && a > 2 ? 8 - a : a)] = k[i];
    }
    mean = (stress[0] + stress[1] + stress[2]) / 3;
    for (int i = 0; i < 6; i++) {
        const double apart = stress[i] - (i < 3 ? mean : 0);
        energy += apart * apart * (i < 3 ? 1 : 2) / (4 * G);
    }
    *sse = energy + mean * mean * (1 - 2 * nu) * 1.5 / E;
    *spd += lost;
}

void friction(const double *trial, double pressure, double mu, double mistake, double *stress)
{
    const double size = hypot(trial[0], trial[1]), limit = mu * fabs(pressure);
    const double share = size > limit && !(mistake == 5 && limit < 1e-12) ? limit / size : 1;
    stress[0] = share * trial[0];
    stress[1] = share * trial[1];
}

#ifdef __cplusplus
}
#endif
