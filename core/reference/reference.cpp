// The visibility by slices: the open part of each pixel's hemisphere.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"

#include <algorithm>

#include "core/reference/reference_blocking.h"

namespace alcove {

ReferenceSettings reference_settings_of(const EstimatorSettings& settings, bool with_hidden) {
  ReferenceSettings reference;
  reference.radius = *settings.radius * settings.falloff_end;
  reference.falloff = settings.falloff;
  reference.falloff_start = settings.falloff_start / settings.falloff_end;
  reference.thickness = settings.thickness == ThicknessKind::automatic  ? ThicknessRule::width
                        : settings.thickness == ThicknessKind::infinite ? ThicknessRule::infinite
                                                                        : ThicknessRule::constant;
  reference.thickness_length = settings.thickness_length;
  reference.bias = settings.bias;
  reference.complete = settings.complete;
  reference.hidden = settings.hidden;
  reference.separation = settings.separation.value_or(-1);
  // Width stands in for hidden surfaces. If these are known or guessed, half of it is nearer to ray tracing.
  if (settings.complete == Completion::all || (with_hidden && settings.hidden > 0)) {
    reference.width_share = 0.5;
    reference.width_pixels = 1;
  }
  return reference;
}

std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings) {
  std::vector<float> ao(frame.data.pixels(), 1.0f);
  for_receivers(frame, settings, [&](std::size_t i, const ReferenceScene& scene, const ReferenceReceiver& receiver) {
    const BlockedShare blocked = blocked_share(scene, receiver, settings);
    ao[i] = float(std::clamp(1 - (blocked.seen + blocked.completed), 0.0, 1.0));
  });
  return ao;
}

}  // namespace alcove
