#include "world/exchange.h"

#include "base/error.h"
#include "base/memory.h"
#include "measure/energy.h"
#include "sched/hold.h"
#include "world/world.h"

#include <string.h>

gneiss_status gn_exchange_add(gn_world *w, gn_exchange exchange, gneiss_error *error) {
    gn_exchange *all = gn_alloc_array(w->features.count + 1, sizeof *all);
    if (!all) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for an exchange");
    if (w->features.exchange) memcpy(all, w->features.exchange, w->features.count * sizeof *all);
    all[w->features.count++] = exchange;
    gn_free(w->features.exchange);
    w->features.exchange = all;
    gneiss_status status = w->dem.motion_sums ? gn_exchanges_mark(w, error) : GNEISS_OK;
    if (status != GNEISS_OK) w->features.count--;
    return status;
}

void gn_exchanges_free(gn_features *features) {
    for (size_t k = 0; k < features->count; k++)
        if (features->exchange[k].end) features->exchange[k].end(features->exchange[k].context);
    gn_free(features->exchange);
}

gneiss_status gn_exchanges_mark(gn_world *w, gneiss_error *error) {
    gn_hold_clear(&w->dem.hold);
    for (size_t k = 0; k < w->solids.count; k++) gn_hold_clear(&w->solids.elements[k]->solid.hold);
    for (size_t k = 0; k < w->features.count; k++)
        GN_TRY(w->features.exchange[k].mark(w->features.exchange[k].context, w, error));
    return GNEISS_OK;
}

gneiss_status gn_exchanges_follow(gn_world *w, gneiss_error *error) {
    for (size_t k = 0; k < w->features.count; k++)
        if (w->features.exchange[k].follow)
            GN_TRY(w->features.exchange[k].follow(w->features.exchange[k].context, w, error));
    return GNEISS_OK;
}

void gn_exchanges_book(gn_world *w, gn_energy *reading) {
    for (size_t k = 0; k < w->features.count; k++)
        if (w->features.exchange[k].book)
            w->features.exchange[k].book(w->features.exchange[k].context, w, reading);
}

gneiss_status gn_exchanges_act(gn_world *w, gneiss_error *error) {
    for (size_t k = 0; k < w->features.count; k++)
        GN_TRY(w->features.exchange[k].act(w->features.exchange[k].context, w, error));
    return GNEISS_OK;
}
