/* Masses raised for a longer step. */
#ifndef GN_TIMESTEP_MASS_SCALING_H
#define GN_TIMESTEP_MASS_SCALING_H

#include "frame/parts.h"

void gn_dem_sum_masses(gn_dem *dem);

#endif
