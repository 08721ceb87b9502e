/* Keys that change nothing in their scene. Each row of the tables below gives a key, the condition
 * under which nothing reads it, and the reason; for a value equal to the default there is no note.
 * These are notes and not errors, so that a scene can be varied. */
#include "scene/check.h"
#include "scene/sides.h"

#include <stdlib.h>
#include <string.h>

/* ---- given values ---- */

/* True if a value in the struct is the default of the key. */
static bool is_default(const gn_key *key, const void *base) {
    const char *at = (const char *)base + key->offset;
    if (key->presence == GN_PRESENT_BOOL || key->presence == GN_PRESENT_ENUM)
        return !gn_key_present(key, base);
    if (key->type == GN_KEY_TABLE) return ((const gn_table *)(const void *)at)->count == 0;
    if (!key->fallback) return false;
    bool word = key->word && strcmp(key->word, key->fallback) == 0;
    double fallback = word ? key->word_value : strtod(key->fallback, NULL);
    if (key->type == GN_KEY_REAL) return *(const double *)(const void *)at == fallback;
    if (key->type == GN_KEY_INTEGER) return (double)*(const int64_t *)(const void *)at == fallback;
    if (key->type != GN_KEY_CHOICE) return false;
    for (const gn_choice *choice = key->choices; choice->name; choice++)
        if (strcmp(choice->name, key->fallback) == 0)
            return gn_choice_load(key, at) == choice->value;
    return false;
}

/* Adds a note about a key of an element, or of the scene, if its value is not the default. */
static void note(const check *section, const void *base, const char *key, const char *why) {
    char path[GN_KEY_PATH_SIZE], text[256];
    const gn_node *node = gn_node_find(section->map, key);
    snprintf(path, sizeof path, "%s%s", section->prefix, key);
    const gn_key *meant = gn_scene_key_at(path);
    if (!node || !meant || is_default(meant, base)) return;
    snprintf(text, sizeof text, "it changes nothing here: %s", why);
    gn_read_note(section->reader, node, path, true, text);
}

/* ---- conditions ---- */

static bool bonded(const gn_scene *scene) {
    return scene->bonds == GN_SWITCH_ON;
}

static bool by_radius(const gn_scene *scene) {
    return scene->stiffness != GN_STIFFNESS_UNIFORM && !gn_scene_by_area(scene) &&
           !gn_scene_hertz(scene);
}

static const char no_bonds[] = "no bonds are formed";
static const char other_law[] = "this law.stiffness does not read it";
static const char other_softening[] = "this law.softening does not read it";

/* A key of a material and the reason why it is not read; NULL: it is read. `limits`: strengths are
 * given as forces. */
typedef struct material_row {
    const char *key;
    bool (*read_by_law)(const gn_scene *s); /* NULL: every law reads the key */
    bool of_bonds;
    int64_t softening; /* kind of softening that reads the key, a gn_softening; -1: any */
} material_row;

static bool uniform(const gn_scene *scene) {
    return scene->stiffness == GN_STIFFNESS_UNIFORM;
}
static bool not_uniform(const gn_scene *scene) {
    return !uniform(scene);
}
static bool elastic(const gn_scene *scene) {
    return gn_scene_by_area(scene) || gn_scene_hertz(scene);
}
static bool not_elastic(const gn_scene *scene) {
    return !elastic(scene);
}

