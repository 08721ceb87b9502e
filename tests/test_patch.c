/* Pressure over a deforming surface: a plane acts as one contact, and there is a potential. */
#include "surface_helpers.h"

#include "surfaces/patch.h"

enum { CELLS = 12, CORNERS = CELLS + 1 };

/* A square (2D: line) of side 2 m about the origin, cut at random; heights up to `rough`. */
typedef struct sheet {
    int corners;
    size_t facets;
    double vertex[CORNERS * CORNERS][3];
    int facet[2 * CELLS * CELLS][3];
} sheet;

static void make_sheet(int corners, double rough, uint64_t seed, sheet *s) {
    const double h = 2.0 / CELLS;
    uint64_t at = seed;
    s->corners = corners;
    s->facets = 0;
    for (int j = 0; j < (corners == 3 ? CORNERS : 1); j++)
        for (int i = 0; i < CORNERS; i++) {
            double *x = s->vertex[CORNERS * j + i];
            x[0] = -1.0 + h * i + uniform(&at, -0.3 * h, 0.3 * h);
            x[1] = corners == 3 ? -1.0 + h * j + uniform(&at, -0.3 * h, 0.3 * h) : 0.0;
            x[2] = 0.0;
            x[corners - 1] = uniform(&at, -rough, rough);
        }
    for (int j = 0; j < (corners == 3 ? CELLS : 1); j++)
        for (int i = 0; i < CELLS; i++) {
            const int a = CORNERS * j + i;
            const int first[3] = {a, a + 1, a + CORNERS + 1},
                      second[3] = {a + CORNERS + 1, a + CORNERS, a};
            memcpy(s->facet[s->facets++], first, sizeof first);
            if (corners == 3) memcpy(s->facet[s->facets++], second, sizeof second);
        }
}

/* Results of a contact divided by k: the force on the surface, the potential, and forces on
 * vertices (NULL: not requested). */
static double press(const sheet *s, const double centre[3], double radius, double force[3],
                    double (*on)[3]) {
    double sum = 0.0;
    memset(force, 0, 3 * sizeof *force);
    for (size_t f = 0; f < s->facets; f++) {
        const double *x[3];
        gn_facet_near near;
        gn_patch_facet part;
        for (int c = 0; c < s->corners; c++) x[c] = s->vertex[s->facet[f][c]];
        if (!gn_patch_press(s->corners, x, centre, radius, &near, &part)) continue;
        sum += part.potential;
        for (int a = 0; a < 3; a++) {
            const double value = part.force * near.away[a] / near.distance;
            force[a] += value;
            for (int c = 0; on && c < s->corners; c++)
                on[s->facet[f][c]][a] += near.weight[c] * value;
        }
    }
    return sum;
}

static void a_plane_however_it_is_cut_is_one_contact(void **state) {
    (void)state;
    for (int corners = 2; corners <= 3; corners++)
        for (int k = 0; k < 200; k++) {
            uint64_t at = 100 + (uint64_t)k;
            static sheet s;
            make_sheet(corners, 0.0, 7 + (uint64_t)k, &s);
            const double radius = uniform(&at, 1.0, 5.0);
            const double depth = radius * pow(10.0, uniform(&at, -6.0, -2.0));
            const int up = corners - 1;
            double centre[3] = {uniform(&at, -0.3, 0.3), uniform(&at, -0.3, 0.3), 0.0}, force[3];
            centre[up] = (k % 2 ? 1.0 : -1.0) * (radius - depth);
            const double potential = press(&s, centre, radius, force, NULL);
            assert_near(fabs(force[up]), depth, 1e-12 * radius);
            assert_true(force[up] * centre[up] < 0.0);
            for (int a = 0; a < up; a++) assert_near(force[a], 0.0, 1e-12 * radius);
            assert_near(potential, 0.5 * depth * depth, 1e-15 * radius * radius);
        }
}

