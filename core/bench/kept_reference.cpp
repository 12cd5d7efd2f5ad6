// References in EXR files: one channel, and the settings as an attribute.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/kept_reference.h"

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/formats/exr.h"

namespace alcove {
namespace {

constexpr const char* kAttribute = "alcove/reference";

const char* name_of(ThicknessRule rule) {
  switch (rule) {
    case ThicknessRule::infinite: return "infinite";
    case ThicknessRule::constant: return "constant";
    case ThicknessRule::width: return "width";
  }
  return "";
}

}  // namespace

std::string text_of(const ReferenceSettings& settings) {
  return fmt::format(
      "radius {} falloff {} from {} slices {} thickness {} length {} share {} pixels {} complete {} bias {}",
      settings.radius, word_of(settings.falloff), settings.falloff_start, settings.slices, name_of(settings.thickness),
      settings.thickness_length, settings.width_share, settings.width_pixels, word_of(settings.complete),
      settings.bias);
}

std::vector<float> read_kept_reference(const std::string& path, const ReferenceSettings& settings, const Window& data) {
  Image image = read_exr_image(path);
  const auto made_with = attribute_of_whole_exr(path, kAttribute);
  if (!made_with || image.names.size() != 1)
    fail(ErrorKind::input, "{}: this is no reference: it needs one channel and the attribute {}", path, kAttribute);
  if (image.data != data)
    fail(ErrorKind::input, "{}: the reference is of {}, and its frame of {}", path, to_string(image.data),
         to_string(data));
  if (*made_with != text_of(settings)) return {};
  return std::move(image.pixels);
}

}  // namespace alcove
