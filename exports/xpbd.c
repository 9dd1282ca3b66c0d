/* A springfit network moved by XPBD (Macklin, Mueller and Chentanez 2016), in C99 with the standard library alone.

       cc -O2 -o run run.c -lm
       ./run                    two seconds of motion, then where the points are
       ./run 5                  five seconds
       ./run --rest F           comes to rest and writes the positions to the file F, a line for each point
       ./run --load NAME        any of these under a load of the scene as well
       ./run --substeps N --iterations N --step S   in place of the setting in network.json

   With -DREAL=float it counts in single precision. The loop is above the line of stars, for an engine of your own; below it, network.json
   is read. What was converted: a spring of constant k is a constraint of compliance 1/k on a length, an area, a volume or the angle of a
   hinge with the rest measure of the spring. Where stress relaxes, a spring has dashpots in series, one for each term of the share g and the
   time tau, which has lengthened by w: it pulls as k (C - sum of g w). Points are in m, masses in kg, times in s; in the plane z is zero. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef REAL
#define REAL double
#endif
typedef REAL Vector[3];

typedef struct {
    int count, points[4];    /* two points have a length, three an area, four a volume or the angle of a hinge */
    int spatial;             /* whether an area is that of a triangle in space, and whether four points are a hinge */
    REAL compliance, rest;   /* 1/k, and the measure at which the spring does not pull */
    REAL multiplier;         /* the sum of the corrections in this substep */
    REAL last, shift;        /* how far it was stretched before this substep, and what its rest measure is longer by in it */
    REAL *creep;             /* w of each term */
} Constraint;

typedef struct {
    REAL share, time;        /* of the stress, s */
    REAL decay, mean;        /* exp(-h/time), and its mean over a substep */
} Term;

typedef struct {
    int points, constraints; /* how many */
    Vector *x, *v;           /* positions and velocities */
    Vector *w;               /* inverse masses along x, y, z: zero where a point is held */
    Vector *force, gravity;  /* forces on the points, and the acceleration of all */
    Vector *old, *seen;      /* positions before the substep, and before a sweep of Jacobi */
    Constraint *constraint;  /* in the order of a sweep */
    REAL h, relaxation;      /* length of a substep, factor of each correction */
    Term *term;              /* in which stress relaxes */
    int terms;
    REAL left;               /* share of the constants in a substep: what relaxes in it makes springs softer */
    int iterations, jacobi;  /* sweeps of a substep; whether they correct all constraints at once */
} Body;

