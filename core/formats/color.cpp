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

/// The name as the configuration spells it, found in any case of letters. Fails if it has none such.
std::string known_name(const std::string& config, const char* option, const std::string& name,
                       const std::vector<std::string>& names) {
  for (const auto& candidate : names)
    if (lower_case(candidate) == lower_case(name)) return candidate;
  const std::string file = display_config_file(config);
  fail(ErrorKind::input, "{}: {}: the configuration has no such name{}; it has {}",
       file.empty() ? "the built-in OpenColorIO configuration (--set ocio names another)" : file, typed(option, name),
       suggestion(name, names), list_of(names));
}

std::string known_display(const OCIO::Config& opened, const std::string& config, const std::string& name) {
  if (name.empty()) return opened.getDefaultDisplay();
  std::vector<std::string> names;
  for (int i = 0; i < opened.getNumDisplays(); i++) names.emplace_back(opened.getDisplay(i));
  return known_name(config, "--set display", name, names);
}

std::string known_view(const OCIO::Config& opened, const std::string& config, const std::string& display,
                       const std::string& name) {
  if (name.empty()) return opened.getDefaultView(display.c_str());
  std::vector<std::string> names;
  for (int i = 0; i < opened.getNumViews(display.c_str()); i++) names.emplace_back(opened.getView(display.c_str(), i));
  return known_name(config, "--set view-transform", name, names);
}

}  // namespace

struct DisplayTransform::Impl {
  OCIO::ConstCPUProcessorRcPtr processor;
};

DisplayTransform::DisplayTransform(const std::string& config, const std::string& display, const std::string& view)
    : impl_(std::make_unique<Impl>()) {
  try {
    const auto opened = open_config(config);
    const std::string used = known_display(*opened, config, display);
    const std::string shown = known_view(*opened, config, used, view);
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
    transform->setDisplay(used.c_str());
    transform->setView(shown.c_str());
    impl_->processor = opened->getProcessor(transform)->getDefaultCPUProcessor();
    description_ = used + " / " + shown;
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
