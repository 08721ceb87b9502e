/* The world as files: snapshots, results.h5, summary.json (docs/results.md). */
#include "base/timer.h"
#include "io/files.h"
#include "io/h5.h"
#include "io/snapshot.h"
#include "run/run.h"
#include "sim/parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- fields derived from the state, in the order of the specimen file
 * -------------------------------- */

typedef struct particle_fields {
    size_t count;
    double *position, *radius, *displacement, *velocity, *spin, *damage, *stress, *coordination,
        *id, *removed;
    double *orientation; /* NULL: output.orientation is off */
} particle_fields;

typedef struct bond_fields {
    size_t count;
    int32_t *ends; /* [count][2], ids */
    double *force, *normal, *shear, *criterion, *state, *broken_time;
} bond_fields;

static void free_particle_fields(particle_fields *f) {
    double *all[] = {f->position, f->radius,  f->displacement, f->velocity,
                     f->spin,     f->damage,  f->stress,       f->coordination,
                     f->id,       f->removed, f->orientation};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
}

static void free_bond_fields(bond_fields *f) {
    double *all[] = {f->force, f->normal, f->shear, f->criterion, f->state, f->broken_time};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
    free(f->ends);
    *f = (bond_fields){0}; /* callers free once more after a failure */
}

static void count_contacts(const gn_world *w, const gn_contacts *list, double *coordination) {
    for (size_t c = 0; c < list->soa.count; c++) {
        bool intact = list->rn && list->rn[c] > 0.0;
        if (!intact && !gn_contact_carries(list, c)) continue;
        coordination[w->particles.id[list->i[c]]] += 1.0;
        coordination[w->particles.id[list->j[c]]] += 1.0;
    }
}

/* Of a quaternion and its opposite, which are the same turn, the shorter way round. */
static void copy_turn(const double from[4], double to[4]) {
    for (int a = 0; a < 4; a++) to[a] = from[0] < 0.0 ? -from[a] : from[a];
}

static void fill_particle(const gn_world *w, size_t p, double damage, const double stress[6],
                          particle_fields *f) {
    const gn_particles *q = &w->particles;
    size_t id = (size_t)q->id[p];
    f->id[id] = (double)id;
    f->radius[id] = q->pos[4 * p + 3];
    f->damage[id] = damage;
    f->removed[id] = q->vel[4 * p + 3] == 0.0;
    if (q->orientation) copy_turn(q->orientation + 4 * p, f->orientation + 4 * id);
    memcpy(f->stress + 6 * id, stress, 6 * sizeof(double));
    gn_world_point_out(w, q->pos + 4 * p, f->position + 3 * id);
    for (size_t a = 0; a < 3; a++) {
        f->displacement[3 * id + a] = q->pos[4 * p + a] - q->start[4 * p + a];
        f->velocity[3 * id + a] = q->vel[4 * p + a];
        if (q->spin) f->spin[3 * id + a] = q->spin[4 * p + a];
    }
}

static gneiss_status make_particle_fields(const gn_world *w, const gn_observed *seen,
                                          particle_fields *f, gneiss_error *error) {
    size_t n = w->particles.soa.count;
    const gn_particles *q = &w->particles;
    *f = (particle_fields){.count = n};
    double **scalars[] = {&f->radius, &f->damage, &f->coordination, &f->id, &f->removed};
    double **vectors[] = {&f->position, &f->displacement, &f->velocity, &f->spin};
    bool held = true;
    for (size_t k = 0; k < 5; k++) held = held && (*scalars[k] = calloc(n + 1, sizeof(double)));
    for (size_t k = 0; k < 4; k++) held = held && (*vectors[k] = calloc(n + 1, 3 * sizeof(double)));
    if (q->orientation) held = held && (f->orientation = calloc(n + 1, 4 * sizeof(double)));
    double *damage = calloc(n + 1, sizeof *damage), *stress = calloc(n + 1, 6 * sizeof *stress);
    held = held && damage && stress && (f->stress = calloc(n + 1, 6 * sizeof(double)));
    if (held) {
        gn_assembly assembly = gn_world_assembly(w);
        assembly.bonds = &seen->bonds;
        assembly.pairs = &seen->pairs;
        gn_stress_particles(&assembly, gn_world_porosity(w), stress);
        if (w->effects & GN_FX_BONDS) gn_damage_particles(q, &w->bonds, damage);
        for (size_t p = 0; p < n; p++) fill_particle(w, p, damage[p], stress + 6 * p, f);
        count_contacts(w, &seen->bonds, f->coordination);
        count_contacts(w, &seen->pairs, f->coordination);
    }
    free(damage);
    free(stress);
    if (held) return GNEISS_OK;
    free_particle_fields(f);
    return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu particles", n);
}

