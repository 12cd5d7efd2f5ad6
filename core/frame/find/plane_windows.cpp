// Planes whose files have another data window than the depth, or are of a picture that is so many times smaller.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/frame_source.h"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

#include "core/base/error.h"
#include "core/base/image.h"
#include "core/base/text.h"

namespace alcove {
namespace {

/// The most bytes that are decoded at once of a file with a larger window than is needed.
constexpr std::uint64_t kBandBytes = 8 << 20;

/// The pixels of the depth, in x and in y, per pixel of a channel's file.
int scale_of(const FrameSource& source, const ChannelRef& channel) {
  const bool is_of_picture = source.file_of(channel).display() == picture_of(source.reading, source.reading.display);
  return is_of_picture ? source.reading.supersampling : 1;
}

/// The pixels of the depth that a channel's file shows, whether the depth has them or not.
Window shown_by(const FrameSource& source, const ChannelRef& channel) {
  return enlarged(source.part_of(channel).data, source.reading.display, scale_of(source, channel));
}

/// The value of a channel beyond the pixels of its file.
float outside_of(const FrameSource& source, const ChannelRef& channel) {
  for (const RawPlane plane : {RawPlane::normal, RawPlane::behind})
    if (std::ranges::find(source.channels[plane], channel) != source.channels[plane].end())
      return std::numeric_limits<float>::quiet_NaN();
  return 0;
}

/// Decodes channels of one file and one window, which is not that of the destination, band by band. What the
/// destination has elsewhere stays.
void read_from_other(ExrFile& file, const Window& from, int rows_together, const std::vector<ExrRead>& reads,
                     const Window& to, const Window& display, int scale) {
  const Window part = common_part(from, covering(to, display, scale));
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
    for (std::size_t i = 0; i < reads.size(); i++) copy_enlarged(of_band[i].to, band, reads[i].to, to, display, scale);
  }
}

/// Says how to mend a file of another size than the depth.
std::string way_out(const FrameSource& source, const Window& display) {
  if (display.width > source.reading.display.width)
    return "render both at the same size, and use --resolution half to save time";
  return "render both at the same size, or the depth at 2, 3 or 4 times that of the picture, with --set supersampling";
}

/// Whether the depth's display window is that of a picture, with so many pixels for each.
bool is_times(const Window& display, const Window& picture, int factor) {
  return display.width == picture.width * factor && display.height == picture.height * factor &&
         reduced(display, display, factor) == picture;
}

/// A channel and its destination.
struct ChannelRead {
  ChannelRef channel;
  float* to;
};

/// Reads all of a window. Every part of every file is decoded once. Where their files have no pixels, normals and
/// hidden depths are NaN, which is none in any encoding, and all else is 0. Channels of the smaller picture have
/// their value in all pixels of a block.
void read_channels(FrameSource& source, const Window& window, std::span<const ChannelRead> reads) {
  const Window& own = source.reading.data;
  using Place = std::tuple<std::size_t, int, int, int, int>;  // a file, and a window
  std::map<Place, std::vector<const ChannelRead*>> groups;
  for (const auto& read : reads) {
    const Window& data = source.part_of(read.channel).data;
    groups[{read.channel.file, data.x, data.y, data.width, data.height}].push_back(&read);
  }
  for (const auto& [place, group] : groups) {
    ExrFile& file = source.file_of(group[0]->channel);
    const ExrPart& part = source.part_of(group[0]->channel);
    std::vector<ExrRead> of_file;
    for (const auto* read : group) of_file.push_back({read->channel.part, read->channel.channel, read->to});
    const int scale = scale_of(source, group[0]->channel);
    if (scale == 1 && part.data == own) {
      file.read(of_file, window.y - own.y, window.height);
      continue;
    }
    for (const auto* read : group) std::fill_n(read->to, window.pixels(), outside_of(source, read->channel));
    read_from_other(file, part.data, part.rows_together, of_file, window, source.reading.display, scale);
  }
}

}  // namespace

int supersampling_of(const FrameSource& source, const InputSettings& settings, const ChannelRef* beauty) {
  const Window& display = source.reading.display;
  const int factor = settings.supersampling == "auto" ? 1 : std::stoi(settings.supersampling);
  if (display.width % factor != 0 || display.height % factor != 0)
    fail(ErrorKind::input, "{}: the display window is {}, which --set supersampling={} cannot divide",
         source.depth_path(), to_string(display), factor);
  if (!beauty) return factor;
  const ExrFile& file = source.file_of(*beauty);
  for (const int times : {2, 3, 4})
    if (factor == 1 && is_times(display, file.display(), times))
      fail(ErrorKind::input,
           "{}: the beauty's picture is {}, and the depth, {}, is {} times as large: --set supersampling={} filters "
           "all outputs down to the beauty's size; or render both at the same size",
           file.path(), to_string(file.display()), to_string(display), times, times);
  if (factor > 1 && !is_times(display, file.display(), factor))
    fail(ErrorKind::input, "{}: the beauty's picture is {}, and --set supersampling={} of the depth, {}, makes {}",
         file.path(), to_string(file.display()), factor, to_string(display),
         to_string(reduced(display, display, factor)));
  return factor;
}

