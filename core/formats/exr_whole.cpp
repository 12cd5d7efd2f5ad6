// Whether an EXR file is whole: OpenEXR's C API tells where its chunks lie without reading them.
// SPDX-License-Identifier: BSD-3-Clause
#include <openexr.h>

#include <filesystem>
#include <memory>

#include "core/formats/exr.h"

namespace alcove {

std::optional<std::string> attribute_of_whole_exr(const std::string& path, const std::string& name) {
  exr_context_initializer_t quiet = EXR_DEFAULT_CONTEXT_INITIALIZER;
  quiet.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
  exr_context_t raw = nullptr;
  if (exr_start_read(&raw, path.c_str(), &quiet) != EXR_ERR_SUCCESS) return std::nullopt;
  const std::unique_ptr<std::remove_pointer_t<exr_context_t>, void (*)(exr_context_t)> file(
      raw, [](exr_context_t context) { exr_finish(&context); });
  exr_attr_box2i_t data;
  int32_t rows = 0, length = 0;
  const char* text = nullptr;
  if (exr_get_data_window(raw, 0, &data) != EXR_ERR_SUCCESS ||
      exr_get_scanlines_per_chunk(raw, 0, &rows) != EXR_ERR_SUCCESS || rows <= 0 ||
      exr_attr_get_string(raw, 0, name.c_str(), &length, &text) != EXR_ERR_SUCCESS)
    return std::nullopt;
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  for (std::int64_t y = data.min.y; y <= data.max.y; y += rows) {
    exr_chunk_info_t chunk;
    if (error || exr_read_scanline_chunk_info(raw, 0, int(y), &chunk) != EXR_ERR_SUCCESS ||
        chunk.data_offset + chunk.packed_size > size)
      return std::nullopt;
  }
  return std::string(text, std::size_t(length));
}

}  // namespace alcove
