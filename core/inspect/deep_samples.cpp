// Counts deep samples, band by band.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/deep_samples.h"

#include <algorithm>

#include "core/frame/deep.h"

namespace alcove {
namespace {

/// How the depth of a file's samples is read.
std::string depth_of(const FrameSource& source, const ExrFile& file) {
  if (!source.deep || source.files[*source.deep].path() != file.path() || !source.settled) return "";
  const ChannelRef& own = source[RawPlane::depth][0];
  if (source.part_of(own).deep) return "the depth of the frame";
  const DepthKind kind = source.deep_kind == DepthKind::automatic ? source.depth_kind : source.deep_kind;
  return kind == DepthKind::ray ? "along the ray" : kind == DepthKind::planar ? "planar" : name_of(kind);
}

}  // namespace

std::optional<InspectedDeep> deep_samples(const FrameSource& source, const ExrFile& file,
                                          const InputSettings& settings) {
  const std::vector<int> parts = deep_parts_of(file, settings);
  if (parts.empty()) return std::nullopt;
  const ExrPart& first = file.parts()[std::size_t(parts.front())];
  ExrFile samples(file.path(), "INPUT");
  samples.take_deep(parts, deep_rules(source, file, parts, settings));
  std::vector<float> band(std::size_t(first.data.width) * std::size_t(first.rows_together));
  const ExrRead read{parts.front(), deep_channel(0, false), band.data()};
  for (int y = 0; y < first.data.height; y += first.rows_together)
    samples.read(std::span(&read, 1), y, std::min(first.rows_together, first.data.height - y));
  return InspectedDeep{file.path(), parts, *first.deep, samples.deep_counts(), depth_of(source, file)};
}

}  // namespace alcove