void require_same_picture(const FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                          const char* option) {
  for (const auto& channel : channels) {
    const ExrFile& file = source.file_of(channel);
    const Window& data = source.part_of(channel).data;
    if (data == source.reading.data) continue;
    if (file.display() != source.reading.display)
      fail(
          ErrorKind::input,
          "{}: the {} channel {} is {} of a picture of {}, and the depth is {} of {}: both must cover the same pixels, "
          "or have the same display window ({})",
          file.path(), what, channel.channel, to_string(data), to_string(file.display()),
          to_string(source.reading.data), to_string(source.reading.display), option);
    if (common_part(data, source.reading.data).pixels() == 0)
      fail(ErrorKind::input, "{}: the {} channel {} is {}, and the depth is {}: they share no pixel ({})", file.path(),
           what, channel.channel, to_string(data), to_string(source.reading.data), option);
  }
}

void require_common_window(FrameSource& source, const std::vector<ChannelRef>& channels, const char* what,
                           const char* option, const char* without) {
  for (const auto& channel : channels) {
    const ExrFile& file = source.file_of(channel);
    const Window& data = source.part_of(channel).data;
    if (data == source.reading.data && source.reading.supersampling == 1) continue;
    if (file.display() != source.reading.display &&
        file.display() != picture_of(source.reading, source.reading.display))
      fail(
          ErrorKind::input,
          "{}: the {} channel {} is {} of a picture of {}, and the depth is {} of {}: only files with the same display "
          "window show which pixels belong together: {} ({})",
          file.path(), what, channel.channel, to_string(data), to_string(file.display()),
          to_string(source.reading.data), to_string(source.reading.display), way_out(source, file.display()), option);
    const Window shown = shown_by(source, channel);
    if (shown == source.reading.data) continue;
    if (common_part(shown, source.reading.data).pixels() == 0)
      fail(ErrorKind::input, "{}: the {} channel {} is {}, and the depth is {}: they share no pixel ({})", file.path(),
           what, channel.channel, to_string(data), to_string(source.reading.data), option);
    add_new(source.notes,
            {{NoteCode::windows_differ, fmt::format("the {} is {}, and the depth is {}: {}", what, to_string(data),
                                                    to_string(source.reading.data), without)}});
  }
}

void read_planes(FrameSource& source, const Window& window, const std::vector<PlaneRead>& reads) {
  source.rows_read += std::uint64_t(window.height);
  std::vector<ChannelRead> firsts;
  // a channel that serves two purposes is decoded to the first place, and copied from there
  std::map<ChannelRef, float*> first;
  std::vector<std::pair<float*, float*>> copies;
  for (const auto& read : reads)
    for (std::size_t i = 0; i < read.channels->size(); i++) {
      const auto& channel = (*read.channels)[i];
      float* to = read.to + i * window.pixels();
      if (const auto [known, is_new] = first.try_emplace(channel, to); is_new)
        firsts.push_back({channel, to});
      else
        copies.emplace_back(known->second, to);
    }
  read_channels(source, window, firsts);
  for (const auto& [from, to] : copies) std::copy_n(from, window.pixels(), to);
}

RawFrame read_raw_frame(FrameSource& source, const Window& window) {
  RawFrame raw{window, {}, {}};
  raw.depth.resize(source.channels[RawPlane::depth].size() * window.pixels());
  raw.normal.resize(source.channels[RawPlane::normal].size() * window.pixels());
  read_planes(
      source, window,
      {{&source.channels[RawPlane::depth], raw.depth.data()}, {&source.channels[RawPlane::normal], raw.normal.data()}});
  return raw;
}

void fill_missing(const FrameSource& source, const Window& window, RawPlane plane, std::span<float> values) {
  const bool is_objects = (plane == RawPlane::matte && source.reading.matte.kind == MatteKind::objects) ||
                          (plane == RawPlane::occluders && source.reading.occluders.kind == MatteKind::objects);
  if (plane != RawPlane::material_ao && !is_objects) return;
  // The number 0 may be that of an object.
  const float neutral = is_objects ? std::numeric_limits<float>::quiet_NaN() : 1;
  const Window part = common_part(shown_by(source, source.channels[plane][0]), window);
  if (part == window) return;
  const std::vector<float> kept = cropped(values, window, part);
  std::ranges::fill(values, neutral);
  copy_common(kept.data(), part, values.data(), window);
}

}  // namespace alcove
