#include "world/exchange.h"

#include "base/memory.h"
#include "world/world.h"

#include <string.h>

gneiss_status gn_exchange_add(gn_world *w, gn_exchange exchange, gneiss_error *error) {
    gn_exchange *all = gn_alloc_array(w->exchange_count + 1, sizeof *all);
    if (!all) return gn_fail(error, GNEISS_ERROR_MEMORY, "no memory for an exchange");
    if (w->exchange) memcpy(all, w->exchange, w->exchange_count * sizeof *all);
    all[w->exchange_count++] = exchange;
    gn_free(w->exchange);
    w->exchange = all;
    gneiss_status status = w->dem.motion_sums ? gn_exchanges_mark(w, error) : GNEISS_OK;
    if (status != GNEISS_OK) w->exchange_count--;
    return status;
}

void gn_exchanges_free(gn_world *w) {
    for (size_t k = 0; k < w->exchange_count; k++)
        if (w->exchange[k].end) w->exchange[k].end(w->exchange[k].context);
    gn_free(w->exchange);
}

gneiss_status gn_exchanges_mark(gn_world *w, gneiss_error *error) {
    gn_hold_clear(&w->dem.hold);
    for (size_t k = 0; k < w->element_count; k++) gn_hold_clear(&w->elements[k]->solid.hold);
    for (size_t k = 0; k < w->exchange_count; k++)
        GN_TRY(w->exchange[k].mark(w->exchange[k].context, w, error));
    return GNEISS_OK;
}

gneiss_status gn_exchanges_follow(gn_world *w, gneiss_error *error) {
    for (size_t k = 0; k < w->exchange_count; k++)
        if (w->exchange[k].follow) GN_TRY(w->exchange[k].follow(w->exchange[k].context, w, error));
    return GNEISS_OK;
}

void gn_exchanges_book(gn_world *w, gn_energy *reading) {
    for (size_t k = 0; k < w->exchange_count; k++)
        if (w->exchange[k].book) w->exchange[k].book(w->exchange[k].context, w, reading);
}

gneiss_status gn_exchanges_act(gn_world *w, gneiss_error *error) {
    for (size_t k = 0; k < w->exchange_count; k++)
        GN_TRY(w->exchange[k].act(w->exchange[k].context, w, error));
    return GNEISS_OK;
}
