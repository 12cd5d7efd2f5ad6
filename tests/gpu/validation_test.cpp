// Every kernel once under the Vulkan validation layer, which checks their synchronization too: tests/CMakeLists.txt
// asks it to.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/chain/warp.h"
#include "tests/support/device.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

/// Runs the chain on a small room in light, and returns the kernels that it took. Nothing is compared: other tests do.
std::set<std::string> kernels_of(gpu::Recorder& gpu, const EstimatorSettings& settings, const OutputSettings& output,
                                 bool has_normals = true) {
  HostFrame frame = furnished_room(70, 45).frame;
  if (!has_normals) frame.normal.clear();
  FrameInputs inputs = upload(gpu, frame);
  const auto planes = [&](const char* name, std::size_t count) {
    gpu::Buffer& buffer = gpu.buffer(name, count * frame.data.pixels() * sizeof(float), gpu::Use::upload);
    std::ranges::fill(buffer.as<float>(), 0.5f);
    return &buffer;
  };
  if (!output.composite.empty()) {
    inputs.supersampling = 2;
    for (const auto& row : kRawPlanes)
      if (!inputs[row.plane]) inputs[row.plane] = planes(row.name, row.most);
    inputs.behind.assign(kMostBehindPlanes, {inputs.depth_map.form, BehindKind::surfaces, inputs.prepare.depth});
  }
  run_chain(gpu, inputs, settings, output);
  gpu.run();
  std::set<std::string> names;
  for (const auto& pass : gpu.passes()) names.insert(pass.name);
  return names;
}

/// The same of a room that another frame of it sees, from where it stands, with a margin for what that shows.
std::set<std::string> kernels_of_views(gpu::Recorder& gpu, const EstimatorSettings& settings) {
  std::set<std::string> names;
  const auto run = [&] {
    gpu.run();
    for (const auto& pass : gpu.passes()) names.insert(pass.name);
  };
  const HostFrame frame = furnished_room(70, 45).frame;
  FrameInputs other = upload(gpu, frame);
  upload(gpu, other);
  const GBuffer seen = prepare(gpu, other, "other ");
  OtherView view;
  view.view = seen.view;
  view.to_here = {{{1, 0, 0, 0.1f}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  view.depth_precision = seen.depth_precision;
  view.depth = seen.depth;
  view.normal = seen.normal;
  gpu::Buffer& moving = gpu.buffer("moving", seen.depth->bytes(), gpu::Use::device);
  surfels(gpu, view, std::array{view}, moving);
  run();
  view.moving = &moving;
  FrameInputs inputs = upload(gpu, frame);
  inputs.others = {view};
  inputs.margin = {{8, 8}, {8, 8}};
  run_chain(gpu, inputs, settings);
  run();
  return names;
}

/// The same of a room whose AO is the mean of its own estimate and of another frame's, from beside it.
std::set<std::string> kernels_of_means(gpu::Recorder& gpu, const EstimatorSettings& settings) {
  const HostFrame frame = furnished_room(70, 45).frame;
  const std::size_t pixels = frame.data.pixels();
  FrameInputs inputs = upload(gpu, frame);
  const auto filled = [&](const char* name, std::size_t words) {
    gpu::Buffer& buffer = gpu.buffer(name, words * sizeof(float), gpu::Use::upload);
    std::ranges::fill(buffer.as<float>(), 0.5f);
    std::ranges::copy(frame.depth, buffer.as<float>().begin());
    return &buffer;
  };
  gpu::Buffer& table = gpu.buffer("estimated frames", sizeof(TakenFrame), gpu::Use::upload);
  table.as<TakenFrame>()[0] = {inputs.view, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1f, 0, 0}, {1e-4f, 1e-5f, 0}, 0};
  EstimateSet& estimates = inputs.estimates;
  estimates.depth = filled("own depth", pixels);
  estimates.normal = filled("own normal", pixels);
  estimates.values = filled("own values", pixels);
  estimates.view = inputs.view;
  estimates.has_moving = true;
  estimates.groups = {{filled("estimates", 2 * pixels), &table, 1}};
  run_chain(gpu, inputs, settings);
  gpu.run();
  std::set<std::string> names;
  for (const auto& pass : gpu.passes()) names.insert(pass.name);
  return names;
}

std::set<std::string> kernels_of_all_settings(gpu::Recorder& gpu) {
  EstimatorSettings settings;
  settings.radius = 0.4;
  settings.slices = 3, settings.steps = 16, settings.samples = 64;
  std::set<std::string> names = kernels_of(gpu, settings, {}, false);
  names.merge(kernels_of_views(gpu, settings));
  names.merge(kernels_of_means(gpu, settings));
  const auto add = [&](const OutputSettings& output) { names.merge(kernels_of(gpu, settings, output)); };

  OutputSettings everything;
  everything.aovs = "ao,ao-scales,normal,bent-normal,depth,specular-occlusion,confidence,hidden";
  everything.composite = "composite.exr";
  everything.multi_bounce = true;
  everything.look.fog_density = 0.1;
  for (const auto& view : debug_view_names()) everything.debug += (everything.debug.empty() ? "" : ",") + view;
  settings.power = 1.5;
  add(everything);
  settings.further_radii = {0.1};
  add(everything);
  settings.resolution = Resolution::half;
  add(everything);
  settings.further_radii.clear();
  settings.steps = 64;
  add(everything);  // lists for upsampling
  settings.resolution = Resolution::full;

  for (const auto estimator : {Estimator::bitmask, Estimator::hbao, Estimator::crytek}) {
    settings.estimator = estimator;
    add({});
  }
  settings.estimator = Estimator::gtao;
  settings.search = SliceSearch::exact;
  settings.slices = 2;
  OutputSettings bent;
  bent.aovs = "ao,bent-normal";
  add(bent);
  settings.tolerance = 0.05;
  OutputSettings error;
  error.aovs = "ao,error,bent-normal";
  add(error);
  return names;
}

std::set<std::string> kernels_there_are() {
  std::set<std::string> names{"horizon_layers"};  // made of horizon.comp
  for (const auto& entry : std::filesystem::directory_iterator(ALCOVE_SOURCE_DIR "/kernels"))
    if (entry.path().extension() == ".comp") names.insert(entry.path().stem().string());
  return names;
}

TEST(Validation, is_silent_about_every_kernel) {
  ASSERT_TRUE(device().options().validate) << "ALCOVE_TEST_VALIDATE is not set";
  ASSERT_TRUE(std::getenv("VK_LAYER_ENABLES")) << "nobody checks synchronization";
  EXPECT_EQ(kernels_of_all_settings(recorder()), kernels_there_are());
  EXPECT_EQ(device().validation_messages(), 0);
}

TEST(Validation, is_silent_about_copies) {
  gpu::DeviceOptions options = device().options();
  options.map_memory = false;
  options.guard_bytes = 0;
  gpu::Device staged(options);
  gpu::Recorder gpu(staged);
  EXPECT_EQ(kernels_of_all_settings(gpu), kernels_there_are());
  EXPECT_EQ(staged.validation_messages(), 0);
}

}  // namespace
}  // namespace alcove
