#include "cli/plan_couple.h"
#include "solids/elements.h"
#include "world/world.h"

#include "base/memory.h"
#include "solids/element_walls.h"
#include "timestep/step_limit.h"
#include "zones/zones.h"

#include <math.h>
#include <stdio.h>

static void warn(int *warnings, const char *text) {
    printf("  warning: %s\n", text);
    (*warnings)++;
}

double gn_zone_advised_width(double element, double diameter) {
    return fmax(3.0 * element, 6.0 * diameter);
}

bool gn_zone_is_thin(double width, double advised) {
    return width < advised * (1.0 - 1e-6);
}

static void print_tension(const gn_zone_material *material) {
    if (!(material->tension[3] > 0.0)) return;
    printf("  tension          %.4g", material->tension[0]);
    for (int a = 1; a < 3 && material->tension[a] > 0.0; a++)
        printf(", %.4g", material->tension[a]);
    printf(" Pa of these particles along the axes with free sides, %.4g Pa of the elements\n",
           material->tension[3]);
}

void gn_print_zone_material(const gn_zone_material *material, bool several, int *warnings) {
    if (several)
        printf("  material         %d of the elements, with %zu particles\n",
               (int)material->material, material->particles);
    if (!(material->modulus[0] > 0.0)) return; /* no bonds: no initial modulus */
    printf("  modulus          %.4g Pa of particles that follow elements, %.4g Pa of these "
           "(confined)\n",
           material->modulus[0], material->modulus[1]);
    print_tension(material);
    printf("  density          %.4g kg/m3, %.4g kg/m3 of the elements\n", material->density[0],
           material->density[1]);
    printf("  returned         %.2g %% of the energy of a wave, by this difference alone\n",
           100.0 * material->returned);
    if (gn_zone_differs(material))
        warn(warnings, "particles and elements differ: calibrate the particles to the elements' E "
                       "and nu, and their density");
}

static void warn_of_edges(const gn_zone_figures *figures, int *warnings) {
    char text[192];
    if (figures->least > 1e-6) {
        snprintf(text, sizeof text,
                 "the elements end where they still have a weight of %.2g: `from` "
                 "is beyond their end",
                 figures->least);
        warn(warnings, text);
    }
    /* Half a distance of neighbours leaves a weight of that over the width, and a plane through the
     * middle of elements up to a quarter of theirs. */
    if (figures->edge * figures->width > figures->diameter + 0.25 * figures->element &&
        !figures->shared) {
        snprintf(text, sizeof text,
                 "the particles end where they still have a weight of %.2g: `to` is beyond their "
                 "outermost centres",
                 figures->edge);
        warn(warnings, text);
    }
    if (figures->beyond)
        warn(warnings, "particles reach beyond the plane through `to`, where elements carry all");
}

static void print_zone(const gn_world *world, size_t k, int *warnings) {
    gn_zone_figures f;
    gn_zone_measure(&world->ctx, &world->dem, &world->solids, &world->zones, k, &f);
    double elements = f.width / f.element, diameters = f.width / f.diameter;
    printf("zone %zu\n  width            %.6g m = %.3g elements = %.3g particles\n", k, f.width,
           elements, diameters);
    printf("  particles        %zu in elements, %zu of them where they have no weight\n",
           f.particles, f.beyond);
    if (f.shared)
        printf(
            "  overlaps         zone %zu: %zu particles are in both, where the smaller weight of "
            "the elements holds\n",
            f.other, f.shared);
    printf("  masses           %.4g times the share that the elements leave\n", f.mass);
    if (gn_zone_is_off(&f))
        warn(
            warnings,
            "the mass of the particles is not the share that the elements leave to them: they have "
            "to fill the zone from side to side, with the elements' density (density_basis bulk)");
    for (size_t m = 0; m < f.materials; m++)
        gn_print_zone_material(&f.material[m], f.materials > 1, warnings);
    if (gn_zone_is_thin(f.width, gn_zone_advised_width(f.element, f.diameter)))
        warn(warnings, "the zone is thin: three elements and six particles across are advised");
    warn_of_edges(&f, warnings);
}

