// Facts of the files that settings name.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/raw_plane.h"

#include <algorithm>

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

bool has_deep(const InputSettings& settings) { return settings.deep != FileList{}; }

bool has_hidden_sources(const InputSettings& settings) {
  const bool has_files = settings.behind != FileList{} || has_deep(settings);
  return has_files || settings.around > 0 || settings.around_all || settings.other_views;
}

}  // namespace alcove
