// Runs the chain for three AOVs and lays them side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/file.h"
#include "core/base/ranks.h"
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/formats/png.h"
#include "core/formats/sequence.h"
#include "core/frame/raw_plane.h"

namespace alcove {
namespace {

constexpr float kMostSky = 1e29f;  // depth from there on is sky

/// The surfaces' depths that 1 %, 50 % and 99 % of them do not reach; 1 where there is none.
std::array<double, 3> percentiles(std::span<const float> depth) {
  std::vector<float> surfaces;
  std::ranges::copy_if(depth, std::back_inserter(surfaces), [](float z) { return z < kMostSky; });
  if (surfaces.empty()) return {1, 1, 1};
  const auto at = [&](double part) {
    return double(value_at_rank(surfaces, std::size_t(part * double(surfaces.size() - 1))));
  };
  return {at(0.01), at(0.5), at(0.99)};
}

}  // namespace

void write_contact_sheet(const Settings& settings, int number) {
  const std::string& path = settings.output.preview;
  require_ending(path, "--preview", ".png", "PNG");
  require_writable(path, "--preview");
  const HostFrame frame = read_host_frame(settings.input, number);
  gpu::Device device({settings.device.device, settings.device.require_gpu, settings.device.validate});
  gpu::Recorder gpu(device);
  const FrameInputs inputs = upload(gpu, frame);
  EstimatorSettings estimator = settings.estimator;
  if (!estimator.radius) {
    std::vector<float> planar = planar_depths(frame.depth, inputs.depth_map, inputs.view);
    std::ranges::replace_if(
        planar, [](float z) { return std::isinf(z); }, kMostSky);
    estimator.radius = 0.1 * percentiles(planar)[1];
  }
  OutputSettings output;
  output.aovs = "ao,normal,depth";
  const FrameOutputs outputs = run_chain(gpu, inputs, estimator, output);
  gpu.run();

  const auto depth = outputs.depth->as<float>(), normal = outputs.normal->as<float>(), ao = outputs.ao->as<float>();
  const auto [near, median, far] = percentiles(depth);
  const std::size_t width = std::size_t(frame.data.width), pixels = frame.data.pixels();
  std::vector<float> picture(9 * pixels);
  for (std::size_t i = 0; i < pixels; i++) {
    const bool sky = depth[i] >= kMostSky;
    const float bright = far > near ? float(1 - std::log(depth[i] / near) / std::log(far / near)) : 0.5f;
    const std::array<float, 3> panels[] = {
        {bright, bright, bright},
        {0.5f + 0.5f * normal[i], 0.5f + 0.5f * normal[i + pixels], 0.5f + 0.5f * normal[i + 2 * pixels]},
        {ao[i], ao[i], ao[i]}};
    for (std::size_t panel = 0; panel < 3; panel++)
      for (std::size_t c = 0; c < 3; c++)
        picture[3 * (i / width * 3 * width + panel * width + i % width) + c] = sky ? kSkyColor[c] : panels[panel][c];
  }
  write_png(path, 3 * frame.data.width, frame.data.height, 3, picture);
}

}  // namespace alcove
