/* The path of equilibria of a loaded specimen up to shortly before its first bond failure.
 *
 * An increment of time moves the prescribed particles and walls; Newton's method brings the rest
 * into equilibrium, with the forces of the actual contacts (static/trial.h) and the tangent of
 * the stability limit, whose contacts open, close and slide as in the last trial. Increments start
 * from the rates of the previous one. The failure time of each bond is extrapolated from its forces
 * at the ends of the last increment by the law's own criterion; the path ends at the wanted
 * fraction of the earliest.
 *
 * In steady loading, what moves at a constant rate has no resultant. Non-viscous damping is
 * proportional to the resultant and therefore vanishes, and the state is the same with or without
 * it. Viscous damping acts on every particle with a m v, which the contacts balance. */
#include "static/first_break.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "boundary/boundary.h"
#include "frame/frame.h"
#include "limit/equilibrium.h"
#include "particles/bonds.h"
#include "particles/particles.h"
#include "scene/scene.h"
#include "soa/records.h"
#include "static/trial.h"
#include "world/world.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum {
    N = GN_COMPONENTS,
    INCREMENTS = 8, /* target number of increments up to the start */
    INCREMENTS_MOST = 200,
    SOLUTIONS_MOST = 12, /* limit for one increment */
    SOLUTIONS_LOADING = 60,
    HALVES_MOST = 6, /* largest number of halvings of a correction */
    HALVINGS_MOST = 30
};

/* Ratio of the mean unbalanced load of a particle to the mean contact force at which a state counts
 * as equilibrium: for the first state, which only determines the range, for states on the path, and
 * for the start. The largest unbalanced load may be `balanced_worst` times that. Tests run with
 * 1e-3 and more. */
static const double balanced_first = 5e-3, balanced_on_the_way = 3e-4, balanced_start = 1e-5;
static const double balanced_worst = 300.0;
/* Tolerance of states from which elastic constants are read. */
static const double balanced_loading = 1e-6;
/* Factor of the strengths of bonds during the search, so that none breaks. */
static const double strengthened = 1e9;
/* Ratio of the duration of initial loads to time.end. */
static const double slowness = 1e6;
/* Tolerance of a linear solution as a fraction of the wanted unbalanced load, and its upper and
 * lower bounds as fractions of the load of the system. */
static const double solved = 0.3, solved_least = 0.1, solved_most = 1e-2;
/* Path of the first increment over the smallest radius. */
static const double first_path = 1e-5;
/* Fraction of the smallest radius below which displacements by initial loads are rounding. */
static const double no_path = 1e-9;
/* Largest speed of a free particle over the largest prescribed one: a lever ratio of 1000. */
static const double rates_most = 1e3;
/* If the mean contact force is below this fraction of the weakest strength, it is no scale for
 * loads, and the fraction of the strength is used instead. */
static const double strength_part = 1e-2;
/* Least number of steps that a start must save. */
static const double steps_least = 2.0;
/* Relative tolerance of the fraction at the start. */
static const double near_enough = 1e-3;

typedef struct bond_force {
    double normal, shear[3];
    bool holds;
} bond_force;

typedef struct search {
    gn_world *w;
    gn_trial trial;
    const gn_first_break_watch *watch;
    gn_first_break *found;
    double *path, *rate;      /* [particles][6] of the increment; rates of the previous increment */
    double *shorter;          /* [particles][6] path before the last correction; NULL: not stored */
    bond_force *before, *now; /* [bonds] at both ends of the last increment */
    double span;              /* s, of the last increment; 0: none yet */
    double scale;             /* N, scale of forces, see in_balance */
    double speed;             /* m/s, of the prescribed motion */
} search;

__attribute__((format(printf, 3, 4))) static gneiss_status
refuse(const gn_world *world, gneiss_error *error, const char *format, ...) {
    char text[600];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (world->ctx.scene.start != GN_START_FIRST_BREAK)
        return gn_fail(error, GNEISS_ERROR_INPUT, "%s", text);
    return gn_fail(error, GNEISS_ERROR_INPUT, "%s: %s",
                   gn_scene_at(&world->ctx.scene, world->ctx.scene.start_where, "time.start").text,
                   text);
}

/* --- bonds --- */

