/* A contact law as all but the kernels see it: what its parameters are, what spring a contact is at
 * most, what it holds, how near it is to its strength; and its force at walls and surfaces, one
 * contact at a time. A law is law_<name>.h (forces, for the kernels) and law_<name>.c (this table);
 * nothing else knows what its columns mean. */
#ifndef GN_KERNELS_LAW_H
#define GN_KERNELS_LAW_H

#include "kernels/contact.h"
#include "scene/scene.h"

/* Averages over the packing that parameters may follow from; 0 when not used. */
typedef struct gn_derived {
    double radius;  /* m: stiffness is 2 E_c radius */
    double radius2; /* m2: strengths are 4 sigma_c radius2, 4 tau_c radius2 */
    double gamma;   /* section of a pair that was never bonded over Dempack's */
    double cut; /* bond area that a plane cuts over its own, where fracture energies are those of
                   planes; else 0 */
} gn_derived;

/* What holds for all contacts. */
typedef struct gn_law_model {
    const gn_scene *scene;
    gn_derived derived;
    double damping_fraction; /* of critical, of contacts that are pressed */
    double dt;               /* s, the step to come; 0: none yet */
} gn_law_model;

/* What a law is told of two particles. */
typedef struct gn_law_pair {
    const gn_material *a, *b;
    double ri, rj;       /* m */
    double inverse_mass; /* 1/kg, with which both give way along the line of their centres; with a
                            damping fraction only */
    const gn_contact_def *own; /* what holds for this pair of materials alone; NULL: nothing */
    double area, length;       /* m2, m: section and length of a bond; 0: none is kept */
    uint64_t lot;              /* of what is drawn for a bond; 0: nothing is */
} gn_law_pair;

/* A contact in the linearised system. */
typedef struct gn_law_spring {
    double kn, kt, cn; /* N/m, N/m, N s/m */
} gn_law_spring;

/* What a contact held at the end of a step, on its first particle. */
typedef struct gn_law_held {
    double normal;   /* N, tension positive, without the dashpot */
    double viscous;  /* N, of the dashpot, along the normal */
    double shear[3]; /* N */
    double stored;   /* J */
} gn_law_held;

/* What the moments of a bond come to, along n of the last instant. */
typedef struct gn_law_moments {
    double couple[3];     /* N m, on the first particle; the other has the opposite */
    double stored;        /* J */
    double normal, shear; /* N: by how much the extreme fibre is nearer to its strength */
    double bend, twist; /* N m, stiffness against the difference of the spins across n and along */
} gn_law_moments;

/* What two materials are to each other by Hertz's law (law_hertz.c). */
typedef struct gn_hertz_pair {
    double modulus, shear_modulus; /* Pa: E*, G* */
    double damping;                /* c_n/sqrt(m S_n) */
    double friction, rolling, twisting;
} gn_hertz_pair;

/* What a wall or a surface says of its contacts, and the part that one contact is of several that
 * share. */
typedef struct gn_touch_side {
    double stiffness, kratio, friction, part;
    double radius;            /* m, of the particle; this and what follows with GN_FX_HERTZ only */
    gn_hertz_pair hertz;      /* with the particle's material; friction is here */
    double rolling, twisting; /* coefficients, with GN_FX_ROLLING */
} gn_touch_side;

/* A contact with a wall or a surface at one instant. Normal from the particle into it, as for a
 * second particle. */
typedef struct gn_touch {
    double n[3];
    double gap;          /* m, negative while it presses */
    double rounding;     /* m, of the gap: an overlap within it is none */
    double speed;        /* m/s, of the wall against the particle along n */
    double relative[3];  /* m/s, the same across n, at the point of contact */
    double twist;        /* rad/s, sum of both spins about n */
    double inverse_mass; /* 1/kg, sum over both sides */
    double whole;        /* 1/kg, the same with a surface that deforms taken as the body behind it,
                            for the dashpot; 0: inverse_mass */
    double other;        /* m/s2, of the gap, by all but this contact; where it may cross only */
    double most;         /* m, overlap up to which the step was looked at; with GN_FX_HERTZ */
    double *closeness;   /* m^-1/2, of the last step, then of this one; with it and a shear force */
    double spin[3];      /* rad/s, of the wall against the particle; with GN_FX_ROLLING */
    double *roll; /* [3] columns of roll_stride, N m: moment on the particle of the last step,
                     turned with the normal, then of this one, as in *couple; NULL: none */
    size_t roll_stride;
    double *couple; /* [3] */
} gn_touch;