/* The force is the gradient of the potential, for the particle, and for vertices along the normal
 * except for the stretch of the surface. */
static void the_force_is_that_of_the_potential(void **state) {
    (void)state;
    const double step = 1e-6;
    for (int corners = 2; corners <= 3; corners++)
        for (int k = 0; k < 50; k++) {
            uint64_t at = 300 + (uint64_t)k;
            static sheet s;
            static double on[CORNERS * CORNERS][3];
            double centre[3] = {uniform(&at, -1.0, 1.0), uniform(&at, -1.0, 1.0), 0.0};
            double force[3], unused[3];
            const int up = corners - 1;
            make_sheet(corners, 0.02, 17 + (uint64_t)k, &s);
            centre[up] = 1.95;
            memset(on, 0, sizeof on);
            press(&s, centre, 2.0, force, on);
            for (int a = 0; a < corners; a++) {
                double moved[3] = {centre[0], centre[1], centre[2]};
                moved[a] += step;
                double slope = press(&s, moved, 2.0, unused, NULL);
                moved[a] -= 2.0 * step;
                slope = (slope - press(&s, moved, 2.0, unused, NULL)) / (2.0 * step);
                assert_near(slope, force[a], 1e-7);
            }
            for (int v = 0; v < (corners == 3 ? CORNERS * CORNERS : CORNERS); v += 7) {
                double *x = &s.vertex[v][up];
                *x += step;
                double slope = press(&s, centre, 2.0, unused, NULL);
                *x -= 2.0 * step;
                slope = (slope - press(&s, centre, 2.0, unused, NULL)) / (2.0 * step);
                *x += step;
                assert_near(slope, -on[v][up], 0.02 * fabs(force[up]));
            }
        }
}

/* Contacts made of several facets have the sum of the facets' forces. */
static void contacts_share_force_and_potential(void **state) {
    (void)state;
    static sheet s;
    static gn_facet_near near[2 * CELLS * CELLS];
    static gn_patch_facet part[2 * CELLS * CELLS];
    static gn_facet_contact contact[2 * CELLS * CELLS];
    const double centre[3] = {0.1, -0.2, 1.95};
    for (int hertz = 0; hertz < 2; hertz++) {
        size_t count = 0;
        double potential = 0.0, stored = 0.0;
        make_sheet(3, 0.02, 5, &s);
        for (size_t f = 0; f < s.facets; f++) {
            const double *x[3];
            for (int c = 0; c < 3; c++) x[c] = s.vertex[s.facet[f][c]];
            if (!gn_patch_press(3, x, centre, 2.0, &near[count], &part[count])) continue;
            potential += part[count++].potential;
        }
        gn_patch_contacts(near, part, count, hertz, contact);
        for (size_t k = 0; k < count; k++) {
            const double overlap = -contact[k].overlap, share = contact[k].part;
            const double factor = hertz ? sqrt(sqrt(2.0 * potential)) : 1.0;
            const double force = hertz ? share * pow(overlap, 1.5) : share * overlap;
            assert_near(force, factor * part[k].force, 1e-3 * potential);
            stored += (hertz ? 0.4 : 0.5) * force * overlap;
        }
        assert_close(stored, hertz ? 0.4 * pow(2.0 * potential, 1.25) : potential, 1e-9);
    }
}

/* --- a block with equal cells --- */

enum { BLOCK_CELLS = 8 };

/* Upper face of 2 m x 2 m at height 0 and its sides, 1 m deep (2D: the same in the plane); all
 * coordinates are exact in binary. */
