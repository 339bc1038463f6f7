/* Von Mises plasticity with isotropic and kinematic hardening as a UMAT, backward Euler, right with BUG 0 and wrong with each other one.
 *
 * PROPS: E, nu, R, Q, b, H, C, gamma, c, a, T0.  Limit (R + H p + Q (1 - exp(-b p))) (1 - a (T - T0)) on the von Mises stress of sigma - X,
 * dX = 2/3 C d eps_p - gamma X dp - c X dt.  STATEV: p, the plastic strain (6, shears of engineers), X (6, stresses). */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef BUG
#define BUG 0
#endif
#ifndef OTHER
#define OTHER BUG
#endif
#define IS(n) (BUG == (n) || OTHER == (n))

static double norm(const double *s) {
    double sum = 0;
    for (int i = 0; i < 6; i++) sum += s[i] * s[i] * (i < 3 ? 1 : 2);
    return sqrt(1.5 * sum);
}

static void deviator(const double *s, double *d) {
    const double mean = (s[0] + s[1] + s[2]) / 3;
    for (int i = 0; i < 6; i++) d[i] = s[i] - (i < 3 ? mean : 0);
}

void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime, double *temp, double *dtemp,
           double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens, int *nstatv, double *props, int *nprops,
           double *coords, double *drot, double *pnewdt, double *celent, double *dfgrd0, double *dfgrd1, int *noel, int *npt, int *layer,
           int *kspt, int *jstep, int *kinc, size_t length) {
    (void)sse, (void)spd, (void)scd, (void)rpl, (void)ddsddt, (void)drplde, (void)drpldt, (void)time, (void)predef, (void)dpred;
    (void)cmname, (void)ndi, (void)nshr, (void)ntens, (void)nprops, (void)coords, (void)drot, (void)celent, (void)dfgrd0, (void)dfgrd1;
    (void)noel, (void)npt, (void)layer, (void)kspt, (void)jstep, (void)kinc, (void)length, (void)dtemp, (void)stran, (void)nstatv, (void)pnewdt;
    const double E = IS(44) ? (double)(float)(props[0] * 1.0000001) : props[0], nu = props[1], R = props[2], Q = props[3], b = props[4];
    double H = props[5], C = props[6], gamma = props[7], c = props[8];
    const double a = props[9], T0 = props[10], G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu));
    double dt = *dtime, warm = 1 - a * (*temp - T0);
    if (IS(20)) warm = 1;
    if (IS(21)) warm = 1 - a * (*temp - 273.15 - T0);
    if (IS(13)) C *= 1.5;
    if (IS(14)) gamma = 0;
    if (IS(15)) dt = 1;
    if (IS(16)) c = 0;
    if (IS(18)) H *= 2;
    if (IS(36)) warm *= sqrt(2.0 / 3.0);
    if (IS(19)) warm *= 1.1;
    if (IS(45)) gamma *= 2;
    if (IS(46)) c *= 3;
    const double p0 = statev[0], trace = dstran[0] + dstran[1] + dstran[2];
    double X0[6], s[6], tr[6], z[6], n[6], k[36];
    memcpy(X0, statev + 7, sizeof X0);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) k[6 * j + i] = (i < 3 && j < 3 ? lame : 0) + (i == j ? (i < 3 ? 2 * G : G) : 0);
    if (IS(42))
        for (int i = 3; i < 6; i++) k[7 * i] *= 2;
    for (int i = 0; i < 6; i++) {
        tr[i] = stress[i];
        for (int j = 0; j < 6; j++) tr[i] += k[6 * j + i] * dstran[j];
    }
    (void)trace;
    deviator(tr, s);
    double A0 = 1 / (1 + c * dt);
    const double in = IS(9) ? 0 : IS(10) ? -1 : 1; /* the back stress in the check */
    for (int i = 0; i < 6; i++) z[i] = s[i] - in * (IS(35) ? 1 : A0) * X0[i];
    double dp = 0, limit = warm * (R + H * p0 + Q * (1 - exp(-b * p0))), A = A0, D = 1, q = norm(z), Hp = 0;
    const int flows = q > limit && !IS(40);
    if (flows) {
        for (int it = 0; it < 200; it++) {
            const double p = IS(17) ? p0 : p0 + dp;
            A = 1 / (1 + (IS(32) ? 0 : gamma * dp) + c * dt);
            for (int i = 0; i < 6; i++) z[i] = s[i] - in * A * X0[i] * (IS(32) ? 1 - gamma * dp : 1);
            q = norm(z);
            for (int i = 0; i < 6; i++) n[i] = 1.5 * z[i] / q;
            Hp = IS(17) ? 0 : warm * (H + Q * b * exp(-b * p));
            const double f = q - 3 * G * dp - (in != 0 ? in * C * A * dp : 0) - warm * (R + H * p + Q * (1 - exp(-b * p)));
            double along = 0;
            for (int i = 0; i < 6; i++) along += n[i] * X0[i] * (i < 3 ? 1 : 2);
            D = Hp + 3 * G + in * C * A - gamma * A * A * in * (along + C * dp);
            if (IS(32)) D = Hp + 3 * G + C * A - gamma * A * along;
            if (fabs(f) <= (IS(34) ? 1e-4 : 1e-14) * limit) break;
            dp += f / D;
        }
    }
    if (IS(30) && flows) { /* the direction of the stress, not of what is left without the back stress; scaled back to K afterwards */
        for (int i = 0; i < 6; i++) n[i] = 1.5 * s[i] / norm(s);
    }
    double X[6], flow[6];
    for (int i = 0; i < 6; i++) {
        const double w = i < 3 ? 1 : 2;
        flow[i] = flows ? n[i] * w : 0; /* strains of engineers */
        double less = 2 * G * dp * (flows ? n[i] : 0);
        if (IS(31) && i >= 3) less *= 0.5;
        stress[i] = tr[i] - less;
        X[i] = flows ? A * ((IS(32) ? 1 - gamma * dp : 1) * X0[i] + C * dp * 2 / 3 * n[i]) : A0 * X0[i];
    }
    if (IS(37)) {
        const double mean = (stress[0] + stress[1] + stress[2]) / 3;
        for (int i = 0; i < 3; i++) stress[i] -= flows ? mean : 0;
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            double t = k[6 * j + i];
            if (flows && !IS(25)) {
                const double *m = n;
                double dj = 2 * G * m[j] / D, dn = 0;
                if (IS(28)) dj = 2 * G * m[j] / (warm * (H + Q * b * exp(-b * p0)) + 3 * G + C); /* of the state before the step */
                for (int l = 0; l < 6; l++) { /* (3/2 dz - n (n : dz))/q, dz = 2 G dev + X0 gamma A^2 ddp */
                    const double unit = (l == j ? (l < 3 ? 1 : 0.5) : 0) - (l < 3 && j < 3 ? 1.0 / 3 : 0);
                    const double dz = 2 * G * unit + in * gamma * A * (IS(32) ? 1 : A) * X0[l] * dj;
                    dn += ((l == i ? 1.5 : 0) - m[i] * m[l] * (l < 3 ? 1 : 2)) * dz / q;
                }
                t -= 2 * G * dj * m[i] + (IS(26) ? 0 : 2 * G * dp * dn);
            }
            if (IS(27) && flows && ((i == 3 && j == 4) || (i == 4 && j == 3))) t += 0.2 * G;
            if (IS(41) && flows && i == j && i >= 3) t *= 2;
            ddsdde[IS(29) ? 6 * i + j : 6 * j + i] = IS(38) ? 0 : t;
        }
    static int calls = 0;
    calls++;
    const double own = IS(39) ? dp * (1 + 0.1 * (calls % 7 == 0)) : dp;
    statev[0] = IS(1) ? dp : IS(2) ? p0 : p0 + own * (IS(3) ? 2 : IS(4) ? sqrt(2.0 / 3.0) : 1);
    if (IS(33)) statev[0] += 0.5 * dt * 1e-4;
    for (int i = 0; i < 6; i++) {
        const double step = dp * flow[i] * (IS(7) && i >= 3 ? 0.5 : IS(8) ? -1 : 1);
        const int at = 1 + (IS(24) && i >= 3 ? 8 - i : i); /* 24: 23 13 12 */
        if (!IS(6)) statev[at] = (IS(5) ? 0 : IS(24) ? statev[at] : statev[1 + i]) + step;
        if (!IS(11)) statev[7 + i] = X[i] + (IS(12) ? X[i] - X0[i] : 0);
    }
    if (IS(43)) statev[0] = statev[0] > 0 ? statev[0] + 1e-3 * dp : 0;
    if (IS(22)) {
        statev[10] = X[4];
        statev[11] = X[3];
    }
    if (IS(23)) {
        statev[9] = p0 + dp;
        statev[0] = X[2];
    }
}
