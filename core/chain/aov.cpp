// The table, and the search in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/aov.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/chain/chain.h"

namespace alcove {

std::span<const Aov> aov_table() {
  static const std::vector<Aov> rows{
      {"ao", {"Y"}, &FrameOutputs::ao},
      {"ao-scales", {"scale1.Y"}, &FrameOutputs::scales},
      {"normal", {"normal.X", "normal.Y", "normal.Z"}, &FrameOutputs::normal},
      {"bent-normal", {"bent.X", "bent.Y", "bent.Z"}, &FrameOutputs::bent_normal},
      {"depth", {"Z"}, &FrameOutputs::depth, true},
      {"confidence", {"confidence.Y"}, &FrameOutputs::confidence},
      {"error", {"error.Y"}, &FrameOutputs::error},
      {"specular-occlusion", {"specular.Y"}, &FrameOutputs::specular_occlusion},
  };
  return rows;
}

std::vector<std::string> aov_names() {
  std::vector<std::string> names;
  std::ranges::transform(aov_table(), std::back_inserter(names), &Aov::name);
  return names;
}

std::vector<Aov> aovs_of(const OutputSettings& settings) {
  std::vector<Aov> aovs;
  for (const auto& name : split(settings.aovs)) {
    const auto found = std::ranges::find(aov_table(), name, &Aov::name);
    if (found == aov_table().end())
      fail(ErrorKind::usage, "--aov: there is no AOV \"{}\"{}; there is {}", name, suggestion(name, aov_names()),
           list_of(aov_names()));
    if (std::ranges::find(aovs, name, &Aov::name) != aovs.end()) continue;
    aovs.push_back(*found);
    if (name != "ao" || settings.ao_channels == AoChannels::mono) continue;
    aovs.back().channels = {"R", "G", "B"};
    if (settings.multi_bounce) aovs.back().planes = &FrameOutputs::color_ao;
  }
  return aovs;
}

std::vector<std::string> channels_of(const Aov& aov, std::size_t planes) {
  if (aov.planes != &FrameOutputs::scales) return aov.channels;
  std::vector<std::string> channels;
  for (std::size_t i = 1; i <= planes; i++) channels.push_back(fmt::format("scale{}.Y", i));
  return channels;
}

bool wants(const OutputSettings& settings, gpu::Buffer* FrameOutputs::*planes) {
  const auto aovs = aovs_of(settings);
  return std::ranges::find(aovs, planes, &Aov::planes) != aovs.end();
}

}  // namespace alcove
