// Scan lines of ZIP and ZIPS: what our own reader accepts has the bits that OpenEXR reads, whatever the file says.
// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "core/formats/exr.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/openexr.h"

using namespace alcove;

namespace {

using Planes = std::vector<std::vector<float>>;

/// Some rows of the channels, or nothing where they are refused.
std::optional<Planes> rows_of(ExrFile& file, int part, const std::vector<std::string>& names, int first, int rows) {
  Planes planes;
  std::vector<ExrRead> reads;
  for (const auto& name : names) {
    planes.emplace_back(std::size_t(file.parts()[std::size_t(part)].data.width) * std::size_t(rows));
    reads.push_back({part, name, planes.back().data()});
  }
  if (!fuzz::accepts([&] { file.read(reads, first, rows); })) return std::nullopt;
  return planes;
}

void compare(ExrFile& file, int part, const std::string& path) {
  const Window data = file.parts()[std::size_t(part)].data;
  std::vector<std::string> names;
  for (const auto& channel : file.parts()[std::size_t(part)].channels)
    if (!channel.subsampled) names.push_back(channel.name);
  const auto planes = rows_of(file, part, names, 0, data.height);
  if (!planes) return;
  const int first = data.height / 3, rows = data.height - first;
  const auto lower = rows_of(file, part, names, first, rows);
  // Who reads from the first row on does not need the table of chunks, which may be wrong.
  if (!lower) return;
  // libdeflate takes some streams that zlib refuses.
  const auto truth = test::openexr_planes(path, part);
  const std::size_t before = std::size_t(data.width) * std::size_t(first);
  const auto is_same = [](const float* a, const std::vector<float>& b) {
    return std::memcmp(a, b.data(), b.size() * sizeof(float)) == 0;
  };
  for (std::size_t i = 0; i < names.size(); i++) {
    fuzz::require(is_same((*planes)[i].data() + before, (*lower)[i]), "rows have the bits of the whole");
    if (truth) fuzz::require(is_same((*planes)[i].data(), truth->at(names[i])), "pixels have the bits of OpenEXR");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  fuzz::accepts([&] {
    ExrFile file(input.path(), "INPUT");
    for (std::size_t part = 0; part < file.parts().size(); part++)
      if (!file.parts()[part].deep && file.parts()[part].data.pixels() <= fuzz::kMostPixels &&
          test::is_of_zip_lines(input.path(), int(part)))
        compare(file, int(part), input.path());
  });
  return 0;
}