static void read_bonds(search *run) {
    bond_force *old = run->before;
    run->before = run->now;
    run->now = old;
    for (size_t c = 0; c < run->w->dem.bonds.contacts.soa.count; c++)
        run->now[c].holds = gn_trial_bond(&run->trial, c, &run->now[c].normal, run->now[c].shear);
}

/* Returns the value of a bond's failure criterion, extrapolated by `share` times the last
 * increment. */
static double criterion(const search *run, size_t c, double share) {
    const gn_contacts *list = &run->w->dem.bonds.contacts;
    const bond_force *a = &run->before[c], *b = &run->now[c];
    double t[3];
    for (int k = 0; k < 3; k++) t[k] = b->shear[k] + share * (b->shear[k] - a->shear[k]);
    return gn_law_of(list->soa.effects)
        ->criterion(list, c, b->normal + share * (b->normal - a->normal), 0.0, sqrt(gn_dot3(t, t)));
}

/* Returns the number of increments until the first bond fails, INFINITY if none does within
 * `most`. */
static double increments_left(const search *run, double most, size_t *bond) {
    double least = most;
    bool any = false;
    for (size_t c = 0; c < run->w->dem.bonds.contacts.soa.count; c++) {
        if (!run->now[c].holds || !(criterion(run, c, least) >= 1.0)) continue;
        double low = 0.0, high = least;
        for (int k = 0; k < 60 && high - low > 1e-12 * high; k++) {
            double middle = 0.5 * (low + high);
            *(criterion(run, c, middle) >= 1.0 ? &high : &low) = middle;
        }
        least = high;
        *bond = c;
        any = true;
    }
    return any ? least : INFINITY;
}

/* Returns the time of the first failure, s; INFINITY: no bond fails before the end. */
static double time_of_break(search *run) {
    const gn_contacts *list = &run->w->dem.bonds.contacts;
    size_t c = 0;
    if (!(run->span > 0.0)) return INFINITY;
    double left = increments_left(run, (run->w->ctx.scene.end - run->w->ctx.time) / run->span, &c);
    if (left == INFINITY) return INFINITY;
    const double *x = run->w->dem.particles.pos + 4 * (int64_t)list->i[c];
    double d[3], middle[3];
    gn_branch(&run->w->ctx, x, run->w->dem.particles.pos + 4 * (int64_t)list->j[c], d);
    for (int a = 0; a < 3; a++) middle[a] = x[a] + 0.5 * d[a];
    gn_user_point(&run->w->ctx, middle, run->found->place);
    run->found->i = run->w->dem.particles.id[list->i[c]];
    run->found->j = run->w->dem.particles.id[list->j[c]];
    return run->w->ctx.time + left * run->span;
}

/* --- one increment --- */

typedef enum outcome { BALANCED, BROKE, STUCK } outcome;

/* Tells whether the state is in equilibrium. If hardly anything is loaded, contact forces are no
 * scale for the residual, and a fraction of the bond strengths is used. */
static bool in_balance(const search *run, double balanced) {
    const gn_trial *t = &run->trial;
    double most = balanced * fmax(t->mean_force, run->scale);
    return t->mean_load <= most && t->most_load <= balanced_worst * most;
}

static gneiss_status correct(search *run, double balanced, gn_equilibrium *linear,
                             gneiss_error *error) {
    const gn_trial *t = &run->trial;
    double wanted = solved * balanced * fmax(t->mean_force, run->scale) / t->mean_load;
    wanted = fmin(fmax(wanted, solved_most), solved_least);
    GN_TRY(gn_trial_correct(&run->trial, wanted, run->path, linear, error));
    run->found->solutions++;
    run->found->iterations += linear->iterations;
    return GNEISS_OK;
}

/* Contacts that close and open alternately make Newton's method cycle. If the loads have grown by
 * the last correction, half of it is undone. Returns false if they have not grown, or after several
 * halvings without success. */
static bool shorten(search *run, double before, int *halves) {
    if (!run->shorter || !(run->trial.mean_load > before) || *halves == HALVES_MOST) {
        *halves = 0;
        return false;
    }
    for (size_t at = 0; at < N * run->trial.count; at++)
        run->path[at] = 0.5 * (run->path[at] + run->shorter[at]);
    ++*halves;
    return true;
}