static double normal_force(const gn_world *w, const gn_contacts *b, size_t c, const double *force) {
    const double *x = w->particles.pos + 4 * (int64_t)b->i[c],
                 *y = w->particles.pos + 4 * (int64_t)b->j[c];
    double d[3], d2 = gn_branch(w, x, y, d), along = 0.0;
    for (int a = 0; a < 3; a++) along += force[a] * d[a];
    return d2 > 0.0 ? along / sqrt(d2) : 0.0;
}

/* State and strengths are the world's; the copy only has the forces. */
static void fill_bond(const gn_world *w, const gn_contacts *seen, bond_fields *f, size_t c) {
    const gn_contacts *b = &w->bonds;
    const double *row = gn_contacts_row(seen) + (size_t)gn_contacts_row_width(seen) * c;
    double force[3] = {row[0], row[1], w->effects & GN_FX_SPACE ? row[2] : 0.0}, size2 = 0.0;
    int32_t i = w->particles.id[b->i[c]], j = w->particles.id[b->j[c]];
    double turn = i < j ? 1.0 : -1.0; /* force on the end with the smaller id, which comes first */
    f->ends[2 * c] = i < j ? i : j;
    f->ends[2 * c + 1] = i < j ? j : i;
    for (size_t a = 0; a < 3; a++) {
        f->force[3 * c + a] = turn * force[a];
        size2 += force[a] * force[a];
    }
    f->normal[c] = normal_force(w, b, c, force);
    f->shear[c] = sqrt(fmax(0.0, size2 - f->normal[c] * f->normal[c]));
    f->state[c] = b->cause[c];
    f->broken_time[c] = b->cause[c] ? b->broken_time[c] : NAN;
    double ratio = f->normal[c] / b->rn[c];
    if (b->rt) ratio = fmax(ratio, f->shear[c] / b->rt[c]);
    f->criterion[c] = b->cause[c] ? 1.0 : fmax(0.0, ratio);
}

static gneiss_status make_bond_fields(const gn_world *w, const gn_contacts *seen, bond_fields *f,
                                      gneiss_error *error) {
    size_t n = w->bonds.soa.count;
    *f = (bond_fields){.count = n};
    double **scalars[] = {&f->normal, &f->shear, &f->criterion, &f->state, &f->broken_time};
    bool held = (f->ends = calloc(n + 1, 2 * sizeof *f->ends)) &&
                (f->force = calloc(n + 1, 3 * sizeof(double)));
    for (size_t k = 0; k < 5; k++) held = held && (*scalars[k] = calloc(n + 1, sizeof(double)));
    if (!held) {
        free_bond_fields(f);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output of %zu bonds", n);
    }
    for (size_t c = 0; c < n; c++) fill_bond(w, seen, f, c);
    return GNEISS_OK;
}

/* --- snapshots
 * ------------------------------------------------------------------------------------- */

static gneiss_status write_snapshot(const gn_run *run, const gn_observed *seen,
                                    const char *particles_name, const char *bonds_name,
                                    gneiss_error *error) {
    const gn_world *w = &run->world;
    particle_fields p;
    GN_TRY(make_particle_fields(w, seen, &p, error));
    const gn_snapshot_array points[] = {
        {"id", "1", 1, p.id},
        {"radius", "m", 1, p.radius},
        {"displacement", "m", 3, p.displacement},
        {"velocity", "m/s", 3, p.velocity},
        {"damage", "1", 1, p.damage},
        {"stress", "Pa", 6, p.stress},
        {"coordination", "1", 1, p.coordination},
        {"removed", "1", 1, p.removed},
        {"orientation", "1", 4, p.orientation}, /* the last: it is often not there */
    };
    gn_snapshot s = {.bad = w->bad,
                     .time = w->time,
                     .step = w->step,
                     .point_count = p.count,
                     .points = p.position};
    s.point_arrays = points;
    s.point_array_count = sizeof points / sizeof *points - (p.orientation ? 0 : 1);
    gneiss_status status = gn_snapshot_write(run->directory, particles_name, &s, error);
    bond_fields b = {0};
    if (status == GNEISS_OK && w->effects & GN_FX_BONDS) {
        status = make_bond_fields(w, &seen->bonds, &b, error);
        const gn_snapshot_array lines[] = {{"state", "1", 1, b.state},
                                           {"force", "N", 1, b.normal},
                                           {"shear_force", "N", 1, b.shear},
                                           {"criterion", "1", 1, b.criterion}};
        s.point_array_count = 0;
        s.line_count = b.count;
        s.lines = b.ends;
        s.line_arrays = lines;
        s.line_array_count = sizeof lines / sizeof *lines;
        if (status == GNEISS_OK) status = gn_snapshot_write(run->directory, bonds_name, &s, error);
    }
    free_particle_fields(&p);
    free_bond_fields(&b);
    return status;
}

