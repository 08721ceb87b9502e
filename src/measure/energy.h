/* The energy ledger: stored energies, inputs and dissipation by cause. */
#ifndef GN_MEASURE_ENERGY_H
#define GN_MEASURE_ENERGY_H

/* X(name, kind, text), all in J. STORED terms are evaluated from the state, INPUT and LOST ones are
 * accumulated step by step. Balance: stored - stored at the start = input - lost + residual. */
#define GN_ENERGY_TERMS(X)                                                                         \
    X(kinetic, STORED, "kinetic energy of translation")                                            \
    X(rotational, STORED, "kinetic energy of rotation")                                            \
    X(elastic_normal, STORED, "elastic energy of normal springs")                                  \
    X(elastic_shear, STORED, "elastic energy of tangential springs")                               \
    X(elastic_bending, STORED, "elastic energy of bending and twisting of bonds")                  \
    X(elastic_wall, STORED, "elastic energy of contacts with walls and surfaces")                  \
    X(elastic_elements, STORED, "elastic energy of finite elements")                               \
    X(elastic_coupling, STORED, "elastic energy of springs that tie particles to elements")        \
    X(work_walls, INPUT, "work of moving walls, bodies and sides of a periodic box")               \
    X(work_prescribed, INPUT, "work of prescribed motions")                                        \
    X(work_applied, INPUT, "work of applied forces")                                               \
    X(work_gravity, INPUT, "work of gravity")                                                      \
    X(work_user, INPUT, "work of forces and changes of velocity by programs")                      \
    X(inserted, INPUT, "energy of particles inserted by sources")                                  \
    X(step_change, INPUT, "change of kinetic energy by changes of the step and by mass scaling")   \
    X(stage_change, INPUT, "change of stored energy of contacts at the start of a stage")          \
    X(friction, LOST, "dissipated by sliding friction")                                            \
    X(contact_damping, LOST, "dissipated by contact damping")                                      \
    X(background_damping, LOST, "dissipated by background damping")                                \
    X(coupling_damping, LOST, "dissipated by dashpots that tie particles to elements")             \
    X(bond_breaking, LOST, "released by breaking bonds")                                           \
    X(damage, LOST, "dissipated by bonds that soften")                                             \
    X(plasticity, LOST, "dissipated by bonds that yield under pressure")                           \
    X(rolling, LOST, "dissipated by resistance to rolling and twisting")                           \
    X(cohesion, LOST, "dissipated by attractive contacts that form and separate")                  \
    X(removed, LOST, "energy of removed particles")                                                \
    X(conversion, LOST, "energy of converted elements minus that of their particles")

typedef struct gn_energy {
#define X(name, kind, text) double name;
    GN_ENERGY_TERMS(X)
#undef X
    double stored_at_start; /* J */
    double
        passed; /* J, maximum of gn_energy_throughput so far, and at least the effect of rounding */
} gn_energy;

/* Works are trapezoidal: one half of the work in an interval is booked with the forces at its
 * beginning, the other half with those at its end. At an instant the second half of the last
 * interval is booked first, then the first half of the coming one; a reading is taken between them.
 */
typedef enum gn_half { GN_HALF_BEFORE, GN_HALF_AFTER } gn_half;

/* Entries of a ledger for output: its terms, the stored energy at the start and the residual. */
#define GN_ENERGY_RESIDUAL_TEXT                                                                    \
    "unexplained energy over the energy that has passed through the system"
typedef struct gn_energy_figure {
    const char *name, *unit, *text;
    const char *kind; /* "stored", "input", "lost"; NULL: the whole ledger */
    double value;
} gn_energy_figure;
#define GN_COUNT_ONE(...) +1
enum { GN_ENERGY_FIGURES = 2 GN_ENERGY_TERMS(GN_COUNT_ONE) };
#undef GN_COUNT_ONE
void gn_energy_figures(const gn_energy *energy, gn_energy_figure figures[GN_ENERGY_FIGURES]);

/* Returns the sum of the stored terms. */
double gn_energy_stored(const gn_energy *energy);

/* Returns the energy that has passed through the system up to this instant: the largest of inputs,
 * initial stored energy, stored energy and dissipation, each a sum of absolute values. */
double gn_energy_throughput(const gn_energy *energy);

/* Returns the largest energy supplied so far, with which the residual is compared: if inputs are
 * recovered (a ball that is thrown up and falls, a wall that moves back and forth), no term is
 * large at the end, although the work was done. */
double gn_energy_scale(const gn_energy *energy);

/* Returns (stored - stored_at_start - input + lost)/scale; 0 if the scale is 0. */
double gn_energy_residual(const gn_energy *energy);

#endif