/* Applies Newton's method, starting from the present path. */
static gneiss_status balance(search *run, double span, bool loads, double balanced, outcome *what,
                             gn_equilibrium *linear, gneiss_error *error) {
    gn_trial *t = &run->trial;
    const int most = run->shorter ? SOLUTIONS_LOADING : SOLUTIONS_MOST;
    double before = INFINITY;
    int halves = 0;
    *linear = (gn_equilibrium){.unsupported = -1};
    for (int k = 0;;) {
        gn_trial_go(t, run->path, span, loads);
        *what = t->broken ? BROKE : BALANCED;
        if (t->broken || in_balance(run, balanced)) return GNEISS_OK;
        *what = STUCK;
        if (shorten(run, before, &halves)) continue;
        if (k++ == most) return GNEISS_OK;
        before = t->mean_load;
        if (run->shorter) memcpy(run->shorter, run->path, N * t->count * sizeof *run->path);
        GN_TRY(correct(run, balanced, linear, error));
    }
}

static gneiss_status no_equilibrium(const search *run, const gn_equilibrium *linear, bool loads,
                                    gneiss_error *error) {
    const char *when = loads ? "under the loads at the start" : "under the prescribed motion";
    if (linear->unsupported >= 0)
        return refuse(
            run->w, error,
            "expected an equilibrium %s, found that particle %d is driven off and nothing "
            "holds it, alone or with the particles bonded to it (t = %g s)",
            when, linear->unsupported, run->w->ctx.time);
    return refuse(run->w, error,
                  "expected an equilibrium %s, found none in %d solutions: at t = %g s particle %d "
                  "has the largest of loads that are %.2g of the contact forces",
                  when, run->shorter ? SOLUTIONS_LOADING : SOLUTIONS_MOST, run->w->ctx.time,
                  run->trial.worst, run->trial.mean_load / run->trial.mean_force);
}

static gneiss_status tell(const search *run, gneiss_error *error) {
    if (!run->watch || !run->watch->state) return GNEISS_OK;
    return run->watch->state(run->watch->context, run->found, error);
}

/* Refuses mechanisms, which have almost no stiffness, so that displacements are arbitrary. They are
 * recognised by a speed of a particle, or of its surface by rotation, that is many times as large
 * as the prescribed speeds. */
static gneiss_status check_rates(const search *run, double span, gneiss_error *error) {
    const gn_particles *p = &run->w->dem.particles;
    for (size_t k = 0; k < run->trial.count; k++)
        for (size_t a = 0; a < N; a++) {
            double arm = a < 3 ? 1.0 : p->pos[4 * k + 3];
            double rate = arm * fabs(run->path[N * k + a]) / span;
            if (rate <= rates_most * run->speed) continue;
            return refuse(run->w, error,
                          "first_break: expected a specimen that is held in every direction, found "
                          "particle %d at %.2g times the prescribed speeds (t = %g s)",
                          p->id[k], rate / run->speed, run->w->ctx.time);
        }
    return GNEISS_OK;
}

static gneiss_status take(search *run, double span, bool loads, gneiss_error *error) {
    if (!loads) GN_TRY(check_rates(run, span, error));
    GN_TRY(gn_trial_take(&run->trial, run->path, span, loads, error));
    for (size_t k = 0; !loads && k < N * run->trial.count; k++) run->rate[k] = run->path[k] / span;
    run->span = loads ? 0.0 : span;
    run->found->start = run->w->ctx.time;
    run->found->increments += !loads;
    read_bonds(run);
    return GNEISS_OK;
}

static bool moves(const search *run) {
    double most = 0.0;
    for (size_t p = 0; p < run->trial.count; p++)
        for (size_t a = 0; a < 3; a++) most = fmax(most, fabs(run->path[N * p + a]));
    return most > no_path * run->w->dem.radius_min;
}

/* Brings the specimen into equilibrium with gravity, applied forces and initially compressed
 * contacts. */
static gneiss_status take_up_loads(search *run, gneiss_error *error) {
    gn_equilibrium linear;
    outcome what;
    const double slow = 1e6; /* s: slow enough for dashpots to be at rest */
    memset(run->path, 0, N * run->trial.count * sizeof *run->path);
    gn_trial_go(&run->trial, run->path, slow, true);
    if (run->trial.most_load == 0.0 || in_balance(run, balanced_start)) return GNEISS_OK;
    GN_TRY(correct(run, balanced_start, &linear, error));
    if (linear.unsupported < 0 && !moves(run)) return GNEISS_OK;
    GN_TRY(balance(run, slow, true, balanced_start, &what, &linear, error));
    if (what == BROKE)
        return refuse(
            run->w, error,
            "expected an equilibrium under the loads at the start, found bonds that break");
    if (what == STUCK) return no_equilibrium(run, &linear, true, error);
    return take(run, slow, true, error);
}