/* Of the step that led to it. */
typedef struct gn_touch_step {
    double dt;               /* s */
    double damping_fraction; /* of critical */
    bool damping, space, spins;
    bool pulls; /* Hertz: the dashpot may */
} gn_touch_step;

/* 1/kg, of the mass that a dashpot belongs to. */
static inline double gn_touch_damped(const gn_touch *t) {
    return t->whole > 0.0 ? t->whole : t->inverse_mass;
}

/* Whether it closed or opened within the step, when its gap grew by `path`. */
static inline bool gn_touch_crosses(const gn_touch *t, double path) {
    return (t->gap < -t->rounding) != (t->gap - path < -t->rounding);
}

/* `overlap`, m: how far a contact that is not bonded can be pressed while the answer is to hold. */
typedef struct gn_law {
    /* Averages of the packing, over its particles or over the contacts at the start, in their
     * order; false: there is none to average over. */
    bool (*derive)(const gn_scene *scene, const gn_particles *particles, const int32_t (*pair)[2],
                   size_t count, gn_derived *derived);
    /* Writes the parameters of contact c, of bonds their strengths as well; the second function
     * those that follow the step, after it has changed, in single precision as well. */
    void (*set)(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c);
    void (*set_dashpot)(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list,
                        size_t c);
    /* Takes a part of contact c, whose parameters have just been set: forces and energies of it are
     * `part` of what they were, whatever its motion. NULL: the law has no parts. */
    void (*weigh)(gn_contacts *list, size_t c, double part);
    /* The largest stiffness that two particles can show which meet unbonded. For a given partner
     * k_n (1/m_i + 1/m_j) must have its maximum at the least or the greatest radius of a material
     * (src/timestep/collisions.c looks at no others). */
    gn_law_spring (*meeting)(const gn_law_model *model, const gn_law_pair *pair, double overlap);
    /* The largest stiffness that contact c can show. */
    gn_law_spring (*spring)(const gn_contacts *list, size_t c, double overlap);
    /* What contact c held when its ends were `length` apart, `stretch` beyond the distance at which
     * there is no normal force. */
    gn_law_held (*held)(const gn_contacts *list, size_t c, double length, double stretch);
    /* Contact c acts no more and holds nothing: one of its particles has left. Who calls notes the
     * cause. */
    void (*release)(gn_contacts *list, size_t c);
    /* The largest of force over strength of a bond that holds. `bent`: what moments add to the
     * normal force at the extreme fibre, which is no pressure that friction sees; what they add to
     * the shear force is in that. */
    double (*criterion)(const gn_contacts *list, size_t c, double normal, double bent,
                        double shear);
    /* Whether contact c, no bond that holds, slides under these forces. */
    bool (*slips)(const gn_contacts *list, size_t c, double normal, double shear);

    /* The largest stiffness of a contact with a wall, with a particle that gives way by
     * `inverse_mass`. */
    gn_law_spring (*touch_spring)(const gn_touch_side *side, double inverse_mass,
                                  double damping_fraction, double overlap);
    /* J, stored by the normal force and a tangential one of square `shear2`, N and N2. */
    double (*touch_stored)(const gn_touch_side *side, double normal, double shear2);
    /* Force on the particle: the returned value along n, and t across it. `fd` (may be NULL):
     * viscous force of the last step, then of this one; `shear` (may be NULL) [3] columns of
     * `stride`: the tangential force of the last step, across the normal of this one, then the new
     * one. Turns of the normal are the caller's. Energies go to *sums. */
    double (*touch)(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                    double *fd, double *shear, size_t stride, double t[3], gn_contact_sums *sums);

    /* The moments that contact c holds besides, with n from its first particle to its second; NULL:
     * contacts of this law carry none. */
    gn_law_moments (*moments)(const gn_contacts *list, size_t c, const double n[3]);

    /* m2, that stresses of a contact are over; NULL: gn_linear_section. `rj` of a pair may be
     * infinite. */
    double (*area)(const gn_law_pair *pair, double overlap);
} gn_law;

#define X(name, ...) extern const gn_law gn_law_##name;
GN_LAWS(X)
#undef X

/* Parameters by area (law_area.c): those of a bond, and the stiffnesses that two particles show at
 * most which meet unbonded. */
