// Facts of the files that settings name.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/raw_plane.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/text.h"

namespace alcove {

const std::string& main_input(const InputSettings& settings) {
  if (!settings.input.empty()) return settings.input;
  if (!settings.depth.empty()) return settings.depth;
  return settings.position.empty() ? settings.deep.front() : settings.position;
}

const char* main_option(const InputSettings& settings) {
  if (!settings.input.empty()) return "INPUT";
  if (!settings.depth.empty()) return "--depth";
  return settings.position.empty() ? "--deep" : "--position";
}

bool wants_normals(const InputSettings& settings) { return lower_case(settings.normal) != "none"; }

bool wants_matte(const InputSettings& settings) {
  return !settings.matte.empty() || !settings.matte_channel.empty() || !settings.matte_object.empty();
}

bool names_picture(const std::string& text) {
  const auto dot = text.rfind('.');
  if (dot == text.npos || text.find(',') != text.npos) return false;
  const std::string ending = lower_case(text.substr(dot + 1));
  return std::ranges::any_of(std::array{"exr", "dds", "npy", "png", "tif", "tiff", "tga", "bmp", "hdr"},
                             [&](const char* known) { return ending == known; });
}

bool chooses_occluders(const InputSettings& settings) {
  return !settings.occluders.empty() || !settings.occluder_objects.empty() || !settings.ignore.empty() ||
         !settings.ignored_objects.empty();
}

std::vector<ShadowLayer> shadow_layers_of(const InputSettings& settings) {
  std::vector<ShadowLayer> layers;
  if (settings.shadow_layers.empty()) return layers;
  for (const auto& text : split(settings.shadow_layers)) {
    const auto colon = text.find(':');
    if (colon == 0 || colon >= text.size() - 1)
      fail(ErrorKind::usage,
           "--set shadow-layers={}: it takes NAME:LAYER, a light of --lights and its layer in the beauty's file, "
           "several with commas",
           text);
    layers.push_back({text.substr(0, colon), text.substr(colon + 1)});
  }
  return layers;
}

bool has_deep(const InputSettings& settings) { return settings.deep != FileList{}; }

bool has_hidden_sources(const InputSettings& settings) {
  const bool has_files = settings.behind != FileList{} || has_deep(settings);
  return has_files || settings.around > 0 || settings.around_all || settings.other_views;
}

}  // namespace alcove
