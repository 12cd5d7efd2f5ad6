// Whatever the numbers: every estimator, preset and resolution gives an AO from 0 to 1, 1 on sky, the same with and
// without skipping, and writes nothing else.
// SPDX-License-Identifier: BSD-3-Clause
//
// ALCOVE_STABILITY_DRAWS=N takes N random draws of all axes at once instead of a round; ALCOVE_STABILITY_SEED=S, the
// number of the first, repeats those of a run. Both are printed.

#include <iostream>

#include "core/chain/compute.h"
#include "tests/bench/stability/cases.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace alcove::grid_test {
namespace {

using namespace test;

/// The AO that the chain makes of a frame.
std::vector<float> run(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

/// What is wrong with the AO of a case, or "".
std::string complaint(const Case& made, const std::vector<float>& skipped, const std::vector<float>& whole) {
  for (std::size_t i = 0; i < skipped.size(); i++)
    if (!(skipped[i] >= 0 && skipped[i] <= 1) || (made.sky[i] && skipped[i] != 1))
      return fmt::format("AO {} at pixel {}{}", skipped[i], i, made.sky[i] ? ", which is sky" : "");
  const Difference d = difference(skipped, whole);
  return same_bits(skipped, whole) ? "" : fmt::format("skipping changes pixel {} by {}", d.worst, d.max);
}

void expect_sound(const Spec& spec, const std::vector<Variant>& variants) {
  const Case made = test::made(spec);
  for (const auto& variant : variants) {
    EstimatorSettings settings = with_radius(variant.settings, made.radius);
    const std::vector<float> skipped = run(made.frame, settings);
    settings.no_skip = true;
    EXPECT_EQ(complaint(made, skipped, run(made.frame, settings)), "") << variant.name << ": " << to_string(spec);
  }
}

/// Those of all variants whose turn it is at the number-th frame: one of every `parts`, and in the long form all. Over
/// the frames of a test each variant is met several times.
std::vector<Variant> variants_in_turn(const std::vector<Variant>& all, int number, int parts = 7) {
  std::vector<Variant> chosen;
  for (std::size_t i = 0; i < all.size(); i++)
    if (tried(number + int(i), parts)) chosen.push_back(all[i]);
  return chosen;
}

TEST(Grid, every_axis_by_itself) {
  const auto all = variants();
  int number = 0;
  for (const Spec& spec : sweeps()) expect_sound(spec, variants_in_turn(all, number++));
}

// The frames of the other tests are a few tiles large.
TEST(Grid, frames_of_many_tiles) {
  const std::vector<Spec> specs{{},
                                {.scale = 1e-15},
                                {.scale = 1e15},
                                {.range = 1e4},
                                {.fov = 0},
                                {.fov = 5},
                                {.fov = 150},
                                {.shift = 1},
                                {.aspect = 0.25},
                                {.radius = 0.01},
                                {.radius = 1},
                                {.radius = 1e4},
                                {.normals = NormalDefect::missing},
                                {.normals = NormalDefect::random},
                                {.depth = DepthDefect::any_bits},
                                {.storage = Storage::half_float},
                                {.storage = Storage::bits_16},
                                {.fov = 0, .storage = Storage::bits_24_reversed},
                                {.place = Place::corner},
                                {.fov = 0, .place = Place::corner}};
  const auto all = estimators();
  int number = 0;
  for (Spec spec : specs) {
    spec.width = 160;
    spec.height = 120;
    expect_sound(spec, variants_in_turn(all, number++, 2));
  }
}

TEST(Grid, all_axes_at_once) {
  const char *draws = std::getenv("ALCOVE_STABILITY_DRAWS"), *seed = std::getenv("ALCOVE_STABILITY_SEED");
  const unsigned first = seed ? unsigned(std::strtoul(seed, nullptr, 10)) : draws ? std::random_device()() : 0;
  const int count = draws ? std::atoi(draws) : int(kRound);
  if (draws) std::cout << "ALCOVE_STABILITY_DRAWS=" << count << " ALCOVE_STABILITY_SEED=" << first << std::endl;
  const auto all = variants();
  for (int i = 0; i < count; i++) {
    expect_sound(drawn(first + unsigned(i)), draws ? all : variants_in_turn(all, i));
    if (HasFailure()) FAIL() << "repeat with ALCOVE_STABILITY_DRAWS=1 ALCOVE_STABILITY_SEED=" << first + unsigned(i);
  }
}

// The near plane's own value is sky; a third of the depths are next to it, the others before the far plane.
TEST(Grid, what_is_next_to_the_near_plane_is_a_surface) {
  for (const Storage storage : {Storage::bits_16, Storage::bits_16_reversed, Storage::bits_24,
                                Storage::bits_24_reversed, Storage::device_reversed}) {
    const Case made = test::made({.range = 50, .depth = DepthDefect::near_plane, .storage = storage});
    const float at_near = made.frame.depth_range.reversed ? 1 : 0,
                next = std::abs(*std::ranges::min_element(made.frame.depth, {}, [&](float x) {
                  return std::abs(x - at_near);
                }) - at_near);
    EXPECT_TRUE(next > 0 && next < 2e-5) << next;
    EXPECT_EQ(compute_ao(recorder(), made.frame, with_radius(plain_settings(), made.radius)).sky_pixels, 0u)
        << int(storage);
  }
}

// The recorder of all tests has NaN beside every buffer, and in it until it is written: see DeviceOptions::guard_bytes.
TEST(Grid, what_lies_beside_buffers_and_in_new_ones_changes_no_bit) {
  gpu::DeviceOptions options = device().options();
  options.guard_bytes = 0;
  gpu::Device plain(options);
  gpu::Recorder unguarded(plain);
  const auto all = variants();
  for (const auto& [width, height] : {std::pair{1, 1}, {37, 1}, {3, 5}, {47, 43}})
    for (const auto& variant : all) {
      const Case made = test::made({.width = width, .height = height});
      const EstimatorSettings settings = with_radius(variant.settings, made.radius);
      const std::vector<float> ao = compute_ao(recorder(), made.frame, settings).ao;
      EXPECT_TRUE(same_bits(ao, compute_ao(unguarded, made.frame, settings).ao))
          << variant.name << " " << width << "x" << height;
    }
}

}  // namespace
}  // namespace alcove::grid_test
