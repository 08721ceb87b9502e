/* Dense packings of discs and spheres in any body (Labra & Onate 2009; Labra 2012, ch. 3). */
#ifndef GN_PACK_PACK_H
#define GN_PACK_PACK_H

#include "io/packing.h"
#include "pack/fit.h"
#include "scene/scene.h"

/* Stages of the fit, in this order (docs/packing.md). */
typedef enum gn_pack_stage {
    GN_PACK_SPREAD,     /* random points move apart, radii fixed and small */
    GN_PACK_COMPRESS,   /* radii grow until all neighbours are in contact */
    GN_PACK_DECOMPRESS, /* the pressure decreases in steps, each of which comes to equilibrium */
    GN_PACK_CLOSE,      /* pairs with small gaps are drawn together */
    GN_PACK_SEPARATE,   /* remaining overlaps are removed */
    GN_PACK_STAGES
} gn_pack_stage;

const char *gn_pack_stage_name(gn_pack_stage stage);

/* The record of one iteration. */
typedef struct gn_pack_trace {
    gn_pack_stage stage;
    gn_fit_state state;
} gn_pack_trace;

typedef struct gn_pack_progress {
    gn_pack_stage stage;
    double fraction; /* fraction of the largest number of iterations, 0 to 1 */
    gn_fit_state state;
    size_t particles;
} gn_pack_progress;

/* Called after every iteration; returning false cancels the packing (GNEISS_INTERRUPTED). */
typedef bool gn_pack_watch(void *context, const gn_pack_progress *progress);

typedef struct gn_pack_result {
    gn_packing packing; /* particles in Morton order */
    gn_domain *domain;  /* the body, for measurements; NULL if the packing came from the cache */
    double volume;      /* m3 (2D: m2), volume of the body */
    double seconds;
    /* false: the time limit ended the fit, so that the result depends on the machine */
    bool in_time;
    bool from_cache;
    char changes[GN_MESH_CHANGES_SIZE]; /* gn_mesh_changed of the body's file; "": nothing */
    size_t trace_count;
    gn_pack_trace *trace; /* gn_alloc'ed */
} gn_pack_result;

/* Packs the body of scene->specimen.pack. The result has the same bits for any number of threads
 * (scene->threads, 0: all cores). `watch` may be NULL. */
gneiss_status gn_pack_make(const gn_scene *scene, gn_pack_watch *watch, void *context,
                           gn_pack_result *result, gneiss_error *error);
void gn_pack_result_free(gn_pack_result *result);

/* Tells whether the range of a distribution's radii, m, is narrower than requested by more than the
 * change of a tenth that each radius may have: there are too few particles for all sizes. `text`
 * then gives the requested and the actual range, else it is "". */
bool gn_pack_is_narrow(const gn_scene *scene, double least, double most, size_t particles,
                       char *text, size_t size);

#endif
