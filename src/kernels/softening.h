/* One bond that softens, in plain doubles, as derived in law_softening.h: for the rare branch of
 * kernels, and for other code that evaluates such bonds. */
#ifndef GN_KERNELS_SOFTENING_H
#define GN_KERNELS_SOFTENING_H

#include "soa/records.h"

#include <math.h>

/* Parameters that are read only for bonds at their strength (column fade). */
enum {
    GN_FADE_SLOPE,    /* N/m, R_n/(u_f - u_l) of the first line; 0: brittle in tension */
    GN_FADE_END,      /* m, u_f, where that line reaches zero; 0: brittle */
    GN_FADE_COHESION, /* N, C of the whole bond */
    GN_FADE_SLIP,     /* m, u_s, where its line reaches zero; 0: brittle in shear */
    GN_FADE_FRICTION, /* mu_1 of the whole bond */
    GN_FADE_KINK, /* fraction of the strength that is lost where a second line begins; 0: there is
                     none */
    GN_FADE_SLOPE_SECOND, /* N/m */
    GN_FADE_END_SECOND,   /* m, where the second line reaches zero */
    GN_FADE_SLIP_SECOND,  /* m, slip by the second line for a loss of the entire strength */
    GN_FADES
};
/* Number of kinks of the compression curve. Column crush has the elastic forces F_i at the kinks,
 * N, then the fractions of k_n by which the slope decreases there. */
enum { GN_KINKS = 3 };

typedef struct gn_softening_bond {
    double fade[GN_FADES];
    double kn, kt, mu2;
    double least;    /* N, least compression for friction */
    double confined; /* N, compression for friction; NaN: the bond's own normal force */
    bool together;   /* quadratic coupling: kappa is the damage in tension and shear */
    double soft, rn, rt, mu1, kappa;
} gn_softening_bond;

static inline gn_softening_bond gn_softening_bond_of(const gn_contacts *list, size_t c) {
    gn_softening_bond b = {
        .kn = list->kn[c], .kt = list->kt[c], .mu2 = list->mu ? list->mu[c] : 0.0};
    for (size_t n = 0; n < GN_FADES; n++) b.fade[n] = list->fade[c + n * list->soa.capacity];
    b.least = list->soa.effects & GN_FX_COUPLED_LINEAR ? -(double)INFINITY : 0.0;
    b.confined = list->confined     ? list->confined[c]
                 : list->confined_f ? (double)list->confined_f[c]
                                    : NAN;
    b.together = list->soa.effects & GN_FX_COUPLED_QUADRATIC;
    b.soft = list->soft[c];
    b.rn = list->rn[c];
    b.rt = list->rt[c];
    b.mu1 = list->mu1[c];
    b.kappa = list->kappa[c];
    return b;
}

static inline bool gn_softening_whole(const gn_softening_bond *bond) {
    return bond->soft == 1.0 && bond->kappa == 0.0;
}

/* Returns the stretch at which a bond is broken, m, from its parameters, which are `stride` numbers
 * apart; 0: brittle. */
static inline double gn_softening_end(const double *fade, size_t stride) {
    double second = fade[GN_FADE_END_SECOND * stride];
    return second > 0.0 ? second : fade[GN_FADE_END * stride];
}

/* Tells whether the second line applies, because enough of the strength is lost (kappa). */
static inline bool gn_softening_second(const gn_softening_bond *bond) {
    return bond->fade[GN_FADE_KINK] > 0.0 && bond->kappa >= bond->fade[GN_FADE_KINK];
}

/* Stretches a bond to u along the softening lines; returns false if it breaks. */
static inline bool gn_soften_pulled(gn_softening_bond *bond, double u, double *normal) {
    if (!(u > 0.0) || bond->soft * bond->kn * u < bond->rn) return true;
    double left = gn_softening_end(bond->fade, 1) - u;
    if (!(left > 0.0)) return false;
    double line = bond->fade[GN_FADE_SLOPE] * (bond->fade[GN_FADE_END] - u);
    double force = fmin(fmax(line, bond->fade[GN_FADE_SLOPE_SECOND] * left), bond->rn);
    if (!(force > 0.0)) return false;
    bond->soft = fmin(bond->soft, force / (bond->kn * u));
    bond->rn = force;
    *normal = force;
    return true;
}

/* Applies slip to a trial force of size `size` under the compression n; returns the remaining size;
 * negative: the bond is broken. Until kappa exceeds d, the cohesion is reduced by d. */