void gn_print_whole_limit(const gn_world *world) {
    const gn_whole_limit *whole = gn_coupled_whole(&world->ctx, &world->zones);
    char text[96];
    if (!whole) return;
    printf("  both together\n  sharp limit      %.6g s  (Lanczos, %d vectors)\n", whole->sharp,
           whole->iterations);
    printf("  rigorous bound   %.6g s  = %.3f of the sharp limit\n",
           gn_world_bound(&world->ctx, &world->dem, &world->solids),
           gn_world_bound(&world->ctx, &world->dem, &world->solids) / whole->sharp);
    printf("  set by           %s; its mode lies to %.0f %% in particles, to %.0f %% in elements, "
           "to %.0f %% in zones\n",
           gn_whole_culprit(whole, text, sizeof text), 100.0 * whole->share[GN_SIDE_PARTICLES],
           100.0 * whole->share[GN_SIDE_ELEMENTS], 100.0 * whole->share[GN_SIDE_ZONE]);
}

static void print_step(const gn_world *world) {
    const gn_whole_limit *whole = gn_coupled_whole(&world->ctx, &world->zones);
    bool elements =
        whole ? whole->side == GN_SIDE_ELEMENTS
              : gn_elements_lead(&world->ctx, &world->dem, &world->solids, &world->zones) != NULL;
    printf("step of the coupled model\n  dt               %.6g s, set by the %s\n", world->ctx.dt,
           whole      ? gn_side_text(whole->side)
           : elements ? "elements"
                      : "particles");
}

/* Notes diagonals of meshes with zones, whose waves they scatter: docs/evidence/coupling.md. */
static void note_diagonals(const gn_world *world) {
    const gn_element_def *elements = &world->ctx.scene.elements;
    const gn_diagonals diagonals =
        elements->has_beam ? elements->beam.diagonals : elements->diagonals;
    if (elements->mesh[0] || diagonals == GN_DIAGONALS_PARALLEL) return;
    printf("  note             diagonals alternate: neighbouring nodes have masses of %s, which "
           "scatter waves only some elements long (elements.%s.diagonals: parallel)\n",
           world->ctx.scene.dimension == 3 ? "5 : 1" : "2 : 1",
           elements->has_beam  ? "beam"
           : elements->has_box ? "box"
                               : "rectangle");
}

void gn_print_zones(const gn_world *world, int *warnings) {
    const size_t zones = world->ctx.scene.has_couple ? world->ctx.scene.couple.zone_count : 0;
    for (size_t k = 0; k < zones; k++) print_zone(world, k, warnings);
    if (zones > 0) note_diagonals(world);
    if (world->ctx.scene.has_couple) print_step(world);
}

/* A sentence that holds for all of them is printed once. */
static const char no_contact[] = "elements have no contact with walls and pass through them; hold "
                                 "or load elements by motions or loads of elements";

static void print_passed(const char *wall, const gn_wall_passed *passed, int *warnings) {
    char text[512];
    if (passed->behind && passed->time > 0.0)
        snprintf(text, sizeof text,
                 "wall '%.60s' goes through elements from t = %.3g s on (%zu nodes, at most %.3g m "
                 "deep): %s",
                 wall, passed->time, passed->behind, passed->deepest, no_contact);
    else if (passed->behind)
        snprintf(text, sizeof text,
                 "wall '%.60s' goes through elements from the start on (%zu nodes, at most %.3g m "
                 "deep): %s",
                 wall, passed->behind, passed->deepest, no_contact);
    else
        snprintf(text, sizeof text, "wall '%.60s' touches %zu nodes of elements: %s", wall,
                 passed->touching, no_contact);
    if (passed->behind || passed->touching) warn(warnings, text);
}

gneiss_status gn_print_walls_passed(gn_world *world, int *warnings, gneiss_error *error) {
    if (!world->ctx.scene.has_couple || !world->ctx.scene.wall_count) return GNEISS_OK;
    gn_wall_passed *passed = gn_alloc_array(world->ctx.scene.wall_count, sizeof *passed);
    gneiss_status status = passed
                               ? gn_wall_predict_passed(&world->ctx, &world->solids, passed, error)
                               : gn_fail(error, GNEISS_ERROR_MEMORY, "no memory to check walls");
    for (size_t k = 0; status == GNEISS_OK && k < world->ctx.scene.wall_count; k++)
        print_passed(world->ctx.scene.walls[k].name, &passed[k], warnings);
    gn_free(passed);
    return status;
}
