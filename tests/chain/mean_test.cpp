// The mean of two frames, made by hand: which of the other one's pixels count.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/time/accumulate.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::mean_test {
namespace {

using namespace test;

constexpr int kSide = 24;
constexpr std::size_t kPixels = std::size_t(kSide) * kSide;
constexpr View kView{{kSide, kSide}, {kSide / 2.0f, kSide / 2.0f}, {0.01f, -0.01f}, 0};
constexpr float kOwn = 0.25f, kOther = 0.75f;
constexpr double kRadius = 0.2;  // scene units: 5 px at the depth of the frame

/// Planes of a frame that faces a plane.
struct Facing {
  std::vector<float> depth = std::vector<float>(kPixels, 4.0f);
  std::vector<std::uint32_t> normal = std::vector<std::uint32_t>(kPixels, 0);  // (0, 0, 1)
};

std::size_t at(int x, int y) { return std::size_t(y * kSide + x); }

class Means : public testing::Test {
 protected:
  Means() : gpu_(device()) {}

  /// The mean at each pixel, of a frame and another one of the same camera, or of one that stands so far to the left.
  std::vector<float> mean(const Facing& own, const Facing& other, float shift = 0) {
    std::vector<std::uint32_t> words;
    for (const float z : other.depth) words.push_back(std::bit_cast<std::uint32_t>(units_ * z));
    for (const std::uint32_t n : other.normal) words.push_back((n & 0xffffu) | std::uint32_t(kOther * 65535) << 16);
    const std::vector<NeighbourFrame> frames{
        {kView, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {units_ * shift, 0, 0}, {units_ * 1e-5f, 0, 0}, 0}};
    std::vector<float> own_depth = own.depth;
    for (float& z : own_depth) z *= units_;
    EstimateSet estimates;
    estimates.depth = &given("own depth", own_depth, gpu_);
    estimates.normal = &given("own normal", own.normal, gpu_);
    estimates.values = &given("own values", std::vector<float>(kPixels, kOwn), gpu_);
    estimates.view = kView;
    estimates.groups = {{&given("words", words, gpu_), &given("frames", frames, gpu_), 1, 1}};
    const auto is_moving = [](float z) { return z < 0; };
    estimates.has_moving = std::ranges::any_of(own.depth, is_moving) || std::ranges::any_of(other.depth, is_moving);
    std::vector<float> depth = own_depth;
    std::ranges::transform(depth, depth.begin(), [](float z) { return std::abs(z); });
    GBuffer gbuffer;
    gbuffer.view = kView;
    gbuffer.depth = &given("depth", depth, gpu_);
    gbuffer.normal = &given("normal", own.normal, gpu_);
    EstimatorSettings settings;
    settings.radius = double(units_) * kRadius;
    const Accumulation result = accumulate(gpu_, gbuffer, estimates, settings, 0, false);
    return downloaded<float>(*result.visibility.ao, gpu_);
  }

  float units_ = 1;  // scene units that a number here stands for

