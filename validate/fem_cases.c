#include "fem_cases.h"

#include "base/memory.h"
#include "fem/structured.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

typedef struct definition {
    const char *name, *material;
    int dimension;
    gn_fem_material rock;
    double load, scale; /* Pa; part of the load that is applied */
} definition;

static const definition definitions[] = {
    {"cook", "compressible", 2, {NULL, 1.0, 1.0 / 3.0, 1.0}, 1.0 / 16.0, 1e-6},
    {"cook", "incompressible", 2, {NULL, 240.565, 0.4999, 1.0}, 6.25, 1e-4},
    {"block", "compressible", 3, {NULL, 240.565e6, 1.0 / 3.0, 1000.0}, 20e3, 0.1},
    {"block", "incompressible", 3, {NULL, 240.565e6, 0.4999, 1000.0}, 20e3, 0.1},
};
static const double block_side = 0.1, block_height = 0.05, block_half = 0.05,
                    block_cube = 0.1 / 6.0; /* m */

/* --- meshes --- */

static void map_cook(gn_mesh *mesh) {
    for (size_t n = 0; n < mesh->node_count; n++) {
        double s = mesh->node[3 * n], t = mesh->node[3 * n + 1];
        mesh->node[3 * n] = 48.0 * s;
        mesh->node[3 * n + 1] = 44.0 * s * (1.0 - t) + (44.0 + 16.0 * s) * t;
    }
}

static gneiss_status make_mesh(const definition *d, const fem_case_spec *spec, gn_mesh *mesh,
                               gneiss_error *error) {
    const int cells = spec->cells;
    gn_structured s = {
        .size = {1.0, 1.0, 1.0}, .cells = {cells, cells, cells / 2}, .parallel = spec->slanted};
    if (d->dimension == 2) {
        GN_TRY(gn_mesh_rectangle(&s, mesh, error));
        map_cook(mesh);
        return GNEISS_OK;
    }
    s.size[0] = s.size[1] = block_side;
    s.size[2] = block_height;
    return gn_mesh_box(&s, mesh, error);
}

/* --- loads and supports --- */

static gneiss_status hold(gn_fem_solid *body, const char *group, unsigned mask,
                          gneiss_error *error) {
    const double rest[3] = {0.0};
    gn_fem_set set;
    int32_t motion;
    GN_TRY(gn_fem_nodes_of_group(body, group, &set, error));
    gneiss_status status = gn_fem_prescribe(body, &set, mask, rest, &motion, error);
    gn_fem_set_free(&set);
    return status;
}

static double press(double x, double y) {
    if (!(fabs(x) < block_half && fabs(y) < block_half)) return 0.0;
    double c = cos(pi * x / (2.0 * block_half)) * cos(pi * y / (2.0 * block_half));
    return c * c;
}

/* Adds the forces of the smooth pressure on one facet of the top: its mean against each shape
 * function, by the six-point rule that is exact to degree 4 (Dunavant 1985). */
static void press_facet(gn_fem_solid *body, const int32_t *node, double p) {
    static const double rule[2][2] = {{0.445948490915965, 0.223381589678011},
                                      {0.091576213509771, 0.109951743655322}};
    const double *x[3];
    for (int a = 0; a < 3; a++) x[a] = body->nodes.start + 4 * (size_t)node[a];
    double area = 0.5 * fabs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) -
                             (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]));
    for (int r = 0; r < 2; r++)
        for (int odd = 0; odd < 3; odd++) {
            double at[2] = {0.0}, shape[3];
            for (int a = 0; a < 3; a++) shape[a] = a == odd ? 1.0 - 2.0 * rule[r][0] : rule[r][0];
            for (int a = 0; a < 3; a++)
                for (int k = 0; k < 2; k++) at[k] += shape[a] * x[a][k];
            for (int a = 0; a < 3; a++)
                body->nodes.applied[4 * (size_t)node[a] + 2] -=
                    area * rule[r][1] * shape[a] * p * press(at[0], at[1]);
        }
}

