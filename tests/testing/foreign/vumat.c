/* Von Mises plasticity with linear hardening as a VUMAT: blocks of points, arrays (nblock, components) with a component's points together,
 * components 11 22 33 12 23 13, shear strains those of the tensor.  PROPS E, nu, R, H, a factor on the rate of p (1 is right); state p. */

#include <math.h>

void vumat_(const int *nblock, const int *ndir, const int *nshr, const int *nstatev, const int *nfieldv, const int *nprops,
            const int *lanneal, const double *steptime, const double *totaltime, const double *dt, const char *cmname,
            const double *coordmp, const double *charlength, const double *props, const double *density, const double *straininc,
            const double *relspininc, const double *tempold, const double *stretchold, const double *defgradold, const double *fieldold,
            const double *stressold, const double *stateold, const double *enerinternold, const double *enerinelasold,
            const double *tempnew, const double *stretchnew, const double *defgradnew, const double *fieldnew, double *stressnew,
            double *statenew, double *enerinternnew, double *enerinelasnew)
{
    const int n = *nblock;
    const double E = props[0], nu = props[1], R = props[2], H = props[3], G = E / (2 * (1 + nu)), lame = E * nu / ((1 + nu) * (1 - 2 * nu));
    (void)ndir, (void)nshr, (void)nstatev, (void)nfieldv, (void)nprops, (void)lanneal, (void)steptime, (void)totaltime, (void)dt;
    (void)cmname, (void)coordmp, (void)charlength, (void)relspininc, (void)tempold, (void)stretchold, (void)defgradold, (void)fieldold;
    (void)tempnew, (void)stretchnew, (void)defgradnew, (void)fieldnew, (void)enerinternnew, (void)enerinternold;
    for (int i = 0; i < n; i++) {
        const double trace = straininc[i] + straininc[n + i] + straininc[2 * n + i];
        double s[6], square = 0;
        for (int j = 0; j < 6; j++) s[j] = stressold[j * n + i] + 2 * G * straininc[j * n + i] + (j < 3 ? lame * trace : 0);
        const double mean = (s[0] + s[1] + s[2]) / 3;
        for (int j = 0; j < 6; j++) square += (s[j] - (j < 3 ? mean : 0)) * (s[j] - (j < 3 ? mean : 0)) * (j < 3 ? 1 : 2);
        const double q = sqrt(1.5 * square), limit = R + H * stateold[i], dp = q > limit ? (q - limit) / (3 * G + H) : 0;
        for (int j = 0; j < 6; j++) stressnew[j * n + i] = s[j] - (q > limit ? 3 * G * dp / q * (s[j] - (j < 3 ? mean : 0)) : 0);
        statenew[i] = stateold[i] + props[4] * dp;
        enerinelasnew[i] = enerinelasold[i] + (limit + H * dp) * dp / density[i];
    }
}
