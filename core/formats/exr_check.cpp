// Checks of EXR files that OpenEXR does not make: whether a header is sane, and whether a file is whole.
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenEXR's document "File Layout" describes the header as bytes: name, type, size and value of each attribute; an
// empty name ends a part.
#include "core/formats/exr.h"

#include <openexr.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/formats/exr_shared.h"

namespace alcove {

namespace {

constexpr std::size_t kLongestName = 255;
constexpr std::uint32_t kMultiPart = 0x1000;             // of the version's flags
constexpr std::uint64_t kLinesPerChunk = 256;            // the most of any compression
constexpr std::string_view kDeepLines = "deepscanline";  // a type of parts, which compresses each line by itself
constexpr int kHtj2k256 = 10, kHtj2k32 = 11;             // compressions
constexpr std::uint64_t kOffset = 8;                     // bytes of a chunk's place in the file
// The most pixels per byte: DWA keeps 2 bytes of a constant block of 64 pixels, and deflate packs these 1032:1.
constexpr std::uint64_t kPixelsPerByte = 65536;
// The longest header: ten times the longest that programs write, and small beside a frame. Several copies of it are
// held.
constexpr std::uint64_t kMostBytes = 32 << 20;

struct Reader {
  std::istream& file;
  std::uint64_t size = 0;

  std::uint64_t bytes_left() { return size - std::uint64_t(file.tellg()); }
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
    if (is_dense || claim.chunks() > reader_.bytes_left() / kOffset)
      refuse(fmt::format("{} x {} pixels in a file of {} bytes", claim.width, claim.height, reader_.size));
  }

  void check_attribute(const std::string& name, Claim& claim) {
    claim.has_attributes = true;
    const auto type = reader_.name();
    const auto size = reader_.word();
    if (!type || !size || *size > reader_.bytes_left())
      refuse(fmt::format("attribute {} is larger than the file", name));
    const auto next = reader_.file.tellg() + std::streamoff(*size);
    if (std::uint64_t(next) > kMostBytes) refuse(fmt::format("it is longer than {} MiB", kMostBytes >> 20));
    if (name == "dataWindow" && *size == 16) read_window(claim);
    if (name == "tiles" && *size == 9) read_tiles(claim);
    if (name == "chunkCount" && *size == 4) read_chunk_count();
    if (name == "compression" && *size == 1) check_compression();
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
    if (const std::uint32_t count = *reader_.word(); count > reader_.bytes_left() / kOffset)
      refuse(fmt::format("{} chunks in a file of {} bytes", count, reader_.size));
  }

  void check_compression() {
    const int number = reader_.file.get();
    if (number < EXR_COMPRESSION_LAST_TYPE) return;
    const std::string name = number == kHtj2k256 || number == kHtj2k32
                                 ? "HTJ2K (high-throughput JPEG 2000, of OpenEXR 3.4)"
                                 : fmt::format("of number {}", number);
    fail(ErrorKind::input,
         "{}: its compression is {}, which OpenEXR {} of this program does not read: write the file with ZIP or PIZ "
         "({})",
         path_, name, OPENEXR_VERSION_STRING, option_);
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

namespace {

/// Checks whether all chunks of a part lie within the file's bytes.
class PartOfFile {
 public:
  PartOfFile(exr_const_context_t file, int part, std::uint64_t size) : file_(file), part_(part), size_(size) {}

  bool is_whole() const {
    exr_storage_t storage;
    if (exr_get_storage(file_, part_, &storage) != EXR_ERR_SUCCESS) return false;
    return storage == EXR_STORAGE_SCANLINE || storage == EXR_STORAGE_DEEP_SCANLINE ? has_rows() : has_tiles();
  }

 private:
  bool lies_within(const exr_chunk_info_t& chunk) const {
    return chunk.packed_size <= size_ && chunk.data_offset <= size_ - chunk.packed_size;
  }

  bool has_rows() const {
    exr_attr_box2i_t data;
    int32_t rows = 0;
    if (exr_get_data_window(file_, part_, &data) != EXR_ERR_SUCCESS ||
        exr_get_scanlines_per_chunk(file_, part_, &rows) != EXR_ERR_SUCCESS || rows <= 0)
      return false;
    for (std::int64_t y = data.min.y; y <= data.max.y; y += rows) {
      exr_chunk_info_t chunk;
      if (exr_read_scanline_chunk_info(file_, part_, int(y), &chunk) != EXR_ERR_SUCCESS || !lies_within(chunk))
        return false;
    }
    return true;
  }

  bool has_tiles() const {
    std::uint32_t width = 0, height = 0;
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t round;
    std::int32_t across = 0, down = 0;
    if (exr_get_tile_descriptor(file_, part_, &width, &height, &levels, &round) != EXR_ERR_SUCCESS ||
        exr_get_tile_levels(file_, part_, &across, &down) != EXR_ERR_SUCCESS)
      return false;
    for (int y = 0; y < down; y++)
      for (int x = 0; x < across; x++)
        if ((levels == EXR_TILE_RIPMAP_LEVELS || x == y) && !has_level(x, y, width, height)) return false;
    return true;
  }

  bool has_level(int x, int y, std::uint32_t width, std::uint32_t height) const {
    std::int32_t pixels_x = 0, pixels_y = 0;
    if (exr_get_level_sizes(file_, part_, x, y, &pixels_x, &pixels_y) != EXR_ERR_SUCCESS) return false;
    for (std::int64_t j = 0; j * height < std::int64_t(pixels_y); j++)
      for (std::int64_t i = 0; i * width < std::int64_t(pixels_x); i++) {
        exr_chunk_info_t chunk;
        if (exr_read_tile_chunk_info(file_, part_, int(i), int(j), x, y, &chunk) != EXR_ERR_SUCCESS ||
            !lies_within(chunk))
          return false;
      }
    return true;
  }

  exr_const_context_t file_;
  int part_;
  std::uint64_t size_;
};

}  // namespace

std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name) {
  exr_context_initializer_t quiet = EXR_DEFAULT_CONTEXT_INITIALIZER;
  quiet.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
  exr_context_t raw = nullptr;
  if (exr_start_read(&raw, path.c_str(), &quiet) != EXR_ERR_SUCCESS) return std::nullopt;
  const std::unique_ptr<std::remove_pointer_t<exr_context_t>, void (*)(exr_context_t)> file(
      raw, [](exr_context_t context) { exr_finish(&context); });
  int32_t length = 0, parts = 0;
  const char* text = nullptr;
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error || exr_get_count(raw, &parts) != EXR_ERR_SUCCESS ||
      exr_attr_get_string(raw, 0, name.c_str(), &length, &text) != EXR_ERR_SUCCESS)
    return std::nullopt;
  for (int part = 0; part < parts; part++)
    if (!PartOfFile(raw, part, size).is_whole()) return std::nullopt;
  return std::string(text, std::size_t(length));
}

}  // namespace alcove
