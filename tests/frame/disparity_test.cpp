// Disparity a / z + b is read as the depth that it is, or refused with the options that say what it lacks.
// SPDX-License-Identifier: BSD-3-Clause
#include <random>

#include "core/frame/pixels/statistics.h"
#include "tests/support/source_frame.h"
#include "tests/support/test.h"

namespace alcove::disparity_test {
namespace {

using namespace test;

double rounded(double value, double step) { return step > 0 ? std::round(value / step) * step : value; }

/// A room with a ball under sky, with disparity a / z + b.
class Disparity : public SettledFile {
 protected:
  Disparity() { settings.depth_kind = DepthKind::disparity; }

  void write(double a, double b, double step = 0, const std::function<Vec3(const Hit&)>& normal = &world_normal) {
    FrameFile file = file_of(
        rendering(), float(rounded(b, step)), [&](const Hit& hit) { return rounded(a / hit.distance + b, step); },
        normal);
    file.halves = halves;
    file.write(settings.input);
    give(camera);
  }

  static Vec3 world_normal(const Hit& hit) { return hit.normal; }

  /// The depths of the surfaces as parts of the true ones: the least and the most. They are all one scale.
  std::pair<double, double> scales() const {
    const FrameSource source = settled();
    HostFrame frame = read_host_frame(settings, 0);
    const DepthMap map = depth_map_of(source.reading);
    std::pair<double, double> scales{kNowhere, 0};
    for (std::size_t i = 0; i < frame.depth.size(); i++) {
      const Hit& hit = rendering().hits[i];
      const double z = planar_depth(map, {frame.depth[i]}, 1);
      if (hit.primitive < 0) EXPECT_TRUE(std::isinf(z)) << "sky " << i << " is at " << z;
      if (hit.primitive < 0) continue;
      scales.first = std::min(scales.first, z / hit.distance);
      scales.second = std::max(scales.second, z / hit.distance);
    }
    return scales;
  }

  std::set<std::string> halves;
  json camera = camera_of(shot());
};

TEST_F(Disparity, has_the_shift_by_which_depth_and_normals_agree) {
  for (const double a : {1.0, 100.0})
    for (const double b : {0.0, 0.15 * a, 0.3 * a})
      for (const double step : {0.0, a / 65535}) {
        write(a, b, step);
        const auto [least, most] = scales();
        EXPECT_LT(most / least, 1.02) << a << " / z + " << b << " in steps of " << step;
        EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("disparity's shift"), HasSubstr("[proven-reading]"))));
      }
  halves = {"Z"};
  write(1, 0.3);
  EXPECT_LT(scales().second / scales().first, 1.02);
}

TEST_F(Disparity, has_the_median_depth_1_unless_its_scale_is_said) {
  write(10, 3);
  EXPECT_NEAR(*settled().evidence->median_depth, 1, 0.01);
  settings.depth_range.disparity_scale = 10;
  const auto [least, most] = scales();
  EXPECT_NEAR(least, 1, 0.01);
  EXPECT_NEAR(most, 1, 0.01);
}

TEST_F(Disparity, takes_any_two_of_its_scale_its_shift_and_its_planes) {
  const double near = 2, far = 40, a = 1 / (1 / near - 1 / far), b = -a / far;
  write(a, b, 0, nullptr);
  constexpr std::optional<double> none;
  const std::array<std::optional<double>, 4> all{near, far, a, b};
  for (std::size_t i = 0; i < 4; i++)
    for (std::size_t j = 0; j < i; j++) {
      const auto one = [&](std::size_t k) { return k == i || k == j ? all[k] : none; };
      settings.depth_range = {};
      settings.depth_range.near = one(0);
      settings.depth_range.far = one(1);
      settings.depth_range.disparity_scale = one(2);
      settings.depth_range.disparity_shift = one(3);
      const auto [least, most] = scales();
      EXPECT_NEAR(least, 1, 1e-4) << i << j;
      EXPECT_NEAR(most, 1, 1e-4) << i << j;
    }
  settings.depth_range = {};
  settings.depth_range.near = far;
  settings.depth_range.far = near;
  expect(Reply::usage, {"--near", "--far"});
}

TEST_F(Disparity, is_no_matter_of_the_cameras_planes) {
  camera["near"] = 0.1;
  camera["far"] = 100;
  write(10, 3);
  const FrameSource first = settled();
  EXPECT_NEAR(*first.reading.depth_range.disparity_shift, 3, 0.01);
  FrameSource other = find_frame(settings, false, 0);
  ASSERT_TRUE(settle_like(other, first));
  EXPECT_EQ(depth_map_of(other.reading), depth_map_of(first.reading));
}

TEST_F(Disparity, finds_its_shift_by_normals_of_either_space) {
  for (const double step : {0.0, 1.0 / 255}) {
    write(2, 0.2, step, [](const Hit& hit) { return in_view(hit.normal); });
    const Reading read = settled().reading;
    EXPECT_EQ(read.normal_space, NormalSpace::view) << step;
    EXPECT_NEAR(*read.depth_range.disparity_shift, 0.2, read.depth_range.disparity_error) << step;
  }
  write(1, 0.2, 0, [](const Hit& hit) { return Vec3{0.5, 0.5, 0.5} + 0.5 * hit.normal; });
  EXPECT_TRUE(settled().reading.normal_unorm);
  EXPECT_LT(scales().second / scales().first, 1.02);
}

