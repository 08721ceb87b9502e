/* Scenes of rigid bodies alone. */
#ifndef GN_TESTS_BODY_HELPERS_H
#define GN_TESTS_BODY_HELPERS_H

#include "surface_helpers.h"

/* One far particle, so that there is a specimen; it is held. */
static const char head3[] =
    "dimension: 3\nspecimen: {particles: [[0, 50, 0.05, 0.02]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
    "law: {stiffness: uniform}\nsets: [{name: far, select: {all: true}, motion: {vx: 0, vy: 0, vz: "
    "0, wx: 0, wy: 0, wz: 0}}]\ndomain: {min: [-99, -99, -99], max: [99, 99, 99]}\n"
    "run: {threads: 1}\n";
static const char head2[] =
    "dimension: 2\nspecimen: {particles: [[50, 0.05, 0.02]], group: 0}\n"
    "materials: [{name: m, density: 2500, normal_stiffness: 1e6, kratio: 2}]\n"
    "law: {stiffness: uniform}\nsets: [{name: far, select: {all: true}, motion: {vx: 0, vy: 0, wz: "
    "0}}]\ndomain: {min: [-99, -99], max: [99, 99]}\nrun: {threads: 1}\n";

#endif