gneiss_status gn_output_snapshot(const gn_run *run, const char *particles_name,
                                 const char *bonds_name, gneiss_error *error) {
    gn_observed seen;
    if (!run->world.particles.soa.count) return GNEISS_OK;
    GN_TRY(gn_world_observe(&run->world, &seen, error));
    gneiss_status status = write_snapshot(run, &seen, particles_name, bonds_name, error);
    gn_observed_free(&seen);
    return status;
}

gneiss_status gn_output_series(gn_run *run, gneiss_error *error) {
    gn_snapshot_times *times = &run->snapshot_times;
    if (run->world.scene.body_count)
        GN_TRY(gn_snapshot_series(run->directory, "bodies", run->world.step, times, error));
    if (run->world.elements)
        GN_TRY(gn_snapshot_series(run->directory, "elements", run->world.step, times, error));
    if (!run->world.particles.soa.count) return GNEISS_OK;
    GN_TRY(gn_snapshot_series(run->directory, "particles", run->world.step, times, error));
    if (!(run->world.effects & GN_FX_BONDS)) return GNEISS_OK;
    return gn_snapshot_series(run->directory, "bonds", run->world.step, times, error);
}

/* --- results.h5
 * ------------------------------------------------------------------------------------ */

static gneiss_status put_scalar(gn_h5 *file, const char *group, const char *name, double value,
                                const char *unit, const char *text, gneiss_error *error) {
    char path[160];
    snprintf(path, sizeof path, "%s/%s", group, name);
    return gn_h5_put(file, path, GN_F64, 1, 1, 0, &value, unit, text, error);
}

static void effect_names(gn_effects effects, char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < GN_EFFECT_COUNT && used < size; k++)
        if (effects >> k & 1)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " " : "",
                                     gn_effect_name((gn_effect_index)k));
}

/* One a line, "name: text"; "" when there are none. */
static gneiss_status put_warnings(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_warnings list = gn_run_warnings(run);
    char text[sizeof list] = "";
    for (size_t k = 0, used = 0; k < list.count; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s: %s", used ? "\n" : "",
                                 list.warning[k].name, list.warning[k].text);
    return gn_h5_attribute_text(file, "/", "warnings", text, error);
}

static gneiss_status put_header(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    char effects[512], hash[24];
    effect_names(w->effects, effects, sizeof effects);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)gn_world_hash(w));
    const char *texts[][2] = {{"title", w->scene.title},
                              {"scene_file", w->scene.source},
                              {"version", gn_version()},
                              {"build", gn_build()},
                              {"isa", w->kernels->name},
                              {"precision", w->effects & GN_FX_MIXED ? "mixed" : "double"},
                              {"effects", effects},
                              {"state_hash", hash},
                              {"stop_reason", run->stop_reason}};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        GN_TRY(gn_h5_attribute_text(file, "/", texts[k][0], texts[k][1], error));
    int64_t threads = w->threads, finished = run->finished, steps = w->step;
    GN_TRY(gn_h5_attribute_i64(file, "/", "threads", &threads, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "finished", &finished, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "dimension", &w->scene.dimension, 1, error));
    GN_TRY(gn_h5_attribute_i64(file, "/", "steps", &steps, 1, error));
    double seconds = gn_run_progress(run).seconds;
    GN_TRY(gn_h5_attribute_f64(file, "/", "dt", &w->dt, 1, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "volume", &w->volume, 1, error));
    GN_TRY(gn_h5_attribute_text(file, "/", "volume_of", gn_world_volume_source(w), error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "seconds", &seconds, 1, error));
    GN_TRY(gn_h5_attribute_f64(file, "/", "origin", w->scene.origin, 3, error));
    GN_TRY(put_warnings(run, file, error));
    char *scene = gn_scene_write(&w->given);
    if (!scene) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the scene text");
    gneiss_status status = gn_h5_put_text(file, "scene", scene, error);
    free(scene);
    return status;
}

