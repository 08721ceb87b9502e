/* What the keys of `sources` and `sinks` must hold together. */
#include "scene/check.h"

#include <math.h>
#include <string.h>

/* The key of the last shape that is given, "" of none. */
static const char *region_key(const gn_flow_region *r) {
    return r->has_cylinder   ? "cylinder"
           : r->has_box      ? "box"
           : r->corner_count ? "polygon"
           : r->has_disc     ? "disc"
                             : (r->has_rectangle ? "rectangle" : "");
}

/* Exactly one of the shapes; of a sink that, or a plane. */
static gneiss_status check_region(const check *c, const gn_scene *s, const gn_flow_region *r,
                                  const gn_sink_def *sink) {
    static const char *const names[] = {"plane", "rectangle", "disc", "polygon", "box", "cylinder"};
    const bool plane = sink && sink->has_plane;
    const bool has[] = {plane,      r->has_rectangle, r->has_disc, r->corner_count > 0,
                        r->has_box, r->has_cylinder};
    char found[80] = "";
    for (int k = 0; k < 6; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    bool moved = r->origin[0] != 0 || r->origin[1] != 0 || r->origin[2] != 0;
    if (!*found || strchr(found, ','))
        return gn_check_fail(c, region_key(r), "expected one of %s%s in it, found %s",
                             sink ? "plane, " : "",
                             s->dimension == 2 ? "rectangle, disc, polygon" : "box, cylinder",
                             *found ? found : "none");
    if (moved && (plane || r->corner_count))
        return gn_check_fail(c, "origin", "expected %s beside it, found %s",
                             s->dimension == 2 ? "rectangle or disc" : "box or cylinder", found);
    return GNEISS_OK;
}

/* m, of the box about it. */
static void bounds(const gn_flow_region *r, double lower[3], double upper[3]) {
    const bool round = r->has_disc || r->has_cylinder;
    for (size_t a = 0; a < 3; a++) {
        lower[a] = r->origin[a] - (round && a < 2 ? 0.5 * r->diameter : 0.0);
        upper[a] = r->origin[a] + (round ? (a < 2 ? 0.5 * r->diameter : r->height) : r->size[a]);
        if (!r->corner_count || a == 2) continue;
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
        for (size_t k = 0; k < r->corner_count; k++) {
            lower[a] = fmin(lower[a], r->corners[2 * k + a]);
            upper[a] = fmax(upper[a], r->corners[2 * k + a]);
        }
    }
}

/* Particles come in where particles may be. */
static gneiss_status check_place(const check *c, const gn_scene *s, const gn_flow_region *r) {
    double lower[3], upper[3];
    bounds(r, lower, upper);
    for (int a = 0; a < (int)s->dimension; a++) {
        const char *what = s->has_domain ? "domain" : "periodic box";
        double least = s->has_domain ? s->domain_min[a] : s->periodic_min[a];
        double most = s->has_domain ? s->domain_max[a] : s->periodic_max[a];
        if (!s->has_domain && !gn_scene_periodic_along(s, a)) continue;
        if (lower[a] >= least && upper[a] <= most) continue;
        return gn_check_fail(c, region_key(r),
                             "expected a region inside the %s, found %g to %g m along %c, outside "
                             "of %g to %g m",
                             what, lower[a], upper[a], "xyz"[a], least, most);
    }
    return GNEISS_OK;
}

gneiss_status gn_check_sieve(const check *c, const char *section, bool wanted, const double *row,
                             size_t n) {
    char sieve[48], sizes[48];
    snprintf(sieve, sizeof sieve, "%ssieve", section);
    snprintf(sizes, sizeof sizes, "%ssizes", section);
    if (wanted != (n > 0))
        return gn_check_fail(c, n ? sieve : sizes,
                             n ? "expected sizes: sieve beside it, found others"
                               : "sieve: expected a sieve beside it, found none");
    for (size_t k = 1; k < n; k++)
        if (!(row[2 * k] > row[2 * k - 2]) || row[2 * k + 1] < row[2 * k - 1])
            return gn_check_fail(c, sieve,
                                 "expected sizes that grow and shares that do not fall, found [%g, "
                                 "%g] behind [%g, %g]",
                                 row[2 * k], row[2 * k + 1], row[2 * k - 2], row[2 * k - 1]);
    if (n && (!(row[0] > 0) || row[1] != 0 || row[2 * n - 2] != 1 || row[2 * n - 1] != 1))
        return gn_check_fail(c, sieve,
                             "expected a first row [size, 0], size above 0, and a last row [1, 1], "
                             "found [%g, %g] and [%g, %g]",
                             row[0], row[1], row[2 * n - 2], row[2 * n - 1]);
    return GNEISS_OK;
}

static gneiss_status check_sizes(const check *c, const gn_source_def *d) {
    GN_TRY(gn_check_sieve(c, "", d->sizes == GN_SIZES_SIEVE, d->sieve, d->sieve_count));
    if (d->sizes == GN_SIZES_SIEVE && gn_check_given(c, "size_ratio"))
        return gn_check_fail(c, "size_ratio",
                             "expected sizes: uniform or normal beside it, found sieve, whose "
                             "first row has the smallest size");
    if (d->size_variation >= 0 && d->sizes != GN_SIZES_NORMAL)
        return gn_check_fail(c, "size_variation",
                             "expected sizes: normal beside it, found another");
    if (d->sizes == GN_SIZES_NORMAL && d->size_ratio == 1.0)
        return gn_check_fail(c, "size_ratio",
                             "expected more than 1 beside sizes: normal, which lie between the "
                             "smallest and the largest, found 1");
    return GNEISS_OK;
}

static gneiss_status check_source(const check *c, const gn_scene *s, size_t index) {
    gn_source_def *d = &s->sources[index];
    for (size_t k = 0; k < index; k++)
        if (strcmp(s->sources[k].name, d->name) == 0)
            return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                                 d->name);
    GN_TRY(check_region(c, s, &d->region, NULL));
    if ((d->rate > 0) == (d->mass_rate > 0))
        return gn_check_fail(c, d->rate > 0 ? "mass_rate" : "rate",
                             "expected either rate or mass_rate, found %s",
                             d->rate > 0 ? "both" : "none");
    if (d->end > 0 && !(d->end > d->start))
        return gn_check_fail(c, "end", "expected an end behind the start, %g s, found %g s",
                             d->start, d->end);
    GN_TRY(check_sizes(c, d));
    if (!*d->material && s->material_count == 1)
        memcpy(d->material, s->materials[0].name, sizeof d->material);
    GN_TRY(gn_check_material_name(c, s, "material", d->material));
    return gn_check_sound(c, "domain") ? check_place(c, s, &d->region) : GNEISS_OK;
}

