// The header as bytes: name, type, size and value of each attribute; an empty name ends a part.
// The source is OpenEXR's document "File Layout".
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <optional>

#include "core/base/error.h"
#include "core/formats/exr_shared.h"

namespace alcove {
namespace {

constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMultiPart = 0x1000;             // of the version's flags
constexpr std::uint64_t kLinesPerChunk = 256;            // at most, of any compression
constexpr std::string_view kDeepLines = "deepscanline";  // a type of parts, which compresses each line by itself
constexpr std::uint64_t kOffset = 8;                     // bytes of a chunk's place in the file
// At most: DWA keeps 2 bytes of a constant block of 64 pixels, and deflate packs these 1032:1.
constexpr std::uint64_t kPixelsPerByte = 65536;
// The longest header: ten times what programs write, and small beside a frame. Several copies of it are held.
constexpr std::uint64_t kMostBytes = 32 << 20;

struct Reader {
  std::istream& file;
  std::uint64_t size = 0;

  std::uint64_t left() { return size - std::uint64_t(file.tellg()); }
  std::optional<std::uint32_t> word() {
    std::array<unsigned char, 4> b{};
    if (!file.read(reinterpret_cast<char*>(b.data()), 4)) return std::nullopt;
    return std::uint32_t(b[0]) | std::uint32_t(b[1]) << 8 | std::uint32_t(b[2]) << 16 | std::uint32_t(b[3]) << 24;
  }
  /// Reads up to a zero byte; gives nothing if the name is too long or the file ends.
  std::optional<std::string> name() {
    std::string text;
    for (char c = 0; text.size() <= kLongestName && file.get(c); text += c)
      if (c == 0) return text;
    return std::nullopt;
  }
};

/// The sizes that a part's header claims.
struct Claim {
  std::uint64_t width = 0, height = 0;            // px
  std::uint64_t tile_width = 0, tile_height = 0;  // px; 0: lines
  bool has_attributes = false;
  std::uint64_t lines_per_chunk = kLinesPerChunk;

  std::uint64_t chunks() const {
    if (!tile_width) return (height + lines_per_chunk - 1) / lines_per_chunk;
    return ((width + tile_width - 1) / tile_width) * ((height + tile_height - 1) / tile_height);
  }
};

/// A header being walked through.
class Walk {
 public:
  Walk(std::istream& file, const std::string& path, const char* option) : path_(path), option_(option), reader_{file} {
    std::error_code error;
    reader_.size = std::filesystem::file_size(path, error);
    const auto magic = reader_.word();
    const auto version = reader_.word();
    if (error || !magic || !version) refuse("the file ends in it");
    is_multi_part_ = *version & kMultiPart;
  }

  /// Gives the bytes of the header.
  std::uint64_t check() {
    for (Claim claim;;) {
      const auto name = reader_.name();
      if (!name) refuse("the file ends in it, or a name is endless");
      if (!name->empty()) {
        check_attribute(*name, claim);
        continue;
      }
      // An empty name ends a part, and a part without attributes the header.
      if (claim.has_attributes) check_part(claim);
      if (!claim.has_attributes || !is_multi_part_) return std::uint64_t(reader_.file.tellg());
      claim = {};
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    fail(ErrorKind::input, "{}: the EXR header cannot be right ({}): {}", path_, option_, why);
  }

  void check_part(const Claim& claim) {
    const bool is_dense = claim.height > 0 && claim.width > kPixelsPerByte * reader_.size / claim.height;
    if (is_dense || claim.chunks() > reader_.left() / kOffset)
      refuse(fmt::format("{} x {} pixels in a file of {} bytes", claim.width, claim.height, reader_.size));
  }

  void check_attribute(const std::string& name, Claim& claim) {
    claim.has_attributes = true;
    const auto type = reader_.name();
    const auto size = reader_.word();
    if (!type || !size || *size > reader_.left()) refuse(fmt::format("attribute {} is larger than the file", name));
    const auto next = reader_.file.tellg() + std::streamoff(*size);
    if (std::uint64_t(next) > kMostBytes) refuse(fmt::format("it is longer than {} MiB", kMostBytes >> 20));
    if (name == "dataWindow" && *size == 16) read_window(claim);
    if (name == "tiles" && *size == 9) read_tiles(claim);
    if (name == "chunkCount" && *size == 4) read_chunk_count();
    if (name == "type" && *size == kDeepLines.size()) read_type(claim);
    reader_.file.seekg(next);
  }

  void read_window(Claim& claim) {
    std::array<std::int64_t, 4> window{};
    for (auto& x : window) x = std::int32_t(*reader_.word());
    if (window[2] < window[0] || window[3] < window[1]) refuse("its data window is empty or inside out");
    claim.width = std::uint64_t(window[2] - window[0] + 1);
    claim.height = std::uint64_t(window[3] - window[1] + 1);
  }

  void read_tiles(Claim& claim) {
    claim.tile_width = *reader_.word();
    claim.tile_height = *reader_.word();
    if (!claim.tile_width || !claim.tile_height) refuse("its tiles are empty");
  }

  void read_chunk_count() {
    if (const std::uint32_t count = *reader_.word(); count > reader_.left() / kOffset)
      refuse(fmt::format("{} chunks in a file of {} bytes", count, reader_.size));
  }

  void read_type(Claim& claim) {
    std::string type(kDeepLines.size(), '\0');
    reader_.file.read(type.data(), std::streamsize(type.size()));
    if (type == kDeepLines) claim.lines_per_chunk = 1;
  }

  const std::string& path_;
  const char* option_;
  Reader reader_;
  bool is_multi_part_ = false;
};

}  // namespace

std::uint64_t require_sane_header(std::istream& file, const std::string& path, const char* option) {
  return Walk(file, path, option).check();
}

}  // namespace alcove
