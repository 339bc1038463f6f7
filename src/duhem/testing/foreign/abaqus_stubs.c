/* What Abaqus offers a UMAT, as far as a test outside Abaqus needs it.  Names and arguments are those of the Abaqus User Subroutines
 * Reference Guide, with the underscore and the hidden lengths of strings of gfortran and ifort.
 *
 * XIT ends Abaqus; here it ends the call alone: duhem_umat calls the UMAT, and XIT jumps back to it, as STDB_ABQERR does with a level of
 * -3.  The increment then counts as not solved (PNEWDT = 1/2). */

#include <math.h>
#include <setjmp.h>
#include <stddef.h>

static jmp_buf back;
static int inside = 0;

#ifdef __cplusplus
extern "C" {
#endif

#define UMAT_ARGUMENTS \
    double *a0, double *a1, double *a2, double *a3, double *a4, double *a5, double *a6, double *a7, double *a8, double *a9, double *a10, \
    double *a11, double *a12, double *a13, double *a14, double *a15, double *a16, double *a17, char *a18, int *a19, int *a20, int *a21, \
    int *a22, double *a23, int *a24, double *a25, double *a26, double *pnewdt, double *a28, double *a29, double *a30, int *a31, int *a32, \
    int *a33, int *a34, int *a35, int *a36, size_t length

void umat_(UMAT_ARGUMENTS);

void duhem_umat(UMAT_ARGUMENTS) {
    if (setjmp(back)) {
        inside = 0;
        *pnewdt = 0.5;
        return;
    }
    inside = 1;
    umat_(a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23, a24, a25, a26,
          pnewdt, a28, a29, a30, a31, a32, a33, a34, a35, a36, length);
    inside = 0;
}

void xit_(void) {
    if (inside) longjmp(back, 1);
}

void stdb_abqerr_(const int *level, const char *text, const int *whole, const double *real, const char *word, size_t one, size_t two) {
    (void)text, (void)whole, (void)real, (void)word, (void)one, (void)two;
    if (*level == -3) xit_();
}

/* a symmetric tensor in the order 11 22 33 12 13 23; kind 1 a stress, 2 a strain, whose shears are those of engineers */
static void unpacked(const double *s, int kind, int ndi, int nshr, double m[3][3]) {
    static const int place[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] = 0;
    for (int i = 0; i < ndi && i < 3; i++) m[i][i] = s[i];
    for (int i = 0; i < nshr && i < 3; i++) m[place[i][0]][place[i][1]] = m[place[i][1]][place[i][0]] = s[ndi + i] / (kind == 2 ? 2 : 1);
}

void rotsig_(const double *s, const double *r, double *turned, const int *kind, const int *ndi, const int *nshr) {
    static const int place[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    double m[3][3], t[3][3];
    unpacked(s, *kind, *ndi, *nshr, m);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            t[i][j] = 0;
            for (int k = 0; k < 3; k++)
                for (int l = 0; l < 3; l++) t[i][j] += r[i + 3 * k] * m[k][l] * r[j + 3 * l]; /* r(i, k) of Fortran */
        }
    for (int i = 0; i < *ndi && i < 3; i++) turned[i] = t[i][i];
    for (int i = 0; i < *nshr && i < 3; i++) turned[*ndi + i] = t[place[i][0]][place[i][1]] * (*kind == 2 ? 2 : 1);
}

void sinv_(const double *s, double *first, double *second, const int *ndi, const int *nshr) {
    double m[3][3], sum = 0;
    unpacked(s, 1, *ndi, *nshr, m);
    *first = (m[0][0] + m[1][1] + m[2][2]) / 3; /* the mean, and the equivalent stress of von Mises */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) sum += (m[i][j] - (i == j) * *first) * (m[i][j] - (i == j) * *first);
    *second = sqrt(1.5 * sum);
}

/* eigenvalues and directions by Jacobi's rotations */
static void axes_of(double m[3][3], double value[3], double v[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) v[i][j] = i == j;
    for (int sweep = 0; sweep < 60; sweep++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++) {
                if (m[p][q] == 0) continue;
                const double half = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = (half < 0 ? -1 : 1) / (fabs(half) + sqrt(half * half + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; k++) {
                    const double x = m[k][p], y = m[k][q];
                    m[k][p] = c * x - s * y, m[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 3; k++) {
                    const double x = m[p][k], y = m[q][k];
                    m[p][k] = c * x - s * y, m[q][k] = s * x + c * y;
                }
                for (int k = 0; k < 3; k++) {
                    const double x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
                }
            }
    for (int i = 0; i < 3; i++) value[i] = m[i][i];
}

void sprind_(const double *s, double *value, double *direction, const int *kind, const int *ndi, const int *nshr) {
    double m[3][3], v[3][3];
    unpacked(s, *kind, *ndi, *nshr, m);
    axes_of(m, value, v);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) direction[i + 3 * k] = v[k][i]; /* direction(i, k): component k of the i-th */
}

void sprinc_(const double *s, double *value, const int *kind, const int *ndi, const int *nshr) {
    double direction[9];
    sprind_(s, value, direction, kind, ndi, nshr);
}

/* no output variable is known: JRCD = 1 says so */
void getvrm_(const char *name, double *array, char *jarray, char *flags, int *jrcd, const int *jmac, const int *jmatyp, const int *matlayo,
             const int *laccfla) {
    (void)name, (void)array, (void)jarray, (void)flags, (void)jmac, (void)jmatyp, (void)matlayo, (void)laccfla;
    *jrcd = 1;
}

#ifdef __cplusplus
}
#endif
