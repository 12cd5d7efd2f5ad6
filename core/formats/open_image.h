// Opens picture files of every format that is read; their first bytes tell the format, whatever their names end in.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/formats/exr.h"

namespace alcove {

/// The formats that a reader of the file can use.
enum class Formats {
  of_frames,  // those that hold depth and normals without loss: the ones that frame_formats() lists
  all,        // also what else OpenImageIO reads, such as JPEG
};

/// Opens a file and reads its header. `option` says where the user named the file. Fails with ErrorKind::input, naming
/// the file's format and those that are read, if it is none of these; also if it is missing or damaged.
ExrFile open_image(const std::string& path, const char* option, Formats formats);

/// "OpenEXR, DDS, PNG, TIFF, TGA, BMP or Radiance HDR"
const char* frame_formats();

}  // namespace alcove