/* Tells whether particles that the lists do not contain may have come into contact on the path. */
static bool beyond_lists(const search *run, double span) {
    const gn_verlet *v = &run->w->dem.verlet;
    const double other =
        gn_boundary_travel(&run->w->ctx, &run->w->boundary, true) + run->speed * span;
    double most = 0.0;
    for (size_t p = 0; p < run->trial.count; p++)
        most = fmax(most, gn_dot3(run->path + N * p, run->path + N * p));
    double own = v->drift + sqrt(most);
    return 2.0 * own > v->skin || own + other > v->skin;
}

/* Makes an increment of up to `span` s; it is shorter if bonds would fail, or if the lists must be
 * rebuilt. */
static gneiss_status increment(search *run, double span, double balanced, gneiss_error *error) {
    gn_equilibrium linear;
    outcome what = BALANCED;
    bool broke = false;
    for (int k = 0; k < HALVINGS_MOST; k++, span *= 0.5) {
        for (size_t at = 0; at < N * run->trial.count; at++) run->path[at] = span * run->rate[at];
        gn_trial_prescribe(&run->trial, span, run->path);
        GN_TRY(balance(run, span, false, balanced, &what, &linear, error));
        broke = broke || what == BROKE;
        if (what == BALANCED && !beyond_lists(run, span)) return take(run, span, false, error);
        if (what == STUCK && linear.unsupported >= 0) break;
    }
    if (broke && linear.unsupported < 0)
        return refuse(run->w, error,
                      "expected bonds that hold under the prescribed motion, found that they break "
                      "however short the increment (t = %g s)",
                      run->w->ctx.time);
    return no_equilibrium(run, &linear, false, error);
}

/* --- the path --- */

static double largest(const gn_table *table) {
    double most = 0.0;
    for (size_t k = 0; k < table->count; k++) most = fmax(most, fabs(table->value[k]));
    return most;
}

/* Returns the largest component of all prescribed velocities, m/s. */
static double fastest(const gn_step_context *ctx, const gn_dem *dem) {
    double most = 0.0;
    for (int a = 0; a < 3; a++) {
        for (size_t k = 0; k < ctx->scene.wall_count; k++)
            most = fmax(most, largest(&ctx->scene.walls[k].motion.velocity[a]));
        for (size_t k = 0; k < ctx->scene.set_count; k++) {
            const gn_motion *motion = &ctx->scene.sets[k].motion;
            most = fmax(most, largest(&motion->velocity[a]));
            most = fmax(most, dem->radius_min * largest(&motion->spin[a]));
        }
    }
    return most;
}

/* Returns the duration of the next increment: twice the last one while no failure is predicted,
 * then a fraction of the time to the target. */
static double next_span(const search *run, double breaks, double first) {
    const gn_world *w = run->w;
    if (breaks == INFINITY)
        return fmin(fmax(2.0 * run->span, first), w->ctx.scene.end - w->ctx.time);
    double target = w->ctx.scene.start_fraction * breaks, left = target - w->ctx.time;
    return fmin(left, fmax(target / INCREMENTS, run->span));
}

static gneiss_status follow(search *run, gneiss_error *error) {
    gn_world *w = run->w;
    double speed = run->speed = fastest(&w->ctx, &w->dem), breaks = INFINITY;
    if (!(speed > 0.0))
        return refuse(w, error, "first_break: expected walls or sets that move, found none");
    const double first = fmin(first_path * w->dem.radius_min / speed, 1e-3 * w->ctx.scene.end);
    for (int k = 0; k < INCREMENTS_MOST; k++) {
        double span = next_span(run, breaks, first);
        if (breaks < INFINITY && span <= near_enough * w->ctx.scene.start_fraction * breaks)
            return GNEISS_OK;
        if (!(span > 0.0)) break;
        if (k > 0) GN_TRY(tell(run, error)); /* the first step reports the last state */
        bool last =
            breaks < INFINITY && w->ctx.time + span >= 0.99 * w->ctx.scene.start_fraction * breaks;
        double wanted = breaks < INFINITY ? balanced_on_the_way : balanced_first;
        GN_TRY(increment(run, span, last ? balanced_start : wanted, error));
        breaks = run->found->time = time_of_break(run);
        run->found->unbalanced = run->trial.mean_load / run->trial.mean_force;
        if (w->ctx.time >= w->ctx.scene.end * (1.0 - 1e-12)) break;
    }
    return refuse(w, error, "first_break: expected a bond that breaks before time.end, found none");
}

