/* Smooth joints (law_joint.h) outside of the kernels. Parameters are those of a joint, not of
 * materials: src/particles/joints.c sets them when a contact forms. */
#include "kernels/combine.h"

#include <math.h>

/* Keeps the parameters, which no material has. */
static void set(const gn_law_model *model, const gn_law_pair *pair, gn_contacts *list, size_t c) {
    (void)model;
    (void)pair;
    (void)list;
    (void)c;
}

/* The spring of the limit of the step has its normal along the branch; the same stiffness in all
 * directions is an upper bound whatever the joint's normal is. */
static gn_law_spring spring(const gn_contacts *list, size_t c, double overlap) {
    (void)overlap;
    const double most = fmax(list->kn[c], list->kt[c]);
    return (gn_law_spring){most, most, 0.0};
}

static gn_law_held held(const gn_contacts *list, size_t c, double length, double stretch) {
    (void)length;
    (void)stretch;
    const double apart = list->apart[c], kn = list->kn[c], kt = list->kt[c];
    gn_law_held h = {.normal = apart < 0.0 || gn_contact_bonded(list, c) ? kn * apart : 0.0};
    double shear2 = 0.0;
    for (size_t a = 0; a < 3; a++) {
        h.shear[a] = list->shear[c + a * list->soa.capacity];
        shear2 += h.shear[a] * h.shear[a];
    }
    h.stored = 0.5 * h.normal * apart + (kt > 0.0 ? 0.5 * shear2 / kt : 0.0);
    return h;
}

static void release(gn_contacts *list, size_t c) {
    gn_linear_release(list, c);
    list->apart[c] = 0.0;
}

/* Returns false, so that the limit of the step counts the stiffness of a joint that slides. */
static bool slips(const gn_contacts *list, size_t c, double normal, double shear) {
    (void)list;
    (void)c;
    (void)normal;
    (void)shear;
    return false;
}

const gn_law gn_law_joint = {.derive = gn_linear_derive,
                             .set = set,
                             .set_dashpot = gn_linear_set_dashpot,
                             .weigh = gn_linear_weigh,
                             .meeting = gn_linear_meeting,
                             .spring = spring,
                             .held = held,
                             .release = release,
                             .criterion = gn_mohr_criterion,
                             .slips = slips,
                             .touch_spring = gn_linear_touch_spring,
                             .touch_stored = gn_linear_touch_stored,
                             .touch = gn_linear_touch};
