// OpenColorIO, wrapped: the only file that includes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/color.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "core/base/error.h"
#include "core/base/file.h"

namespace alcove {
namespace {

namespace OCIO = OCIO_NAMESPACE;

/// Used when neither --ocio nor the OCIO variable names a configuration.
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
  require_readable(file, "OpenColorIO configuration", path.empty() ? "the OCIO variable" : "--ocio");
  return OCIO::Config::CreateFromFile(file.c_str());
}

}  // namespace

std::string display_config_file(const std::string& config) {
  const char* variable = config.empty() ? std::getenv("OCIO") : nullptr;
  return variable ? variable : config;
}

struct DisplayTransform::Impl {
  OCIO::ConstCPUProcessorRcPtr processor;
};

DisplayTransform::DisplayTransform(const std::string& config) : impl_(std::make_unique<Impl>()) {
  try {
    const auto opened = open_config(config);
    const char* display = opened->getDefaultDisplay();
    const char* view = opened->getDefaultView(display);
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
    transform->setDisplay(display);
    transform->setView(view);
    impl_->processor = opened->getProcessor(transform)->getDefaultCPUProcessor();
    description_ = std::string(display) + " / " + view;
  } catch (const OCIO::Exception& error) {
    std::string text = error.what();
    std::ranges::replace(text, '\n', ' ');
    fail(ErrorKind::input, "{}: OpenColorIO {} cannot use this configuration for the preview (--ocio): {}",
         config.empty() ? "OCIO" : config, OCIO::GetVersion(), text);
  }
}

DisplayTransform::~DisplayTransform() = default;

void DisplayTransform::apply(std::span<float> rgb) const {
  OCIO::PackedImageDesc image(rgb.data(), long(rgb.size() / 3), 1, 3);
  impl_->processor->apply(image);
}

}  // namespace alcove