static const material_row material_rows[] = {
    {"contact_modulus", by_radius, false, -1},
    {"normal_stiffness", uniform, false, -1},
    {"kratio", not_elastic, false, -1},
    {"young", elastic, false, -1},
    {"poisson", elastic, false, -1},
    {"adhesion", gn_scene_adheres, false, -1},
    {"alpha", gn_scene_by_area, false, -1},
    {"beta", gn_scene_by_area, false, -1},
    {"tensile_strength", not_uniform, true, -1},
    {"shear_strength", not_uniform, true, -1},
    {"bond_tension_limit", uniform, true, -1},
    {"bond_shear_limit", uniform, true, -1},
    {"strength_scatter", NULL, true, -1},
    {"stiffness_scatter", NULL, true, -1},
    {"bond_friction", NULL, true, -1},
    {"fracture_energy", NULL, true, GN_SOFTENING_ENERGY},
    {"shear_fracture_energy", NULL, true, GN_SOFTENING_ENERGY},
    {"fracture_strain", NULL, true, GN_SOFTENING_STRAIN},
    {"shear_fracture_strain", NULL, true, GN_SOFTENING_STRAIN},
    {"fracture_ratio", NULL, true, GN_SOFTENING_RATIO},
    {"yield_stress_1", NULL, true, -1},
    {"yield_stress_2", NULL, true, -1},
    {"yield_stress_3", NULL, true, -1},
};

static const char *unread_by_material(const gn_scene *scene, const material_row *row) {
    if (row->read_by_law && !row->read_by_law(scene)) return other_law;
    if (row->of_bonds && !bonded(scene)) return no_bonds;
    if (row->softening >= 0 && (int64_t)scene->softening != row->softening) return other_softening;
    return NULL;
}

/* True if a particle or another object is of the material; files of particles and earlier runs may
 * name any material. */
static bool is_used(const gn_scene *scene, const char *name) {
    bool used = *scene->specimen.file || *scene->specimen.from ||
                strcmp(scene->specimen.material, name) == 0 ||
                strcmp(scene->elements.contact.material, name) == 0;
    for (size_t k = 0; k < scene->set_count; k++)
        used |= strcmp(scene->sets[k].material, name) == 0;
    for (size_t k = 0; k < scene->wall_count; k++)
        used |= strcmp(scene->walls[k].material, name) == 0;
    for (size_t k = 0; k < scene->body_count; k++)
        used |= strcmp(scene->bodies[k].material, name) == 0;
    for (size_t k = 0; k < scene->source_count; k++)
        used |= strcmp(scene->sources[k].material, name) == 0;
    for (size_t k = 0; k < scene->clumps.shape_count; k++)
        used |= strcmp(scene->clumps.shapes[k].material, name) == 0;
    return used;
}

static void note_materials(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    for (size_t k = 0; scene->has_law && k < scene->material_count; k++) {
        check c = gn_check_element(reader, root, "materials", k);
        const gn_material *material = &scene->materials[k];
        if (!is_used(scene, material->name)) {
            note(&c, material, "name", "no particle, wall or body is of this material");
            continue;
        }
        if (scene->stage_count && !gn_material_has_spring(scene, material))
            note(&c, material, "friction", "without a tangential spring contacts have no friction");
        for (size_t r = 0; r < sizeof material_rows / sizeof *material_rows; r++) {
            const char *why = unread_by_material(scene, &material_rows[r]);
            if (why) note(&c, material, material_rows[r].key, why);
        }
    }
}

/* Adds notes on the keys of pairs. Keys that law.stiffness and law.softening do not read are
 * refused (check_law.c). */
static void note_contacts(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    for (size_t k = 0; !bonded(scene) && k < scene->contact_count; k++) {
        check c = gn_check_element(reader, root, "contacts", k);
        for (size_t r = 0; r < sizeof material_rows / sizeof *material_rows; r++)
            if (material_rows[r].of_bonds)
                note(&c, &scene->contacts[k], material_rows[r].key, no_bonds);
    }
}

/* ---- the scene itself ---- */

