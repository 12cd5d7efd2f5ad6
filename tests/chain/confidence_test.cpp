// The confidence AOV: it is low where the AO is a guess.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/exr.h"
#include "tests/support/chain.h"

namespace alcove::confidence_test {
namespace {

using namespace test;

Planes run(const HostFrame& frame, const EstimatorSettings& settings) {
  return planes_of(frame, settings, "ao,confidence");
}

EstimatorSettings settings_of(double radius) {
  EstimatorSettings settings;
  settings.radius = radius;
  return settings;
}

// What hides a surface may be nearer than the sphere: then it is no occluder itself, however thick.
TEST(Confidence, is_low_where_completed_surfaces_decide) {
  const HostFrame frame = rendered_frame("colonnade");
  EstimatorSettings settings = settings_of(0.75);
  settings.slices = 4;
  settings.stride = 1;
  const Planes all = run(frame, settings);
  settings.complete = Completion::none;
  const Planes none = run(frame, settings);
  int decided = 0;
  int trusted = 0;
  for (std::size_t i = 0; i < all.ao.size(); i++) {
    if (none.ao[i] - all.ao[i] < 0.2f) continue;
    decided++;
    trusted += all.confidence[i] > 0.8f;
  }
  EXPECT_GT(decided, 150);
  EXPECT_LT(trusted, 0.02 * decided);
}

TEST(Confidence, the_confident_half_errs_less_than_half_as_much_as_the_rest) {
  for (const auto& [name, radius] : {std::pair<std::string, double>{"monkeys", 0.5},
                                     {"colonnade", 0.75},
                                     {"machine", 0.006},
                                     {"interior", 0.35},
                                     {"terrain", 100}}) {
    const HostFrame frame = rendered_frame(name);
    const Planes outcome = run(frame, settings_of(radius));
    const std::string base = ALCOVE_SOURCE_DIR "/examples/bench/" + name;
    const std::vector<float> a = read_exr_image(base + ".ao.a.exr").pixels,
                             b = read_exr_image(base + ".ao.b.exr").pixels;
    std::vector<float> truth(a.size());
    std::ranges::transform(a, b, truth.begin(), [](float x, float y) { return (x + y) / 2; });
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < truth.size(); i++)
      if (frame.depth[i] < kSky) pixels.push_back(i);
    std::ranges::stable_sort(pixels, std::greater(), [&](std::size_t i) { return outcome.confidence[i]; });
    const auto mean_error = [&](std::size_t from, std::size_t to) {
      double sum = 0;
      for (std::size_t i = from; i < to; i++) sum += std::abs(outcome.ao[pixels[i]] - truth[pixels[i]]);
      return sum / double(to - from);
    };
    const std::size_t half = pixels.size() / 2;
    EXPECT_LT(mean_error(0, half), 0.5 * mean_error(half, pixels.size())) << name;
  }
}

TEST(Confidence, is_whole_on_an_open_floor_and_on_sky) {
  const Scene scene{{parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0})}};
  const Rendering floor = render(scene, Shot::perspective({0, -3, 2}, {0, 0, 1.5}, 60, 64, 48));
  for (const float value : run(floor.frame, settings_of(0.3)).confidence) ASSERT_GT(value, 0.99f);
}

TEST(Confidence, falls_where_the_back_of_a_thing_decides) {
  // A slab that floats over a floor: what lies behind its rim is not seen.
  const Scene scene{
      {parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}), parallelogram({-0.5, 0, 0.4}, {1, 0, 0}, {0, 0, 0.5})}};
  const Rendering slab = render(scene, Shot::perspective({0, -4, 2}, {0, 0, 0.2}, 40, 96, 72));
  const Planes outcome = run(slab.frame, settings_of(1));
  double floor = 0, floors = 0, below = 0, belows = 0;
  for (int y = 0; y < 72; y++)
    for (int x = 0; x < 96; x++) {
      const Hit& hit = slab.at(x, y);
      if (hit.primitive != 0) continue;
      const float value = outcome.confidence[std::size_t(y * 96 + x)];
      if (std::abs(hit.position.x) > 1.8) floor += value, floors++;
      if (std::abs(hit.position.x) < 0.3 && std::abs(hit.position.y) < 0.2) below += value, belows++;
    }
  ASSERT_GT(floors, 20);
  ASSERT_GT(belows, 20);
  EXPECT_GT(floor / floors, 0.97);
  EXPECT_LT(below / belows, 0.9);
}

TEST(Confidence, falls_with_the_precision_of_depth) {
  HostFrame frame = render(Scene{{parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0})}},
                           Shot::perspective({0, -3, 2}, {0, 0, 0}, 60, 64, 48))
                        .frame;
  frame.depth_is_half = true;
  const auto mean = [&](double radius) {
    const auto confidence = run(frame, settings_of(radius)).confidence;
    return std::accumulate(confidence.begin(), confidence.end(), 0.0) / double(confidence.size());
  };
  EXPECT_GT(mean(1), 0.95);
  EXPECT_LT(mean(0.02), 0.5);
  EXPECT_LT(mean(0.002), 0.01);
}

TEST(Confidence, does_not_change_the_ao_and_is_there_for_every_estimator) {
  const Rendering room = furnished_room(61, 47);
  for (const auto estimator : {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek}) {
    EstimatorSettings settings = settings_of(0.5);
    settings.estimator = estimator;
    const Planes outcome = run(room.frame, settings);
    EXPECT_TRUE(same_bits(outcome.ao, ao_of(room.frame, settings)));
    for (const float value : outcome.confidence) ASSERT_TRUE(value >= 0 && value <= 1);
  }
}

}  // namespace
}  // namespace alcove::confidence_test
