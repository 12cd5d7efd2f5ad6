// The planes of a frame's files, before any pass: one table of their facts, arrays with an entry for each, and
// what the settings say of the files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/settings.h"
#include "core/base/text.h"

namespace alcove {

/// A plane may have several components: depth may be a position's x, y, z.
enum class RawPlane { depth, normal, behind, beauty, indirect, diffuse_color, material_ao, albedo, matte, occluders };

/// Whether an estimate is made from a plane, whether the plane only colours or dims it afterwards, or whether it says
/// where there is to be one.
enum class PlaneContent { geometry, color, selection };

/// The most planes of depth behind the first surface that files may give.
constexpr std::size_t kMostBehindPlanes = 16;

/// The most planes of a matte: those of an identifier and its coverage, for each rank of a Cryptomatte.
constexpr std::size_t kMostMattePlanes = 32;

/// The most lights that AO and shadows may dim.
constexpr std::size_t kMostAmbientLights = 16;

/// A row of the table.
struct RawPlaneFacts {
  RawPlane plane;
  const char* name;         // of its buffer
  std::size_t least, most;  // components
  PlaneContent content;
};

inline constexpr std::array kRawPlanes{
    RawPlaneFacts{RawPlane::depth, "raw depth", 1, 3, PlaneContent::geometry},
    RawPlaneFacts{RawPlane::normal, "raw normal", 2, 3, PlaneContent::geometry},
    RawPlaneFacts{RawPlane::behind, "raw behind", 1, kMostBehindPlanes, PlaneContent::geometry},
    RawPlaneFacts{RawPlane::beauty, "raw beauty", 3, 4, PlaneContent::color},
    RawPlaneFacts{RawPlane::indirect, "raw indirect", 3, 3 * kMostAmbientLights, PlaneContent::color},
    RawPlaneFacts{RawPlane::diffuse_color, "raw diffuse color", 3, 3 * kMostAmbientLights, PlaneContent::color},
    RawPlaneFacts{RawPlane::material_ao, "raw material ao", 1, 1, PlaneContent::color},
    RawPlaneFacts{RawPlane::albedo, "raw albedo", 3, 3, PlaneContent::color},
    RawPlaneFacts{RawPlane::matte, "raw matte", 1, kMostMattePlanes, PlaneContent::selection},
    RawPlaneFacts{RawPlane::occluders, "raw occluders", 1, kMostMattePlanes, PlaneContent::geometry},
};

/// An array with an entry for each plane.
template <class T>
struct RawPlaneArray {
  std::array<T, kRawPlanes.size()> entries{};

  T& operator[](RawPlane plane) { return entries[std::size_t(plane)]; }
  const T& operator[](RawPlane plane) const { return entries[std::size_t(plane)]; }
};

/// Whether the rows stand in the order of the enumeration.
constexpr bool rows_are_in_order() {
  for (std::size_t i = 0; i < kRawPlanes.size(); i++)
    if (std::size_t(kRawPlanes[i].plane) != i) return false;
  return true;
}
static_assert(rows_are_in_order());

// Files.

/// The file that a frame is called after: its INPUT, or else its depth, its positions or its deep samples.
inline const std::string& main_input(const InputSettings& settings) {
  if (!settings.input.empty()) return settings.input;
  if (!settings.depth.empty()) return settings.depth;
  return settings.position.empty() ? settings.deep.front() : settings.position;
}
/// The option that names it.
inline const char* main_option(const InputSettings& settings) {
  if (!settings.input.empty()) return "INPUT";
  if (!settings.depth.empty()) return "--depth";
  return settings.position.empty() ? "--deep" : "--position";
}

/// Whether the frame's normals are read; `--normal none` leaves them out.
inline bool wants_normals(const InputSettings& settings) { return lower_case(settings.normal) != "none"; }

/// Whether AO is wanted in parts of the frame only.
inline bool wants_matte(const InputSettings& settings) {
  return !settings.matte.empty() || !settings.matte_channel.empty() || !settings.matte_object.empty();
}

/// Whether a text names a picture by its ending, rather than objects.
inline bool names_picture(const std::string& text) {
  const auto dot = text.rfind('.');
  if (dot == text.npos || text.find(',') != text.npos) return false;
  const std::string ending = lower_case(text.substr(dot + 1));
  return std::ranges::any_of(std::array{"exr", "dds", "npy", "png", "tif", "tiff", "tga", "bmp", "hdr"},
                             [&](const char* known) { return ending == known; });
}

/// Whether some surfaces are no occluders.
inline bool chooses_occluders(const InputSettings& settings) {
  return !settings.occluders.empty() || !settings.occluder_objects.empty() || !settings.ignore.empty() ||
         !settings.ignored_objects.empty();
}

/// A layer of the beauty, and the light of --lights that it is the light of.
struct ShadowLayer {
  std::string light, layer;
};
/// What --set shadow-layers lists. Fails with ErrorKind::usage on a text that is no such list.
inline std::vector<ShadowLayer> shadow_layers_of(const InputSettings& settings) {
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

/// Whether --deep names a file.
inline bool has_deep(const InputSettings& settings) { return settings.deep != FileList{}; }

/// Whether anything is named that may show more than the first surface of each pixel.
inline bool has_hidden_sources(const InputSettings& settings) {
  const bool has_files = settings.behind != FileList{} || has_deep(settings);
  return has_files || settings.around > 0 || settings.around_all || settings.other_views;
}

}  // namespace alcove
