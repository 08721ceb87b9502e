/* The energy ledger: what is stored, what came in, what was dissipated and by which cause. */
#ifndef GN_MEASURE_ENERGY_H
#define GN_MEASURE_ENERGY_H

/* X(name, kind, text), all in J. STORED terms are evaluated from the state, INPUT and LOST ones are
 * accumulated step by step. Balance: stored - stored at the start = input - lost + residual. */
#define GN_ENERGY_TERMS(X)                                                                         \
    X(kinetic, STORED, "kinetic energy of translation")                                            \
    X(rotational, STORED, "kinetic energy of rotation")                                            \
    X(elastic_normal, STORED, "elastic energy of normal springs")                                  \
    X(elastic_shear, STORED, "elastic energy of tangential springs")                               \
    X(elastic_bending, STORED, "elastic energy of bonds that are bent and twisted")                \
    X(elastic_wall, STORED, "elastic energy of contacts with walls and surfaces")                  \
    X(elastic_elements, STORED, "elastic energy of finite elements")                               \
    X(elastic_coupling, STORED, "elastic energy of springs that tie particles to elements")        \
    X(work_walls, INPUT, "work of moving walls, bodies and sides of a periodic box")               \
    X(work_prescribed, INPUT, "work of prescribed motions")                                        \
    X(work_applied, INPUT, "work of applied forces")                                               \
    X(work_gravity, INPUT, "work of gravity")                                                      \
    X(inserted, INPUT, "brought in by particles of sources")                                       \
    X(step_change, INPUT,                                                                          \
      "of particles and bodies, by changes of the step and masses raised for it")                  \
    X(stage_change, INPUT, "stored in contacts by going from one stage to the next")               \
    X(friction, LOST, "dissipated by sliding friction")                                            \
    X(contact_damping, LOST, "dissipated by contact damping")                                      \
    X(background_damping, LOST, "dissipated by background damping")                                \
    X(coupling_damping, LOST, "dissipated by dashpots that tie particles to elements")             \
    X(bond_breaking, LOST, "released by breaking bonds")                                           \
    X(damage, LOST, "dissipated by bonds that soften")                                             \
    X(plasticity, LOST, "dissipated by bonds that yield under pressure")                           \
    X(rolling, LOST, "dissipated by resistance to rolling and twisting")                           \
    X(removed, LOST, "carried away by removed particles")                                          \
    X(conversion, LOST, "what elements held more than the particles that they turned into")

typedef struct gn_energy {
#define X(name, kind, text) double name;
    GN_ENERGY_TERMS(X)
#undef X
    double stored_at_start; /* J */
    double passed;          /* J, the most that gn_energy_passed gave at an instant before, and at
                               least what rounding makes by itself */
} gn_energy;

/* Works are trapezoidal: of what happens between two instants half is booked with the forces of the
 * one and half with those of the other. At an instant the half of the interval before it comes
 * first, then that of the interval after it; a reading lies between them. */
typedef enum gn_half { GN_HALF_BEFORE, GN_HALF_AFTER } gn_half;

/* A ledger as it is shown: its terms, then what was stored at the start and the residual. */
#define GN_ENERGY_RESIDUAL_TEXT                                                                    \
    "what the ledger does not explain, over the energy that has gone through"
typedef struct gn_energy_figure {
    const char *name, *unit, *text;
    const char *kind; /* "stored", "input", "lost"; NULL: of the whole ledger */
    double value;
} gn_energy_figure;
#define GN_COUNT_ONE(...) +1
enum { GN_ENERGY_FIGURES = 2 GN_ENERGY_TERMS(GN_COUNT_ONE) };
#undef GN_COUNT_ONE
void gn_energy_figures(const gn_energy *energy, gn_energy_figure figures[GN_ENERGY_FIGURES]);

/* Sum of the stored terms. */
double gn_energy_stored(const gn_energy *energy);

/* What has gone through the system at this instant: the largest of what came in, what was stored at
 * the start, what is stored and what was dissipated, each as a sum of absolute values. */
double gn_energy_passed(const gn_energy *energy);

/* The most that has gone through so far, which is what the residual is measured against: inputs
 * that are taken back (a ball thrown up that comes down, a wall that goes to and fro) leave none of
 * the terms large, and yet the work was done. */
double gn_energy_scale(const gn_energy *energy);

/* (stored - stored_at_start - input + lost)/scale; 0 when the scale is 0. */
double gn_energy_residual(const gn_energy *energy);

#endif
