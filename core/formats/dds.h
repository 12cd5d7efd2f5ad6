// DDS textures as RenderDoc saves them: one plane of pixels, uncompressed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/image.h"

namespace alcove {

/// Reads the first image of a DDS. Its format must be one of R32_FLOAT, D32_FLOAT, R16_UNORM, D16_UNORM, R16_FLOAT,
/// R24_UNORM_X8 / D24_UNORM_S8, R32G32_FLOAT, R16G16_FLOAT, R16G16_UNORM, R8G8B8A8_UNORM, R10G10B10A2_UNORM,
/// R16G16B16A16 (float and unorm) or R32G32B32A32_FLOAT. The channels are called R, G, B, A as far as there are any;
/// unorm values go from 0 to 1. Fails with ErrorKind::input on other formats, on headers that make no sense, and on
/// files that are too short.
Image read_dds(const std::string& path, const char* option);

}  // namespace alcove
