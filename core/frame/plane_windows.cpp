// Planes whose files have another data window than the depth.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/plane_windows.h"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/base/windows.h"

namespace alcove {
namespace {

/// The most that is decoded at once of a file whose window is larger than what is wanted of it.
constexpr std::uint64_t kBandBytes = 8 << 20;

/// Decodes channels of one file and one window, which is not that of the destination, band by band.
void read_from_other(ExrFile& file, const Window& from, int rows_together, const std::vector<ExrRead>& reads,
                     const Window& to) {
  for (const auto& read : reads) std::fill_n(read.to, to.pixels(), 0.0f);
  const Window part = common_part(from, to);
  if (part.pixels() == 0) return;
  const std::uint64_t row_bytes = sizeof(float) * std::uint64_t(from.width) * reads.size();
  const int most = int(std::clamp<std::uint64_t>(kBandBytes / row_bytes, 1, std::uint64_t(part.height)));
  const int step = std::max(rows_together, most);
  for (int y = part.y; y < part.y + part.height; y += step) {
    const Window band{from.x, y, from.width, std::min(step, part.y + part.height - y)};
    std::vector<float> pixels(band.pixels() * reads.size());
    std::vector<ExrRead> of_band = reads;
    for (std::size_t i = 0; i < reads.size(); i++) of_band[i].to = pixels.data() + i * band.pixels();
    file.read(of_band, y - from.y, band.height);
    for (std::size_t i = 0; i < reads.size(); i++) copy_common(of_band[i].to, band, reads[i].to, to);
  }
}

}  // namespace

void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without) {
  for (const auto& channel : channels) {
    const ExrFile& file = source.files[channel.file];
    const Window& data = source.part_of(channel).data;
    if (data == source.file_data) continue;
    if (file.display() != source.display)
      fail(
          ErrorKind::input,
          "{}: the {} channel {} is {} of a picture of {}, and the depth is {} of {}: only files with the same display "
          "window show which pixels belong together: render both at the same size ({})",
          file.path(), what, channel.channel, to_string(data), to_string(file.display()), to_string(source.file_data),
          to_string(source.display), option);
    if (common_part(data, source.file_data).pixels() == 0)
      fail(ErrorKind::input, "{}: the {} channel {} is {}, and the depth is {}: they share no pixel ({})", file.path(),
           what, channel.channel, to_string(data), to_string(source.file_data), option);
    add_new(source.notes,
            {{NoteCode::windows_differ, fmt::format("the {} is {}, and the depth is {}: {}", what, to_string(data),
                                                    to_string(source.file_data), without)}});
  }
}

void read_rows(FrameSource& source, std::span<const ChannelRead> reads, int top, int rows) {
  const Window& own = source.file_data;
  using Place = std::tuple<std::size_t, int, int, int, int>;  // a file, and a window
  std::map<Place, std::vector<const ChannelRead*>> groups;
  for (const auto& read : reads) {
    const Window& data = source.part_of(read.channel).data;
    groups[{read.channel.file, data.x, data.y, data.width, data.height}].push_back(&read);
  }
  for (const auto& [place, group] : groups) {
    ExrFile& file = source.files[group[0]->channel.file];
    const ExrPart& part = source.part_of(group[0]->channel);
    std::vector<ExrRead> of_file;
    for (const auto* read : group) of_file.push_back({read->channel.part, read->channel.channel, read->to});
    if (part.data == own)
      file.read(of_file, top - own.y, rows);
    else
      read_from_other(file, part.data, part.rows_together, of_file, {own.x, top, own.width, rows});
  }
}

void fill_missing(const FrameSource& source, RawPlane plane, std::span<float> values) {
  const bool is_objects = (plane == RawPlane::matte && source.matte.kind == MatteKind::objects) ||
                          (plane == RawPlane::occluders && source.occluders.kind == MatteKind::objects);
  if (plane != RawPlane::material_ao && !is_objects) return;
  // The number 0 may be that of an object.
  const float neutral = is_objects ? std::numeric_limits<float>::quiet_NaN() : 1;
  const Window& there = source.part_of(source[plane][0]).data;
  const Window part = common_part(there, source.data);
  if (part == source.data) return;
  const std::vector<float> kept = cropped(values, source.data, part);
  std::ranges::fill(values, neutral);
  copy_common(kept.data(), part, values.data(), source.data);
}

}  // namespace alcove