static void make_block(int corners, soup *s) {
    const double h = 2.0 / BLOCK_CELLS;
    const int down = BLOCK_CELLS / 2;
    s->count = 0;
    for (int face = 0; face < (corners == 3 ? 5 : 3); face++)
        for (int i = 0; i < BLOCK_CELLS; i++)
            for (int j = 0; j < (corners == 2 ? 1 : face ? down : BLOCK_CELLS); j++) {
                double x[4][3] = {{0.0}};
                if (corners == 2 && face && i >= down) continue;
                for (int c = 0; c < 4; c++) {
                    const double u = -1.0 + h * (i + (c == 1 || c == 2)), v = h * (j + (c > 1));
                    const double side = face % 2 ? 1.0 : -1.0;
                    const int across = face > 2;
                    x[c][corners - 1] = corners == 2 ? -1.0 - u : -v;
                    x[c][across] = side;
                    if (corners == 3) x[c][!across] = u;
                    if (face) continue;
                    x[c][0] = u;
                    x[c][1] = corners == 3 ? -1.0 + v : 0.0;
                    x[c][2] = 0.0;
                }
                add_corners(s, x[0], x[1], x[2]);
                if (corners == 3) add_corners(s, x[2], x[3], x[0]);
            }
}

/* Forces and contacts of a sphere (disc) on the block. */
typedef struct pressed {
    double potential, force[3];
    size_t count;
    gn_facet_near near[1024];
    gn_patch_facet part[1024];
} pressed;

static void press_block(const soup *s, int corners, const double centre[3], double radius,
                        pressed *out) {
    out->potential = 0.0;
    out->count = 0;
    memset(out->force, 0, sizeof out->force);
    for (size_t f = 0; f < s->count && out->count < 1024; f++) {
        const double *x[3] = {s->x[f][0], s->x[f][1], s->x[f][2]};
        gn_facet_near *near = &out->near[out->count];
        gn_patch_facet *part = &out->part[out->count];
        if (!gn_patch_press(corners, x, centre, radius, near, part)) continue;
        double weight = 0.0;
        for (int c = 0; c < corners; c++) {
            assert_true(near->weight[c] >= 0.0 && near->weight[c] <= 1.0);
            weight += near->weight[c];
        }
        assert_near(weight, 1.0, 1e-14);
        assert_true(isfinite(part->force) && isfinite(part->potential) && part->potential >= 0.0);
        for (int a = 0; a < 3; a++) out->force[a] += part->force * near->away[a] / near->distance;
        out->potential += part->potential;
        out->count++;
    }
}

/* The centre is over a node, an edge, a diagonal, the middle of a cell, at a point along a
 * diagonal. */
static void a_centre_over_a_node_or_an_edge_is_no_special_place(void **state) {
    (void)state;
    static soup s;
    static pressed p;
    const double h = 2.0 / BLOCK_CELLS;
    const double places[][2] = {{0.0, 0.0},           {0.5, 0.0},  {0.0, 0.3},     {0.5, 0.5},
                                {0.3, 0.3},           {1.0, 1.0},  {2.0, 2.0},     {0.7, 0.3},
                                {0.1, 0.1},           {1e-9, 0.0}, {1e-16, 1e-17}, {1.0, 1e-16},
                                {0.25, 0.25 + 1e-16}, {-1.0, 2.0}};
    for (int corners = 2; corners <= 3; corners++) {
        make_block(corners, &s);
        for (size_t k = 0; k < sizeof places / sizeof *places; k++)
            for (int power = -8; power <= -2; power++) {
                const double depth = pow(10.0, power);
                double centre[3] = {h * places[k][0], corners == 3 ? h * places[k][1] : 0.0, 0.0};
                centre[corners - 1] = 1.0 - depth;
                press_block(&s, corners, centre, 1.0, &p);
                for (int a = 0; a < corners; a++)
                    assert_near(p.force[a], a == corners - 1 ? -depth : 0.0, 1e-14);
                assert_near(p.potential, 0.5 * depth * depth, 1e-14 * sqrt(depth));
            }
    }
}

