#include "cli/plan_law.h"

#include "particles/bond_sections.h"

#include <math.h>

/* Prints the least, mean and largest value of a column over the bonds. */
static void print_range(const char *name, const double *column, const gn_contacts *bonds,
                        const char *unit) {
    double least = INFINITY, most = 0.0, sum = 0.0;
    size_t count = 0;
    for (size_t c = 0; column && c < bonds->soa.count; c++) {
        if (!gn_contact_bonded(bonds, c)) continue;
        count++;
        least = fmin(least, column[c]);
        most = fmax(most, column[c]);
        sum += column[c];
    }
    if (!count) return;
    printf("  %-16s %.6g to %.6g, mean %.6g %s\n", name, least, most, sum / (double)count, unit);
}

static void print_area(const gn_world *world, const gn_area_check *check) {
    bool polyhedron = world->ctx.scene.stiffness == GN_STIFFNESS_POLYHEDRON;
    int d = (int)world->ctx.scene.dimension;
    print_range("section A", world->dem.bonds.contacts.area, &world->dem.bonds.contacts,
                d == 3 ? "m2" : "m2 (1 m thick)");
    printf("  sections fill    %.4f of the body: sum(A L)/(%d V)", check->filled, d);
    if (polyhedron)
        printf(", %.4f with the free faces of %zu particles that have some",
               check->filled + check->free, check->open);
    printf("\n  gamma            %.4g%s%s", world->dem.derived.gamma,
           world->ctx.scene.gamma > 0.0                       ? " (given)"
           : world->ctx.scene.gamma_rule == GN_GAMMA_POROSITY ? " = 40 e/n_c"
                                                              : " fills it with Dempack's sections",
           polyhedron ? ", for pairs that come into contact later" : "");
    if (world->ctx.scene.gamma > 0.0 || world->ctx.scene.gamma_rule == GN_GAMMA_VOLUME)
        printf("; 40 e/n_c would be %.4g", check->dempack_gamma);
    printf("\n");
}

/* Prints Young's modulus and Poisson's ratio of the body for uniform strain of an isotropic packing
 * whose sections fill it: see docs/physics.md. */
static void print_body(const gn_world *world, const gn_area_check *check) {
    const gn_material *material = &world->ctx.scene.materials[0];
    double rho = material->beta / material->alpha / (2.0 * (1.0 + material->poisson)), e, nu;
    bool space = world->ctx.scene.dimension == 3;
    if (world->ctx.scene.material_count > 1) return;
    if (space) {
        e = (2.0 + 3.0 * rho) / (4.0 + rho);
        nu = (1.0 - rho) / (4.0 + rho);
    } else {
        e = 2.0 * (1.0 + rho) / (3.0 + rho);
        nu = (1.0 - rho) / (3.0 + rho);
    }
    printf("  uniform strain   E%s %.6g Pa, nu%s %.4f, of an isotropic packing filled so far\n",
           space ? "" : "'", e * material->alpha * material->young * check->filled,
           space ? "" : "'", nu);
}

/* A cubic lattice has 1.3, at its surface about half more. */
static const double gamma_most = 3.0;

gneiss_status gn_print_law(const gn_world *world, int *warnings, gneiss_error *error) {
    const gn_contacts *b = &world->dem.bonds.contacts;
    size_t n = b->soa.count;
    gn_area_check check;
    if (!n) return GNEISS_OK;
    if (gn_scene_by_area(&world->ctx.scene)) {
        GN_TRY(gn_areas_check(&world->ctx, &world->dem, &check, error));
        print_area(world, &check);
        print_body(world, &check);
    }
    print_range("k_n of bonds", b->kn, b, "N/m");
    print_range("k_t", b->kt, b, "N/m");
    print_range("R_n", b->rn, b, "N");
    print_range("R_t", b->rt, b, "N");
    if (world->ctx.scene.softening == GN_SOFTENING_ENERGY)
        printf("  plane cuts       %.4f of its section in bonds: fracture energies refer to %s\n",
               gn_law_cut(&world->ctx, &world->dem),
               world->ctx.scene.fracture_energy_of == GN_FRACTURE_BODY
                   ? "the body, and those of contacts are lower by this factor"
                   : "contacts, and that of the body is higher by this factor");
    if (!gn_scene_by_area(&world->ctx.scene)) return GNEISS_OK;
    if (world->ctx.scene.gamma == 0.0 && world->dem.derived.gamma > gamma_most) {
        printf("  warning: gamma is %.3g: the volume contains more than the bonded particles (set "
               "law.gamma)\n",
               world->dem.derived.gamma);
        (*warnings)++;
    }
    if (fabs(check.filled + check.free - 1.0) <= 0.1) return GNEISS_OK;
    printf("  warning: sections fill %.3g of the body instead of 1: stiffness and strength deviate "
           "by about this factor\n",
           check.filled + check.free);
    (*warnings)++;
    return GNEISS_OK;
}
