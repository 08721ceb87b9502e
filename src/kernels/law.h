/* A contact law outside of the kernels: its parameters, the largest stiffness of a contact, its
 * energy, the ratio of its force to its strength; and its force at walls and surfaces, one contact
 * at a time. A law is law_<name>.h (forces, for the kernels) and law_<name>.c (this table); no
 * other code depends on the meaning of its columns. */
#ifndef GN_KERNELS_LAW_H
#define GN_KERNELS_LAW_H

#include "kernels/contact.h"
#include "scene/scene.h"

/* Averages over the packing on which parameters may depend; 0 if not used. */
typedef struct gn_derived {
    double radius;  /* m: stiffness is 2 E_c radius */
    double radius2; /* m2: strengths are 4 sigma_c radius2, 4 tau_c radius2 */
    double gamma;   /* ratio of the section of a pair that was never bonded to Dempack's */
    /* area of bonds per area of a plane that cuts them, if fracture energies refer to planes; else
     * 0 */
    double cut;
} gn_derived;

/* Parameters common to all contacts. */
typedef struct gn_law_model {
    const gn_scene *scene;
    gn_derived derived;
    double damping_fraction; /* fraction of the critical damping, for contacts in compression */
    double dt;               /* s, the coming step; 0: none yet */
} gn_law_model;

/* The two particles of a contact. */
typedef struct gn_law_pair {
    const gn_material *a, *b;
    double ri, rj; /* m */
    /* 1/kg, of both along the line of the centres; only with a damping fraction */
    double inverse_mass;
    const gn_contact_def *own; /* parameters of this pair of materials; NULL: none */
    double area, length;       /* m2, m: section and length of a bond; 0: none is stored */
    uint64_t draw_id;          /* number of the random properties of a bond; 0: none are random */
} gn_law_pair;

/* A contact as a spring of the linearised system. */
typedef struct gn_law_spring {
    double kn, kt, cn; /* N/m, N/m, N s/m */
} gn_law_spring;

/* Forces and energy of a contact at the end of a step, on its first particle. */
typedef struct gn_law_held {
    double normal;   /* N, tension positive, without the dashpot */
    double viscous;  /* N, force of the dashpot along the normal */
    double shear[3]; /* N */
    double stored;   /* J */
} gn_law_held;

/* The moments of a bond, for the normal n of the last evaluation of forces. */
typedef struct gn_law_moments {
    double couple[3];     /* N m, moment on the first particle; opposite on the other */
    double stored;        /* J */
    double normal, shear; /* N: increase of normal and shear force at the extreme fibre */
    double bend, twist;   /* N m, stiffness against relative rotation across n and about n */
} gn_law_moments;

/* Effective Hertz-Mindlin parameters of two materials (law_hertz.c). */
typedef struct gn_hertz_pair {
    double modulus, shear_modulus; /* Pa: E*, G* */
    double damping;                /* c_n/sqrt(m S_n) */
    double friction, rolling, twisting;
    int cohesion;    /* gn_cohesion */
    double adhesion; /* J/m2 = N/m: w, with liquid gamma cos theta; see cohesion.h */
} gn_hertz_pair;

/* Contact parameters of a wall or a surface. If several contacts share a stiffness, `part` is the
 * fraction that this one has. */
typedef struct gn_touch_side {
    double stiffness, kratio, friction, part;
    double radius;       /* m, radius of the particle; this and all below with GN_FX_HERTZ only */
    gn_hertz_pair hertz; /* parameters with the particle's material; includes friction */
    double rolling, twisting; /* coefficients, with GN_FX_ROLLING */
} gn_touch_side;

/* A contact with a wall or a surface at one instant. The normal points from the particle into it,
 * as to a second particle. */
