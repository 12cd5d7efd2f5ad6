// Channels that may hold what lies behind the first surface. There is no convention for their names, so that they are
// only proposed: a run uses none of them unless it is told to.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/frame/gbuffer.h"
#include "core/inspect/inspection.h"

namespace alcove {

/// Those among the channels of the frame's files that nothing is read from yet, by their names: of the frame's view and
/// the settings' layer, since a run finds no others.
std::vector<HiddenGuess> hidden_guesses(const FrameSource& source, const InputSettings& settings);

/// The options by which a run would take all of them; "" where there are none.
std::string options_for(const std::vector<HiddenGuess>& guesses);

}  // namespace alcove
