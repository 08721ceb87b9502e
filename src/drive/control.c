#include "drive/control.h"

#include "conversion/conversion.h"
#include "laboratory/ends.h"

#include <math.h>
#include <string.h>

/* Steps from one look to the next. */
enum { LOOK_INTERVAL = 10 };

/* Extension across the axis positive. */
static double lateral_strain(const gn_world *w) {
    double gradient[9], g[9], sum = 0.0;
    int dimension = (int)w->scene.dimension;
    gn_conversion_gradient(w, gradient);
    gn_strain_of(gradient, g);
    for (int a = 0; a < dimension; a++)
        if (a != (int)w->scene.test.axis) sum += g[4 * a];
    return sum / (dimension - 1);
}

static double reading(const gn_world *w) {
    return w->scene.test.control.opening > 0.0 ? gn_ends_opening(w) : lateral_strain(w);
}

static double rate(const gn_control *c) {
    return c->opening > 0.0 ? c->opening : c->lateral_strain;
}

/* At full speed at the start: both readings begin at 0. */
void gn_control_create(gn_world *w) {
    const gn_control *c = &w->scene.test.control;
    w->machine = (gn_machine){.wanted = rate(c) * c->response, .factor = 1.0};
}

/* What is wanted grows at the rate, but is never ahead by more than the motion makes up at full
 * speed: a reading that lags behind while all is elastic finds no backlog to jump to when it lets
 * go. The factor is the distance over that, so it is 1 as long as the reading lags, falls as it
 * comes near, and is bounded both ways whatever the reading does. */
void gn_control_look(gn_world *w) {
    const gn_control *c = &w->scene.test.control;
    gn_machine *m = &w->machine;
    if (!w->scene.test.has_control || w->step % LOOK_INTERVAL != 0) return;
    const double now = reading(w), most = rate(c) * c->response;
    if (isnan(now)) return; /* too little is left of the specimen to be read */
    m->wanted = fmin(m->wanted + rate(c) * (w->time - m->looked), now + most);
    m->looked = w->time;
    m->factor = fmax(-c->reverse, fmin(1.0, (m->wanted - now) / most));
}

static bool in(const gn_test_end *end, const char *name) {
    for (size_t k = 0; k < end->count; k++)
        if (strcmp(end->name[k], name) == 0) return true;
    return false;
}

double gn_control_of(const gn_world *w, const char *name, int axis) {
    const gn_test *t = &w->scene.test;
    if (!t->has_control || axis != (int)t->axis) return 1.0;
    return in(&t->lower, name) || in(&t->upper, name) ? w->machine.factor : 1.0;
}