typedef struct gn_touch {
    double n[3];
    double gap;      /* m, negative in compression */
    double rounding; /* m: an overlap within this rounding of the gap counts as none */
    double speed;    /* m/s, velocity of the wall relative to the particle along n */
    /* m/s, velocity of the wall relative to the particle across n, at the contact point */
    double relative[3];
    double twist;        /* rad/s, sum of both spins about n */
    double inverse_mass; /* 1/kg, sum over both sides */
    /* 1/kg, inverse mass to which the dashpot refers: with the whole body of a deformable surface;
     * 0: inverse_mass */
    double body_inverse_mass;
    double other_acceleration; /* m/s2, acceleration of the gap by all forces but this contact; only
                                  where it may cross */
    double checked_overlap;    /* m, overlap up to which the step was checked; with GN_FX_HERTZ */
    /* m^-1/2; in: value of the last step, out: of this one; with GN_FX_HERTZ and a shear force */
    double *closeness;
    double spin[3]; /* rad/s, spin of the wall relative to the particle; with GN_FX_ROLLING */
    /* [3] columns of roll_stride, N m; in: moment on the particle in the last step, rotated with
     * the normal; out: that of this step, which *couple receives too; NULL: none */
    double *roll;
    size_t roll_stride;
    double *couple; /* [3] */
    /* with GN_FX_COHESION, in and out: see the column `bridge`; m3, liquid on the particle */
    double *bridge, *film;
} gn_touch;

/* The step that led to the contact's instant. */
typedef struct gn_touch_step {
    double dt;               /* s */
    double damping_fraction; /* fraction of the critical damping */
    bool damping, space, spins;
    bool pulls;     /* Hertz's law: the dashpot may cause tension */
    double rupture; /* (1 + theta/2)^3, see cohesion.h */
} gn_touch_step;

/* Returns the inverse of the mass to which a dashpot refers, 1/kg. */
static inline double gn_touch_damped(const gn_touch *touch) {
    return touch->body_inverse_mass > 0.0 ? touch->body_inverse_mass : touch->inverse_mass;
}

/* Tells whether a contact closed or opened within the step, if its gap grew by `path`. */
static inline bool gn_touch_crosses(const gn_touch *touch, double path) {
    return (touch->gap < -touch->rounding) != (touch->gap - path < -touch->rounding);
}

/* Returns a value of a column that is single in mixed precision; 0 if it does not exist. */
static inline double gn_column_value(const double *column, const float *single, size_t at) {
    return column ? column[at] : single ? (double)single[at] : 0.0;
}

/* The functions of a law. `overlap`, m: the largest overlap of an unbonded contact up to which the
 * result is valid. */
typedef struct gn_law {
    /* Computes averages of the packing, over its particles or over the initial contacts, in their
     * order; returns false if there is nothing to average over. */
    bool (*derive)(const gn_scene *scene, const gn_particles *particles, const int32_t (*pair)[2],
                   size_t count, gn_derived *derived);
    /* Writes the parameters of contact c, including the strengths of bonds. The second function
     * writes those that depend on the step, after it has changed, in single precision as well. */
    void (*set)(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c);
    void (*set_dashpot)(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                        size_t c);
    /* Scales contact c, whose parameters have just been set, so that its forces and energies have
     * the fraction `part` of their values in any motion. NULL: the law does not support it. */
    void (*weigh)(gn_contacts *list, size_t c, double part);
    /* Returns the largest stiffness of two particles that come into contact without a bond. For a
     * given partner k_n (1/m_i + 1/m_j) must have its maximum at the least or the greatest radius
     * of a material, because src/timestep/collisions.c evaluates only these. */
    gn_law_spring (*meeting)(const gn_law_model *model, const gn_law_pair *pair, double overlap);
    /* Returns the largest stiffness that contact c can have. */
    gn_law_spring (*spring)(const gn_contacts *list, size_t c, double overlap);
    /* Returns the forces and energy of contact c at a `length` between its ends, which is the
     * distance of zero normal force plus `stretch`. */
    gn_law_held (*held)(const gn_contacts *list, size_t c, double length, double stretch);
    /* Deactivates contact c, one of whose particles was removed. The caller records the cause. */
    void (*release)(gn_contacts *list, size_t c);
    /* Returns the largest ratio of force to strength of an intact bond. `bent`: increase by moments
     * of the normal force at the extreme fibre, which does not count as pressure for friction;
     * `shear` includes their increase of the shear force. */
    double (*criterion)(const gn_contacts *list, size_t c, double normal, double bent,
                        double shear);
    /* Tells whether contact c, which is not an intact bond, slides under these forces. */
    bool (*slips)(const gn_contacts *list, size_t c, double normal, double shear);

    /* Returns the largest stiffness of a contact with a wall, for a particle with
     * `inverse_mass`. */
    gn_law_spring (*touch_spring)(const gn_touch_side *side, double inverse_mass,
                                  double damping_fraction, double overlap);
    /* Returns the energy, J, of the normal force (N) and of a tangential force of square `shear2`
     * (N2). */
    double (*touch_stored)(const gn_touch_side *side, double normal, double shear2);
    /* Computes the force on the particle: returns its component along n and sets t, the rest. `fd`
     * (may be NULL): in: viscous force of the last step, out: of this one. `shear` (may be NULL)
     * [3] columns of `stride`: in: tangential force of the last step, rotated to the present normal
     * by the caller, out: the new one. Energies are added to *sums. */
    double (*touch)(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                    double *fd, double *shear, size_t stride, double t[3], gn_contact_sums *sums);

    /* Returns the moments of contact c, with n from its first particle to its second; NULL:
     * contacts of this law have none. */
    gn_law_moments (*moments)(const gn_contacts *list, size_t c, const double n[3]);

    /* Returns the section to which stresses of a contact refer, m2; NULL: gn_linear_section. `rj`
     * of a pair may be infinite. */
    double (*area)(const gn_law_pair *pair, double overlap);
} gn_law;

