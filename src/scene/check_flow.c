/* Cross-key checks of `sources` and `sinks`. */
#include "scene/check.h"

#include <math.h>
#include <string.h>

/* Returns the key of the last given shape, "" if there is none. */
static const char *region_key(const gn_flow_region *region) {
    return region->has_cylinder   ? "cylinder"
           : region->has_box      ? "box"
           : region->corner_count ? "polygon"
           : region->has_disc     ? "disc"
                                  : (region->has_rectangle ? "rectangle" : "");
}

/* Checks that exactly one shape is given; for a sink, exactly one shape or a plane. */
static gneiss_status check_region(const check *section, const gn_scene *scene,
                                  const gn_flow_region *region, const gn_sink_def *sink) {
    static const char *const names[] = {"plane", "rectangle", "disc", "polygon", "box", "cylinder"};
    const bool plane = sink && sink->has_plane;
    const bool has[] = {
        plane,           region->has_rectangle, region->has_disc, region->corner_count > 0,
        region->has_box, region->has_cylinder};
    char found[80] = "";
    for (int k = 0; k < 6; k++) {
        size_t used = strlen(found);
        if (has[k]) snprintf(found + used, sizeof found - used, "%s%s", used ? ", " : "", names[k]);
    }
    bool moved = region->origin[0] != 0 || region->origin[1] != 0 || region->origin[2] != 0;
    if (!*found || strchr(found, ','))
        return gn_check_fail(section, region_key(region), "expected one of %s%s in it, found %s",
                             sink ? "plane, " : "",
                             scene->dimension == 2 ? "rectangle, disc, polygon" : "box, cylinder",
                             *found ? found : "none");
    if (moved && (plane || region->corner_count))
        return gn_check_fail(section, "origin", "expected %s beside it, found %s",
                             scene->dimension == 2 ? "rectangle or disc" : "box or cylinder",
                             found);
    return GNEISS_OK;
}

/* m, bounding box of the region. */
static void bounds(const gn_flow_region *region, double lower[3], double upper[3]) {
    const bool round = region->has_disc || region->has_cylinder;
    for (size_t a = 0; a < 3; a++) {
        lower[a] = region->origin[a] - (round && a < 2 ? 0.5 * region->diameter : 0.0);
        upper[a] = region->origin[a] +
                   (round ? (a < 2 ? 0.5 * region->diameter : region->height) : region->size[a]);
        if (!region->corner_count || a == 2) continue;
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
        for (size_t k = 0; k < region->corner_count; k++) {
            lower[a] = fmin(lower[a], region->corners[2 * k + a]);
            upper[a] = fmax(upper[a], region->corners[2 * k + a]);
        }
    }
}

/* Checks that particles are created inside the domain and the periodic box. */
static gneiss_status check_place(const check *section, const gn_scene *scene,
                                 const gn_flow_region *region) {
    double lower[3], upper[3];
    bounds(region, lower, upper);
    for (int a = 0; a < (int)scene->dimension; a++) {
        const char *what = scene->has_domain ? "domain" : "periodic box";
        double least = scene->has_domain ? scene->domain_min[a] : scene->periodic_min[a];
        double most = scene->has_domain ? scene->domain_max[a] : scene->periodic_max[a];
        if (!scene->has_domain && !gn_scene_periodic_along(scene, a)) continue;
        if (lower[a] >= least && upper[a] <= most) continue;
        return gn_check_fail(section, region_key(region),
                             "expected a region inside the %s, found %g to %g m along %c, outside "
                             "of %g to %g m",
                             what, lower[a], upper[a], "xyz"[a], least, most);
    }
    return GNEISS_OK;
}

gneiss_status gn_check_sieve(const check *checked, const char *section, bool wanted,
                             const double *row, size_t count) {
    char sieve[48], sizes[48];
    snprintf(sieve, sizeof sieve, "%ssieve", section);
    snprintf(sizes, sizeof sizes, "%ssizes", section);
    if (wanted != (count > 0))
        return gn_check_fail(checked, count ? sieve : sizes,
                             count ? "expected sizes: sieve beside it, found others"
                                   : "sieve: expected a sieve beside it, found none");
    for (size_t k = 1; k < count; k++)
        if (!(row[2 * k] > row[2 * k - 2]) || row[2 * k + 1] < row[2 * k - 1])
            return gn_check_fail(checked, sieve,
                                 "expected increasing sizes and shares that do not decrease, found "
                                 "[%g, %g] after [%g, %g]",
                                 row[2 * k], row[2 * k + 1], row[2 * k - 2], row[2 * k - 1]);
    if (count &&
        (!(row[0] > 0) || row[1] != 0 || row[2 * count - 2] != 1 || row[2 * count - 1] != 1))
        return gn_check_fail(checked, sieve,
                             "expected a first row [size, 0], size above 0, and a last row [1, 1], "
                             "found [%g, %g] and [%g, %g]",
                             row[0], row[1], row[2 * count - 2], row[2 * count - 1]);
    return GNEISS_OK;
}

