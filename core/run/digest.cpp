// The text of all settings that change the result, and its digest.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/digest.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "core/base/file.h"
#include "core/base/version.h"
#include "core/chain/passes.h"

namespace alcove {

std::string options_digest(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& i = settings.input;
  // Every value on a line of its own, so that no two sets of values make one text.
  std::string text = kVersion;
  const auto add = [&](const auto&... values) { ((text += fmt::format("\n{}", values)), ...); };
  add(int(e.estimator), e.radius ? fmt::format("{}", fmt::join(radii_of(e), ",")) : "", int(e.falloff), e.falloff_start,
      e.falloff_end, e.slices, e.steps, e.intensity, e.power, e.seed, int(e.noise));
  add(e.fade_start.value_or(-1), e.fade_end.value_or(-1), e.roughness, settings.output.fog_density);
  add(settings.output.multi_bounce, i.albedo_value.value_or(-1));
  add(settings.output.aovs, int(settings.output.ao_channels), int(settings.output.aov_space));
  add(i.material_ao.empty(), i.material_ao_channel, i.albedo.empty(), i.albedo_channels);
  add(int(e.search), e.samples, e.bias, int(e.elevation), int(e.sample_kernel), int(e.range_check));
  add(int(e.thickness), e.thickness_length, e.tolerance, e.skip_tolerance, int(e.resolution), e.stride, int(e.denoise));
  add(e.denoise_radius, fmt::format("{}", fmt::join(e.denoise_kernel, ",")), e.denoise_depth_sigma);
  // The camera by what it says; where files lie is not part of it, so that a job has the same digest wherever its
  // folder is mounted.
  add(i.camera.empty() ? std::string() : read_text(i.camera, "camera", "--camera"));
  add(i.depth_channel, i.normal_channels, i.beauty_channels, i.layer, i.view, i.source);
  add(int(i.depth_kind), i.depth_scale, i.sky, int(i.normal_space), i.fov.value_or(0), i.focal.value_or(0),
      i.aperture.value_or(0), i.ortho_width.value_or(0));
  const DepthRange& range = i.depth_range;
  add(range.near.value_or(0), range.far.value_or(0), range.reversed, int(range.device), range.log_constant);
  const Region roi = i.roi.value_or(Region{});
  add(roi.x, roi.y, roi.width, roi.height);
  add(int(i.normal_encoding), i.flip_normal.x, i.flip_normal.y, i.flip_normal.z, i.position_channels,
      int(i.position_space), i.position.empty());
  add(int(settings.output.type));
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace alcove
