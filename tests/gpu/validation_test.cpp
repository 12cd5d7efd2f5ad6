// Every kernel once under the Vulkan validation layer, which checks their synchronization too: tests/CMakeLists.txt
// asks it to.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/chain.h"
#include "core/chain/compute.h"
#include "core/chain/hidden/hidden.h"
#include "tests/support/chain.h"
#include "tests/support/device.h"

namespace alcove::validation_test {
namespace {

using namespace test;

const HostFrame& room() {
  static const HostFrame frame = furnished_room(70, 45).frame;
  return frame;
}

/// Runs what is recorded, and adds the kernels that it took. Nothing is compared: other tests do.
void run(gpu::Recorder& gpu, std::set<std::string>& kernels) {
  gpu.run();
  for (const auto& pass : gpu.passes()) kernels.insert(pass.name);
}

gpu::Buffer& halves(gpu::Recorder& gpu, const char* name, std::size_t count) {
  gpu::Buffer& buffer = gpu.buffer(name, count * sizeof(float), gpu::Use::upload);
  std::ranges::fill(buffer.as<float>(), 0.5f);
  return buffer;
}

/// A small room in light.
void run_chain_of(gpu::Recorder& gpu, std::set<std::string>& kernels, const EstimatorSettings& settings,
                  const OutputSettings& output, bool has_normals = true) {
  HostFrame frame = room();
  if (!has_normals) frame.normal.clear();
  FrameInputs inputs = upload(gpu, frame);
  if (output.aovs.find("shadow") != std::string::npos)
    inputs.lights = {{.at = {0.3, 0.5, 0.8}}, {.is_lamp = true, .at = {0, 0, -1}, .size = 0.1}};
  if (!output.composite.empty()) {
    inputs.supersampling = 2;
    for (const auto& row : kRawPlanes)
      if (!inputs[row.plane]) inputs[row.plane] = &halves(gpu, row.name, row.most * frame.data.pixels());
    inputs.behind.assign(kMostBehindPlanes, {inputs.depth_map.form, BehindKind::surfaces, inputs.prepare.depth});
  }
  run_chain(gpu, inputs, settings, output);
  run(gpu, kernels);
}

/// The same of a room that another frame of it sees, from where it stands, with a margin for what that shows.
void run_views(gpu::Recorder& gpu, std::set<std::string>& kernels, const EstimatorSettings& settings) {
  FrameInputs other = upload(gpu, room());
  const GBuffer seen = prepare(gpu, other, "other ");
  OtherView view;
  view.view = seen.view;
  view.to_here = {{{1, 0, 0, 0.1f}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  view.depth_precision = seen.depth_precision;
  view.depth = seen.depth;
  view.normal = seen.normal;
  gpu::Buffer& moving = gpu.buffer("moving", seen.depth->bytes(), gpu::Use::device);
  surfels(gpu, view, std::array{view}, moving);
  run(gpu, kernels);
  view.moving = &moving;
  FrameInputs inputs = upload(gpu, room());
  inputs.others = {view};
  inputs.margin = {{8, 8}, {8, 8}};
  run_chain(gpu, inputs, settings);
  run(gpu, kernels);
}

/// The same of a room whose AO is the mean of its own estimate and of another frame's, from beside it.
void run_means(gpu::Recorder& gpu, std::set<std::string>& kernels, const EstimatorSettings& settings) {
  FrameInputs inputs = upload(gpu, room());
  const std::size_t pixels = room().data.pixels();
  const auto filled = [&](const char* name, std::size_t words) {
    gpu::Buffer& buffer = halves(gpu, name, words);
    std::ranges::copy(room().depth, buffer.as<float>().begin());
    return &buffer;
  };
  gpu::Buffer& table = gpu.buffer("estimated frames", sizeof(NeighbourFrame), gpu::Use::upload);
  table.as<NeighbourFrame>()[0] = {inputs.view, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1f, 0, 0}, {1e-4f, 1e-5f, 0}, 0};
  EstimateSet& estimates = inputs.estimates;
  estimates.depth = filled("own depth", pixels);
  estimates.normal = filled("own normal", pixels);
  estimates.values = filled("own values", pixels);
  estimates.view = inputs.view;
  estimates.has_moving = true;
  estimates.groups = {{filled("estimates", 2 * pixels), &table, 1}};
  run_chain(gpu, inputs, settings);
  run(gpu, kernels);
}

EstimatorSettings few_samples() {
  EstimatorSettings settings;
  settings.radius = 0.4;
  settings.slices = 3, settings.steps = 16, settings.samples = 64;
  return settings;
}

OutputSettings everything() {
  OutputSettings output;
  output.aovs = "ao,ao-scales,normal,bent-normal,transfer,depth,specular-occlusion,confidence,hidden,curvature,shadow";
  output.composite = "composite.exr";
  output.multi_bounce = true;
  output.look.fog_density = 0.1;
  for (const auto& view : debug_view_names()) output.debug += (output.debug.empty() ? "" : ",") + view;
  return output;
}

OutputSettings only(const std::string& aovs) {
  OutputSettings output;
  output.aovs = aovs;
  return output;
}

std::set<std::string> kernels_of_all_settings(gpu::Recorder& gpu) {
  std::set<std::string> kernels;
  EstimatorSettings settings = few_samples();
  run_chain_of(gpu, kernels, settings, {}, false);
  run_views(gpu, kernels, settings);
  run_means(gpu, kernels, settings);
  settings.search = SliceSearch::quick;
  OutputSettings density;
  density.debug = "density";
  run_chain_of(gpu, kernels, settings, density, false);
  settings.search = SliceSearch::steps;
  settings.denoise_radius = 5;
  run_chain_of(gpu, kernels, settings, only("ao,shadow"));
  settings.denoise_radius = 0;
  settings.power = 1.5;
  run_chain_of(gpu, kernels, settings, everything());
  settings.further_radii = {0.1};
  run_chain_of(gpu, kernels, settings, everything());
  settings.resolution = Resolution::half;
  run_chain_of(gpu, kernels, settings, everything());
  settings.further_radii.clear();
  settings.steps = 64;
  run_chain_of(gpu, kernels, settings, everything());  // lists for upsampling
  settings.resolution = Resolution::full;
  for (const auto estimator : {Estimator::bitmask, Estimator::hbao, Estimator::crytek}) {
    settings.estimator = estimator;
    run_chain_of(gpu, kernels, settings, {});
  }
  settings.estimator = Estimator::gtao;
  settings.search = SliceSearch::exact;
  settings.slices = 2;
  run_chain_of(gpu, kernels, settings, only("ao,bent-normal"));
  settings.tolerance = 0.05;
  run_chain_of(gpu, kernels, settings, only("ao,error,bent-normal"));
  return kernels;
}

std::set<std::string> kernels_there_are() {
  std::set<std::string> names{"horizon_layers", "shadow_layers"};  // made of horizon.comp and shadow.comp
  for (const auto& entry : std::filesystem::recursive_directory_iterator(ALCOVE_SOURCE_DIR "/kernels"))
    if (entry.path().extension() == ".comp") names.insert(entry.path().stem().string());
  return names;
}

TEST(Validation, is_silent_about_every_kernel) {
  ASSERT_TRUE(device().options().validate) << "ALCOVE_TEST_VALIDATE is not set";
  ASSERT_TRUE(std::getenv("VK_LAYER_ENABLES") || std::getenv("VK_LAYER_SETTINGS_PATH"))
      << "nobody checks synchronization";
  EXPECT_EQ(kernels_of_all_settings(recorder()), kernels_there_are());
  EXPECT_EQ(device().validation_messages(), 0);
}

TEST(Validation, is_silent_about_copies) {
  gpu::DeviceOptions options = device().options();
  options.map_memory = false;
  options.guard_bytes = 0;
  gpu::Device staged(options);
  gpu::Recorder gpu(staged);
  std::set<std::string> kernels;  // other ones copy as these do
  run_chain_of(gpu, kernels, few_samples(), everything());
  run_views(gpu, kernels, few_samples());
  run_means(gpu, kernels, few_samples());
  EstimatorSettings exact = few_samples();
  exact.tolerance = 0.05;
  run_chain_of(gpu, kernels, exact, only("ao,error,bent-normal"));
  EXPECT_GT(kernels.size(), 30u);
  EXPECT_EQ(staged.validation_messages(), 0);
}

}  // namespace
}  // namespace alcove::validation_test
