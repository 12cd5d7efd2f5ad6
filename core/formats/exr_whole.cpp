// Whether an EXR file is whole: OpenEXR's C API tells where its chunks lie without reading them.
// SPDX-License-Identifier: BSD-3-Clause
#include <openexr.h>

#include <filesystem>
#include <memory>

#include "core/formats/exr.h"

namespace alcove {

namespace {

/// Whether all chunks of a part lie within so many bytes.
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