static gneiss_status check_sink(const check *c, const gn_scene *s, size_t index) {
    gn_sink_def *d = &s->sinks[index];
    for (size_t k = 0; k < index; k++)
        if (strcmp(s->sinks[k].name, d->name) == 0)
            return gn_check_fail(c, "name", "expected a name of its own, found '%s' a second time",
                                 d->name);
    GN_TRY(check_region(c, s, &d->region, d));
    if (!d->remove && !d->has_plane)
        return gn_check_fail(c, "remove", "expected plane beside false, found a region");
    if (d->has_plane && !gn_check_direction(d->normal))
        return gn_check_fail(c, "plane.normal", "expected a direction, found [0, 0, 0]");
    return GNEISS_OK;
}

/* What goes by particles that are there from the start to the end. */
static gneiss_status check_beside(const check *c, const gn_scene *s) {
    const struct {
        bool found;
        const char *what;
    } others[] = {{s->has_membrane, "membrane"},
                  {s->has_couple, "couple"},
                  {s->has_mass_scaling, "time.mass_scaling"},
                  {s->start == GN_START_FIRST_BREAK, "time.start: first_break"}};
    const char *list = s->source_count ? "sources" : "sinks";
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(c, list, "expected a scene without %s, found one with it",
                                 others[k].what);
    if (!s->has_specimen)
        return gn_check_fail(c, list, "expected a specimen or sources beside it, found none");
    if (s->set_count && !s->specimen_given)
        return gn_check_fail(c, "sets",
                             "expected a specimen beside it, whose particles sets select, found "
                             "sources alone");
    for (size_t k = 0; k < s->source_count && !s->specimen_given; k++)
        if (s->sources[k].start == 0) return GNEISS_OK;
    if (s->specimen_given) return GNEISS_OK;
    return gn_check_fail(c, list,
                         "expected a specimen, or a source with start 0, found neither: there is "
                         "nothing to begin with");
}

gneiss_status gn_check_flow(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    const check scene = {.reader = reader, .map = root};
    for (size_t k = 0; k < s->source_count; k++) {
        check element = gn_check_element(reader, root, "sources", k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(&element, check_source(&element, s, k)));
    }
    for (size_t k = 0; k < s->sink_count; k++) {
        check element = gn_check_element(reader, root, "sinks", k);
        if (!gn_check_element_sound(&element)) continue;
        GN_TRY(gn_check_keep(&element, check_sink(&element, s, k)));
    }
    if (!s->source_count && !s->sink_count) return GNEISS_OK;
    if (!gn_check_sound(&scene, "sources") || !gn_check_sound(&scene, "specimen")) return GNEISS_OK;
    return gn_check_keep(&scene, check_beside(&scene, s));
}