static bool unbonded(const gn_scene *scene) {
    return scene->has_specimen && !bonded(scene);
}
static bool without_events(const gn_scene *scene) {
    return scene->has_specimen && (unbonded(scene) || scene->events == GN_SWITCH_OFF);
}
static bool without_ledger(const gn_scene *scene) {
    return scene->energy == GN_SWITCH_OFF;
}
static bool without_gravity(const gn_scene *scene) {
    return !gn_scene_has_gravity(scene);
}
static bool with_step(const gn_scene *scene) {
    return scene->step > 0.0 && !scene->has_couple;
}
static bool without_relaxation(const gn_scene *scene) {
    return !(scene->couple.convert.relax > 0.0);
}
static bool all_faces(const gn_scene *scene) {
    return scene->has_membrane && scene->membrane.faces == GN_FACES_ALL;
}
static bool without_spins(const gn_scene *scene) {
    return scene->rotation == GN_SWITCH_OFF;
}
static bool without_run(const gn_scene *scene) {
    return scene->specimen_given && !*scene->specimen.from;
}
static bool from_nodes(const gn_scene *scene) {
    return scene->specimen.pack.start == GN_START_NODES;
}
static bool from_random_points(const gn_scene *scene) {
    return scene->specimen.pack.start != GN_START_NODES;
}
static bool without_particles(const gn_scene *scene) {
    return !scene->has_specimen;
}
/* Tells whether there are no contacts at all; bodies touch each other even without particles. */
static bool without_contacts(const gn_scene *scene) {
    return without_particles(scene) && !scene->body_count;
}
/* Tells whether materials alone determine the damping of contacts; bodies without a material damp
 * their contacts with each other by damping.contact. */
static bool damped_by_materials(const gn_scene *scene) {
    if (!scene->has_law || !gn_scene_hertz(scene) || scene->body_count) return false;
    for (size_t k = 0; k < scene->material_count; k++)
        if (scene->materials[k].restitution < 0.0) return false;
    return scene->material_count > 0;
}
static bool turns_of_nothing(const gn_scene *scene) {
    return scene->orientation == GN_SWITCH_ON && (without_particles(scene) || without_spins(scene));
}
static bool events_of_nothing(const gn_scene *scene) {
    return scene->events == GN_SWITCH_ON && without_particles(scene);
}
static const char no_particles[] = "there are no particles";
static const char no_contacts[] = "there are neither particles nor bodies";
static const char own_damping[] = "every material has its own restitution";

static const struct {
    const char *key;
    bool (*idle)(const gn_scene *s);
    const char *why;
} scene_rows[] = {
    {"law.coupling", unbonded, no_bonds},
    {"law.confinement", unbonded, no_bonds},
    {"law.softening", unbonded, no_bonds},
    {"bonds.interaction_range", unbonded, no_bonds},
    {"bonds.overlap_range", unbonded, no_bonds},
    {"bonds.passive_gaps", unbonded, no_bonds},
    {"bonds.radius_multiplier", unbonded, no_bonds},
    {"bonds.moment_share", unbonded, no_bonds},
    {"specimen.from_velocities", without_run, "the specimen comes from no other run"},
    {"specimen.packing.size_ratio", from_nodes, "particles come from the nodes of the mesh"},
    {"specimen.packing.size_variation", from_nodes, "particles come from the nodes of the mesh"},
    {"specimen.packing.jiggle", from_random_points, "specimen.packing.start is random"},
    {"couple.convert.relax_iterations", without_relaxation, "couple.convert.relax is none"},
    {"couple.spins", without_spins, "law.rotation is off"},
    {"membrane.axis", all_faces, "membrane.faces is all"},
    {"time.safety", with_step, "time.step is given, and it is a factor of an automatic step"},
    {"time.contact_steps", with_step,
     "time.step is given, and only the warning of unresolved collisions reads it"},
    {"time.contact_steps", without_contacts, no_contacts},
    {"neighbours.skin", without_contacts, no_contacts},
    {"damping.contact.restitution", without_contacts, no_contacts},
    {"damping.contact.restitution", damped_by_materials, own_damping},
    {"damping.contact.fraction", without_contacts, no_contacts},
    {"damping.contact.fraction", damped_by_materials, own_damping},
    {"damping.background.rotation", without_particles, no_particles},
    {"elements.contact", without_particles, no_particles},
    {"time.mass_scaling.gravity", without_gravity, "there is no gravity"},
    {"output.events", unbonded, no_bonds},
    {"output.events", events_of_nothing, no_particles},
    {"output.orientation", turns_of_nothing, "no particles rotate"},
    {"output.burst_reach", without_particles, no_particles},
    {"output.burst_reach", without_events, "there is no list of events"},
    {"run.residual_warning", without_ledger, "output.energy is off"},
    {"run.residual_limit", without_ledger, "output.energy is off"},
};

