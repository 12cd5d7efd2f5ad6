// Loads the module of core/image_io.cpp on first use and hands the calls on.
// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image_io.h"
#include "core/image_io_module.h"

namespace alcove {
namespace {

/// `path` is the picture that needs it.
const ImageIoModule& module(const std::string& path, ErrorKind kind) {
  static const ImageIoModule* loaded = [&] {
    void* library = ::dlopen(kImageIoFile, RTLD_NOW | RTLD_LOCAL);  // found beside the program or in ../lib/alcove, by the program's run path
    void* symbol = library ? ::dlsym(library, kImageIoSymbol) : nullptr;
    if (!symbol) fail(kind, "{}: a picture that is no EXR needs {} beside the program: {}", path, kImageIoFile, ::dlerror());
    return static_cast<const ImageIoModule*>(symbol);
  }();
  return *loaded;
}

}  // namespace

Image read_image(const std::string& path, const char* option) { return module(path, ErrorKind::input).read_image(path, option); }

std::vector<char> encode_png(const std::string& name, int width, int height, int channels, std::span<const float> pixels) {
  return module(name, ErrorKind::output).encode_png(name, width, height, channels, pixels);
}

std::vector<char> encode_chart(const std::string& name, const Chart& chart) { return module(name, ErrorKind::output).encode_chart(name, chart); }

void write_png(const std::string& path, int width, int height, int channels, std::span<const float> pixels) {
  write_whole(path, encode_png(path, width, height, channels, pixels));
}

}  // namespace alcove