static gneiss_status load_and_hold(gn_fem_solid *body, const definition *d, gneiss_error *error) {
    const double p = d->scale * d->load;
    if (d->dimension == 2) {
        GN_TRY(hold(body, "x_lower", 3, error));
        gn_fem_load load;
        GN_TRY(gn_fem_load_on_facets(body, "x_upper", NULL, NULL, &load, error));
        gn_fem_set_loads(body, &load, (const double[1][3]){{0.0, p, 0.0}}, 1);
        gn_fem_load_free(&load);
        return GNEISS_OK;
    }
    GN_TRY(hold(body, "x_lower", 1, error));
    GN_TRY(hold(body, "y_lower", 2, error));
    GN_TRY(hold(body, "z_lower", 4, error));
    const gn_mesh_elements *facets = &body->mesh.triangles;
    for (size_t f = 0; f < facets->count; f++) {
        const int32_t *node = facets->node + 3 * f;
        bool top = true;
        for (int a = 0; a < 3; a++)
            top = top && body->nodes.start[4 * (size_t)node[a] + 2] > (1.0 - 1e-9) * block_height;
        if (top) press_facet(body, node, p);
    }
    return GNEISS_OK;
}

static const definition *find(const fem_case_spec *spec, gneiss_error *error) {
    const definition *found = NULL;
    for (size_t k = 0; k < sizeof definitions / sizeof *definitions; k++)
        if (!strcmp(definitions[k].name, spec->name) &&
            !strcmp(definitions[k].material, spec->material))
            found = &definitions[k];
    if (!found)
        gn_fail(error, GNEISS_ERROR_INPUT,
                "expected the case cook or block and the material compressible or incompressible, "
                "found '%s' and '%s'",
                spec->name, spec->material);
    else if (spec->cells < 2 || spec->cells % 2) {
        gn_fail(error, GNEISS_ERROR_INPUT, "expected an even number of cells > 0, found %d",
                spec->cells);
        found = NULL;
    }
    return found;
}

gneiss_status fem_case_create(const fem_case_spec *spec, fem_case *c, gneiss_error *error) {
    memset(c, 0, sizeof *c);
    const definition *d = find(spec, error);
    if (!d) return GNEISS_ERROR_INPUT;
    const gn_fem_spec body = {.name = d->name,
                              .dimension = d->dimension,
                              .form = spec->form,
                              .materials = &d->rock,
                              .material_count = 1,
                              .damping = GN_FX_VISCOUS,
                              .threads = spec->threads};
    gn_mesh mesh;
    GN_TRY(make_mesh(d, spec, &mesh, error));
    GN_TRY(gn_fem_solid_create(&body, &mesh, &c->body, error));
    c->scale = d->scale;
    gneiss_status status = load_and_hold(&c->body, d, error);
    if (status != GNEISS_OK) fem_case_free(c);
    return status;
}

void fem_case_free(fem_case *c) {
    gn_fem_solid_free(&c->body);
    memset(c, 0, sizeof *c);
}

/* --- relaxation --- */

/* Computes u f, u M u and v M v of the body, f being the applied forces; the sums run in node
 * order. */
static void products(const gn_fem_solid *body, double *uf, double *umu, double *vmv) {
    *uf = *umu = *vmv = 0.0;
    for (size_t n = 0; n < body->nodes.soa.count; n++) {
        const double mass = 1.0 / body->nodes.vel[4 * n + 3];
        for (size_t k = 4 * n; k < 4 * n + (size_t)body->dimension; k++) {
            double u = body->nodes.pos[k] - body->nodes.start[k], v = body->nodes.vel[k];
            *uf += u * body->nodes.applied[k];
            *umu += u * u * mass;
            *vmv += v * v * mass;
        }
    }
}

static gneiss_status read_all(fem_case *c, gneiss_error *error);

gneiss_status fem_case_relax(fem_case *c, double tolerance, int64_t most, gneiss_error *error) {
    enum { EVERY = 50, CALM = 20 }; /* steps between checks; consecutive checks that must be calm */
    gn_fem_limit limit;
    GN_TRY(gn_fem_bound(&c->body, &limit, error));
    const double dt = 0.9 * limit.bound;
    for (int calm = 0; calm < CALM;) {
        if (c->steps >= most)
            return gn_fail(error, GNEISS_ERROR_UNSTABLE,
                           "%s: expected rest after %lld steps, found sqrt(v M v/u f) = %g",
                           c->body.name, (long long)most, c->unrest);
        for (int s = 0; s < EVERY; s++) GN_TRY(gn_fem_step(&c->body, dt, false, error));
        c->steps += EVERY;
        double uf, umu, vmv;
        products(&c->body, &uf, &umu, &vmv);
        if (!(uf > 0.0 && umu > 0.0)) continue;
        c->unrest = sqrt(vmv / uf);
        c->body.damping_coefficient = fmin(2.0 * sqrt(uf / umu), 0.1 / dt);
        calm = c->unrest < tolerance ? calm + 1 : 0;
    }
    return read_all(c, error);
}

