// OpenColorIO, wrapped: the only file that includes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/color.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace alcove {
namespace {

namespace OCIO = OCIO_NAMESPACE;

/// The configuration if neither --set ocio nor the OCIO variable names one.
constexpr const char* kBuiltinConfig = R"(ocio_profile_version: 2
name: alcove-builtin
roles:
  default: linear_rec709
  scene_linear: linear_rec709
  data: raw
displays:
  sRGB:
    - !<View> {name: Standard, colorspace: srgb}
active_displays: [sRGB]
active_views: [Standard]
colorspaces:
  - !<ColorSpace>
    name: linear_rec709
    encoding: scene-linear
  - !<ColorSpace>
    name: srgb
    encoding: sdr-video
    from_scene_reference: !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055, direction: inverse}
  - !<ColorSpace>
    name: raw
    isdata: true
)";

OCIO::ConstConfigRcPtr open_config(const std::string& path) {
  const std::string file = display_config_file(path);
  if (file.empty()) {
    std::istringstream text(kBuiltinConfig);
    return OCIO::Config::CreateFromStream(text);
  }
  require_readable(file, "OpenColorIO configuration", path.empty() ? "the OCIO variable" : "--set ocio");
  return OCIO::Config::CreateFromFile(file.c_str());
}

/// The name as the configuration spells it, found in any case of letters among `count`. Fails if it has none such.
template <class NameAt>
std::string known_name(const std::string& config, const char* option, const std::string& name, int count,
                       const NameAt& name_at) {
  std::vector<std::string> names;
  for (int i = 0; i < count; i++) names.emplace_back(name_at(i));
  for (const auto& candidate : names)
    if (lower_case(candidate) == lower_case(name)) return candidate;
  const std::string file = display_config_file(config);
  fail(ErrorKind::input, "{}: {}: the configuration has no such name{}; it has {}",
       file.empty() ? "the built-in OpenColorIO configuration (--set ocio names another)" : file, typed(option, name),
       suggestion(name, names), list_of(names));
}

}  // namespace

struct DisplayTransform::Impl {
  OCIO::ConstCPUProcessorRcPtr processor;
};

DisplayTransform::DisplayTransform(const std::string& config, const std::string& display, const std::string& view)
    : impl_(std::make_unique<Impl>()) {
  try {
    const auto opened = open_config(config);
    const std::string used = display.empty() ? opened->getDefaultDisplay()
                                             : known_name(config, "--set display", display, opened->getNumDisplays(),
                                                          [&](int i) { return opened->getDisplay(i); });
    const std::string shown = view.empty()
                                  ? opened->getDefaultView(used.c_str())
                                  : known_name(config, "--set view-transform", view, opened->getNumViews(used.c_str()),
                                               [&](int i) { return opened->getView(used.c_str(), i); });
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
    transform->setDisplay(used.c_str());
    transform->setView(shown.c_str());
    impl_->processor = opened->getProcessor(transform)->getDefaultCPUProcessor();
  } catch (const OCIO::Exception& error) {
    std::string text = error.what();
    std::ranges::replace(text, '\n', ' ');
    fail(ErrorKind::input, "{}: OpenColorIO {} cannot use this configuration for the preview (--set ocio): {}",
         config.empty() ? "OCIO" : config, OCIO::GetVersion(), text);
  }
}

DisplayTransform::~DisplayTransform() = default;

void DisplayTransform::apply(std::span<float> rgb) const {
  OCIO::PackedImageDesc image(rgb.data(), long(rgb.size() / 3), 1, 3);
  impl_->processor->apply(image);
}

}  // namespace alcove