/* One that is absent is NaN and says why. */
static gneiss_status put_reading(gn_h5 *file, const char *name, double value, const char *unit,
                                 const char *text, const char *reason, gneiss_error *error) {
    char path[160];
    GN_TRY(put_scalar(file, "readings", name, value, unit, text, error));
    snprintf(path, sizeof path, "readings/%s", name);
    return *reason ? gn_h5_attribute_text(file, path, "absent", reason, error) : GNEISS_OK;
}

static gneiss_status put_readings(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    gn_readings r = gn_record_readings(&run->world, &run->history);
    bool demanded = gn_h5_demand_finite(file, false);
#define X(name, unit, text)                                                                        \
    GN_TRY(put_reading(file, #name, r.name, unit, text, r.reason[GN_READING_##name], error));
    GN_READINGS(X)
#undef X
    gn_h5_demand_finite(file, demanded);
    return GNEISS_OK;
}

static gneiss_status put_tables(const gn_run *run, gn_h5 *file, gneiss_error *error) {
    const gn_world *w = &run->world;
    for (size_t c = 0; c < run->history.column_count; c++) {
        const gn_column *column = &run->history.columns[c];
        char path[160];
        snprintf(path, sizeof path, "history/%s", column->name);
        gn_h5_demand_finite(file, !column->absent && !w->bad);
        GN_TRY(gn_h5_put(file, path, GN_F64, run->history.row_count, 1, 0, column->value,
                         column->unit, column->text, error));
    }
    gn_h5_demand_finite(file, !w->bad);
    GN_TRY(put_readings(run, file, error));
    if (w->effects & GN_FX_ENERGY) {
#define X(name, kind, text)                                                                        \
    GN_TRY(put_scalar(file, "energy", #name, w->reading.name, "J", text, error));
        GN_ENERGY_TERMS(X)
#undef X
        GN_TRY(put_scalar(file, "energy", "stored_at_start", w->reading.stored_at_start, "J",
                          "stored energy at the start", error));
        GN_TRY(put_scalar(file, "energy", "residual", gn_energy_residual(&w->reading), "1",
                          "what the ledger does not explain, over the energy that has gone through",
                          error));
    }
    for (int k = 0; k < GN_PHASE_COUNT; k++)
        GN_TRY(put_scalar(file, "profile", gn_phase_name((gn_phase)k), w->seconds[k], "s",
                          gn_phase_text((gn_phase)k), error));
    return GNEISS_OK;
}

static gneiss_status put_particles(const gn_world *w, const gn_observed *seen, gn_h5 *file,
                                   gneiss_error *error) {
    particle_fields f;
    GN_TRY(make_particle_fields(w, seen, &f, error));
    const struct {
        const char *name, *unit, *text;
        size_t components;
        const double *data;
    } fields[] = {
        {"particles/position", "m", "centre", 3, f.position},
        {"particles/radius", "m", "radius", 1, f.radius},
        {"particles/displacement", "m", "from the start", 3, f.displacement},
        {"particles/velocity", "m/s", "velocity", 3, f.velocity},
        {"particles/spin", "rad/s", "angular velocity", 3, f.spin},
        {"particles/damage", "1", "broken bonds over bonds at the start", 1, f.damage},
        {"particles/stress", "Pa", "xx yy zz xy yz xz, tension positive", 6, f.stress},
        {"particles/coordination", "1", "contacts that carry force and intact bonds", 1,
         f.coordination},
        {"particles/orientation", "1", "unit quaternion w x y z of the turn from the start, w >= 0",
         4, f.orientation},
    };
    gneiss_status status = GNEISS_OK;
    for (size_t k = 0; status == GNEISS_OK && k < sizeof fields / sizeof *fields; k++)
        if (fields[k].data)
            status = gn_h5_put(file, fields[k].name, GN_F64, f.count, fields[k].components, 0,
                               fields[k].data, fields[k].unit, fields[k].text, error);
    int32_t *number = calloc(f.count + 1, sizeof *number);
    uint8_t *removed = calloc(f.count + 1, sizeof *removed);
    for (size_t id = 0; number && removed && id < f.count; id++) {
        size_t p = (size_t)w->index_of_id[id];
        number[id] = w->particles.bonds0 ? w->particles.bonds0[p] : 0;
        removed[id] = f.removed[id] != 0.0;
    }
    if (status == GNEISS_OK && (!number || !removed))
        status = gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output");
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "particles/bonds_at_start", GN_I32, f.count, 1, 0, number, "1",
                           "bonds at the start", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "particles/removed", GN_U8, f.count, 1, 0, removed, "1",
                           "1: left the domain", error);
    free(number);
    free(removed);
    free_particle_fields(&f);
    return status;
}

static gneiss_status put_bonds(const gn_world *w, const gn_contacts *seen, gn_h5 *file,
                               gneiss_error *error) {
    bond_fields f;
    GN_TRY(make_bond_fields(w, seen, &f, error));
    int32_t *state = calloc(f.count + 1, sizeof *state);
    if (!state) {
        free_bond_fields(&f);
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the output");
    }
    for (size_t c = 0; c < f.count; c++) state[c] = w->bonds.cause[c];
    gneiss_status status =
        gn_h5_put(file, "bonds/i", GN_I32, f.count, 1, 2 * sizeof(int32_t), f.ends, "1",
                  "first particle, base 0, order of the specimen file", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bonds/j", GN_I32, f.count, 1, 2 * sizeof(int32_t), f.ends + 1,
                           "1", "second particle", error);
    if (status == GNEISS_OK)
        status = gn_h5_put(file, "bonds/state", GN_I32, f.count, 1, 0, state, "1",
                           "0 intact, 1 broken in tension, 2 broken in shear", error);
    if (status == GNEISS_OK) {
        bool demanded = gn_h5_demand_finite(file, false);
        status = gn_h5_put(file, "bonds/broken_time", GN_F64, f.count, 1, 0, f.broken_time, "s",
                           "when it broke; NaN: intact", error);
        gn_h5_demand_finite(file, demanded);
    }
    const struct {
        const char *name, *unit, *text;
        size_t components;
        const double *data;
    } fields[] = {
        {"bonds/force", "N", "force on i", 3, f.force},
        {"bonds/criterion", "1", "largest of force over strength; 1: broken", 1, f.criterion},
    };
    for (size_t k = 0; status == GNEISS_OK && k < sizeof fields / sizeof *fields; k++)
        status = gn_h5_put(file, fields[k].name, GN_F64, f.count, fields[k].components, 0,
                           fields[k].data, fields[k].unit, fields[k].text, error);
    free(state);
    free_bond_fields(&f);
    return status;
}

gneiss_status gn_output_results(const gn_run *run, gneiss_error *error) {
    char path[GN_PATH_SIZE + 32];
    snprintf(path, sizeof path, "%s/results.h5", run->directory);
    gn_h5 *file = NULL;
    GN_TRY(gn_h5_create(path, &file, error));
    gn_h5_demand_finite(file, !run->world.bad);
    gneiss_status status = put_header(run, file, error);
    if (status == GNEISS_OK) status = put_tables(run, file, error);
    gn_observed seen = {0};
    if (status == GNEISS_OK) status = gn_elements_results(&run->world, file, error);
    if (status == GNEISS_OK) status = gn_bodies_results(&run->world, file, error);
    if (status == GNEISS_OK) status = gn_world_observe(&run->world, &seen, error);
    if (status == GNEISS_OK && run->world.particles.soa.count)
        status = put_particles(&run->world, &seen, file, error);
    if (status == GNEISS_OK && run->world.effects & GN_FX_BONDS)
        status = put_bonds(&run->world, &seen.bonds, file, error);
    gn_observed_free(&seen);
    if (status == GNEISS_OK) return gn_h5_commit(file, GN_DURABLE, error);
    gn_h5_close(file);
    return status;
}

/* --- summary.json
 * ---------------------------------------------------------------------------------- */

static size_t touching(const gn_contacts *list) {
    size_t count = 0;
    for (size_t c = 0; c < list->soa.count; c++) count += gn_contact_carries(list, c);
    return count;
}

static void summary_warnings(const gn_run *run, gn_json *j) {
    gn_warnings list = gn_run_warnings(run);
    gn_json_array(j, "warnings");
    for (size_t k = 0; k < list.count; k++) {
        gn_json_object(j, NULL);
        gn_json_text(j, "name", list.warning[k].name);
        gn_json_text(j, "text", list.warning[k].text);
        gn_json_end(j);
    }
    gn_json_end(j);
}

/* Numbers, null where one is absent, and why it is. */
static void summary_readings(const gn_run *run, gn_json *j) {
    gn_readings r = gn_record_readings(&run->world, &run->history);
    gn_json_object(j, "readings");
#define X(name, unit, text) gn_json_number(j, #name, r.name);
    GN_READINGS(X)
#undef X
    gn_json_end(j);
    gn_json_object(j, "absent");
#define X(name, unit, text)                                                                        \
    if (r.reason[GN_READING_##name][0]) gn_json_text(j, #name, r.reason[GN_READING_##name]);
    GN_READINGS(X)
#undef X
    gn_json_end(j);
}

static void summary_counts(const gn_world *w, size_t contacts, gn_json *j) {
    gn_json_object(j, "counts");
    gn_json_integer(j, "particles", (int64_t)w->particles.soa.count);
    gn_json_integer(j, "contacts", (int64_t)contacts);
    gn_json_integer(j, "bonds", w->bonds_at_start);
    gn_json_integer(j, "broken_tension", w->broken_tension);
    gn_json_integer(j, "broken_shear", w->broken_shear);
    gn_json_integer(j, "removed", w->lost);
    if (w->scene.body_count) {
        gn_json_integer(j, "bodies", (int64_t)w->scene.body_count);
        gn_json_integer(j, "facets", (int64_t)w->body_corner_count / w->scene.dimension);
    }
    if (w->elements) {
        gn_json_integer(j, "nodes", (int64_t)w->elements->body.nodes.soa.count);
        gn_json_integer(j, "elements", (int64_t)w->elements->body.elements.soa.count);
    }
    gn_json_end(j);
}

static void summary_step(const gn_world *w, gn_json *j) {
    gn_json_integer(j, "steps", w->step);
    gn_json_number(j, "time", w->time);
    gn_json_number(j, "dt", w->dt);
    gn_json_number(j, "dt_limit", w->stable);
    gn_json_number(j, "dt_limit_sharp", gn_world_sharp_limit(w));
    gn_json_number(j, "dt_limit_bound", gn_world_bound(w));
    gn_json_number(j, "dt_resolution", w->resolution.step);
}

/* What it took, and of what. */
static void summary_cost(const gn_run *run, gn_json *j) {
    const gn_world *w = &run->world;
    gn_progress p = gn_run_progress(run);
    gn_json_integer(j, "list_rebuilds", w->verlet.rebuilds);
    gn_json_object(j, "seconds");
    for (int k = 0; k < GN_PHASE_COUNT; k++)
        gn_json_number(j, gn_phase_name((gn_phase)k), w->seconds[k]);
    gn_json_number(j, "total", p.seconds);
    gn_json_end(j);
    gn_json_number(j, "particle_steps_per_second",
                   (double)w->particles.soa.count * (double)w->step / p.seconds);
    gn_json_number(j, "contact_steps_per_second", (double)w->contact_steps / p.seconds);
    if (w->elements) gn_json_number(j, "element_steps_per_second", p.element_steps_per_second);
    gn_json_integer(j, "threads", w->threads);
    gn_json_text(j, "isa", w->kernels->name);
    gn_json_text(j, "precision", w->effects & GN_FX_MIXED ? "mixed" : "double");
    gn_json_text(j, "version", gn_version());
    gn_json_text(j, "build", gn_build());
}

gneiss_status gn_output_summary(const gn_run *run, gneiss_error *error) {
    const gn_world *w = &run->world;
    gn_observed seen;
    GN_TRY(gn_world_observe(w, &seen, error));
    size_t contacts = touching(&seen.bonds) + touching(&seen.pairs);
    gn_observed_free(&seen);
    char hash[24], path[GN_PATH_SIZE + 32];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)gn_world_hash(w));
    gn_json *j = gn_json_begin();
    gn_json_text(j, "title", w->scene.title);
    summary_readings(run, j);
    summary_counts(w, contacts, j);
    gn_json_number(j, "volume", w->volume);
    gn_json_text(j, "volume_of", gn_world_volume_source(w));
    gn_json_number(j, "energy_residual",
                   w->effects & GN_FX_ENERGY ? gn_energy_residual(&w->reading) : NAN);
    summary_warnings(run, j);
    gn_json_text(j, "state_hash", hash);
    gn_json_bool(j, "finished", run->finished);
    gn_json_text(j, "stop_reason", run->stop_reason);
    summary_step(w, j);
    summary_cost(run, j);
    char *text = gn_json_finish(j, true);
    if (!text) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for summary.json");
    snprintf(path, sizeof path, "%s/summary.json", run->directory);
    gneiss_status status = gn_write_text_file(path, text, GN_DURABLE, error);
    free(text);
    return status;
}