TEST_F(Disparity, of_8_bits_says_what_that_does_to_ao) {
  write(2.2, 0.2, 1.0 / 255);
  EXPECT_THAT(said(), ElementsAre(HasSubstr("disparity's shift"))) << "the normals need no doubt";
  const FrameSource source = settled();
  std::string text;
  for (const auto& note : source.suspicious) text += note.text;
  EXPECT_THAT(text, AllOf(HasSubstr("in steps of 0.0039"), HasSubstr("off by about"), HasSubstr("(RMS)")));
  EXPECT_NEAR(*source.reading.depth_range.disparity_shift, 0.2, source.reading.depth_range.disparity_error);
  settings.depth_range.disparity_shift = 0.2;
  EXPECT_THAT(said(), ElementsAre()) << "nor do they where the shift is said";
  settings.depth_range = {};
  settings.depth_kind = DepthKind::inverse;
  expect(Reply::refused, {"8 bits", "--depth-kind disparity"});
}

TEST_F(Disparity, is_refused_where_nothing_tells_its_shift) {
  const std::vector<std::string> options{"--set disparity-shift", "--near", "--far", "--normal"};
  write(1, 0.2, 0, nullptr);
  expect(Reply::refused, options);
  write(1, 0.2, 0, [](const Hit&) { return unit(shot().back); });
  expect(Reply::refused, options);
  std::mt19937 random;
  std::uniform_real_distribution<double> any(-1, 1);
  std::map<int, Vec3> normals;
  write(1, 0.2, 0, [&](const Hit& hit) {
    return normals
        .try_emplace(int(3 * hit.position.x) + 100 * int(3 * hit.position.y),
                     unit({any(random), any(random), any(random)}))
        .first->second;
  });
  expect(Reply::refused, options);
}

TEST_F(Disparity, alone_says_the_shift_by_which_its_planes_meet_at_right_angles) {
  for (const double step : {0.0, 1.0 / 65535}) {
    write(1, 0.3, step, nullptr);
    expect(Reply::refused, {"right angles", "--set disparity-shift=0."});
    settings.depth_range.disparity_shift = 0.3;
    expect(Reply::silent);
    for (const double wrong : {0.25, -0.2, 0.1}) {
      settings.depth_range.disparity_shift = wrong;
      EXPECT_THAT(said(),
                  Contains(AllOf(HasSubstr("with b = 0."), HasSubstr("right angles"), HasSubstr("[said-otherwise]"))));
    }
    settings.depth_range = {};
  }
  // By another camera the same walls are still planes, and meet at other angles.
  write(1, 0.3, 0, nullptr);
  camera["fx"] = camera["fy"] = 1.6 * camera["fx"].get<double>();
  give(camera);
  EXPECT_THAT(error_of(ErrorKind::input, [&] { settled(); }), Not(HasSubstr("right angles")));
}

TEST_F(Disparity, that_is_largest_far_away_is_refused) {
  write(-1, 1);
  expect(Reply::refused, {"larger values are farther"});
}

TEST_F(Disparity, of_an_orthographic_camera_is_refused) {
  camera["projection"] = "orthographic";
  write(1, 0.2);
  expect(Reply::refused, {"orthographic"});
}

TEST_F(Disparity, with_a_shift_that_the_normals_speak_against_is_noted) {
  write(1, 0.2);
  settings.depth_range.disparity_shift = 0.2;
  expect(Reply::silent);
  settings.depth_range.disparity_shift = 0.1;
  EXPECT_THAT(said(), Contains(AllOf(HasSubstr("shift"), HasSubstr("0.2"), HasSubstr("[said-otherwise]"))));
}

TEST_F(Disparity, of_nothing_but_sky_is_sky) {
  FrameFile file = file_of(
      rendering(), 0, [](const Hit&) { return 0; }, &world_normal);
  file.write(settings.input);
  give(camera);
  const FrameSource source = settled();
  EXPECT_EQ(source.evidence->median_depth, std::nullopt);
  EXPECT_FALSE(source.evidence->tells) << "another frame of the sequence does";
}

TEST_F(Disparity, of_a_sequence_has_one_shift_unless_a_frame_proves_another) {
  write(10, 3);
  const FrameSource first = settled();
  const auto read_after_first = [&] {
    FrameSource source = find_frame(settings, false, 0);
    const bool is_like = settle_like_or_alone(source, first, settings, 1 << 30);
    EXPECT_EQ(is_like, !std::ranges::any_of(source.notes,
                                            [](const Note& note) { return note.code == NoteCode::unusual_reading; }));
    return *source.reading.depth_range.disparity_shift;
  };
  const double shift = *first.reading.depth_range.disparity_shift;
  write(10.001, 3.001, 0.01);
  EXPECT_EQ(read_after_first(), shift);
  write(10, 3, 0, [](const Hit&) { return unit(shot().back); });
  EXPECT_EQ(read_after_first(), shift) << "of a frame that does not tell";
  write(5, 1);
  EXPECT_NEAR(read_after_first(), 1, 0.01);
}

}  // namespace
}  // namespace alcove::disparity_test