static REAL dot(const Vector a, const Vector b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const Vector a, const Vector b, Vector c)
{
    for (int k = 0; k < 3; k++) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The angle at the edge from e[1] to e[2] between the plane of a triangle and another apex, which is zero if both triangles are flat, and
   its gradient; e are the places of the points, of which the first is the apex. */
static REAL turn(Vector *e, Vector *g)
{
    Vector t, u, v, n, m; /* along the edge, to both apexes, the normal, and the conormal, which points out of the triangle */
    for (int k = 0; k < 3; k++) t[k] = e[2][k] - e[1][k], u[k] = e[0][k] - e[1][k], v[k] = e[3][k] - e[1][k];
    REAL length = (REAL)sqrt(dot(t, t)), feet[2] = {dot(u, t) / (length * length), dot(v, t) / (length * length)};
    cross(t, u, n);
    REAL area = (REAL)sqrt(dot(n, n));
    for (int k = 0; k < 3; k++) t[k] /= length, n[k] /= area;
    cross(t, n, m);
    REAL out = dot(v, m), up = dot(v, n), square = out * out + up * up;
    for (int k = 0; k < 3; k++) {
        g[0][k] = n[k] * length / area;
        g[3][k] = (out * n[k] - up * m[k]) / square;
        g[1][k] = (feet[0] - 1) * g[0][k] + (feet[1] - 1) * g[3][k];
        g[2][k] = -feet[0] * g[0][k] - feet[1] * g[3][k];
    }
    return (REAL)atan2(up, out);
}

/* The measure of a constraint at the positions x, and its gradient g at each of its points. */
static REAL measure(const Constraint *c, Vector *x, Vector *g)
{
    Vector e[4], n = {0, 0, 1}; /* edges from the first point to the others */
    if (c->spatial && c->count == 4) {
        for (int i = 0; i < 4; i++) memcpy(e[i], x[c->points[i]], sizeof(Vector));
        return turn(e, g);
    }
    for (int i = 1; i < c->count; i++)
        for (int k = 0; k < 3; k++) e[i][k] = x[c->points[i]][k] - x[c->points[0]][k];
    if (c->count == 2) { /* |e1| */
        REAL length = (REAL)sqrt(dot(e[1], e[1]));
        for (int k = 0; k < 3; k++) g[1][k] = length > 0 ? e[1][k] / length : 0;
    } else if (c->count == 3) { /* n . (e1 x e2)/2, where n is along z in the plane */
        if (c->spatial) cross(e[1], e[2], n);
        REAL length = (REAL)sqrt(dot(n, n));
        for (int k = 0; k < 3; k++) n[k] /= 2 * (length > 0 ? length : 1);
        cross(e[2], n, g[1]), cross(n, e[1], g[2]);
    } else { /* e1 . (e2 x e3)/6 */
        cross(e[2], e[3], g[1]), cross(e[3], e[1], g[2]), cross(e[1], e[2], g[3]);
        for (int i = 1; i < 4; i++)
            for (int k = 0; k < 3; k++) g[i][k] /= 6;
    }
    /* A motion of all points at once changes nothing. */
    for (int k = 0; k < 3; k++) g[0][k] = -g[1][k] - (c->count > 2 ? g[2][k] : 0) - (c->count > 3 ? g[3][k] : 0);
    /* Each measure grows in proportion to e1 in its direction. */
    return dot(g[1], e[1]);
}

/* Corrects each constraint once. Gauss-Seidel sees what the constraints before have moved, Jacobi the positions before the sweep. */
static void sweep(Body *b)
{
    Vector *x = b->x, g[4];
    if (b->jacobi) x = memcpy(b->seen, b->x, (size_t)b->points * sizeof(Vector));
    for (Constraint *c = b->constraint; c < b->constraint + b->constraints; c++) {
        REAL violation = measure(c, x, g) - c->rest - c->shift;
        REAL softness = c->compliance / (b->left * b->h * b->h), stiffness = 0;
        for (int i = 0; i < c->count; i++)
            for (int k = 0; k < 3; k++) stiffness += b->w[c->points[i]][k] * g[i][k] * g[i][k];
        /* The step of Newton's method for violation + softness * multiplier = 0. */
        REAL step = -b->relaxation * (violation + softness * c->multiplier) / (stiffness + softness);
        c->multiplier += step;
        for (int i = 0; i < c->count; i++)
            for (int k = 0; k < 3; k++) b->x[c->points[i]][k] += b->w[c->points[i]][k] * g[i][k] * step;
    }
}

/* What relaxes in each substep, by the exponential rule, which takes stretches to change evenly. */
static void begin(Body *b)
{
    b->left = 1;
    for (Term *t = b->term; t < b->term + b->terms; t++) {
        t->decay = (REAL)exp(-b->h / t->time);
        t->mean = (REAL)(-expm1(-b->h / t->time) * t->time / b->h);
        b->left -= t->share * (1 - t->mean);
    }
}

/* The rest measure of a substep: at its end w will be decay w + (mean - decay) C_before + (1 - mean) C. The last part is in `left`. */
static void recall(const Body *b, Constraint *c)
{
    c->shift = 0;
    for (int i = 0; i < b->terms; i++) {
        const Term *t = b->term + i;
        c->shift += t->share * (t->decay * c->creep[i] + (t->mean - t->decay) * c->last) / b->left;
    }
}

/* Dashpots give way in a substep that ends here. */
static void forget(const Body *b, Constraint *c)
{
    Vector g[4];
    REAL stretch = measure(c, b->x, g) - c->rest;
    for (int i = 0; i < b->terms; i++) {
        const Term *t = b->term + i;
        c->creep[i] = t->decay * c->creep[i] + (t->mean - t->decay) * c->last + (1 - t->mean) * stretch;
    }
    c->last = stretch;
}

/* A substep: points fly under the forces, the sweeps correct where they are, and velocities follow from where they have come. */
static void substep(Body *b)
{
    memcpy(b->old, b->x, (size_t)b->points * sizeof(Vector));
    for (int p = 0; p < b->points; p++)
        for (int k = 0; k < 3; k++) {
            if (b->w[p][k] == 0) continue;
            b->v[p][k] += b->h * (b->gravity[k] + b->w[p][k] * b->force[p][k]);
            b->x[p][k] += b->h * b->v[p][k];
        }
    for (int i = 0; i < b->constraints; i++) b->constraint[i].multiplier = 0;
    for (int i = 0; b->terms && i < b->constraints; i++) recall(b, b->constraint + i);
    for (int i = 0; i < b->iterations; i++) sweep(b);
    for (int p = 0; p < b->points; p++)
        for (int k = 0; k < 3; k++) b->v[p][k] = (b->x[p][k] - b->old[p][k]) / b->h;
    for (int i = 0; b->terms && i < b->constraints; i++) forget(b, b->constraint + i);
}

/******************************************************************************************************************************/

/* The kinetic energy of the velocities, or of motions by a few last digits of each position in a substep. */
static double kinetic(const Body *b, int of_digits)
{
    double digit = sizeof(REAL) == sizeof(float) ? 5e-7 : 9e-16, sum = 0;
    for (int p = 0; p < b->points; p++)
        for (int k = 0; k < 3; k++) {
            double v = of_digits ? digit * b->x[p][k] / b->h : b->v[p][k];
            if (b->w[p][k] > 0) sum += v * v / b->w[p][k] / 2;
        }
    return sum;
}

/* Leaves what is left when all that relaxes has relaxed, or nothing. */
static int relax(Body *b)
{
    b->left = 1;
    for (int i = 0; i < b->terms; i++) b->left -= b->term[i].share;
    b->terms = 0;
    return b->left > (REAL)1e-6;
}

/* Comes to rest: whenever the kinetic energy has passed a maximum, the body is stopped. Returns the number of substeps, or 0. */
static long settle(Body *b)
{
    double highest = 0, last = 0, least = kinetic(b, 1);
    for (long n = 1; n <= 2000000; n++) {
        substep(b);
        double energy = kinetic(b, 0);
        if (!(energy <= HUGE_VAL)) return 0;
        if (energy <= last) {
            if (last <= 1e-18 * highest + least) return n;
            memset(b->v, 0, (size_t)b->points * sizeof(Vector));
            energy = 0;
        }
        last = energy;
        if (last > highest) highest = last;
    }
    return 0;
}

static char *at; /* what is left to be read of network.json */

static void refuse(const char *expected)
{
    /* A text with its quotes, or up to what ends a number. */
    int length = (int)(*at == '"' ? 1 + strcspn(at + 1, "\"\t\r\n") : strcspn(at, " ,\t\r\n"));
    if (*at == '"' && at[length] == '"') length++;
    fprintf(stderr, "network.json: expected %s, found ", expected);
    fprintf(stderr, *at ? "%.*s" : "its end", length < 30 ? length : 30, at);
    fprintf(stderr, "; springfit export --to xpbd writes this file\n");
    exit(2);
}

static void misuse(const char *option, const char *expected, const char *found)
{
    fprintf(stderr, "%s: expected %s, found \"%s\"\n", option, expected, found);
    exit(2);
}

/* A list with room for one more entry: its room doubles whenever it is full. */
static void *grown(void *list, int count, size_t size)
{
    if (count & (count - 1)) return list;
    list = realloc(list, (count ? 2 * (size_t)count : 1) * size);
    if (!list) fprintf(stderr, "the memory is full\n"), exit(2);
    return list;
}

/* Numbers for each point, zero at first. */
static Vector *table(int points)
{
    Vector *list = calloc((size_t)points + 1, sizeof(Vector));
    if (!list) fprintf(stderr, "the memory is full\n"), exit(2);
    return list;
}

static void skip(void) { at += strspn(at, " \t\r\n,:"); }

/* Goes past a word, a bracket or a text in quotes if it is next. */
static int take(const char *word)
{
    skip();
    size_t length = strlen(word);
    if (strncmp(at, word, length)) return 0;
    at += length;
    return 1;
}

static void expect(const char *word)
{
    if (!take(word)) refuse(word);
}

static double number(void)
{
    char *end;
    skip();
    double found = strtod(at, &end);
    if (end == at || !(fabs(found) < HUGE_VAL)) refuse("a number");
    at = end;
    return found;
}

/* A whole number from `least` and below `end`. */
static int whole(int least, int end)
{
    skip();
    char *from = at, expected[60];
    double found = number();
    if (found >= least && found < end && found == floor(found)) return (int)found;
    at = from;
    sprintf(expected, "a whole number from %d to %d", least, end - 1);
    refuse(expected);
    return 0;
}

/* A text in quotes; it is ended where its last quote was. */
static char *text(void)
{
    expect("\"");
    char *start = at, *to = at;
    for (; *at && *at != '"'; *to++ = *at++)
        if (*at == '\\' && at[1]) at++;
    expect("\"");
    *to = 0;
    return start;
}

static void vector(REAL *x)
{
    expect("[");
    for (int k = 0; k < 3; k++) x[k] = (REAL)number();
    expect("]");
}

/* What the command line asks for; zeros leave the setting as it is. */
typedef struct {
    const char *rest, *load;
    double seconds, step;
    int substeps, iterations;
} Asked;

/* Reads the setting, and says where other numbers are asked for than the constants were fitted for. */
static void read_setting(Body *b, const Asked *asked)
{
    expect("\"fitted\"");
    int is_fitted = take("true");
    if (!is_fitted) expect("false");
    expect("\"setting\""), expect("{"), expect("\"method\""), expect("\"xpbd\""), expect("\"step\"");
    double step = number();
    expect("\"substeps\"");
    int substeps = whole(1, 100001);
    expect("\"iterations\"");
    int iterations = whole(1, 100001);
    expect("\"sweep\"");
    b->jacobi = take("\"jacobi\"");
    if (!b->jacobi) expect("\"gauss-seidel\"");
    expect("\"relaxation\"");
    b->relaxation = (REAL)number();
    expect("\"order\""), text(), expect("\"precision\""), text(), expect("}");
    double own_step = asked->step > 0 ? asked->step : step;
    int own_substeps = asked->substeps ? asked->substeps : substeps;
    b->iterations = asked->iterations ? asked->iterations : iterations;
    b->h = (REAL)(own_step / own_substeps);
    if (!(b->h > 0)) refuse("a step above zero");
    if (is_fitted && (own_step != step || own_substeps != substeps || b->iterations != iterations))
        fprintf(stderr, "Beware: the constants were fitted for %d substeps of %d iterations in %g s; with %d of %d in %g s the body has "
                "another stiffness\n", substeps, iterations, step, own_substeps, b->iterations, own_step);
}

/* Adds the forces of the load that is asked for. */
static void read_loads(Body *b, const char *asked)
{
    char **names = NULL;
    int count = 0, is_found = 0;
    expect("\"loads\""), expect("[");
    for (; take("{"); expect("}")) {
        expect("\"name\"");
        names = grown(names, count, sizeof *names);
        names[count] = text();
        int is_asked = asked && !is_found && !strcmp(asked, names[count]);
        count++;
        is_found |= is_asked;
        expect("\"moves\"");
        if (take("true") && is_asked) misuse("--load", "a load of forces", "one that moves points: move them in the engine");
        take("false"), expect("\"forces\""), expect("[");
        while (take("[")) {
            int p = whole(0, b->points);
            for (int k = 0; k < 3; k++) {
                REAL force = (REAL)number();
                if (is_asked) b->force[p][k] += force;
            }
            expect("]");
        }
        expect("]");
    }
    expect("]");
    if (!asked || is_found) return;
    fprintf(stderr, "--load: expected one of");
    for (int i = 0; i < count; i++) fprintf(stderr, " \"%s\"", names[i]);
    fprintf(stderr, "%s, found \"%s\"\n", count ? "" : " none", asked);
    exit(2);
}

/* The whole of network.json, whose keys are in the order in which they are written. */
static Body read_body(const Asked *asked)
{
    Body b = { 0 };
    FILE *file = fopen("network.json", "rb");
    long length = 0;
    if (!file || fseek(file, 0, SEEK_END) || (length = ftell(file)) < 0 || fseek(file, 0, SEEK_SET))
        misuse("network.json", "a file that can be read", strerror(errno));
    char *all = at = calloc((size_t)length + 1, 1);
    if (!all || fread(all, 1, (size_t)length, file) != (size_t)length) misuse("network.json", "its bytes in memory", "fewer");
    fclose(file);
    expect("{"), expect("\"format\""), expect("\"springfit xpbd\""), expect("\"version\""), whole(1, 2);
    read_setting(&b, asked);
    expect("\"gravity\""), vector(b.gravity), expect("\"points\""), expect("[");
    for (; !take("]"); b.points++) b.x = grown(b.x, b.points, sizeof(Vector)), vector(b.x[b.points]);
    b.v = table(b.points), b.w = table(b.points), b.force = table(b.points), b.old = table(b.points), b.seen = table(b.points);
    expect("\"masses\""), expect("[");
    for (int p = 0; p < b.points; p++) {
        double mass = number();
        if (!(mass > 0)) refuse("masses above zero");
        for (int k = 0; k < 3; k++) b.w[p][k] = (REAL)(1 / mass);
    }
    expect("]"), expect("\"held\""), expect("[");
    for (; take("["); expect("]")) {
        int p = whole(0, b.points);
        b.w[p][whole(0, 3)] = 0;
    }
    expect("]"), expect("\"surface\""), expect("[");
    for (; take("["); expect("]")) whole(0, b.points), whole(0, b.points), whole(0, b.points);
    expect("]");
    read_loads(&b, asked->load);
    expect("\"constraints\""), expect("[");
    for (; take("{"); expect("}"), b.constraints++) {
        b.constraint = grown(b.constraint, b.constraints, sizeof(Constraint));
        Constraint *c = b.constraint + b.constraints;
        memset(c, 0, sizeof *c);
        expect("\"kind\"");
        int is_content = take("\"content\""), is_area = !is_content && take("\"area\""), is_hinge = !is_content && !is_area && take("\"hinge\"");
        int least = is_content || is_area ? 3 : is_hinge ? 4 : 2, most = is_content ? 4 : least;
        if (least == 2) expect("\"length\"");
        c->spatial = is_area || is_hinge;
        expect("\"points\""), expect("[");
        while (c->count < least || (c->count < most && !take("]"))) c->points[c->count++] = whole(0, b.points);
        if (c->count == most) expect("]");
        expect("\"compliance\""), c->compliance = (REAL)number();
        if (!(c->compliance > 0)) refuse("compliances above zero");
        expect("\"rest\""), c->rest = (REAL)number(), expect("\"colour\""), number();
    }
    expect("]");
    if (take("\"relaxation\"")) {
        expect("[");
        for (; take("["); b.terms++, expect("]")) {
            b.term = grown(b.term, b.terms, sizeof(Term));
            b.term[b.terms].share = (REAL)number(), b.term[b.terms].time = (REAL)number();
            if (!(b.term[b.terms].time > 0)) refuse("times above zero");
        }
        expect("]");
    }
    expect("}");
    for (int i = 0; b.terms && i < b.constraints; i++) {
        b.constraint[i].creep = calloc((size_t)b.terms, sizeof(REAL));
        if (!b.constraint[i].creep) fprintf(stderr, "the memory is full\n"), exit(2);
    }
    begin(&b);
    return b;
}

static double counted(const char *option, const char *given, int is_whole)
{
    char *end;
    double found = given ? strtod(given, &end) : 0;
    int is_fine = given && end != given && !*end && found > 0 && found < 1e300;
    if (is_whole) is_fine = is_fine && found == floor(found) && found <= 100000;
    if (!is_fine) misuse(option, is_whole ? "a whole number from 1 to 100000" : "a time above 0 s", given ? given : "nothing");
    return found;
}

int main(int count, char **words)
{
    Asked asked = { NULL, NULL, 2, 0, 0, 0 };
    int has_seconds = 0;
    for (int i = 1; i < count; i++) {
        const char *word = words[i], *next = i + 1 < count ? words[i + 1] : NULL;
        if (strncmp(word, "--", 2)) {
            if (has_seconds++) misuse("SECONDS", "one time", word);
            asked.seconds = counted("SECONDS", word, 0);
            continue;
        }
        if (!strcmp(word, "--rest")) asked.rest = next;
        else if (!strcmp(word, "--load")) asked.load = next;
        else if (!strcmp(word, "--step")) asked.step = counted(word, next, 0);
        else if (!strcmp(word, "--substeps")) asked.substeps = (int)counted(word, next, 1);
        else if (!strcmp(word, "--iterations")) asked.iterations = (int)counted(word, next, 1);
        else misuse(word, "--rest, --load, --step, --substeps or --iterations", word);
        if (!next) misuse(word, "a word after it", "none");
        i++;
    }
    Body b = read_body(&asked);
    if (asked.rest && !relax(&b)) misuse("--rest", "a body of which some stress remains", "one that relaxes wholly");
    Vector *start = memcpy(table(b.points), b.x, (size_t)b.points * sizeof(Vector));
    double steps = asked.rest ? settle(&b) : floor(asked.seconds / b.h + 0.5);
    if (asked.rest && !steps) return fprintf(stderr, "the body has not come to rest\n"), 1;
    for (double n = 0; !asked.rest && n < steps; n++) substep(&b);
    double largest = 0;
    int place = 0;
    for (int p = 0; p < b.points; p++) {
        double square = 0;
        for (int k = 0; k < 3; k++) square += (b.x[p][k] - start[p][k]) * (b.x[p][k] - start[p][k]);
        if (!(square < HUGE_VAL)) return fprintf(stderr, "the motion has diverged\n"), 1;
        if (square > largest) largest = square, place = p;
    }
    FILE *file = asked.rest ? fopen(asked.rest, "w") : NULL;
    if (asked.rest && !file) misuse("--rest", "a file that can be written", strerror(errno));
    for (int p = 0; file && p < b.points; p++) fprintf(file, "%.17g %.17g %.17g\n", b.x[p][0], b.x[p][1], b.x[p][2]);
    if (file && fclose(file)) misuse("--rest", "a file that can be written", strerror(errno));
    printf("%d points, %s%.4g s: the largest displacement is %.4g m, at point %d\n", b.points, asked.rest ? "at rest after " : "",
           steps * b.h, sqrt(largest), place);
    return 0;
}
