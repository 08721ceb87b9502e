/* Packings on request and on disk. gn_pack_obtain takes a packing from the cache, or makes it
 * (pack.h) and stores it there. On disk a packing is packing.h5 with all data, packing.txt for
 * other programs, and a snapshot for ParaView. */
#ifndef GN_PACK_STORE_H
#define GN_PACK_STORE_H

#include "io/h5.h"
#include "pack/quality.h"

/* Writes packing.h5, packing.txt, particles_0000000000.hdf and particles.hdf.series in the existing
 * folder `directory`. */
gneiss_status gn_pack_write_folder(const char *directory, const gn_scene *scene,
                                   const gn_pack_result *result, const gn_pack_quality *quality,
                                   gneiss_error *error);

/* Returns the packing of the scene's specimen, from the cache if it has one for an equal request;
 * otherwise makes and stores it. The request is every key of the shape and of `packing`, the seed,
 * the contents of its files and the version of the method, but not the material and the number of
 * threads. The cache is $GNEISS_CACHE, else $XDG_CACHE_HOME/gneiss, else ~/.cache/gneiss;
 * GNEISS_CACHE=off disables it. A cache that cannot be written or read is no error: `note` [size]
 * then has the reason, else "". Packings ended by a time limit are not stored. */
gneiss_status gn_pack_obtain(const gn_scene *scene, gn_pack_watch *watch, void *context,
                             gn_pack_result *result, char *note, size_t size, gneiss_error *error);

#endif
