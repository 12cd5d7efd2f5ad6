// A picture of how a frame was understood: depth, normals and AO side by side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"

namespace alcove {

/// Writes an 8-bit PNG to settings.output.preview, with the data window three times: depth (near is bright,
/// logarithmic), view-space normals (0.5 + 0.5 n) and AO, sky in a colour of its own. The radius is
/// settings.estimator.radius, or else a tenth of the median distance. Fails as reading and computing the frame do, and
/// with ErrorKind::output.
void write_contact_sheet(const Settings& settings, int frame);

}  // namespace alcove
