/* First events of bonds: failure, softening, yield; at most three rows for a bond. */
#ifndef GN_PARTICLES_EVENTS_H
#define GN_PARTICLES_EVENTS_H

#include "frame/parts.h"

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* Kinds of events in addition to gn_cause, with the numbers of the states of bonds in output. */
enum { GN_EVENT_SOFTENING = 4, GN_EVENT_YIELD = 5 };

typedef struct gn_event {
    int64_t step;    /* step whose forces caused it */
    double time;     /* s */
    double place[3]; /* m, position of the contact in the user's coordinates */
    double energy;   /* J, energy released by the break; 0 for other events */
    int32_t i, j;    /* ids of the particles, i < j */
    int32_t cause;   /* gn_cause, GN_EVENT_SOFTENING, GN_EVENT_YIELD */
    int32_t unused;
} gn_event;

typedef struct gn_events {
    gn_event *rows; /* events by step, then by i and j */
    size_t count, capacity;
} gn_events;

/* Appends the events of a step, after its motion and before its time is counted. */
gneiss_status gn_events_note(const gn_step_context *ctx, gn_dem *dem, gneiss_error *error);
void gn_events_free(gn_events *events);

#endif
