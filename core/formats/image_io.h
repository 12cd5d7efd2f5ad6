// Pictures of other formats in, and charts out, through OpenImageIO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/formats/chart.h"
#include "core/formats/picture_reader.h"
#include "core/formats/png.h"

namespace alcove {

/// Fails with ErrorKind::input, also where a header claims more pixels than its file can hold; `option` is for the
/// message.
std::unique_ptr<PictureReader> open_picture(const std::string& path, const char* option);

/// An 8-bit colour PNG of a chart. Fails with ErrorKind::output, also where the font for its texts is missing.
std::vector<char> encode_chart(const std::string& name, const Chart& chart);

}  // namespace alcove