/* Computes the velocities of steady loading from a short increment by the tangent alone. */
static gneiss_status leave(search *run, gneiss_error *error) {
    gn_trial *t = &run->trial;
    gn_equilibrium linear;
    const double span = 1e-3 * run->w->ctx.time;
    if (!(run->w->ctx.time >= steps_least * run->w->ctx.dt))
        return refuse(run->w, error,
                      "first_break: expected a start that is at least %g steps after time 0, found "
                      "the first break at %g s and a step of %g s",
                      steps_least, run->found->time, run->w->ctx.dt);
    for (size_t at = 0; at < N * t->count; at++) run->path[at] = span * run->rate[at];
    gn_trial_prescribe(t, span, run->path);
    gn_trial_go(t, run->path, span, false);
    if (!in_balance(run, balanced_start)) GN_TRY(correct(run, balanced_start, &linear, error));
    GN_TRY(gn_trial_leave(t, run->path, span, error));
    run->w->ctx.step = run->w->ctx.first_step = run->found->steps =
        llround(run->w->ctx.time / run->w->ctx.dt);
    run->found->shortfall = t->shortfall;
    return GNEISS_OK;
}

static gneiss_status allocate(search *run, gneiss_error *error) {
    size_t particles = run->w->dem.particles.soa.count,
           bonds = run->w->dem.bonds.contacts.soa.count;
    run->path = gn_alloc_array(particles + 1, N * sizeof *run->path);
    run->rate = gn_alloc_array(particles + 1, N * sizeof *run->rate);
    run->before = gn_alloc_array(bonds + 1, sizeof *run->before);
    run->now = gn_alloc_array(bonds + 1, sizeof *run->now);
    if (run->path && run->rate && run->before && run->now) return GNEISS_OK;
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the equilibrium of %zu particles",
                   particles);
}

/* Returns the weakest bond strength, N. */
static double weakest(const gn_dem *dem) {
    const gn_contacts *list = &dem->bonds.contacts;
    double least = INFINITY;
    for (size_t c = 0; c < list->soa.count; c++) {
        if (!gn_contact_bonded(list, c)) continue;
        least = fmin(least, list->rn[c]);
        if (list->rt) least = fmin(least, list->rt[c]);
    }
    return least < INFINITY ? least : 0.0;
}

static gneiss_status find(search *run, gneiss_error *error) {
    GN_TRY(allocate(run, error));
    GN_TRY(gn_trial_begin(run->w, &run->trial, error));
    run->found->time = INFINITY;
    run->scale = strength_part * weakest(&run->w->dem);
    read_bonds(run);
    GN_TRY(tell(run, error));
    GN_TRY(take_up_loads(run, error));
    GN_TRY(follow(run, error));
    return leave(run, error);
}

/* --- loading without failure --- */

static double displacement(const gn_motion *motion, double time) {
    double most = 0.0;
    for (int a = 0; a < 3; a++)
        most = fmax(most, fabs(gn_table_between(&motion->velocity[a], 0.0, time)));
    return most;
}

/* Returns the largest prescribed displacement of a wall or a set up to a time, m. */
static double prescribed_path(const gn_scene *scene, double time) {
    double most = 0.0;
    for (size_t k = 0; k < scene->wall_count; k++)
        most = fmax(most, displacement(&scene->walls[k].motion, time));
    for (size_t k = 0; k < scene->set_count; k++)
        most = fmax(most, displacement(&scene->sets[k].motion, time));
    return most;
}

/* Finds the time, s, at which the prescribed displacement is `path`; motions may continue after the
 * end of the scene. */
