// The memory that a frame is expected to take, before its pixels are read, is no less than what its buffers then take.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "core/frame/pixels/ramps.h"
#include "core/run/frame_files.h"
#include "core/run/frame_run.h"
#include "core/run/tiles.h"
#include "tests/support/device.h"
#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove::memory_test {
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
    write_plane(layer, "Z", std::vector<float>(window.pixels(), 9), window);
    settings.input.input = folder / "frame.exr";
    settings.input.camera = folder / "camera.json";
    settings.estimator.radius = 1;
    settings.output.output = folder / "ao.exr";
  }

  /// Bytes per pixel of all buffers.
  struct Bytes {
    double taken, expected;
  };
  Bytes bytes() const {
    gpu::Recorder gpu(device());
    FrameSource source = open_frame(settings, 0);
    const FrameMemory expected = memory_of(source, settings);
    FrameInputs inputs = load_frame(gpu, source, source.reading.data, settings, 0);
    if (takes_others(settings.input)) inputs.others = {from_beside(gpu, inputs)};
    const std::size_t of_others = takes_others(settings.input) ? 3 * sizeof(float) * window.pixels() : 0;
    run_chain(gpu, inputs, settings.estimator, settings.output);
    const std::size_t taken = gpu.bytes() - of_others;  // buffers are made while commands are recorded
    if (tried(number++, 4)) gpu.run();                  // fails where a kernel writes beside its buffers
    return {double(taken) / double(window.pixels()), double(expected.of(window).device) / double(window.pixels())};
  }

  mutable int number = 0;  // of the frame that was made last

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

  void expect_enough(const std::string& what) const {
    const auto [taken, expected] = bytes();
    EXPECT_LE(taken, expected) << what;
    EXPECT_GE(taken, 0.9 * expected) << what << ": so much is never used";
  }
  /// What changed takes at least so many floats more per pixel, and no more than is expected, which is rounded up to
  /// whole bytes per pixel.
  void expect_more_than(const Bytes& before, double floats) const {
    const auto [taken, expected] = bytes();
    EXPECT_GE(taken - before.taken, floats * sizeof(float));
    EXPECT_LE(taken - before.taken, expected - before.expected + 1);
  }

  const Window window{0, 0, 320, 180};
  TemporaryFolder folder;
  const std::string layer = folder / "layer.exr";
  Settings settings;
};

TEST_F(Memory, is_expected_of_every_estimator_search_and_resolution) {
  const std::pair<const char*, void (*)(EstimatorSettings&)> estimators[] = {
      {"steps", [](EstimatorSettings&) {}},
      {"volume", [](EstimatorSettings& e) { e.estimator = Estimator::crytek; }},
      {"exact", [](EstimatorSettings& e) { e.search = SliceSearch::exact; }},
      {"by error", [](EstimatorSettings& e) { e.search = SliceSearch::exact, e.tolerance = 0.03; }}};
  const Settings all = settings;
  int number = 0;
  for (const auto& [name, change] : estimators)
    for (const Resolution resolution : {Resolution::full, Resolution::half, Resolution::quarter})
      for (const char* aovs :
           {"ao", "ao,ao-scales", "ao,bent-normal", "ao,transfer", "ao,confidence,normal,depth,specular-occlusion"}) {
        if (!tried(number++, 2)) continue;
        SCOPED_TRACE(fmt::format("{}, resolution {}, {}", name, int(resolution), aovs));
        settings = all;
        change(settings.estimator);
        if (!searches_slices(settings.estimator) && std::string_view(aovs) == "ao,transfer") continue;
        settings.estimator.resolution = resolution;
        settings.output.aovs = aovs;
        expect_enough("filtered");
        settings.estimator.denoise = Denoise::none;
        settings.estimator.further_radii = {0.5, 2};
        if (settings.estimator.tolerance == 0) expect_enough("3 radii, no filter");
      }
}

TEST_F(Memory, is_expected_of_every_output) {
  settings.output.composite = folder / "composite.exr";
  expect_enough("composite");
  settings.output.multi_bounce = true;
  settings.output.ao_channels = AoChannels::rgb;
  expect_enough("multi-bounce");
  settings.input.material_ao_channel = "material";
  expect_enough("material AO");
  settings.output.debug = "tiles,raw-ao,denoised-ao,completed";
  expect_enough("debug views");
  settings.output.aovs = "ao,bent-normal,transfer,normal,depth,confidence,specular-occlusion,ao-scales";
  settings.estimator.resolution = Resolution::half;
  settings.estimator.power = 2;
  expect_enough("all at half the resolution");
}

TEST_F(Memory, is_expected_of_what_is_hidden) {
  const Bytes without = bytes();
  settings.input.behind = {layer, layer, layer};
  expect_more_than(without, 0);
  EXPECT_GE(bytes().expected - without.expected, 9 * sizeof(float))
      << "three planes as read, as many that were found, and what is kept of them";
  expect_enough("hidden surfaces");
  settings.output.aovs = "ao,hidden";
  expect_enough("their AOV");
  settings.estimator.resolution = Resolution::half;
  expect_enough("at half the resolution");
  settings.estimator.hidden = 0;
  settings.output.aovs = "ao";
  settings.estimator.resolution = Resolution::full;
  EXPECT_EQ(bytes().expected, without.expected) << "none is kept";
}

TEST_F(Memory, is_expected_of_what_tells_occluders_from_the_rest) {
  const std::string matte = folder / "matte.exr";
  write_plane(matte, "Y", std::vector<float>(window.pixels(), 1), window);
  const Bytes without = bytes();
  settings.input.ignore = matte;
  expect_more_than(without, 3);  // the matte as read and as made, and the depth of what may block
  settings.output.aovs = "ao,confidence";
  expect_enough("with the confidence");
  settings.input.behind = {layer};
  settings.estimator.resolution = Resolution::half;
  expect_enough("and at half the resolution, with hidden surfaces");
}

