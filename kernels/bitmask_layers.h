// bitmask_layers.comp has the parameters, bindings and constants of bitmask.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_BITMASK_LAYERS_H
#define ALCOVE_BITMASK_LAYERS_H
#include "bitmask.h"
#endif
