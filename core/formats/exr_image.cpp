// EXR files as wholes: all planes of one are read or written at once.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>

#include "core/base/error.h"
#include "core/base/text.h"
#include "core/formats/exr.h"

namespace alcove {

void write_exr(const std::string& path, const ExrOutput& output) {
  ExrWriter writer(path, output);
  std::vector<std::span<const float>> planes;
  for (const auto& plane : output.planes) planes.push_back(plane.pixels);
  writer.write(planes);
  writer.finish();
}

Image read_exr_image(const std::string& path, const std::vector<std::string>& channels) {
  ExrFile file(path, "INPUT");
  const auto has_all = [&](const ExrPart& part) {
    return !part.deep && std::ranges::all_of(channels, [&](const auto& name) {
      return std::ranges::find(part.channels, name, &ExrChannel::name) != part.channels.end();
    });
  };
  const auto part = std::ranges::find_if(file.parts(), has_all);
  if (std::ranges::all_of(file.parts(), [](const ExrPart& each) { return each.deep.has_value(); }))
    fail(ErrorKind::input, "{}: it holds deep data only, which has no single value per pixel: flatten it first", path);
  if (part == file.parts().end()) fail(ErrorKind::input, "{}: no part has the channels {}", path, list_of(channels));
  std::vector<std::string> names = channels;
  if (names.empty()) std::ranges::transform(part->channels, std::back_inserter(names), &ExrChannel::name);
  require_host_room(path, part->data);
  Image image(part->data, file.display(), names);
  std::vector<ExrRead> reads;
  for (std::size_t i = 0; i < names.size(); i++)
    reads.push_back({int(part - file.parts().begin()), names[i], image.plane(i).data()});
  file.read(reads);
  return image;
}

}  // namespace alcove
