// Loads the module of core/formats/image_io.cpp on first use and hands the calls on.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"
#include "core/base/system.h"
#include "core/formats/image_io.h"

namespace alcove {
namespace {

/// Null, and why in `why`, where the module cannot be loaded. It is found beside the program or in ../lib/alcove, by
/// the program's run path.
const ImageIoModule* load(std::string& why) {
  return static_cast<const ImageIoModule*>(symbol_of(kImageIoFile, kImageIoSymbol, why));
}

/// `path` is the picture that needs it.
const ImageIoModule& module(const std::string& path) {
  static const ImageIoModule* loaded = [&] {
    std::string why;
    const ImageIoModule* found = load(why);
    if (!found)
      fail(ErrorKind::input,
           "{}: to read a picture that is no EXR, Alcove needs {}, of the package "
           "alcove-pictures, which is built where OpenImageIO is installed (libopenimageio-dev): {}",
           path, kImageIoFile, why);
    return found;
  }();
  return *loaded;
}

}  // namespace

std::string why_no_image_io() {
  std::string why;
  return load(why) ? "" : why;
}

std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option) {
  return module(path).open_picture(path, option);
}

}  // namespace alcove
