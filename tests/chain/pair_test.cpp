// Which hidden surfaces are taken to close a solid, where nobody says it: ends.comp and pair.comp of kernels/hidden.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/hidden/hidden.h"
#include "core/reference/reference_scene.h"
#include "kernels/hidden/hidden.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::pair_test {
namespace {

using namespace test;

constexpr int kWidth = 96, kHeight = 80;

const Shot kShot = Shot::perspective({0, -6, 0}, {0, 0, 0}, 40, kWidth, kHeight);

Sphere ball(Vec3 center, double radius) { return {.center = center, .radius = radius}; }

/// A plate across the view.
Polygon plate(double y, double half_width, double half_height, double x = 0) {
  return parallelogram({x - half_width, y, -half_height}, {2 * half_width, 0, 0}, {0, 0, 2 * half_height});
}

/// The planes of GBuffer::hidden.
std::vector<float> hidden_of(const HostFrame& frame, int kept = 3) {
  const FrameInputs inputs = upload(recorder(), frame);
  return downloaded<float>(*layers(recorder(), prepare(recorder(), inputs), inputs, {kept, -1}).hidden);
}

/// Of the surfaces behind the first that so lie behind another, the share that closes it.
double closing(const std::vector<float>& hidden, std::size_t plane = 0) {
  const std::size_t pixels = std::size_t(kWidth * kHeight);
  double all = 0, closes = 0;
  for (std::size_t i = plane * pixels; i < (plane + 1) * pixels; i++) {
    all += std::abs(hidden[i]) < kSkyDepth;
    closes += hidden[i] < 0;
  }
  EXPECT_GE(all, 100);
  return closes / all;
}

TEST(Pair, a_sphere_and_a_box_are_solid) {
  EXPECT_GE(closing(hidden_of(peeled({{ball({0, 0, 0}, 1)}}, kShot, 2))), 0.98);
  Scene boxes;
  boxes.add(parallelepiped({-0.7, -0.7, -0.5}, {1.2, 0, 0}, {0, 1.1, 0}, {0, 0, 0.9}));
  EXPECT_GE(closing(hidden_of(peeled(boxes, kShot, 2))), 0.95);
  boxes.primitives.push_back(Plane{{0, 3, 0}, {0, -1, 0}});
  const std::vector<float> before_wall = hidden_of(peeled(boxes, kShot, 3));
  EXPECT_GE(closing(before_wall, 0), 0.95);
  EXPECT_EQ(closing(before_wall, 1), 0);
}

TEST(Pair, sheets_before_each_other_are_none) {
  EXPECT_EQ(closing(hidden_of(peeled({{plate(0, 0.5, 0.5), Plane{{0, 1, 0}, {0, -1, 0}}}}, kShot, 2))), 0);
  EXPECT_LE(closing(hidden_of(peeled({{plate(0, 0.5, 0.4), plate(1, 0.8, 0.9, 0.3)}}, kShot, 2))), 0.02);
  // blades of grass, of three to ten pixels
  Scene grass;
  for (int i = 0; i < 5; i++) {
    grass.primitives.push_back(plate(0.1 * i, 0.1, 1.5, -1 + 0.5 * i));
    grass.primitives.push_back(plate(1.5 + 0.1 * i, 0.08, 1.3, -1.1 + 0.45 * i));
  }
  EXPECT_LE(closing(hidden_of(peeled(grass, kShot, 2))), 0.05);
}

// What ends together is far too thick to be one.
TEST(Pair, a_solid_is_no_more_than_twice_as_thick_as_wide) {
  for (const double behind : {1.5, 2.5}) {
    const double far = 6 + behind;
    const Scene both{{plate(0, 0.5, 0.5), plate(behind, 0.5 * far / 6, 0.5 * far / 6)}};
    const double share = closing(hidden_of(peeled(both, kShot, 2)));
    if (behind < 2)
      EXPECT_GE(share, 0.95);
    else
      EXPECT_EQ(share, 0);
  }
}

/// A ball before a wall with another ball behind it.
Scene balls() { return {{ball({0, 0, 0}, 0.8), ball({0.4, 2.4, 0.3}, 0.7), Plane{{0, 5, 0}, {0, -1, 0}}}}; }

TEST(Pair, what_files_say_stays) {
  HostFrame frame = peeled(balls(), kShot, 4);
  for (auto& plane : frame.behind) plane.kind = BehindKind::fronts;
  for (const std::size_t plane : {0u, 1u, 2u}) EXPECT_EQ(closing(hidden_of(frame), plane), 0);
  for (auto& plane : frame.behind) plane.kind = BehindKind::backs;
  for (const std::size_t plane : {0u, 1u, 2u}) EXPECT_EQ(closing(hidden_of(frame), plane), 1);
}

TEST(Pair, a_surface_that_closes_a_solid_opens_none) {
  const std::vector<float> hidden = hidden_of(peeled(balls(), kShot, 4));
  const std::size_t pixels = std::size_t(kWidth * kHeight);
  for (std::size_t i = 0; i < 2 * pixels; i++) EXPECT_FALSE(hidden[i] < 0 && hidden[i + pixels] < 0) << i;
}

TEST(Pair, the_order_of_planes_changes_no_bit) {
  HostFrame frame = peeled(balls(), kShot, 4);
  frame.behind[1].kind = BehindKind::fronts;
  const std::vector<float> expected = hidden_of(frame);
  const std::ptrdiff_t pixels = kWidth * kHeight;
  std::swap(frame.behind[0], frame.behind[2]);
  std::swap_ranges(frame.behind_depth.begin(), frame.behind_depth.begin() + pixels,
                   frame.behind_depth.begin() + 2 * pixels);
  EXPECT_EQ(hidden_of(frame), expected);
  std::swap(frame.behind[0], frame.behind[1]);
  std::swap_ranges(frame.behind_depth.begin(), frame.behind_depth.begin() + pixels,
                   frame.behind_depth.begin() + pixels);
  EXPECT_EQ(hidden_of(frame), expected);
}

/// Layers by chance: boxes of chance on a picture of chance, some of them as wide as each other.
HostFrame by_chance(unsigned seed, int width, int height) {
  std::mt19937 random(seed);
  const auto number = [&](int from, int to) { return std::uniform_int_distribution(from, to)(random); };
  HostFrame frame;
  frame.data = frame.display = {0, 0, width, height};
  frame.camera = kShot.camera;
  frame.camera.width = width;
  frame.camera.height = height;
  frame.behind.assign(3, {});
  const std::size_t pixels = frame.data.pixels();
  std::vector<std::vector<float>> lists(pixels);
  for (int i = 0; i < 40; i++) {
    const int x = number(0, width - 2), y = number(0, height - 2);
    const int last_x = std::min(width - 1, x + number(0, 90)), last_y = std::min(height - 1, y + number(0, 40));
    const float z = float(number(400, 900)) / 100;
    const int sides = number(1, 2);
    for (int side = 0; side < sides; side++)
      for (int b = y; b <= last_y; b++)
        for (int a = x; a <= last_x; a++)
          lists[std::size_t(b * width + a)].push_back(z + 0.3f * float(side) + 0.001f * float(a));
  }
  frame.depth.assign(pixels, kSky);
  frame.behind_depth.assign(3 * pixels, kSky);
  for (std::size_t i = 0; i < pixels; i++) {
    std::ranges::sort(lists[i]);
    for (std::size_t k = 0; k < std::min<std::size_t>(4, lists[i].size()); k++)
      (k == 0 ? frame.depth[i] : frame.behind_depth[(k - 1) * pixels + i]) = lists[i][k];
  }
  frame.normal.assign(2 * pixels, 0.0f);
  frame.normal.resize(3 * pixels, 1.0f);
  return frame;
}

// The kernels go along whole lines, and the reference walks from each pixel.
TEST(Pair, the_reference_finds_the_same) {
  for (unsigned seed = 1; seed <= 6; seed++)
    for (const int kept : {1, 2, 3}) {
      const HostFrame frame = by_chance(seed, 150, 37);
      const std::vector<float> hidden = hidden_of(frame, kept);
      const ReferenceLayers expected = reference_layers(ReferenceScene(frame), frame, kept, -1);
      std::size_t others = 0, closed = 0;
      for (std::size_t i = 0; i < hidden.size(); i++) {
        EXPECT_NEAR(std::abs(hidden[i]) < kSkyDepth ? std::abs(hidden[i]) : 0, std::abs(expected.planes[i]), 1e-5);
        closed += hidden[i] < 0;
        others += (hidden[i] < 0) != (expected.planes[i] < 0);
      }
      EXPECT_GE(closed, 100u) << seed;
      EXPECT_LE(others, hidden.size() / 2000) << seed << ", kept " << kept;
    }
}

// As far in as the margin, a crop has the bits of the whole.
TEST(Pair, a_crop_with_its_margin_is_as_the_whole) {
  constexpr int kMargin = kEndsReach + kEndsBeyond;
  constexpr int kWide = 260, kHigh = 40, kLeft = 50;
  for (unsigned seed = 1; seed <= 4; seed++) {
    const HostFrame whole = by_chance(seed, kWide, kHigh);
    HostFrame crop = whole;
    crop.data = {kLeft, 0, kWide - kLeft, kHigh};
    for (auto* planes : {&crop.depth, &crop.normal, &crop.behind_depth}) {
      std::vector<float> kept;
      for (std::size_t i = 0; i < planes->size(); i++)
        if (i % kWide >= kLeft) kept.push_back((*planes)[i]);
      *planes = kept;
    }
    const std::vector<float> expected = hidden_of(whole), given = hidden_of(crop);
    for (int row = 0; row < 3 * kHigh; row++)
      for (int x = kLeft + kMargin; x < kWide; x++)
        EXPECT_EQ(given[std::size_t(row * (kWide - kLeft) + x - kLeft)], expected[std::size_t(row * kWide + x)])
            << seed << ", row " << row << ", column " << x;
  }
}

}  // namespace
}  // namespace alcove::pair_test
