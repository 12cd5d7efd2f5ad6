// The composite of a beauty whose data window is not the depth's.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/composite_window.h"

#include <algorithm>

#include "core/base/windows.h"
#include "core/frame/raw_plane.h"
#include "core/run/frame_files.h"

namespace alcove {
namespace {

/// The most that is put together at once, so that a beauty which is much larger than the depth needs no more memory.
constexpr std::uint64_t kBytesAtOnce = 1 << 20;

const Window& window_of_beauty(const FrameSource& source) { return source.part_of(source[RawPlane::beauty][0]).data; }

/// Of all planes.
std::uint64_t row_bytes(const FrameSource& source) {
  return sizeof(float) * source[RawPlane::beauty].size() * std::uint64_t(window_of_beauty(source).width);
}

}  // namespace

Window composite_window(const FrameSource& source) {
  const Window& beauty = window_of_beauty(source);
  return source.region ? common_part(picture_of(source, *source.region), beauty) : beauty;
}

std::vector<std::vector<float>> composite_over(FrameSource& source, std::size_t count, const Window& part,
                                               const Window& from, std::span<const std::span<const float>> planes) {
  const auto& beauty = source[RawPlane::beauty];
  const Window& whole = window_of_beauty(source);
  const Window rows{whole.x, part.y, whole.width, part.height};
  const bool is_all_computed = common_part(part, from) == part;
  std::vector<std::vector<float>> composite(count, std::vector<float>(part.pixels(), 1));
  for (std::size_t c = 0; c < count; c++) {
    if (!is_all_computed && c < beauty.size()) {
      std::vector<float> read(rows.pixels());
      const ExrRead channel{beauty[c].part, beauty[c].channel, read.data()};
      source.files[beauty[c].file].read({&channel, 1}, part.y - whole.y, part.height);
      copy_common(read.data(), rows, composite[c].data(), part);
    }
    if (!planes.empty()) copy_common(planes[c].data(), from, composite[c].data(), part);
  }
  return composite;
}

std::uint64_t composite_bytes(const FrameSource& source) {
  if (source[RawPlane::beauty].empty() || composite_window(source) == written_picture(source)) return 0;
  return 2 * std::max(kBytesAtOnce, kRowsOfOutput * row_bytes(source));  // what is read, and what is made of it
}

CompositeRows::CompositeRows(FrameSource& source, const Window& computed, std::size_t planes)
    : source_(source),
      computed_(computed),
      window_(composite_window(source)),
      planes_(planes),
      computed_row_(computed.y),
      row_(window_.y) {}

void CompositeRows::write(std::span<const std::span<const float>> planes, const WriteRows& write_rows) {
  const int rows = int(planes[0].size() / std::size_t(computed_.width));
  const Window from{computed_.x, computed_row_, computed_.width, rows};
  write_until(from.y, {}, {}, write_rows);
  write_until(from.y + rows, from, planes, write_rows);
  computed_row_ += rows;
}

void CompositeRows::finish(const WriteRows& write_rows) { write_until(window_.y + window_.height, {}, {}, write_rows); }

void CompositeRows::write_until(int bottom, const Window& from, std::span<const std::span<const float>> planes,
                                const WriteRows& write_rows) {
  const int step = int(std::clamp<std::uint64_t>(kBytesAtOnce / row_bytes(source_), kRowsOfOutput, 1 << 20));
  for (const int end = std::min(bottom, window_.y + window_.height); row_ < end;) {
    const Window part{window_.x, row_, window_.width, std::min(step, end - row_)};
    const auto composite = composite_over(source_, planes_, part, from, planes);
    write_rows(std::vector<std::span<const float>>(composite.begin(), composite.end()));
    row_ += part.height;
  }
}

}  // namespace alcove
