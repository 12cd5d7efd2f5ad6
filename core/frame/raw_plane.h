// The planes of a frame's files, before any pass: one table of their facts, arrays with an entry for each, and the
// files that the settings name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/base/settings.h"

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

/// The most lights that AO may dim.
constexpr std::size_t kMostAmbientLights = 16;

/// An option that names a file, or one of its files.
struct FileOption {
  const char* option = nullptr;
  std::string InputSettings::*path = nullptr;
  FileList InputSettings::*list = nullptr;  // instead of a path
  std::size_t entry = 0;                    // of the list

  std::string& of(InputSettings& settings) const { return path ? settings.*path : (settings.*list)[entry]; }
  const std::string& of(const InputSettings& settings) const { return path ? settings.*path : (settings.*list)[entry]; }
};

/// A row of the table.
struct RawPlaneFacts {
  RawPlane plane;
  const char* name;   // of its buffer
  std::size_t least;  // components
  std::size_t most;
  PlaneContent content;
  FileOption file;             // null: it lies in the beauty's file
  FileOption other_file = {};  // null: there is no second option for it
  FileOption third_file = {};  // the same
};

inline constexpr std::array kRawPlanes{
    RawPlaneFacts{.plane = RawPlane::depth,
                  .name = "raw depth",
                  .least = 1,
                  .most = 3,
                  .content = PlaneContent::geometry,
                  .file = {"--depth", &InputSettings::depth},
                  .other_file = {"--position", &InputSettings::position}},
    RawPlaneFacts{.plane = RawPlane::normal,
                  .name = "raw normal",
                  .least = 2,
                  .most = 3,
                  .content = PlaneContent::geometry,
                  .file = {"--normal", &InputSettings::normal}},
    RawPlaneFacts{.plane = RawPlane::behind,
                  .name = "raw behind",
                  .least = 1,
                  .most = kMostBehindPlanes,
                  .content = PlaneContent::geometry,
                  .file = {"--behind", nullptr, &InputSettings::behind},
                  .other_file = {"--deep", nullptr, &InputSettings::deep}},
    RawPlaneFacts{.plane = RawPlane::beauty,
                  .name = "raw beauty",
                  .least = 3,
                  .most = 4,
                  .content = PlaneContent::color,
                  .file = {"--beauty", &InputSettings::beauty}},
    RawPlaneFacts{.plane = RawPlane::indirect,
                  .name = "raw indirect",
                  .least = 3,
                  .most = 3 * kMostAmbientLights,
                  .content = PlaneContent::color,
                  .file = {}},
    RawPlaneFacts{.plane = RawPlane::diffuse_color,
                  .name = "raw diffuse color",
                  .least = 3,
                  .most = 3 * kMostAmbientLights,
                  .content = PlaneContent::color,
                  .file = {}},
    RawPlaneFacts{.plane = RawPlane::material_ao,
                  .name = "raw material ao",
                  .least = 1,
                  .most = 1,
                  .content = PlaneContent::color,
                  .file = {"--set material-ao", &InputSettings::material_ao}},
    RawPlaneFacts{.plane = RawPlane::albedo,
                  .name = "raw albedo",
                  .least = 3,
                  .most = 3,
                  .content = PlaneContent::color,
                  .file = {"--set albedo", &InputSettings::albedo}},
    RawPlaneFacts{.plane = RawPlane::matte,
                  .name = "raw matte",
                  .least = 1,
                  .most = kMostMattePlanes,
                  .content = PlaneContent::selection,
                  .file = {"--matte", &InputSettings::matte}},
    RawPlaneFacts{.plane = RawPlane::occluders,
                  .name = "raw occluders",
                  .least = 1,
                  .most = kMostMattePlanes,
                  .content = PlaneContent::geometry,
                  .file = {"--set occluders", &InputSettings::occluders},
                  .other_file = {"--set ignore", &InputSettings::ignore},
                  .third_file = {"--set objects", &InputSettings::objects}},
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

/// Every option that names a file of planes, INPUT first; one that names several, once for each.
std::vector<FileOption> plane_file_options();

// Files.

/// The file that a frame is called after: its INPUT, or else its depth, its positions or its deep samples.
const std::string& main_input(const InputSettings& settings);

/// Whether the frame's normals are read; `--normal none` leaves them out.
bool wants_normals(const InputSettings& settings);

/// Whether AO is wanted in parts of the frame only.
bool wants_matte(const InputSettings& settings);

/// Whether a text names a picture by its ending, rather than objects.
bool names_picture(const std::string& text);

/// Whether some surfaces are no occluders.
bool chooses_occluders(const InputSettings& settings);

/// Whether --deep names a file.
bool has_deep(const InputSettings& settings);

/// Whether anything is named that may show more than the first surface of each pixel.
bool has_hidden_sources(const InputSettings& settings);

/// All files that a frame reads; empty names where it has none.
std::vector<std::string> input_files(const InputSettings& settings);

}  // namespace alcove
