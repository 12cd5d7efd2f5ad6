// The interface between the program and core/formats/image_io.cpp, a module that is loaded on first use.
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenImageIO brings some 200 shared libraries along (video, GIS, computer vision). To load them costs a fifth of a
// second, more than all the rest of a small frame, and a job with EXRs only needs none of them.
#pragma once

#include <memory>
#include <string>

#include "core/formats/image_io.h"

namespace alcove {

/// The function of core/formats/image_io.h that needs OpenImageIO.
struct ImageIoModule {
  std::unique_ptr<PictureReader> (*open_picture)(const std::string& path, const char* option);
};

inline constexpr const char* kImageIoFile = "libalcove_image_io.so";
inline constexpr const char* kImageIoSymbol = "alcove_image_io_module";  // an ImageIoModule

}  // namespace alcove