/* --- readings --- */

void fem_case_displacement(const fem_case *c, size_t node, double u[3]) {
    for (size_t k = 0; k < 3; k++)
        u[k] = (c->body.nodes.pos[4 * node + k] - c->body.nodes.start[4 * node + k]) / c->scale;
}

gneiss_status fem_case_pressure(const fem_case *c, double **pressure, gneiss_error *error) {
    const size_t count = c->body.elements.soa.count;
    double(*stress)[6] = gn_alloc_array(count + 1, sizeof *stress);
    *pressure = gn_alloc_array(count + 1, sizeof **pressure);
    if (!stress || !*pressure) {
        gn_free(stress);
        gn_free(*pressure);
        *pressure = NULL;
        return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for the stress of %zu elements",
                       count);
    }
    gn_fem_element_stress(&c->body, stress);
    for (size_t e = 0; e < count; e++)
        (*pressure)[e] = -(stress[e][0] + stress[e][1] + stress[e][2]) / 3.0 / c->scale;
    gn_free(stress);
    return GNEISS_OK;
}

static double component_at(const fem_case *c, double x, double y, double z, size_t component) {
    size_t best = 0;
    double least = INFINITY, u[3];
    for (size_t n = 0; n < c->body.nodes.soa.count; n++) {
        const double *q = c->body.nodes.start + 4 * n;
        double far =
            fabs(q[0] - x) + fabs(q[1] - y) + (c->body.dimension == 3 ? fabs(q[2] - z) : 0.0);
        if (far >= least) continue;
        least = far;
        best = n;
    }
    fem_case_displacement(c, best, u);
    return u[component];
}

/* Returns the displacement along a component, weighted by the applied forces. */
static double mean_of_loaded(const fem_case *c, size_t component) {
    double sum = 0.0, all = 0.0, u[3];
    for (size_t n = 0; n < c->body.nodes.soa.count; n++) {
        double f = c->body.nodes.applied[4 * n + component];
        fem_case_displacement(c, n, u);
        sum += f * u[component];
        all += f;
    }
    return sum / all;
}

static void add(fem_case *c, const char *name, double value) {
    c->reading[c->count] = name;
    c->value[c->count++] = value;
}

/* Computes the mean pressure of the three cubes below the middle of the block, from the top. */
static gneiss_status read_column(fem_case *c, gneiss_error *error) {
    static const char *const name[3] = {"pressure 1", "pressure 2", "pressure 3"};
    const gn_elements *q = &c->body.elements;
    double *pressure, sum[3] = {0.0}, volume[3] = {0.0};
    GN_TRY(fem_case_pressure(c, &pressure, error));
    for (size_t e = 0; e < q->soa.count; e++) {
        double centre[3] = {0.0};
        for (int a = 0; a < 4; a++)
            for (size_t k = 0; k < 3; k++)
                centre[k] += 0.25 * c->body.nodes.start[4 * (size_t)gn_elements_node(q, a)[e] + k];
        if (centre[0] > block_cube || centre[1] > block_cube) continue;
        int layer = (int)((block_height - centre[2]) / block_cube);
        sum[layer] += q->volume[e] * pressure[e];
        volume[layer] += q->volume[e];
    }
    for (int k = 0; k < 3; k++) add(c, name[k], sum[k] / volume[k]);
    gn_free(pressure);
    return GNEISS_OK;
}

static gneiss_status read_all(fem_case *c, gneiss_error *error) {
    c->count = 0;
    if (c->body.dimension == 2) {
        add(c, "top right", component_at(c, 48.0, 60.0, 0.0, 1));
        add(c, "middle right", component_at(c, 48.0, 52.0, 0.0, 1));
        add(c, "mean right", mean_of_loaded(c, 1));
        return GNEISS_OK;
    }
    add(c, "centre", component_at(c, 0.0, 0.0, block_height, 2));
    add(c, "mean", mean_of_loaded(c, 2));
    return read_column(c, error);
}