 private:
  gpu::Recorder gpu_;
};

constexpr float kMean = (kOwn + kOther) / 2;

/// What moves in one tile: a near thing on something near, and beside it a far one, many radii behind it.
Facing near_and_far(float near, float far) {
  Facing facing;
  for (int y = 0; y < kSide; y++)
    for (int x = 0; x < kSide; x++) {
      const bool is_far = x >= 4 && x < 8, moves = x < 8 && y < 8;
      facing.depth[at(x, y)] = is_far ? (moves ? far : 9.0f) : (moves ? near : 1.0f);
    }
  return facing;
}

TEST_F(Means, are_of_all_that_see_the_same_point) {
  for (const float value : mean({}, {})) EXPECT_NEAR(value, kMean, 1e-4);
}

TEST_F(Means, leave_out_what_hides_the_point_lies_off_its_plane_or_is_turned) {
  Facing nearer, farther, turned;
  std::ranges::fill(nearer.depth, 3.0f);  // the frame sees through all of it, so all has moved; but far from the point
  std::ranges::fill(farther.depth, 4.03f);        // less than counts as seen through, more than half a pixel
  std::ranges::fill(turned.normal, 0x00000040u);  // half way to the side
  for (const Facing& other : {nearer, farther, turned})
    for (const float value : mean({}, other)) EXPECT_EQ(value, kOwn);
}

TEST_F(Means, leave_out_all_within_the_radius_of_what_moves_and_nothing_far) {
  Facing moving;
  for (int y = 0; y < 8; y++)
    for (int x = 0; x < 8; x++) moving.depth[at(x, y)] = -4.0f;  // by its vectors
  const auto near_own = mean(moving, {}), near_other = mean({}, moving);
  for (const auto& values : {near_own, near_other}) {
    EXPECT_EQ(values[at(4, 4)], kOwn);
    EXPECT_EQ(values[at(10, 4)], kOwn) << "3 px beside it";
    for (int y = 0; y < kSide; y++)
      for (int x = 0; x < kSide; x++)
        if (std::max(x, y) >= 16) EXPECT_NEAR(values[at(x, y)], kMean, 1e-4) << x << " " << y;
  }
}

TEST_F(Means, begin_over_the_width_of_a_cell) {
  Facing moving;
  for (int y = 0; y < kSide; y++)
    for (int x = 0; x < 8; x++) moving.depth[at(x, y)] = -4.0f;
  const auto values = mean(moving, {});
  double most = 0;
  for (int x = 8; x + 1 < kSide; x++) {
    EXPECT_GE(values[at(x + 1, 12)], values[at(x, 12)] - 1e-6) << x;
    most = std::max(most, double(values[at(x + 1, 12)]) - values[at(x, 12)]);
  }
  // A cell is 1.7 px wide here.
  EXPECT_LT(most, 0.75 * (kMean - kOwn));
}

TEST_F(Means, leave_out_what_is_near_each_of_two_things_of_a_tile_that_lie_far_apart) {
  const Facing still = near_and_far(1, 9), by_vectors = near_and_far(-1, -9), gone = near_and_far(0.9f, 8);
  for (const auto& values : {mean(by_vectors, still), mean(still, by_vectors)})
    EXPECT_EQ(values[at(6, 8)], kOwn) << "beside the far one";
  for (const auto& values : {mean(by_vectors, still), mean(still, by_vectors), mean(gone, still), mean(still, gone)}) {
    EXPECT_EQ(values[at(10, 4)], kOwn) << "beside the near one";
    EXPECT_NEAR(values[at(6, 20)], kMean, 1e-4) << "beside neither";
  }
}

TEST_F(Means, find_what_has_gone) {
  Facing there;
  for (int y = 0; y < 8; y++)
    for (int x = 0; x < 8; x++) there.depth[at(x, y)] = 3.85f;
  for (const auto& values : {mean({}, there), mean(there, {})}) {
    EXPECT_EQ(values[at(4, 4)], kOwn);
    EXPECT_EQ(values[at(9, 4)], kOwn) << "2 px beside it";
    EXPECT_NEAR(values[at(20, 20)], kMean, 1e-4);
  }
}

TEST_F(Means, find_what_has_gone_whose_plane_is_nearly_edge_on) {
  // Half a pixel beside its point the plane is as far as what is behind it, and a little more.
  Facing there;
  for (int y = 8; y < 16; y++)
    for (int x = 8; x < 16; x++) {
      there.depth[at(x, y)] = 3.85f;
      there.normal[at(x, y)] = 0x000079e7u;  // (20, 0, 1), turned to the side
    }
  const float shift = 0.45f * 0.01f * 3.85f;
  for (const float to : {-shift, shift})
    for (const auto& values : {mean(there, {}, to), mean({}, there, to)}) {
      EXPECT_EQ(values[at(17, 12)], kOwn) << "2 px beside it";
      EXPECT_NEAR(values[at(2, 2)], kMean, 1e-4);
    }
}

TEST_F(Means, are_the_same_in_any_units) {
  Facing sky, gone;
  std::ranges::fill(sky.depth, kSkyDepth);
  const Facing near = near_and_far(-1, -9), still = near_and_far(1, 9);
  for (int y = 0; y < 8; y++)
    for (int x = 0; x < 8; x++) gone.depth[at(x, y)] = 3.85f, sky.depth[at(x, y)] = 4.0f;
  const std::pair<const Facing*, const Facing*> pairs[]{{&near, &still}, {&gone, &sky}, {&sky, &gone}};
  std::vector<std::vector<float>> expected;
  for (const auto& [own, other] : pairs) expected.push_back(mean(*own, *other, 0.01f));
  for (const float units : {0x1p-50f, 0x1p50f}) {
    units_ = units;
    for (std::size_t i = 0; i < expected.size(); i++)
      EXPECT_TRUE(same_bits(mean(*pairs[i].first, *pairs[i].second, 0.01f), expected[i])) << units << " " << i;
  }
}

TEST(Mean, of_fewer_frames_than_are_listed_runs_the_same_kernels) {
  const auto kernels_for = [](const std::vector<uint>& groups) {
    gpu::Recorder gpu;
    EstimateSet estimates;
    const auto made = [&](const std::string& name, std::size_t bytes) {
      return &gpu.buffer(name, bytes, gpu::Use::upload);
    };
    gpu::Buffer* own = made("own", 4 * kPixels);
    estimates.depth = estimates.normal = estimates.values = own;
    estimates.view = kView;
    for (const uint count : groups) {
      gpu::Buffer* frames =
          made(fmt::format("frames {}", estimates.groups.size()), kMostNeighbours * sizeof(NeighbourFrame));
      std::ranges::fill(frames->as<NeighbourFrame>(), NeighbourFrame{kView, {}, {}, {}, {}, {}, 0});
      estimates.groups.push_back({own, frames, count, kMostNeighbours});
    }
    GBuffer gbuffer;
    gbuffer.view = kView;
    gbuffer.depth = gbuffer.normal = own;
    EstimatorSettings settings;
    settings.radius = kRadius;
    accumulate(gpu, gbuffer, estimates, settings, 0, false);
    const auto& names = gpu.rehearsed();
    return std::set<gpu::KernelName>(names.begin(), names.end());
  };
  const auto of_all = kernels_for({kMostNeighbours});
  for (const std::vector<uint>& groups : {std::vector<uint>{1}, {2}, {8}, {9, 1}, {9, 9, 9, 5}})
    EXPECT_EQ(kernels_for(groups), of_all) << testing::PrintToString(groups);
}

}  // namespace
}  // namespace alcove::mean_test
