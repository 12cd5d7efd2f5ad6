// On a rendered frame AO without normals is near AO with them. What presets make of rendered frames against Cycles'
// ray-traced AO, `preset_limits` measures.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/frame_source.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::real_frame_test {
namespace {

using namespace test;

TEST(RealFrame, normals_from_depth_come_close_to_the_rendered_ones) {
  const std::string base = ALCOVE_SOURCE_DIR "/examples/bench/colonnade";
  InputSettings input;
  input.input = base + ".gbuffer.exr";
  input.camera = base + ".camera.json";
  HostFrame frame = read_host_frame(input, 0);
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.75;
  settings.slices = 8;
  settings.steps = 16;
  const auto with_normals = compute_ao(recorder(), frame, settings).ao;
  frame.normal.clear();
  // measured 0.0718; the rendered normals are smooth over facets
  EXPECT_LE(difference(compute_ao(recorder(), frame, settings).ao, with_normals).rmse, 0.08);
}

}  // namespace
}  // namespace alcove::real_frame_test
