// Pictures for the report page: planes as "data:image/png;base64,..." URLs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

namespace alcove {

/// The size of an error that has full colour: blue where the result is too dark, red where it is too bright, white at
/// 0.
inline constexpr float kFullColorError = 0.25f;

/// Width x height values in [0, 1] as grey, as they are: AO is data.
std::string grey_picture(int width, int height, std::span<const float> values);
/// Interleaved r, g, b display values.
std::string color_picture(int width, int height, std::span<const float> rgb);
/// result - reference in colours; grey where the difference is not finite.
std::string error_picture(int width, int height, std::span<const float> result, std::span<const float> reference);

}  // namespace alcove
