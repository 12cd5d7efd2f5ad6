// horizon_layers.comp has the parameters, bindings and constants of horizon.comp.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ALCOVE_HORIZON_LAYERS_H
#define ALCOVE_HORIZON_LAYERS_H
#include "horizon.h"
#endif
