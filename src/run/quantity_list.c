/* The quantities of a world, one after another, and the components of their values. */
#include "run/quantities.h"

#include <stdio.h>
#include <string.h>

bool gn_condition_holds(const gn_condition *when, const gn_world *world, size_t owner) {
    return (!when->of_kind || when->of_kind(gn_scene_test(&world->ctx.scene))) &&
           (!when->holds || when->holds(world, owner));
}

const char *gn_condition_text(const gn_condition *when, char *text, size_t size) {
    char names[256];
    unsigned kinds = 0;
    for (unsigned k = 0; when->of_kind && k < GN_TEST_KINDS; k++)
        kinds |= (unsigned)when->of_kind(gn_test_kinds[k]) << k;
    gn_test_names(kinds, names, sizeof names);
    for (char *c = names; *c; c++)
        if (*c == '_') *c = ' ';
    const char *place = strstr(when->text, "%s");
    if (!place)
        snprintf(text, size, "%s", when->text);
    else
        snprintf(text, size, "%.*s%s%s", (int)(place - when->text), when->text, names, place + 2);
    return text;
}

bool gn_quantity_next(const gn_world *world, gn_quantity_place *place) {
    while (place->next_group < GN_QUANTITY_GROUPS) {
        const gn_quantity_group *g = &gn_quantity_groups[place->next_group];
        if (place->next_owner >= g->count(world)) {
            place->next_group++;
            place->next_owner = 0;
            continue;
        }
        place->group = g;
        place->owner = place->next_owner;
        place->quantity = &g->quantities[place->next_quantity++];
        if (place->next_quantity == g->quantity_count) {
            place->next_quantity = 0;
            place->next_owner++;
        }
        if (gn_condition_holds(place->quantity->when, world, place->owner)) return true;
    }
    return false;
}

static gn_shape_component tensor_component(int a, int b) {
    return (gn_shape_component){{'_', "xyz"[a], "xyz"[b], 0}, 3 * a + b, 3 * b + a};
}

size_t gn_shape_components(gn_shape shape, int dimension, gn_shape_component out[GN_SHAPE_MOST]) {
    static const int tensor[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    size_t count = 0;
    if (shape == GN_SCALAR) out[count++] = (gn_shape_component){"", 0, 0};
    for (int a = 0; a < 3; a++) {
        bool there = dimension == 3 || (shape == GN_TURN ? a == 2 : a < 2);
        if ((shape == GN_VECTOR || shape == GN_TURN) && there)
            out[count++] = (gn_shape_component){{'_', "xyz"[a], 0, 0}, a, a};
    }
    for (int c = 0; shape == GN_TENSOR && c < 6; c++)
        if (dimension == 3 || (tensor[c][0] < 2 && tensor[c][1] < 2))
            out[count++] = tensor_component(tensor[c][0], tensor[c][1]);
    return count;
}

void gn_shape_take(const double *value, const gn_shape_component *part, size_t parts, double *to) {
    for (size_t c = 0; c < parts; c++)
        to[c] = part[c].first == part[c].second
                    ? value[part[c].first]
                    : 0.5 * (value[part[c].first] + value[part[c].second]);
}