/* ---- motions ---- */

static bool is_zero(const gn_table *table) {
    for (size_t k = 0; k < table->count; k++)
        if (table->value[k] != 0.0) return false;
    return true;
}

/* Adds notes on walls: a plane that moves within itself and has no friction has no effect. */
static void note_walls(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    static const char *const keys[] = {"motion.vx", "motion.vy", "motion.vz"};
    for (size_t k = 0; k < scene->wall_count; k++) {
        check c = gn_check_element(reader, root, "walls", k);
        const gn_wall_def *wall = &scene->walls[k];
        const int m = *wall->material ? gn_scene_find_material(scene, wall->material) : -1;
        const bool rough = wall->friction > 0 || wall->rolling_friction > 0 ||
                           wall->twisting_friction > 0 || m >= 0 || scene->contact_count;
        for (int a = 0; !rough && a < 3; a++)
            if (wall->normal[a] == 0.0 && !is_zero(&wall->motion.velocity[a]))
                note(&c, &wall->motion, keys[a],
                     "the wall moves in its own plane, and has no friction");
        if (!rough) note(&c, wall, "kratio", "the wall has no friction");
    }
}

static void note_sets(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    for (size_t k = 0; k < scene->set_count; k++) {
        check c = gn_check_element(reader, root, "sets", k);
        bool led = true;
        for (int a = 0; a < (int)scene->dimension; a++)
            led =
                led && (scene->sets[k].motion.velocity[a].count || scene->sets[k].force[a] == 0.0);
        if (led) note(&c, &scene->sets[k], "force", "its motion is prescribed along it");
    }
}

static void note_bodies(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    for (size_t k = 0; k < scene->body_count; k++) {
        check c = gn_check_element(reader, root, "bodies", k);
        const gn_body_def *body = &scene->bodies[k];
        if (!*body->material &&
            !(body->friction > 0 || body->rolling_friction > 0 || body->twisting_friction > 0))
            note(&c, body, "kratio", "the body has no friction");
    }
}

static void note_sources(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    for (size_t k = 0; k < scene->source_count; k++) {
        check c = gn_check_element(reader, root, "sources", k);
        if (scene->sources[k].start >= scene->end)
            note(&c, &scene->sources[k], "start", "the run ends before it (time.end)");
    }
}

/* Adds notes on shapes that no clump has; the rows of a file may name any shape. */
static void note_clumps(const gn_reader *reader, const gn_node *root, const gn_scene *scene) {
    const gn_clumps_def *clumps = &scene->clumps;
    for (size_t s = 0; !*clumps->file && s < clumps->shape_count; s++) {
        const char *name = clumps->shapes[s].name;
        check c = gn_check_element(reader, root, "clumps.shapes", s);
        bool used = false;
        for (size_t k = 0; k < clumps->placed_count; k++)
            used |= strcmp(clumps->placed[k].shape, name) == 0;
        for (size_t k = 0; k < clumps->filled_count; k++)
            for (size_t i = 0; i < clumps->filled[k].shape_count; i++)
                used |= strcmp(clumps->filled[k].shapes[i], name) == 0;
        if (!used) note(&c, &clumps->shapes[s], "name", "no clump has this shape");
    }
}

void gn_note_idle_keys(const gn_reader *reader, const gn_node *root) {
    const gn_scene *scene = reader->scene;
    const check c = {.reader = reader, .map = root};
    note_materials(reader, root, scene);
    note_contacts(reader, root, scene);
    for (size_t k = 0; k < sizeof scene_rows / sizeof *scene_rows; k++)
        if (scene_rows[k].idle(scene)) note(&c, scene, scene_rows[k].key, scene_rows[k].why);
    note_walls(reader, root, scene);
    note_sets(reader, root, scene);
    note_bodies(reader, root, scene);
    note_sources(reader, root, scene);
    note_clumps(reader, root, scene);
}
