// The header as bytes: name, type, size and value of each attribute; an empty name ends a part. Source: OpenEXR's "File
// Layout".
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr_header.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "core/base/error.h"

namespace alcove {
namespace {

constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMultiPart = 0x1000;  // of the version's flags
constexpr std::uint64_t kLinesAChunk = 256;   // at most, of any compression
constexpr std::uint64_t kOffset = 8;          // bytes of a chunk's place in the file
// at most: DWA keeps 2 bytes of a constant block of 64 pixels, and deflates these 1032:1
constexpr std::uint64_t kPixelsAByte = 65536;
// of a header: ten times what programs write, and small beside a frame; it is held several times
constexpr std::uint64_t kMostBytes = 32 << 20;

struct Reader {
  std::ifstream file;
  std::uint64_t size = 0;

  std::uint64_t left() { return size - std::uint64_t(file.tellg()); }
  std::optional<std::uint32_t> word() {
    std::array<unsigned char, 4> b{};
    if (!file.read(reinterpret_cast<char*>(b.data()), 4)) return std::nullopt;
    return std::uint32_t(b[0]) | std::uint32_t(b[1]) << 8 | std::uint32_t(b[2]) << 16 | std::uint32_t(b[3]) << 24;
  }
  /// Up to a zero byte; nothing where it is too long or the file ends.
  std::optional<std::string> name() {
    std::string text;
    for (char c = 0; text.size() <= kLongestName && file.get(c); text += c)
      if (c == 0) return text;
    return std::nullopt;
  }
};

}  // namespace

void require_sane_header(const std::string& path, const char* option) {
  std::error_code error;
  Reader reader{std::ifstream(path, std::ios::binary), std::filesystem::file_size(path, error)};
  const auto refuse = [&](const std::string& why) {
    fail(ErrorKind::input, "{}: the EXR header cannot be right ({}): {}", path, option, why);
  };
  const auto magic = reader.word(), version = reader.word();
  if (error || !magic || !version) return refuse("the file ends in it");
  std::uint64_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  bool in_part = false;
  while (true) {
    const auto name = reader.name();
    if (!name) return refuse("the file ends in it, or a name is endless");
    if (name->empty()) {
      const std::uint64_t offsets =
          tile_width ? ((width + tile_width - 1) / tile_width) * ((height + tile_height - 1) / tile_height)
                     : (height + kLinesAChunk - 1) / kLinesAChunk;
      const bool too_many =
          offsets > reader.left() / kOffset || (height > 0 && width > kPixelsAByte * reader.size / height);
      if (in_part && too_many)
        return refuse(fmt::format("{} x {} pixels in a file of {} bytes", width, height, reader.size));
      if (!in_part || !(*version & kMultiPart)) return;
      in_part = false, width = height = tile_width = tile_height = 0;
      continue;
    }
    in_part = true;
    const auto type = reader.name();
    const auto size = reader.word();
    if (!type || !size || *size > reader.left())
      return refuse(fmt::format("attribute {} is larger than the file", *name));
    const auto next = reader.file.tellg() + std::streamoff(*size);
    if (std::uint64_t(next) > kMostBytes) return refuse(fmt::format("it is longer than {} MiB", kMostBytes >> 20));
    if (*name == "dataWindow" && *size == 16) {
      std::array<std::int64_t, 4> window{};
      for (auto& x : window) x = std::int32_t(*reader.word());
      if (window[2] < window[0] || window[3] < window[1]) return refuse("its data window is empty or inside out");
      width = std::uint64_t(window[2] - window[0] + 1), height = std::uint64_t(window[3] - window[1] + 1);
    } else if (*name == "tiles" && *size == 9) {
      tile_width = *reader.word(), tile_height = *reader.word();
      if (!tile_width || !tile_height) return refuse("its tiles are empty");
    }
    reader.file.seekg(next);
  }
}

}  // namespace alcove
