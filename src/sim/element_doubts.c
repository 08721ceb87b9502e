#include "base/point.h"
#include "sim/internal.h"

#include <stdio.h>

const char *gn_elements_doubts(const gn_world *w, char *text, size_t size) {
    char place[GN_POINT_SIZE];
    size_t used = 0;
    *text = '\0';
    for (size_t k = 0; k < w->element_count; k++) {
        const gn_mesh_joints *j = &w->elements[k]->joints;
        const char *name = w->elements[k]->solid.name;
        if (j->together && used < size)
            used += (size_t)snprintf(
                text + used, size - used,
                "%s%s: two nodes at one place in %zu place%s, the first at %s m: elements are not "
                "joined there, as at a crack of no width",
                used ? "; " : "", name, j->together, j->together == 1 ? "" : "s",
                gn_point_text(w->scene.origin, j->together_at, place));
        if (j->hanging && used < size)
            used += (size_t)snprintf(
                text + used, size - used,
                "%s%s: %zu hanging node%s on sides of elements that do not have them, the first at "
                "%s m: elements are not joined there",
                used ? "; " : "", name, j->hanging, j->hanging == 1 ? "" : "s",
                gn_point_text(w->scene.origin, j->hanging_at, place));
    }
    return text;
}