#define X(name, ...) extern const gn_law gn_law_##name;
GN_LAWS(X)
#undef X

/* Parameters by area (law_area.c): those of a bond, and the largest stiffnesses of two particles in
 * contact without a bond. */
typedef struct gn_area_parameters {
    double kn, kt, rn, rt;
} gn_area_parameters;
gn_area_parameters gn_area_parameters_of(const gn_law_model *model, const gn_law_pair *pair);
gn_area_parameters gn_area_meeting(const gn_law_model *model, const gn_law_pair *pair);
/* Returns Dempack's section of a pair without gamma, m2, in 2D m x 1 m (Santasusana 2013, 4.5). */
double gn_dempack_area(int dimension, double ri, double rj);

/* Functions of the linear law, which the tables of other laws may contain (law_linear.c). */
bool gn_linear_derive(const gn_scene *scene, const gn_particles *particles,
                      const int32_t (*pair)[2], size_t count, gn_derived *derived);
/* Returns the section to which the strengths of a pair refer, m2 (2D: m x 1 m); the uniform law,
 * whose strengths are forces, has that of the mean radius. It does not depend on random properties
 * of a bond. */
double gn_linear_section(const gn_law_model *model, const gn_law_pair *pair);
void gn_linear_set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c);
void gn_linear_set_dashpot(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                           size_t c);
void gn_linear_weigh(gn_contacts *list, size_t c, double part);
gn_law_spring gn_linear_meeting(const gn_law_model *model, const gn_law_pair *pair, double overlap);
gn_law_spring gn_linear_spring(const gn_contacts *list, size_t c, double overlap);
gn_law_held gn_linear_held(const gn_contacts *list, size_t c, double length, double stretch);
void gn_linear_release(gn_contacts *list, size_t c);
double gn_linear_criterion(const gn_contacts *list, size_t c, double normal, double bent,
                           double shear);
/* Returns the shear strength of a bond under its normal force, including the effect of pressure, N
 * (law_mohr.c). */
double gn_mohr_strength(const gn_contacts *list, size_t c, double normal);
double gn_mohr_criterion(const gn_contacts *list, size_t c, double normal, double bent,
                         double shear);
bool gn_linear_slips(const gn_contacts *list, size_t c, double normal, double shear);
gn_law_spring gn_linear_touch_spring(const gn_touch_side *side, double inverse_mass,
                                     double damping_fraction, double overlap);
double gn_linear_touch_stored(const gn_touch_side *side, double normal, double shear2);
/* Returns the normal force alone, without the effect of other_acceleration, and stores nothing. */
double gn_linear_press(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch);
double gn_linear_touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                       double *fd, double *shear, size_t stride, double t[3],
                       gn_contact_sums *sums);

/* Table entries of laws that are linear except for the strength of their bonds; the second macro is
 * for laws whose wall contacts are linear, too. */
#define GN_LINEAR_SPRINGS                                                                          \
    .derive = gn_linear_derive, .set_dashpot = gn_linear_set_dashpot,                              \
    .meeting = gn_linear_meeting, .spring = gn_linear_spring, .slips = gn_linear_slips,            \
    .touch_spring = gn_linear_touch_spring, .touch_stored = gn_linear_touch_stored
#define GN_LINEAR_FUNCTIONS GN_LINEAR_SPRINGS, .touch = gn_linear_touch

/* Functions of Hertz's law (law_hertz.c), and common entries of laws with its springs. */
bool gn_hertz_derive(const gn_scene *scene, const gn_particles *particles, const int32_t (*pair)[2],
                     size_t count, gn_derived *derived);