/* A coordinate on a line of nodes, between two, near the rim, on it, beyond it, or anywhere. */
static double some_place(uint64_t *at) {
    const double h = 2.0 / BLOCK_CELLS, kind = uniform(at, 0.0, 1.0);
    const double cell = floor(uniform(at, -3.0, 4.0));
    if (kind < 0.3) return h * cell;
    if (kind < 0.4) return h * (cell + 0.5);
    if (kind < 0.7) return (cell > 0.0 ? 1.0 : -1.0) * uniform(at, 0.9, 1.03);
    if (kind < 0.8) return cell > 0.0 ? 1.0 : -1.0;
    return uniform(at, -0.8, 0.8);
}

/* Faces, edges and corners of the block. */
static void the_force_is_that_of_the_potential_at_edges_and_corners(void **state) {
    (void)state;
    static soup s;
    static pressed p, moved;
    const double step = 1e-6;
    for (int corners = 2; corners <= 3; corners++) {
        make_block(corners, &s);
        for (int k = 0; k < 200; k++) {
            uint64_t at = 700 + (uint64_t)k;
            const double radius = uniform(&at, 0.8, 2.0);
            double centre[3] = {some_place(&at), some_place(&at), 0.0};
            if (k % 4 == 0) centre[1] = centre[0];
            centre[corners - 1] = radius * (1.0 - pow(10.0, uniform(&at, -4.0, -1.5)));
            press_block(&s, corners, centre, radius, &p);
            for (int a = 0; a < corners; a++) {
                double slope = 0.0;
                for (int side = 0; side < 2; side++) {
                    double x[3] = {centre[0], centre[1], centre[2]};
                    x[a] += side ? step : -step;
                    press_block(&s, corners, x, radius, &moved);
                    slope += (side ? 0.5 : -0.5) * moved.potential / step;
                }
                assert_near(slope, p.force[a], 1e-7);
            }
        }
    }
}

/* By Hertz's law at edges and corners every contact has a positive part, and a force that is at
 * most that of the power 5/4 of the whole potential. */
static void hertz_contacts_are_finite_at_edges_and_corners(void **state) {
    (void)state;
    static soup s;
    static pressed p;
    static gn_facet_contact contact[1024];
    for (int corners = 2; corners <= 3; corners++) {
        make_block(corners, &s);
        for (int k = 0; k < 400; k++) {
            uint64_t at = 900 + (uint64_t)k;
            const double radius = uniform(&at, 0.8, 2.0);
            double centre[3] = {some_place(&at), some_place(&at), 0.0};
            centre[corners - 1] = radius * (1.0 - pow(10.0, uniform(&at, -10.0, -1.5)));
            press_block(&s, corners, centre, radius, &p);
            gn_patch_contacts(p.near, p.part, p.count, true, contact);
            const double whole = sqrt(sqrt(2.0 * p.potential));
            for (size_t c = 0; c < p.count; c++) {
                const double overlap = -contact[c].overlap;
                const double force = contact[c].part * pow(overlap, 1.5);
                assert_true(isfinite(1.0 / contact[c].part) && isfinite(contact[c].crowd));
                assert_true(overlap > 0.0 && overlap < radius);
                assert_true(force <= 1.001 * whole * p.part[c].force + 1e-12 * radius);
            }
        }
    }
    gn_facet_near near = {.away = {0.0, 0.0, -1.0}, .distance = 1.0};
    const gn_patch_facet rim = {.force = 1e-14, .potential = 0.0};
    gn_patch_contacts(&near, &rim, 1, true, contact);
    assert_true(isfinite(1.0 / contact[0].part) && contact[0].part < 1e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_however_it_is_cut_is_one_contact),
        cmocka_unit_test(the_force_is_that_of_the_potential),
        cmocka_unit_test(contacts_share_force_and_potential),
        cmocka_unit_test(a_centre_over_a_node_or_an_edge_is_no_special_place),
        cmocka_unit_test(the_force_is_that_of_the_potential_at_edges_and_corners),
        cmocka_unit_test(hertz_contacts_are_finite_at_edges_and_corners),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
