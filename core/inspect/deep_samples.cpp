// Counts deep samples, band by band.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/deep_samples.h"

#include <algorithm>

#include "core/frame/deep.h"

namespace alcove {
namespace {

/// How the depth of a file's samples is read.
std::string depth_of(const FrameSource& source, const ExrFile& file) {
  const auto is_it = [&](std::size_t other) { return source.files[other].path() == file.path(); };
  const auto is_element = [&](const auto& element) { return is_it(element.first); };
  const bool is_taken = source.deep && (is_it(*source.deep) || std::ranges::any_of(source.deep_elements, is_element));
  if (!is_taken || !source.settled) return "";
  const ChannelRef& own = source[RawPlane::depth][0];
  if (source.part_of(own).deep) return "the depth of the frame";
  const DepthKind kind = source.deep_kind == DepthKind::automatic ? source.depth_kind : source.deep_kind;
  return kind == DepthKind::ray ? "along the ray" : kind == DepthKind::planar ? "planar" : name_of(kind);
}

}  // namespace

std::optional<InspectedDeep> deep_samples(const FrameSource& source, const ExrFile& file,
                                          const InputSettings& settings) {
  const std::vector<int> parts = deep_parts_of(file, settings.layer, source.view);
  if (parts.empty()) return std::nullopt;
  ExrFile samples(file.path(), "INPUT");
  const ExrPart& first = samples.parts()[std::size_t(parts.front())];
  samples.take_deep(parts, deep_rules(source, file, parts, settings));
  const std::size_t band = std::size_t(first.data.width) * std::size_t(first.rows_together);
  std::vector<float> surfaces(2 * kMostDeepSurfaces * band, kNoDeepSurface);
  std::vector<ExrRead> reads;
  for (const bool back : {false, true})
    for (std::size_t i = 0; i < kMostDeepSurfaces; i++)
      reads.push_back({parts.front(), deep_channel(i, back), surfaces.data() + reads.size() * band});
  const auto is_surface = [](float z) { return z < kNoDeepSurface; };
  std::vector<bool> has_any(reads.size());
  for (int y = 0; y < first.data.height; y += first.rows_together) {
    samples.read(reads, y, std::min(first.rows_together, first.data.height - y));
    for (std::size_t i = 0; i < reads.size(); i++)
      has_any[i] = has_any[i] || std::ranges::any_of(std::span(reads[i].to, band), is_surface);
  }
  InspectedDeep deep{file.path(), parts, *first.deep, samples.deep_counts(), depth_of(source, file), {}};
  for (std::size_t i = 0; i < reads.size(); i++)
    if (has_any[i]) deep.channels.push_back(reads[i].channel);
  return deep;
}

}  // namespace alcove
