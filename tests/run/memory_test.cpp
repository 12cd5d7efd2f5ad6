// The memory that a frame is expected to take, before its pixels are read, is no less than what its buffers then take.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/run/frame_files.h"
#include "core/run/shot.h"
#include "core/run/tiles.h"
#include "tests/support/device.h"
#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove {
namespace {

using namespace test;

class Memory : public testing::Test {
 protected:
  Memory() {
    FrameFile frame = wall_frame(window, window);
    add_beauty(frame);
    frame.planes["material"] = std::vector<float>(window.pixels(), 0.5f);
    frame.write(folder / "frame.exr");
    write_bytes(folder / "camera.json", wall_camera(window).dump());
    all.input.input = folder / "frame.exr";
    all.input.camera = folder / "camera.json";
    all.estimator.radius = 1;
    all.output.output = folder / "ao.exr";
  }

  /// Bytes per pixel of all buffers.
  struct Bytes {
    double taken, expected;
  };
  Bytes bytes_of(const Settings& settings) const {
    gpu::Recorder gpu(device());
    FrameSource source = open_frame(settings, 0);
    const FrameMemory expected = memory_of(source, settings);
    FrameInputs inputs = load_frame(gpu, source, settings, 0);
    if (takes_others(settings.input)) inputs.others = {from_beside(gpu, inputs)};
    const std::size_t of_others = takes_others(settings.input) ? 3 * sizeof(float) * window.pixels() : 0;
    run_chain(gpu, inputs, settings.estimator, settings.output);
    gpu.run();
    return {double(gpu.bytes() - of_others) / double(window.pixels()),
            double(expected.of(window).device) / double(window.pixels())};
  }

