/* Basic types of the structs of a scene. */
#ifndef GN_SCENE_VALUES_H
#define GN_SCENE_VALUES_H

#include "scene/table.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GN_NAME_SIZE = 64, GN_PATH_SIZE = 4096 };

#endif
