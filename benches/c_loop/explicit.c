/* Symplectic Euler on flat arrays, as one writes it: a loop over springs with a rest length, one over those without, one over
   tetrahedra, one over hexahedra with eight points each, and the update. Read by benches/explicit.rs, which writes the network.
   explicit NETWORK RESULT: prints seconds of processor time per step, writes the positions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void *get(FILE *file, size_t size, size_t count) {
    void *data = malloc(size * count + 1);
    if (!data || fread(data, size, count, file) != count) exit(1);
    return data;
}

static void lengths(int n, const int *restrict p, const double *restrict k, const double *restrict rest, const double *restrict x,
                    double *restrict f) {
    for (int s = 0; s < n; s++) {
        int i = 3 * p[2 * s], j = 3 * p[2 * s + 1];
        double a = x[j] - x[i], b = x[j + 1] - x[i + 1], c = x[j + 2] - x[i + 2];
        double l = sqrt(a * a + b * b + c * c), t = k[s] * (l - rest[s]) / l;
        f[i] -= t * a, f[i + 1] -= t * b, f[i + 2] -= t * c;
        f[j] += t * a, f[j + 1] += t * b, f[j + 2] += t * c;
    }
}

static void edges(int n, const int *restrict p, const double *restrict k, const double *restrict x, double *restrict f) {
    for (int s = 0; s < n; s++) {
        int i = 3 * p[2 * s], j = 3 * p[2 * s + 1];
        for (int m = 0; m < 3; m++) {
            double t = k[s] * (x[j + m] - x[i + m]);
            f[i + m] -= t, f[j + m] += t;
        }
    }
}

static inline void cross(const double *a, const double *b, double *c) {
    c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}

static void tetrahedra(int n, const int *restrict p, const double *restrict slope, const double *restrict pull,
                       const double *restrict x, double *restrict f) {
    for (int s = 0; s < n; s++) {
        double e[3][3], g[3][3];
        for (int a = 0; a < 3; a++)
            for (int m = 0; m < 3; m++) e[a][m] = x[3 * p[4 * s + a + 1] + m] - x[3 * p[4 * s] + m];
        for (int a = 0; a < 3; a++) cross(e[(a + 1) % 3], e[(a + 2) % 3], g[a]);
        double t = slope[s] * (e[0][0] * g[0][0] + e[0][1] * g[0][1] + e[0][2] * g[0][2]) - pull[s];
        for (int m = 0; m < 3; m++) {
            for (int a = 0; a < 3; a++) f[3 * p[4 * s + a + 1] + m] += t * g[a][m];
            f[3 * p[4 * s] + m] -= t * (g[0][m] + g[1][m] + g[2][m]);
        }
    }
}

/* dn: derivatives of the eight shape functions at the eight points. */
static void hexahedra(int n, const int *restrict p, const double *restrict slope, const double *restrict pull,
                      const double *restrict dn, const double *restrict x, double *restrict f) {
    for (int s = 0; s < n; s++) {
        double own[8][3], sum[8][3] = {{0}};
        for (int a = 0; a < 8; a++)
            for (int m = 0; m < 3; m++) own[a][m] = x[3 * p[8 * s + a] + m];
        for (int q = 0; q < 8; q++) {
            double t[3][3] = {{0}}, g[3][3];
            for (int a = 0; a < 8; a++)
                for (int l = 0; l < 3; l++)
                    for (int m = 0; m < 3; m++) t[l][m] += dn[(8 * q + a) * 3 + l] * own[a][m];
            for (int l = 0; l < 3; l++) cross(t[(l + 1) % 3], t[(l + 2) % 3], g[l]);
            double pulled = slope[8 * s + q] * (t[0][0] * g[0][0] + t[0][1] * g[0][1] + t[0][2] * g[0][2]) - pull[8 * s + q];
            for (int l = 0; l < 3; l++)
                for (int m = 0; m < 3; m++) g[l][m] *= pulled;
            for (int a = 0; a < 8; a++)
                for (int l = 0; l < 3; l++)
                    for (int m = 0; m < 3; m++) sum[a][m] += dn[(8 * q + a) * 3 + l] * g[l][m];
        }
        for (int a = 0; a < 8; a++)
            for (int m = 0; m < 3; m++) f[3 * p[8 * s + a] + m] += sum[a][m];
    }
}

int main(int count, char **names) {
    FILE *file = count == 3 ? fopen(names[1], "rb") : NULL;
    if (!file) return 1;
    /* points, springs with and without a rest length, tetrahedra, hexahedra, steps */
    int *n = get(file, sizeof(int), 6);
    double *h = get(file, 8, 1), *x = get(file, 8, 3 * n[0]), *inverse = get(file, 8, 3 * n[0]);
    int *bar = get(file, sizeof(int), 2 * n[1]);
    double *k = get(file, 8, n[1]), *rest = get(file, 8, n[1]);
    int *edge = get(file, sizeof(int), 2 * n[2]);
    double *c = get(file, 8, n[2]);
    int *tet = get(file, sizeof(int), 4 * n[3]);
    double *slope = get(file, 8, n[3]), *pull = get(file, 8, n[3]);
    int *hex = get(file, sizeof(int), 8 * n[4]);
    double *slopes = get(file, 8, 8 * n[4]), *pulls = get(file, 8, 8 * n[4]), *dn = get(file, 8, n[4] ? 192 : 0);
    fclose(file);
    double *v = calloc(3 * n[0] + 1, 8), *f = malloc(24 * n[0] + 8);
    struct timespec begun, ended;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begun);
    for (int step = 0; step < n[5]; step++) {
        memset(f, 0, 24 * n[0]);
        lengths(n[1], bar, k, rest, x, f);
        edges(n[2], edge, c, x, f);
        tetrahedra(n[3], tet, slope, pull, x, f);
        hexahedra(n[4], hex, slopes, pulls, dn, x, f);
        for (int i = 0; i < 3 * n[0]; i++) {
            v[i] -= *h * inverse[i] * f[i];
            x[i] += *h * v[i];
        }
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ended);
    printf("%.9e\n", ((ended.tv_sec - begun.tv_sec) + 1e-9 * (ended.tv_nsec - begun.tv_nsec)) / n[5]);
    file = fopen(names[2], "wb");
    return !file || fwrite(x, 8, 3 * n[0], file) != (size_t)(3 * n[0]) || fclose(file);
}