static gneiss_status check_sizes(const check *section, const gn_source_def *source) {
    GN_TRY(gn_check_sieve(section, "", source->sizes == GN_SIZES_SIEVE, source->sieve,
                          source->sieve_count));
    if (source->sizes == GN_SIZES_SIEVE && gn_check_given(section, "size_ratio"))
        return gn_check_fail(section, "size_ratio",
                             "expected sizes: uniform or normal beside it, found sieve, whose "
                             "first row has the smallest size");
    if (source->size_variation >= 0 && source->sizes != GN_SIZES_NORMAL)
        return gn_check_fail(section, "size_variation",
                             "expected sizes: normal beside it, found another");
    if (source->sizes == GN_SIZES_NORMAL && source->size_ratio == 1.0)
        return gn_check_fail(section, "size_ratio",
                             "expected more than 1 beside sizes: normal, which is truncated at the "
                             "smallest and the largest size, found 1");
    return GNEISS_OK;
}

static gneiss_status check_source(const check *section, const gn_scene *scene, size_t index) {
    gn_source_def *source = &scene->sources[index];
    for (size_t k = 0; k < index; k++)
        if (strcmp(scene->sources[k].name, source->name) == 0)
            return gn_check_fail(section, "name",
                                 "expected a unique name, found '%s' a second time", source->name);
    GN_TRY(check_region(section, scene, &source->region, NULL));
    if ((source->rate > 0) == (source->mass_rate > 0))
        return gn_check_fail(section, source->rate > 0 ? "mass_rate" : "rate",
                             "expected either rate or mass_rate, found %s",
                             source->rate > 0 ? "both" : "none");
    if (source->end > 0 && !(source->end > source->start))
        return gn_check_fail(section, "end", "expected an end after the start, %g s, found %g s",
                             source->start, source->end);
    GN_TRY(check_sizes(section, source));
    if (!*source->material && scene->material_count == 1)
        memcpy(source->material, scene->materials[0].name, sizeof source->material);
    GN_TRY(gn_check_material_name(section, scene, "material", source->material));
    return gn_check_is_valid(section, "domain") ? check_place(section, scene, &source->region)
                                                : GNEISS_OK;
}

static gneiss_status check_sink(const check *section, const gn_scene *scene, size_t index) {
    gn_sink_def *sink = &scene->sinks[index];
    for (size_t k = 0; k < index; k++)
        if (strcmp(scene->sinks[k].name, sink->name) == 0)
            return gn_check_fail(section, "name",
                                 "expected a unique name, found '%s' a second time", sink->name);
    GN_TRY(check_region(section, scene, &sink->region, sink));
    if (!sink->remove && !sink->has_plane)
        return gn_check_fail(section, "remove", "expected plane beside false, found a region");
    if (sink->has_plane && !gn_check_direction(sink->normal))
        return gn_check_fail(section, "plane.normal", "expected a direction, found [0, 0, 0]");
    return GNEISS_OK;
}

/* Refuses keys that need the same particles from start to end. */
static gneiss_status check_beside(const check *section, const gn_scene *scene) {
    const struct {
        bool found;
        const char *what;
    } others[] = {{scene->has_membrane, "membrane"},
                  {scene->has_couple, "couple"},
                  {scene->has_mass_scaling, "time.mass_scaling"},
                  {scene->start == GN_START_FIRST_BREAK, "time.start: first_break"}};
    const char *list = scene->source_count ? "sources" : "sinks";
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (others[k].found)
            return gn_check_fail(section, list, "expected a scene without %s, found one with it",
                                 others[k].what);
    if (!scene->has_specimen)
        return gn_check_fail(section, list, "expected a specimen or sources beside it, found none");
    if (scene->set_count && !scene->specimen_given)
        return gn_check_fail(section, "sets",
                             "expected a specimen beside it, whose particles sets select, found "
                             "sources alone");
    for (size_t k = 0; k < scene->source_count && !scene->specimen_given; k++)
        if (scene->sources[k].start == 0) return GNEISS_OK;
    if (scene->specimen_given) return GNEISS_OK;
    return gn_check_fail(section, list,
                         "expected a specimen, or a source with start 0, found neither: the scene "
                         "starts without particles");
}

gneiss_status gn_check_flow(const gn_reader *reader, const gn_node *root) {
    const gn_scene *s = reader->scene;
    const check scene = {.reader = reader, .map = root};
    for (size_t k = 0; k < s->source_count; k++) {
        check element = gn_check_element(reader, root, "sources", k);
        if (!gn_check_element_is_valid(&element)) continue;
        GN_TRY(gn_check_keep_problem(&element, check_source(&element, s, k)));
    }
    for (size_t k = 0; k < s->sink_count; k++) {
        check element = gn_check_element(reader, root, "sinks", k);
        if (!gn_check_element_is_valid(&element)) continue;
        GN_TRY(gn_check_keep_problem(&element, check_sink(&element, s, k)));
    }
    if (!s->source_count && !s->sink_count) return GNEISS_OK;
    if (!gn_check_is_valid(&scene, "sources") || !gn_check_is_valid(&scene, "specimen"))
        return GNEISS_OK;
    return gn_check_keep_problem(&scene, check_beside(&scene, s));
}