TEST_F(Memory, is_expected_of_what_is_filtered_to_a_smaller_picture) {
  settings.output.aovs = "ao,normal,confidence";
  const Bytes without = bytes();
  settings.input.supersampling = "2";
  expect_more_than(without, 5);
}

TEST_F(Memory, is_expected_of_what_others_show) {
  settings.input.around = 1;
  // Of the largest buffer it is that of all hidden surfaces with the margin.
  const std::uint64_t plane = sizeof(float) * std::uint64_t(320 + 2 * 40) * std::uint64_t(180 + 2 * 40);
  EXPECT_GE(memory_of(open_frame(settings, 0), settings).of(window).buffer, 3 * plane);
  settings.estimator.hidden = 0;
  expect_enough("in the margin alone");
  settings.estimator.hidden = 3;
  expect_enough("behind the first surface");
  settings.estimator.search = SliceSearch::exact;
  EXPECT_GE(memory_of(open_frame(settings, 0), settings).of(window).buffer, 5 * plane);
  settings.output.aovs = "ao,hidden,bent-normal,transfer,confidence,normal";
  expect_enough("in an exact search");
  settings.estimator.resolution = Resolution::half;
  expect_enough("at half the resolution");
  settings.estimator.resolution = Resolution::full;
  settings.input.behind = {layer};
  expect_enough("files too, and no margin then");
}

TEST_F(Memory, is_expected_of_what_completed_surfaces_take) {
  for (const Resolution resolution : {Resolution::full, Resolution::half}) {
    settings.output.stats = "";
    settings.estimator.complete = EstimatorSettings().complete;
    settings.estimator.resolution = resolution;
    const Bytes without = bytes();
    settings.output.stats = folder / "stats.json";
    EXPECT_GT(bytes().taken, without.taken);
    expect_more_than(without, 0);
    settings.estimator.complete = Completion::none;
    EXPECT_EQ(bytes().expected, without.expected) << "nothing is made";
  }
}

// The parts of a frame differ in size, and each takes the buffers of the one before.
TEST_F(Memory, of_parts_stays_within_any_limit_and_below_the_whole) {
  settings.estimator.radius = 0.05;
  const FrameMemory memory = memory_of(open_frame(settings, 0), settings);
  WindowLimits limits{memory, {.bytes = MemoryBudget::kEndless, .buffer_bytes = MemoryBudget::kEndless}};
  FrameSource first = open_frame(settings, 0);
  const auto [least, whole, parts, factor] = memory_needs(first, settings, limits);
  ASSERT_LT(least, whole);
  for (const double share : {0.95, 0.7, 0.4, 0.2, 0.0}) {
    gpu::Recorder gpu(device());
    FrameSource source = open_frame(settings, 0);
    ReadPlanes planes;
    read_for_parts(source, settings, planes, whole);
    Surroundings surroundings(source, settings, planes[RawPlane::depth]);
    limits.budget.bytes = least + std::uint64_t(share * double(whole - least));
    limits.kept = raw_bytes_of(source);
    std::uint64_t peak = 0;
    for (const auto& row : tiles_of(window, surroundings, limits, source))
      for (const auto& tile : row) {
        const Window computed = surroundings.around(tile);
        run_chain(gpu, load_frame(gpu, source, computed, settings, 0, &planes), settings.estimator, settings.output);
        peak = std::max<std::uint64_t>(peak, gpu.bytes() + memory.fixed_bytes + limits.kept);
        gpu.run();
      }
    EXPECT_LE(peak, limits.budget.bytes) << share;
    EXPECT_LT(peak, whole) << share;
  }
}

TEST_F(Memory, of_a_cut_of_ramps_counts) {
  const auto bytes = [&] { return memory_of(open_frame(settings, 0), settings).fixed_bytes; };
  const std::uint64_t kept = bytes();
  settings.input.ramps = "cut";
  EXPECT_EQ(bytes() - kept, kRampBytes * window.pixels());
}

// A look that shapes has a buffer that one without shaping does not have.
TEST_F(Memory, of_looks_is_that_of_the_one_that_takes_the_most) {
  RunPreview first(settings);
  first.prepare();
  InputIdentities identities(first.plan());
  Lanes lanes({"cpu", false, false, false}, 1);
  const auto report_within = [&](std::uint64_t device_bytes, std::vector<double> intensities) {
    RunContext run{first, first.plan(), identities, nullptr, nullptr, nullptr, false, {}};
    for (const double intensity : intensities) {
      run.looks.push_back(settings);
      run.looks.back().estimator.intensity = intensity;
    }
    run.take_look = [](std::size_t, FrameSource&, const Window&, const FrameOutputs&, const LookTime&) {};
    const MemoryBudget budget{
        .bytes = MemoryBudget::kEndless, .device_bytes = device_bytes, .buffer_bytes = MemoryBudget::kEndless};
    return run_frame(lanes, run, budget, 0, [](int, int, double) {});
  };
  const std::uint64_t unshaped = memory_of(open_frame(settings, 0), settings).of(window).device;
  EXPECT_EQ(report_within(unshaped, {1, 1}).state, FrameState::done);
  const FrameReport refused = report_within(unshaped, {1, 2});
  ASSERT_TRUE(refused.error);
  EXPECT_THAT(refused.error->what(), HasSubstr("a wedge needs it whole"));
  EXPECT_EQ(report_within(unshaped + 2 * sizeof(float) * window.pixels(), {1, 2}).state, FrameState::done);
}

}  // namespace
}  // namespace alcove::memory_test
