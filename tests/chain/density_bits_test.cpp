// An adaptive density changes no bit by what part of a picture is computed, how, or after what.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "cli/options.h"
#include "core/formats/exr.h"
#include "core/run/batch.h"
#include "core/run/frame_run.h"
#include "tests/support/device.h"
#include "tests/support/difference.h"
#include "tests/support/sequence_folder.h"
#include "tests/support/single_pass.h"

namespace alcove {
namespace {

using namespace test;

EstimatorSettings adaptive(double radius, int spacing = 16) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.stride = spacing;
  return settings;
}

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

/// A room with strands a pixel wide before it, so that all lattices have sites.
HostFrame hairy_room(int width, int height) {
  HostFrame frame = furnished_room(width, height).frame;
  std::mt19937 random(3);
  for (int strand = 0; strand < 14; strand++) {
    const double slope = double(random() % 400) / 100 - 2, x0 = random() % unsigned(width);
    const auto top = int(random() % unsigned(height)), bottom = std::min(height, top + 10 + int(random() % 40));
    for (int y = top; y < bottom; y++) {
      const int x = int(std::floor(x0 + slope * (y - top)));
      if (x >= 0 && x < width) frame.depth[std::size_t(y * width + x)] *= 0.93f;
    }
  }
  return frame;
}

HostFrame cropped_frame(const HostFrame& whole, const Window& window) {
  HostFrame crop = whole;
  crop.data = window;
  crop.depth = cropped(whole.depth, whole.data, window);
  crop.normal = cropped(whole.normal, whole.data, window);
  return crop;
}

// The farthest that anything reaches: 11 px of the radius, 8 of the filter, 13 of the choice of sites.
TEST(Density, of_a_crop_is_that_of_the_whole) {
  constexpr int kReach = 11 + 8 + 13;
  const HostFrame whole = hairy_room(180, 140);
  for (const int spacing : {16, 8, 4, 2}) {
    EstimatorSettings settings = adaptive(0.1, spacing);
    const std::vector<float> expected = ao_of(whole, settings);
    for (const Window& window : {Window{5, 3, 170, 130}, {26, 17, 121, 119}, {40, 34, 125, 101}}) {
      const std::vector<float> ao = ao_of(cropped_frame(whole, window), settings);
      int darkened = 0;
      for (int y = kReach; y < window.height - kReach; y++)
        for (int x = kReach; x < window.width - kReach; x++) {
          const float value = ao[std::size_t(y * window.width + x)];
          ASSERT_EQ(value, expected[std::size_t((y + window.y) * 180 + x + window.x)])
              << "spacing " << spacing << ", pixel " << x << " " << y << " of the crop at " << window.x;
          darkened += value < 0.98;
        }
      EXPECT_GT(darkened, 150);
    }
  }
}

TEST(Density, skips_without_a_bit_of_difference) {
  HostFrame frame = hairy_room(180, 140);
  std::fill_n(frame.depth.begin(), 45 * 180 + 77, kSky);
  for (const int spacing : {16, 4})
    for (const Completion complete : {Completion::none, Completion::border, Completion::all})
      for (const double radius : {0.02, 0.1})
        for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask}) {
          EstimatorSettings settings = adaptive(radius, spacing);
          settings.estimator = estimator;
          settings.complete = complete;
          settings.denoise_radius = 8;
          // Sites that were left out by mistake would hold what was there before.
          const std::size_t bytes = frame.depth.size() * sizeof(float);
          std::ranges::fill(recorder().buffer("ao", bytes, gpu::Use::device).as<float>(), 0.5f);
          const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings);
          recorder().run();
          EXPECT_GT(outputs.tiles->as<TileCounts>()[0].sky, 100u);
          const auto skipped = outputs.ao->as<float>();
          const std::vector<float> ao(skipped.begin(), skipped.end());
          settings.no_skip = true;
          EXPECT_TRUE(same_bits(ao_of(frame, settings), ao))
              << "spacing " << spacing << " completes " << int(complete) << " radius " << radius;
        }
}