static inline double gn_soften_sheared(gn_softening_bond *bond, double n, double size) {
    const double cohesion = bond->fade[GN_FADE_COHESION], mu1 = bond->fade[GN_FADE_FRICTION];
    const double kink = bond->fade[GN_FADE_KINK], d = bond->together ? 0.0 : 1.0 - bond->soft;
    for (int piece = 0; piece < 3; piece++) {
        const bool second = gn_softening_second(bond);
        const double end = bond->fade[second ? GN_FADE_SLIP_SECOND : GN_FADE_SLIP];
        double whole = 1.0 - fmax(d, bond->kappa);
        double surface =
            whole * cohesion + ((1.0 - bond->kappa) * mu1 + bond->kappa * bond->mu2) * n;
        double excess = size - fmax(surface, 0.0);
        if (excess < 0.0) return size;
        if (!(end > 0.0)) return -1.0;
        double slope = ((bond->kappa >= d ? cohesion : 0.0) + (mu1 - bond->mu2) * n) / end;
        if (surface <= 0.0) slope = 0.0;
        if (!(slope < bond->kt)) return -1.0;
        double slip = excess / (bond->kt - slope);
        double next = bond->kappa < d ? d : 1.0;
        if (kink > bond->kappa) next = fmin(next, kink);
        double room = (next - bond->kappa) * end;
        if (slip < room) {
            bond->kappa += slip / end;
            return fmax(size - bond->kt * slip, 0.0);
        }
        size = fmax(size - bond->kt * room, 0.0);
        if (!(next < 1.0)) return -1.0;
        bond->kappa = next;
    }
    return size;
}

/* With quadratic coupling the tensile stiffness is reduced to the fraction (1 - kappa)/(base + more
 * kappa). On the first line base = 1 and more = n - 1; the second line continues from its end. */
typedef struct gn_softening_secant {
    double base, more;
} gn_softening_secant;

static inline gn_softening_secant gn_softening_secant_of(const gn_softening_bond *bond) {
    const double slope = bond->fade[GN_FADE_SLOPE], more = slope > 0.0 ? bond->kn / slope : 0.0;
    if (!gn_softening_second(bond)) return (gn_softening_secant){1.0, more};
    const double slope_second = bond->fade[GN_FADE_SLOPE_SECOND];
    const double second = slope_second > 0.0 ? bond->kn / slope_second : 0.0;
    return (gn_softening_secant){1.0 + (more - second) * bond->fade[GN_FADE_KINK], second};
}

/* Sets the common damage kappa; bond->rn and bond->soft follow from it. */
static inline void gn_soften_both(gn_softening_bond *bond, double kappa) {
    if (!(kappa > bond->kappa)) return;
    bond->rn *= (1.0 - kappa) / (1.0 - bond->kappa);
    bond->kappa = kappa;
    const gn_softening_secant s = gn_softening_secant_of(bond);
    bond->soft = (1.0 - kappa) / (s.base + s.more * kappa);
}

/* Returns the g >= 0 at which (A/(1 + P g))^2 + (B/(1 + Q g))^2 = 1; the sum is at least 1 at g =
 * 0. A result of 1 means that g is 1 or larger. Newton's method is applied to 1/root of the sum,
 * which is concave in g and linear if A or B is 0, so that it converges from below in few
 * iterations. */
static inline double gn_soften_growth(double A, double B, double P, double Q) {
    double g = 0.0;
    for (int k = 0; k < 64; k++) {
        double a = A / (1.0 + P * g), b = B / (1.0 + Q * g), square = a * a + b * b;
        double rate = a * a * P / (1.0 + P * g) + b * b * Q / (1.0 + Q * g);
        double more = (sqrt(square) - 1.0) * square / rate;
        if (!(g + more < 1.0)) return 1.0; /* without a slope there is no softening */
        if (!(more > 0x1p-52)) break;
        g += more;
    }
    return g;
}

/* Contributions of tension and shear to the failure of a bond that both damage, at the stretch u
 * and the tangential force of size `size`: the ratios A and B to the remaining strengths, and the
 * factors 1 + P and 1 + Q by which these ratios decrease while kappa grows to 1. */
typedef struct gn_softening_shares {
    double A, B, P, Q;
} gn_softening_shares;

static inline gn_softening_shares gn_softening_shares_at(const gn_softening_bond *bond, double u,
                                                         double size) {
    const gn_softening_secant secant = gn_softening_secant_of(bond);
    const double left = 1.0 - bond->kappa, cohesion = bond->fade[GN_FADE_COHESION];
    const double slip = bond->fade[gn_softening_second(bond) ? GN_FADE_SLIP_SECOND : GN_FADE_SLIP];
    gn_softening_shares s = {.A = bond->soft * bond->kn * u / bond->rn,
                             .B = size > 0.0 ? size / bond->rt : 0.0};
    s.P = secant.more * left / (secant.base + secant.more * bond->kappa);
    s.Q = cohesion > 0.0 ? fmax(bond->kt * slip / cohesion - 1.0, 0.0) : 0.0;
    return s;
}

static inline double gn_softening_size(const double t[3]) {
    return sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
}

/* Path of a bond in a step: stretch and tangential force at its start, and at its end if there were
 * no limit. */