static gneiss_status time_of_path(const search *run, double path, double *time,
                                  gneiss_error *error) {
    const gn_step_context *ctx = &run->w->ctx;
    double low = 0.0, high = ctx->scene.end;
    for (int k = 0; k < 60 && !(prescribed_path(&ctx->scene, high) >= path); k++) high *= 2.0;
    if (!(prescribed_path(&ctx->scene, high) >= path))
        return refuse(run->w, error, "expected walls or sets that move by %.3g m, found %.3g m",
                      path, prescribed_path(&ctx->scene, high));
    while (high - low > 1e-15 * high) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        *(prescribed_path(&ctx->scene, middle) >= path ? &high : &low) = middle;
    }
    *time = high;
    return GNEISS_OK;
}

/* Replaces a motion up to `time` by one of constant velocity that ends at `end`. */
static void spread_motion(gn_motion *motion, double time, double end) {
    for (int k = 0; k < N; k++) {
        gn_table *table = k < 3 ? &motion->velocity[k] : &motion->spin[k - 3];
        if (!table->count) continue;
        gn_table_set_constant(table, gn_table_between(table, 0.0, time) / end);
    }
}

/* Replaces the prescribed motions by steady ones with the same displacements, which are so slow
 * that dashpots and drag have no effect. */
static gneiss_status slow_down(search *run, double path, gneiss_error *error) {
    gn_scene *scene = &run->w->ctx.scene;
    const double end = slowness * scene->end;
    double time = 0.0;
    GN_TRY(time_of_path(run, path, &time, error));
    for (size_t k = 0; k < scene->wall_count; k++)
        spread_motion(&scene->walls[k].motion, time, end);
    for (size_t k = 0; k < scene->set_count; k++) spread_motion(&scene->sets[k].motion, time, end);
    scene->end = end;
    return GNEISS_OK;
}

/* Advances to a time, in several increments if the lists have to be rebuilt. */
static gneiss_status go_to(search *run, double time, double path, gneiss_error *error) {
    const double near = 1e-9;
    for (int k = 0; k < INCREMENTS_MOST; k++) {
        GN_TRY(increment(run, time - run->w->ctx.time, balanced_loading, error));
        if (run->w->ctx.time >= time * (1.0 - near)) return GNEISS_OK;
    }
    return refuse(run->w, error,
                  "expected a displacement of %.3g m, found %.3g m after %d increments", path,
                  prescribed_path(&run->w->ctx.scene, run->w->ctx.time), INCREMENTS_MOST);
}

static gneiss_status load_up(search *run, double path, int count, gneiss_error *error) {
    GN_TRY(allocate(run, error));
    run->shorter = gn_alloc_array(run->w->dem.particles.soa.count + 1, N * sizeof *run->shorter);
    if (!run->shorter)
        return gn_fail(error, GNEISS_ERROR_MEMORY,
                       "no memory for the equilibrium of the particles");
    GN_TRY(slow_down(run, path, error));
    gn_bonds_strengthen(&run->w->dem, strengthened);
    GN_TRY(gn_trial_begin(run->w, &run->trial, error));
    run->speed = fastest(&run->w->ctx, &run->w->dem);
    GN_TRY(take_up_loads(run, error));
    GN_TRY(tell(run, error));
    for (int k = 1; k <= count; k++) {
        GN_TRY(go_to(run, run->w->ctx.scene.end * k / count, path, error));
        run->found->unbalanced = run->trial.mean_load / run->trial.mean_force;
        GN_TRY(tell(run, error));
    }
    return GNEISS_OK;
}

static void free_search(search *run) {
    gn_trial_free(&run->trial);
    gn_free(run->path);
    gn_free(run->rate);
    gn_free(run->shorter);
    gn_free(run->before);
    gn_free(run->now);
}

gneiss_status gn_static_loading(gn_world *world, double path, int count,
                                const gn_first_break_watch *watch, gn_first_break *found,
                                gneiss_error *error) {
    *found = (gn_first_break){.time = INFINITY};
    search s = {.w = world, .watch = watch, .found = found};
    gneiss_status status = load_up(&s, path, count, error);
    free_search(&s);
    return status;
}

gneiss_status gn_first_break_start(gn_world *world, const gn_first_break_watch *watch,
                                   gn_first_break *found, gneiss_error *error) {
    *found = (gn_first_break){0};
    if (!world->dem.bonds.contacts.soa.count)
        return refuse(world, error, "first_break: expected bonds, found none in this specimen");
    search s = {.w = world, .watch = watch, .found = found};
    gneiss_status status = find(&s, error);
    free_search(&s);
    return status;
}