TEST(Density, gives_the_same_bits_again) {
  const HostFrame frame = hairy_room(180, 140);
  const std::vector<float> first = ao_of(frame, adaptive(0.5));
  const HostFrame other = furnished_room(97, 61).frame;
  ao_of(other, adaptive(0.2, 4));
  EXPECT_TRUE(same_bits(ao_of(frame, adaptive(0.5)), first));
  gpu::Recorder fresh(device());
  EXPECT_TRUE(same_bits(compute_ao(fresh, frame, adaptive(0.5)).ao, first));
}

/// The next frame of a lane, and how many of its tiles were kept.
std::pair<std::vector<float>, std::uint32_t> next_of(Lane& lane, const HostFrame& frame,
                                                     const EstimatorSettings& settings) {
  FrameInputs inputs = upload(lane.gpu, frame);
  const bool is_same = lane.last.is_same(lane.gpu, inputs, settings);
  const FrameOutputs outputs = is_same ? lane.last.outputs() : run_chain(lane.gpu, inputs, settings);
  if (!is_same) lane.gpu.run();
  lane.last.keep(outputs);
  const auto ao = outputs.ao->as<float>();
  return {{ao.begin(), ao.end()}, is_same ? 0 : outputs.tiles->as<TileCounts>()[0].kept};
}

/// Something small comes or goes in a frame: next to the border of a block of 32 pixels, or anywhere.
void change(HostFrame& frame, std::mt19937& random) {
  const auto whole = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  const auto place = [&](int size) {
    return whole(0, 1) ? whole(0, size - 1) : std::min(size - 1, 32 * whole(0, size / 32) + whole(-2, 1) + 2);
  };
  const int width = frame.data.width, height = frame.data.height;
  const int x0 = place(width), y0 = place(height), kind = whole(0, 3);
  const int x1 = std::min(width, x0 + whole(1, 6)), y1 = std::min(height, y0 + whole(1, 6));
  const std::size_t pixels = frame.depth.size();
  for (int y = y0; y < y1; y++)
    for (int x = x0; x < x1; x++) {
      const auto i = std::size_t(y * width + x);
      if (kind == 0) frame.depth[i] *= 0.9f;
      if (kind == 1) frame.depth[i] = 2e9f;
      if (kind == 2) frame.normal[i] += 0.5f;
      if (kind == 3) frame.depth[i] = frame.depth[std::size_t((y * 7 + x) % int(pixels))];
    }
}

TEST(Density, of_kept_tiles_is_that_of_a_fresh_run) {
  std::mt19937 random(99);
  std::uint64_t kept = 0;
  int frames = 0;
  for (int scene = 0; scene < 7 && !HasFailure(); scene++) {
    EstimatorSettings settings = adaptive(scene % 2 ? 0.02 : 0.05, 16 >> (scene % 3));
    settings.estimator = scene == 3 ? Estimator::bitmask : Estimator::gtao;
    settings.slices = 1;
    settings.steps = 4;
    // At a quarter of the resolution the choice of sites reaches farther than a block of changes.
    const bool is_quarter = scene >= 5;
    if (is_quarter) settings.resolution = Resolution::quarter;
    HostFrame frame = is_quarter ? hairy_room(640, 480) : hairy_room(250, 190);
    Lane lane(device());
    for (int i = 0; i < 25 && !HasFailure(); i++) {
      if (i > 0) change(frame, random);
      frame.frame = i;
      const auto [ao, tiles] = next_of(lane, frame, settings);
      EXPECT_TRUE(same_bits(ao, ao_of(frame, settings))) << "scene " << scene << " frame " << i;
      kept += tiles;
      frames++;
    }
  }
  EXPECT_GT(kept, std::uint64_t(frames) * 150) << "tiles";
}

TEST(Density, of_a_still_scene_does_not_flicker) {
  HostFrame frame = hairy_room(180, 140);
  frame.frame = 1;
  const std::vector<float> first = ao_of(frame, adaptive(0.5));
  frame.frame = 2;
  EXPECT_TRUE(same_bits(ao_of(frame, adaptive(0.5)), first));
  EstimatorSettings animated = adaptive(0.5);
  animated.noise = Noise::animated;
  EXPECT_FALSE(same_bits(ao_of(frame, animated), first));
}