void gn_hertz_set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c);
void gn_hertz_set_dashpot(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                          size_t c);
gn_law_spring gn_hertz_meeting(const gn_law_model *model, const gn_law_pair *pair, double overlap);
gn_law_spring gn_hertz_spring(const gn_contacts *list, size_t c, double overlap);
gn_law_held gn_hertz_held(const gn_contacts *list, size_t c, double length, double stretch);
gn_law_spring gn_hertz_touch_spring(const gn_touch_side *side, double inverse_mass,
                                    double damping_fraction, double overlap);
double gn_hertz_touch_stored(const gn_touch_side *side, double normal, double shear2);
double gn_hertz_touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                      double *fd, double *shear, size_t stride, double t[3], gn_contact_sums *sums);
/* The normal force of a wall contact without its dashpot, and the circle of the contact. */
typedef struct gn_touch_press {
    double normal; /* N, tension positive */
    double beside; /* N, the attraction that presses the solids in addition to -normal */
    double root;   /* m^1/2, root of the overlap, or what takes its place */
    double stored; /* J */
} gn_touch_press;
/* Returns the force of a wall contact whose normal force is given, as `touch` does. */
double gn_hertz_touch_by(const gn_touch_step *step, const gn_touch_side *side,
                         const gn_touch *touch, const gn_touch_press *press, double *fd,
                         double *shear, size_t stride, double t[3], gn_contact_sums *sums);
/* Returns the contact circle's area, pi R overlap. */
double gn_hertz_area(const gn_law_pair *pair, double overlap);
#define GN_HERTZ_FUNCTIONS                                                                         \
    .derive = gn_hertz_derive, .set_dashpot = gn_hertz_set_dashpot, .meeting = gn_hertz_meeting,   \
    .spring = gn_hertz_spring, .held = gn_hertz_held, .release = gn_linear_release,                \
    .criterion = gn_linear_criterion, .slips = gn_linear_slips,                                    \
    .touch_spring = gn_hertz_touch_spring, .touch_stored = gn_hertz_touch_stored,                  \
    .area = gn_hertz_area

/* Resistance to rolling (law_rolling.c) for laws with Hertz's springs: parameters of a pair; the
 * moments of a contact; those at a wall, where `root` and `past` are the root of the overlap and
 * the inverse of the last one, and the solids press each other with `pressed` >= 0, N. */
void gn_rolling_set(const gn_law_pair *pair, gn_contacts *list, size_t c);
gn_law_moments gn_hertz_moments(const gn_contacts *list, size_t c, const double n[3]);
void gn_hertz_touch_roll(const gn_touch_step *step, const gn_touch_side *side,
                         const gn_touch *touch, double pressed, double root, double past,
                         gn_contact_sums *sums);

/* Returns the largest attraction A, N, and the length, m, of cohesion.h for a pair whose work of
 * adhesion (or gamma cos theta) is `adhesion`. `modulus`: E*, Pa; `radius`: reduced, m. */
double gn_cohesion_most(int cohesion, double adhesion, double radius);
double gn_cohesion_span(int cohesion, double adhesion, double modulus, double radius);

/* Returns the parameters of two materials (`b` NULL: a rigid wall), with keys for this pair alone
 * (NULL: none). */
gn_hertz_pair gn_hertz_pair_of(const gn_scene *scene, const gn_material *a, const gn_material *b,
                               const gn_contact_def *own);

/* The state of a bond that softens or yields. */
typedef struct gn_bond_condition {
    double tension, shear; /* damage, 0 to 1 */
    double permanent;      /* m, stretch at which its normal force is zero */
} gn_bond_condition;
gn_bond_condition gn_softening_condition(const gn_contacts *list, size_t c);

/* Returns the number of softening bonds that are too long to soften in tension: their springs store
 * more energy than they may dissipate, so that they break at once. */
size_t gn_softening_too_long(const gn_contacts *list);
/* Returns the number of bonds that soften in tension, but are brittle in shear. */
size_t gn_softening_brittle_in_shear(const gn_contacts *list);

/* Returns the law of a list by its effects; with the effects of a scene, that of its bonds. */
static inline const gn_law *gn_law_of(gn_effects effects) {
#define X(name, effect, lists)                                                                     \
    if ((effects & (effect)) == (effect)) return &gn_law_##name;
    GN_LAWS(X)
#undef X
    return &gn_law_linear;
}

#endif