  /// A camera a step to the right that sees a wall where this frame shows none.
  OtherView from_beside(gpu::Recorder& gpu, const FrameInputs& inputs) const {
    const auto plane = [&](const char* name) -> gpu::Buffer& {
      return gpu.buffer(name, sizeof(float) * window.pixels(), gpu::Use::upload);
    };
    OtherView other;
    other.view = inputs.view;
    other.to_here = {{{1, 0, 0, 0.5f}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    std::ranges::fill(plane("other depth").as<float>(), 9.0f);
    std::ranges::fill(plane("other normal").as<std::uint32_t>(), 0u);
    std::ranges::fill(plane("other moving").as<std::uint32_t>(), 0u);
    other.depth = &plane("other depth");
    other.normal = &plane("other normal");
    other.moving = &plane("other moving");
    return other;
  }

  void expect_enough(const Settings& settings, const std::string& what) const {
    const Bytes bytes = bytes_of(settings);
    EXPECT_LE(bytes.taken, bytes.expected) << what;
    EXPECT_GE(bytes.taken, 0.9 * bytes.expected) << what << ": so much is never used";
  }

  const Window window{0, 0, 320, 180};
  TemporaryFolder folder;
  Settings all;
};

TEST_F(Memory, is_expected_of_every_estimator_search_and_resolution) {
  const std::vector<std::pair<const char*, std::function<void(EstimatorSettings&)>>> estimators{
      {"steps", [](auto&) {}},
      {"volume", [](auto& e) { e.estimator = Estimator::crytek; }},
      {"exact", [](auto& e) { e.search = SliceSearch::exact; }},
      {"by error", [](auto& e) { e.search = SliceSearch::exact, e.tolerance = 0.03; }}};
  for (const auto& [name, change] : estimators)
    for (const Resolution resolution : {Resolution::full, Resolution::half, Resolution::quarter})
      for (const char* aovs :
           {"ao", "ao,ao-scales", "ao,bent-normal", "ao,confidence,normal,depth,specular-occlusion"}) {
        Settings settings = all;
        change(settings.estimator);
        settings.estimator.resolution = resolution;
        settings.output.aovs = aovs;
        expect_enough(settings, fmt::format("{}, resolution {}, {}", name, int(resolution), aovs));
        settings.estimator.denoise = Denoise::none;
        settings.estimator.further_radii = {0.5, 2};
        if (settings.estimator.tolerance == 0)
          expect_enough(settings,
                        fmt::format("{}, resolution {}, {}, 3 radii, no filter", name, int(resolution), aovs));
      }
}

TEST_F(Memory, is_expected_of_every_output) {
  Settings settings = all;
  settings.output.composite = folder / "composite.exr";
  expect_enough(settings, "composite");
  settings.output.multi_bounce = true;
  settings.output.ao_channels = AoChannels::rgb;
  expect_enough(settings, "multi-bounce");
  settings.input.material_ao_channel = "material";
  expect_enough(settings, "material AO");
  settings.output.debug = "tiles,raw-ao,denoised-ao,completed";
  expect_enough(settings, "debug views");
  settings.output.aovs = "ao,bent-normal,normal,depth,confidence,specular-occlusion,ao-scales";
  settings.estimator.resolution = Resolution::half;
  settings.estimator.power = 2;
  expect_enough(settings, "all at half the resolution");
}

TEST_F(Memory, is_expected_of_what_is_hidden) {
  Settings settings = all;
  const Bytes without = bytes_of(settings);
  FrameFile layer{window, window, 1, {}, {}, {}};
  layer.planes["Z"] = std::vector<float>(window.pixels(), 9);
  layer.write(folder / "layer.exr");
  settings.input.behind = {folder / "layer.exr", folder / "layer.exr", folder / "layer.exr"};
  const Bytes with = bytes_of(settings);
  // three planes as read, as many that were found, and what is kept of them
  EXPECT_LE(with.taken - without.taken, with.expected - without.expected + 1);
  EXPECT_GE(with.expected - without.expected, 9 * sizeof(float));
  expect_enough(settings, "hidden surfaces");
  settings.output.aovs = "ao,hidden";
  expect_enough(settings, "their AOV");
  settings.estimator.resolution = Resolution::half;
  expect_enough(settings, "at half the resolution");
  settings.estimator.hidden = 0;
  settings.output.aovs = "ao";
  settings.estimator.resolution = Resolution::full;
  EXPECT_EQ(bytes_of(settings).expected, without.expected) << "none is kept";
}

TEST_F(Memory, is_expected_of_what_tells_occluders_from_the_rest) {
  Settings settings = all;
  FrameFile{window, window, 1, {{"Y", std::vector<float>(window.pixels(), 1)}}, {}, {}}.write(folder / "matte.exr");
  FrameFile{window, window, 1, {{"Z", std::vector<float>(window.pixels(), 9)}}, {}, {}}.write(folder / "layer.exr");
  const Bytes without = bytes_of(settings);
  settings.input.ignore = folder / "matte.exr";
  const Bytes with = bytes_of(settings);
  // the matte as read and as made, and the depth of what may block
  EXPECT_GE(with.taken - without.taken, 3 * sizeof(float));
  EXPECT_LE(with.taken - without.taken, with.expected - without.expected + 1);
  settings.output.aovs = "ao,confidence";
  expect_enough(settings, "with the confidence");
  settings.input.behind = {folder / "layer.exr"};
  settings.estimator.resolution = Resolution::half;
  expect_enough(settings, "and at half the resolution, with hidden surfaces");
}

TEST_F(Memory, is_expected_of_what_is_filtered_to_a_smaller_picture) {
  Settings settings = all;
  settings.output.aovs = "ao,normal,confidence";
  const Bytes without = bytes_of(settings);
  settings.input.supersampling = "2";
  const Bytes with = bytes_of(settings);
  EXPECT_GE(with.taken - without.taken, 5 * sizeof(float));
  EXPECT_LE(with.taken - without.taken, with.expected - without.expected + 1);
}

TEST_F(Memory, is_expected_of_what_others_show) {
  Settings settings = all;
  settings.input.around = 1;
  settings.estimator.hidden = 0;
  expect_enough(settings, "in the margin alone");
  settings.estimator.hidden = 3;
  expect_enough(settings, "behind the first surface");
  settings.estimator.search = SliceSearch::exact;
  settings.output.aovs = "ao,hidden,bent-normal,confidence,normal";
  expect_enough(settings, "in an exact search");
  settings.estimator.resolution = Resolution::half;
  expect_enough(settings, "at half the resolution");
  settings.estimator.resolution = Resolution::full;
  FrameFile layer{window, window, 1, {}, {}, {}};
  layer.planes["Z"] = std::vector<float>(window.pixels(), 9);
  layer.write(folder / "layer.exr");
  settings.input.behind = {folder / "layer.exr"};
  expect_enough(settings, "files too, and no margin then");
}

TEST_F(Memory, of_the_largest_buffer_is_that_of_all_hidden_surfaces_with_the_margin) {
  Settings settings = all;
  settings.input.around = 1;
  const FrameMemory steps = memory_of(open_frame(settings, 0), settings);
  const std::uint64_t plane = sizeof(float) * std::uint64_t(320 + 2 * 40) * std::uint64_t(180 + 2 * 40);
  EXPECT_GE(steps.of(window).buffer, 3 * plane);
  settings.estimator.search = SliceSearch::exact;
  EXPECT_GE(memory_of(open_frame(settings, 0), settings).of(window).buffer, 5 * plane);
}

TEST_F(Memory, is_expected_of_what_completed_surfaces_take) {
  for (const Resolution resolution : {Resolution::full, Resolution::half}) {
    Settings settings = all;
    settings.estimator.resolution = resolution;
    const Bytes without = bytes_of(settings);
    settings.output.stats = folder / "stats.json";
    const Bytes with = bytes_of(settings);
    EXPECT_GT(with.taken, without.taken);
    // What is expected is rounded up to whole bytes per pixel.
    EXPECT_LE(with.taken - without.taken, with.expected - without.expected + 1) << int(resolution);
    settings.estimator.complete = Completion::none;
    EXPECT_EQ(bytes_of(settings).expected, without.expected) << "nothing is made";
  }
}

}  // namespace
}  // namespace alcove
