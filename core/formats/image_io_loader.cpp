// Loads the module of core/formats/image_io.cpp on first use and hands the calls on.
// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/formats/image_io.h"
#include "core/formats/image_io_module.h"

namespace alcove {
namespace {

constexpr std::size_t kTextWithin = 4096;  // bytes: texts are written before the pixels

/// `path` is the picture that needs it.
const ImageIoModule& module(const std::string& path, ErrorKind kind) {
  static const ImageIoModule* loaded = [&] {
    // found beside the program or in ../lib/alcove, by the program's run path
    std::string why;
    void* symbol = symbol_of(kImageIoFile, kImageIoSymbol, why);
    if (!symbol) fail(kind, "{}: a picture that is no EXR needs {} beside the program: {}", path, kImageIoFile, why);
    return static_cast<const ImageIoModule*>(symbol);
  }();
  return *loaded;
}

}  // namespace

std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option) {
  return module(path, ErrorKind::input).open_picture(path, option);
}

std::vector<char> encode_png(const std::string& name, int width, int height, int channels,
                             std::span<const float> pixels, const std::string& made_by) {
  return module(name, ErrorKind::output).encode_png(name, width, height, channels, pixels, made_by);
}

std::vector<char> encode_chart(const std::string& name, const Chart& chart) {
  return module(name, ErrorKind::output).encode_chart(name, chart);
}

void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels,
               const std::string& made_by) {
  write_whole(path, encode_png(path, width, height, channels, pixels, made_by));
}

bool is_whole_png(const std::string& path, const std::string& made_by) {
  constexpr std::string_view kEnd("IEND\xae\x42\x60\x82");  // the last chunk, behind the four bytes of its length
  std::ifstream file(path, std::ios::binary);
  std::string begin(kTextWithin, '\0'), end(kEnd.size(), '\0');
  file.read(begin.data(), std::streamsize(begin.size()));
  file.clear();
  return begin.find(std::string(kMadeBy) + '\0' + made_by) != begin.npos &&
         file.seekg(-std::streamoff(end.size()), std::ios::end) && file.read(end.data(), std::streamsize(end.size())) &&
         end == kEnd;
}

}  // namespace alcove