typedef struct gn_area_parameters {
    double kn, kt, rn, rt;
} gn_area_parameters;
gn_area_parameters gn_area_parameters_of(const gn_law_model *m, const gn_law_pair *q);
gn_area_parameters gn_area_meeting(const gn_law_model *model, const gn_law_pair *pair);
/* m2, in 2D m x 1 m: Dempack's section of a pair, without gamma (Santasusana 2013, 4.5). */
double gn_dempack_area(int dimension, double ri, double rj);

/* The functions of the linear law, which may stand in the tables of others (law_linear.c). */
bool gn_linear_derive(const gn_scene *scene, const gn_particles *particles,
                      const int32_t (*pair)[2], size_t count, gn_derived *derived);
/* m2, in 2D m x 1 m: the section that strengths of a pair are over; of the uniform law, whose
 * strengths are forces, that of the mean radius. What is drawn for a bond does not change it. */
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
/* N, the shear strength of a bond under its normal force, with what pressure adds (law_mohr.c). */
double gn_mohr_strength(const gn_contacts *list, size_t c, double normal);
double gn_mohr_criterion(const gn_contacts *list, size_t c, double normal, double bent,
                         double shear);
bool gn_linear_slips(const gn_contacts *list, size_t c, double normal, double shear);
gn_law_spring gn_linear_touch_spring(const gn_touch_side *side, double inverse_mass,
                                     double damping_fraction, double overlap);
double gn_linear_touch_stored(const gn_touch_side *side, double normal, double shear2);
/* The part along n alone, without `other`, of which nothing is kept. */
double gn_linear_press(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch);
double gn_linear_touch(const gn_touch_step *step, const gn_touch_side *side, const gn_touch *touch,
                       double *fd, double *shear, size_t stride, double t[3],
                       gn_contact_sums *sums);

/* What the tables of laws share that are linear but for the strength of their bonds; the second
 * those whose contacts with walls are linear too. */
#define GN_LINEAR_SPRINGS                                                                          \
    .derive = gn_linear_derive, .set_dashpot = gn_linear_set_dashpot,                              \
    .meeting = gn_linear_meeting, .spring = gn_linear_spring, .slips = gn_linear_slips,            \
    .touch_spring = gn_linear_touch_spring, .touch_stored = gn_linear_touch_stored
#define GN_LINEAR_FUNCTIONS GN_LINEAR_SPRINGS, .touch = gn_linear_touch

/* Those of Hertz's law (law_hertz.c), and what the tables of laws with his springs share. */
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
/* The circle of contact, pi R overlap. */
double gn_hertz_area(const gn_law_pair *pair, double overlap);
#define GN_HERTZ_FUNCTIONS                                                                         \
    .derive = gn_hertz_derive, .set_dashpot = gn_hertz_set_dashpot, .meeting = gn_hertz_meeting,   \
    .spring = gn_hertz_spring, .held = gn_hertz_held, .release = gn_linear_release,                \
    .criterion = gn_linear_criterion, .slips = gn_linear_slips,                                    \
    .touch_spring = gn_hertz_touch_spring, .touch_stored = gn_hertz_touch_stored,                  \
    .area = gn_hertz_area

/* Of two materials (`b` NULL: a rigid wall) and what holds for them alone (NULL: nothing). */
gn_hertz_pair gn_hertz_pair_of(const gn_scene *scene, const gn_material *a, const gn_material *b,
                               const gn_contact_def *own);

/* What a bond that softens or yields has gone through. */
typedef struct gn_bond_condition {
    double tension, shear; /* damage, 0 to 1 */
    double permanent;      /* m, stretch at which its normal force is zero */
} gn_bond_condition;
gn_bond_condition gn_softening_condition(const gn_contacts *list, size_t c);

/* How many bonds were to soften in tension and are too long for it: their spring holds more energy
 * than they may dissipate, so that they break at once. */
size_t gn_softening_too_long(const gn_contacts *list);
/* Of those that soften in tension, how many break at once in shear. */
size_t gn_softening_brittle_in_shear(const gn_contacts *list);

/* The law of a list, by its effects; by those of a scene that of its bonds. */
static inline const gn_law *gn_law_of(gn_effects effects) {
#define X(name, effect, lists)                                                                     \
    if ((effects & (effect)) == (effect)) return &gn_law_##name;
    GN_LAWS(X)
#undef X
    return &gn_law_linear;
}

#endif