typedef struct gn_softening_way {
    double u[2], t[2][3];
} gn_softening_way;

/* Returns the cause of failure of a bond under tension and shear: the larger ratio at the point of
 * the path where the strength vanished, which is where A/(1 + P) and B/(1 + Q) reach the ellipse.
 * (The end of the step would be misleading: the strength at its start may be arbitrarily small, and
 * any tangential motion of the step is then a large multiple of it.) */
static inline gn_cause gn_softening_cause(const gn_softening_bond *bond,
                                          const gn_softening_way *way) {
    double low = 0.0, high = 1.0, a = 0.0, c = 0.0;
    for (int turn = 0; turn < 60; turn++) {
        double at = turn ? 0.5 * (low + high) : 0.0, t[3];
        for (int x = 0; x < 3; x++) t[x] = way->t[0][x] + at * (way->t[1][x] - way->t[0][x]);
        double u = way->u[0] + at * (way->u[1] - way->u[0]);
        gn_softening_shares s = gn_softening_shares_at(bond, fmax(u, 0.0), gn_softening_size(t));
        a = s.A / (1.0 + s.P);
        c = s.B / (1.0 + s.Q);
        if (a * a + c * c >= 1.0)
            high = at;
        else
            low = at;
        if (!(high > 0.0)) break; /* at the start, up to rounding, or held by pressure */
    }
    return a >= c ? GN_BROKEN_TENSION : GN_BROKEN_SHEAR;
}

/* Stretches and shears a bond with quadratic coupling. After growth by g the fraction 1 - g of the
 * strength remains: the trial force along the secant is multiplied by (1 - g)/(1 + P g), the
 * tangential one by (1 - g)/(1 + Q g). Growth beyond a kink is computed up to the kink and
 * continues from there. Returns false if no strength remains. */
static inline bool gn_soften_together(gn_softening_bond *bond, double u, double *normal,
                                      double t[3]) {
    const double kink = bond->fade[GN_FADE_KINK];
    for (;;) {
        const gn_softening_shares s = gn_softening_shares_at(bond, u, gn_softening_size(t));
        *normal = bond->soft * bond->kn * u;
        if (s.A * s.A + s.B * s.B < 1.0) return true;
        double g = gn_soften_growth(s.A, s.B, s.P, s.Q);
        double kappa = bond->kappa + g * (1.0 - bond->kappa);
        const bool bends = kink > bond->kappa && kappa >= kink;
        if (bends) {
            g = (kink - bond->kappa) / (1.0 - bond->kappa);
            kappa = kink;
            bond->rt *= 1.0 - g; /* the next fraction refers to this */
        }
        if (!(kappa < 1.0)) return false;
        gn_soften_both(bond, kappa);
        *normal = bond->soft * bond->kn * u;
        for (int x = 0; x < 3; x++) t[x] *= (1.0 - g) / (1.0 + s.Q * g);
        if (!bends) return true;
    }
}

/* Applies the limit of the normal force first, then that of the tangential force. */
static inline gn_cause gn_soften_apart(gn_softening_bond *bond, double u, double *normal,
                                       double t[3]) {
    if (!bond->together && !gn_soften_pulled(bond, u, normal)) return GN_BROKEN_TENSION;
    double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), kappa = bond->kappa;
    double pressed = isnan(bond->confined) ? -*normal : bond->confined;
    double left = gn_soften_sheared(bond, fmax(pressed, bond->least), size);
    if (left < 0.0) return GN_BROKEN_SHEAR;
    if (left < size)
        for (int x = 0; x < 3; x++) t[x] *= left / size;
    if (!bond->together) return GN_INTACT;
    double grown = bond->kappa;
    bond->kappa = kappa;
    gn_soften_both(bond, grown);
    return GN_INTACT;
}

/* Advances the bond along `way`. *normal is the normal force of the undamaged bond; it and the
 * tangential force t are reduced to the forces that the bond carries, unless it breaks. */
static inline gn_cause gn_soften(gn_softening_bond *bond, const gn_softening_way *way,
                                 double *normal, double t[3]) {
    const double u = way->u[1];
    gn_cause cause = GN_INTACT;
    for (int x = 0; x < 3; x++) t[x] = way->t[1][x];
    if (!bond->together || !(u > 0.0))
        cause = gn_soften_apart(bond, u, normal, t);
    else if (!gn_soften_together(bond, u, normal, t))
        cause = gn_softening_cause(bond, way);
    if (cause != GN_INTACT) return cause;
    double gone = bond->together ? bond->kappa : fmax(1.0 - bond->soft, bond->kappa);
    bond->rt = (1.0 - gone) * bond->fade[GN_FADE_COHESION];
    bond->mu1 = (1.0 - bond->kappa) * bond->fade[GN_FADE_FRICTION] + bond->kappa * bond->mu2;
    return GN_INTACT;
}

#endif