/// A sequence of frames in files, with blocks of a few pixels that move from frame to frame.
class DensityOfFiles : public SequenceFolder {
 protected:
  DensityOfFiles() {
    for (int frame = 1; frame <= 5; frame++) {
      FrameFile file = wall_frame(data, display);
      std::vector<float>& depth = file.planes.at("ViewLayer.Depth.Z");
      for (std::size_t i = 0; i < depth.size(); i++) {
        const std::size_t x = i % std::size_t(data.width), y = i / std::size_t(data.width);
        // Blocks of 5 x 4 pixels at five heights, and slanting lines.
        if (x > 40 && x < 150) depth[i] -= 0.015f * float((7 * (x / 5) + 13 * (y / 4)) % 5);
        if ((x + y / 2 + std::size_t(frame >= 4 ? frame : 0)) % 37 == 0) depth[i] -= 0.1f;
      }
      file.write(input(frame));
    }
    write_bytes(camera, wall_camera(display).dump());
  }

  /// The files of a run with these options; the same files must come of any other.
  std::map<std::string, std::string> made(std::vector<std::string> options) const {
    remove_outputs();
    options.insert(options.end(), {"--radius", "0.2", "--type", "float"});
    const Finished finished = run(options);
    EXPECT_EQ(finished.code, 0) << finished;
    return outputs();
  }

  const Window data{-3, -2, 227, 141}, display{0, 0, 220, 137};
};

TEST_F(DensityOfFiles, is_the_same_with_any_threads_chunks_and_reuse) {
  const auto expected = made({"--threads", "1"});
  ASSERT_EQ(expected.size(), 5u);
  EXPECT_EQ(made({"--threads", "2"}), expected);
  EXPECT_EQ(made({"--no-skip"}), expected);
  const auto first = made({"--chunk", "1/2"}), second = made({"--chunk", "2/2"});
  auto both = first;
  both.insert(second.begin(), second.end());
  EXPECT_LT(first.size(), 5u);
  EXPECT_EQ(both, expected);
  EXPECT_TRUE(std::ranges::equal(read_exr_image(input(1)).pixels, read_exr_image(input(2)).pixels));
}

TEST_F(DensityOfFiles, of_a_region_is_that_of_the_whole) {
  made({"--frames", "1"});
  const Image whole = read_exr_image(output(1));
  for (const Window& region : {Window{61, 33, 50, 41}, {0, 0, 33, 29}, {150, 90, 70, 47}}) {
    made({"--frames", "1", "--roi", fmt::format("{},{},{},{}", region.x, region.y, region.width, region.height)});
    const Image part = read_exr_image(output(1));
    EXPECT_EQ(part.data, region);
    // The optical axis is counted from another pixel, so floats may round otherwise; another site would be far more.
    const Difference d = difference(part.pixels, cropped(whole.pixels, whole.data, region));
    EXPECT_LE(d.max, 1e-6) << "region at " << region.x << ", pixel " << d.worst % std::size_t(region.width) << " "
                           << d.worst / std::size_t(region.width);
  }
}

/// `alcove run` on a frame within this process, with so little memory that it takes tiles; none: as much as there is.
RunReport run_with(const std::vector<std::string>& arguments, std::uint64_t bytes) {
  ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  RunOptions options;
  EXPECT_TRUE(parse_run_options(arguments, options));
  if (bytes) options.settings.device.memory = 1;
  if (bytes) options.settings.device.least_memory = bytes;
  return run_frames(options.settings);
}

TEST_F(DensityOfFiles, in_tiles_is_that_of_the_whole) {
  std::vector<std::string> arguments{
      input(1), "-o",    output(1), "--camera",       camera,    "--radius",           "0.1",
      "--type", "float", "--set",   "overwrite=true", "--stats", folder / "stats.json"};
  if (const char* device = std::getenv("ALCOVE_TEST_DEVICE"); device && *device)
    arguments.insert(arguments.end(), {"--device", device});
  ASSERT_EQ(run_with(arguments, 0).done, 1);
  const std::string whole = read_bytes(output(1));
  RunReport report = run_with(arguments, 1 << 18);
  for (std::uint64_t bytes = 1 << 18; report.done != 1 && bytes < (8u << 20); bytes += bytes / 4)
    report = run_with(arguments, bytes);
  ASSERT_EQ(report.done, 1);
  EXPECT_GT(report.frames[0].parts, 1);
  EXPECT_TRUE(read_bytes(output(1)) == whole);
}

}  // namespace
}  // namespace alcove
