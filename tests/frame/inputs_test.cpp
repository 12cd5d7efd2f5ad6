// Every way to say depth and normals gives the same AO; what pixels tell of them is found, and what they do not tell is
// refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/option_words.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/settle/settle.h"
#include "core/run/resume.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::inputs_test {
namespace {

using namespace test;

constexpr double kFar = 100;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();

EstimatorSettings settings_of(double radius) {
  EstimatorSettings settings;
  settings.radius = radius;
  settings.slices = 3;
  settings.steps = 12;
  settings.stride = 1;  // or rounding would choose other pixels to estimate
  return settings;
}

EstimatorSettings with(double radius, ThicknessKind thickness) {
  EstimatorSettings settings = settings_of(radius);
  settings.thickness = thickness;
  return settings;
}

std::vector<float> ao_of(const HostFrame& frame, double radius, ThicknessKind thickness = ThicknessKind::infinite) {
  return compute_ao(recorder(), frame, with(radius, thickness)).ao;
}

/// The AO of a scene by planar depth. With no radius that samples could fall in or out of by rounding, and occluders
/// that have no width, every pixel of another storage agrees; else all but single samples do.
struct Planar {
  explicit Planar(const HostFrame& frame)
      : whole(ao_of(frame, 1e3)),
        far(ao_of(frame, 1e3, ThicknessKind::automatic)),
        near(ao_of(frame, 0.6, ThicknessKind::automatic)),
        sky_pixels(compute_ao(recorder(), frame, settings_of(0.6)).sky_pixels) {}

  void expect_same(const HostFrame& frame, const std::string& what) const {
    SCOPED_TRACE(what);
    const Difference all = difference(ao_of(frame, 1e3), whole);
    EXPECT_LE(all.max, 1e-4) << place(all, frame);
    const HostResult result = compute_ao(recorder(), frame, with(0.6, ThicknessKind::automatic));
    EXPECT_LE(difference(result.ao, near).rmse, 1e-4);
    EXPECT_LE(difference(ao_of(frame, 1e3, ThicknessKind::automatic), far).rmse, 1e-4);
    EXPECT_EQ(result.sky_pixels, sky_pixels);
    EXPECT_EQ(result.repaired_depth, 0u);
  }

  std::vector<float> whole, far, near;
  std::uint64_t sky_pixels;
};

// Depth.

TEST(Depth, of_every_z_buffer_is_the_same_scene) {
  for (const bool inside : {false, true}) {
    const Rendering rendering = furnished(inside);
    const Planar planar(rendering.frame);
    // as near as the scene allows: standard z is coarse beyond some hundred times that
    const double near = inside ? 0.1 : 1;
    for (const double far : {kFar, double(kInfinite)})
      for (const bool reversed : {false, true})
        for (const DeviceRange device : {DeviceRange::zero_to_one, DeviceRange::minus_one_to_one}) {
          const float sky = float(device_depth(kInfinite, kInfinite, reversed, device));
          HostFrame frame = with_depth(
              rendering, DepthKind::device,
              [&](const test::Hit& hit) { return device_depth(hit.distance, far, reversed, device, near); }, sky);
          frame.depth_range = between_planes(far, reversed, device, near);
          planar.expect_same(frame,
                             fmt::format("inside {} far {} reversed {} range {}", inside, far, reversed, int(device)));
        }
  }
}

TEST(Depth, by_distance_by_inverse_or_between_planes_is_the_same_scene) {
  for (const bool inside : {false, true}) {
    const Rendering rendering = furnished(inside);
    const Planar planar(rendering.frame);
    const auto check = [&](const char* what, DepthKind kind, float sky, const DepthRange& range,
                           const std::function<double(const test::Hit&)>& value) {
      HostFrame frame = with_depth(rendering, kind, value, sky);
      frame.depth_range = range;
      planar.expect_same(frame, what);
    };
    DepthRange negative, log = between_planes(kFar, false), log_reversed = between_planes(kFar, true);
    negative.negative = true;
    log.log_constant = log_reversed.log_constant = 0.5;
    const auto log_depth = [](double z) { return std::log1p(0.5 * z) / std::log1p(0.5 * kFar); };
    check("ray", DepthKind::ray, 1e30f, {},
          [&](const test::Hit& hit) { return length(hit.position - rendering.shot.eye); });
    check("inverse", DepthKind::inverse, 0, {}, [](const test::Hit& hit) { return 1 / hit.distance; });
    check("negative planar", DepthKind::planar, -1e10f, negative, [](const test::Hit& hit) { return -hit.distance; });
    check("negative inverse", DepthKind::inverse, 0, negative, [](const test::Hit& hit) { return -1 / hit.distance; });
    check("normalized", DepthKind::normalized, 1, between_planes(kFar, false),
          [](const test::Hit& hit) { return (hit.distance - kNear) / (kFar - kNear); });
    check("normalized, near 1", DepthKind::normalized, 0, between_planes(kFar, true),
          [](const test::Hit& hit) { return (kFar - hit.distance) / (kFar - kNear); });
    check("log", DepthKind::log, 1, log, [&](const test::Hit& hit) { return log_depth(hit.distance); });
    check("log, near 1", DepthKind::log, 0, log_reversed,
          [&](const test::Hit& hit) { return 1 - log_depth(hit.distance); });
  }
}

TEST(Depth, of_an_orthographic_z_buffer_is_linear) {
  const Scene scene{
      {parallelogram({0, -3, 0}, {4, 0, 0}, {0, 6, 0}), Sphere{.center = {1.2, 0.4, 0.5}, .radius = 0.5}}};
  const Rendering rendering = render(scene, Shot::orthographic({4.5, -1.5, 2.4}, {1, 0, 0.6}, 5, 160, 120));
  for (const bool reversed : {false, true}) {
    HostFrame frame = with_depth(
        rendering, DepthKind::device,
        [&](const test::Hit& hit) {
          const double d = (hit.distance - kNear) / (kFar - kNear);
          return reversed ? 1 - d : d;
        },
        reversed ? 0.0f : 1.0f);
    frame.depth_range = between_planes(kFar, reversed);
    Planar(rendering.frame).expect_same(frame, reversed ? "reversed" : "standard");
  }
}

TEST(Depth, by_position_in_world_or_view_space_is_the_same_scene) {
  for (const bool inside : {false, true}) {
    const Rendering rendering = furnished(inside);
    const Shot& shot = rendering.shot;
    for (const bool world : {false, true}) {
      HostFrame frame = rendering.frame;
      frame.depth_kind = DepthKind::position;
      frame.position_space = world ? PositionSpace::world : PositionSpace::view;
      frame.camera.view_from_world = Matrix3{{{shot.right.x, shot.right.y, shot.right.z},
                                              {shot.up.x, shot.up.y, shot.up.z},
                                              {shot.back.x, shot.back.y, shot.back.z}}};
      const Vec3 offset = -shot.view_from_world(shot.eye);
      frame.camera.view_from_world_offset = {offset.x, offset.y, offset.z};
      const std::size_t pixels = frame.data.pixels();
      frame.depth.assign(3 * pixels, 0);
      for (std::size_t i = 0; i < pixels; i++) {
        if (rendering.hits[i].primitive < 0) continue;
        const Vec3 p = world ? rendering.hits[i].position : shot.view_from_world(rendering.hits[i].position - shot.eye);
        frame.depth[i] = float(p.x);
        frame.depth[i + pixels] = float(p.y);
        frame.depth[i + 2 * pixels] = float(p.z);
      }
      Planar(rendering.frame).expect_same(frame, world ? "world" : "view");
      const View view = view_of(frame.camera, frame.data, frame.display);
      EXPECT_LT(reprojection_error(frame.depth, frame.position_space, false, frame.camera, view).value(), 1e-3);
      EXPECT_GT(
          reprojection_error(frame.depth, world ? PositionSpace::view : PositionSpace::world, false, frame.camera, view)
              .value(),
          10);
    }
  }
}

TEST(Depth, of_every_sentinel_is_sky) {
  const Rendering rendering = furnished();
  const Planar planar(rendering.frame);
  const auto check = [&](DepthKind kind, const DepthRange& range, const std::vector<float>& sentinels,
                         const std::function<double(const test::Hit&)>& value) {
    for (const float sentinel : sentinels) {
      HostFrame frame = with_depth(rendering, kind, value, sentinel);
      frame.depth_range = range;
      if (kind == DepthKind::planar && sentinel == 65504)
        frame.sky = 65504;  // which is a distance like others, unless told
      const HostResult result = compute_ao(recorder(), frame, with(0.6, ThicknessKind::automatic));
      EXPECT_LE(difference(result.ao, planar.near).rmse, kind == DepthKind::planar ? 0 : 1e-4)
          << word_of(kind) << " " << sentinel;
      EXPECT_EQ(result.sky_pixels, planar.sky_pixels) << word_of(kind) << " " << sentinel;
      if (kind == DepthKind::planar)
        EXPECT_EQ(result.repaired_depth, std::isnan(sentinel) || sentinel < 0 ? planar.sky_pixels : 0) << sentinel;
    }
  };
  const auto distance = [](const test::Hit& hit) { return hit.distance; };
  constexpr float kLargest = std::numeric_limits<float>::max();
  check(DepthKind::planar, {},
        {0, -0.0f, 65504, 1e9f, 1e10f, 1e30f, 1e38f, kLargest, -kLargest, kInfinite, -kInfinite, kNan, -1}, distance);
  check(DepthKind::ray, {}, {0, 1e10f, kInfinite, kNan, -1},
        [&](const test::Hit& hit) { return length(hit.position - rendering.shot.eye); });
  check(DepthKind::inverse, {}, {0, 1e-10f, -1, kNan, -kInfinite, kInfinite},
        [](const test::Hit& hit) { return 1 / hit.distance; });
  for (const bool reversed : {false, true})
    check(DepthKind::device, between_planes(kFar, reversed), {0, 1, 1e10f, 65504, kInfinite, -kInfinite, kNan, -1},
          [&](const test::Hit& hit) { return device_depth(hit.distance, kFar, reversed, DeviceRange::zero_to_one); });
  check(DepthKind::normalized, between_planes(kFar, false), {0, 1, 1e10f, kInfinite, kNan, -1},
        [](const test::Hit& hit) { return (hit.distance - kNear) / (kFar - kNear); });
}

TEST(Depth, scale_holds_for_every_kind) {
  const Rendering rendering = furnished();
  HostFrame frame = with_depth(
      rendering, DepthKind::device,
      [](const test::Hit& hit) { return device_depth(hit.distance, kFar, true, DeviceRange::zero_to_one); }, 0);
  frame.depth_range = between_planes(kFar, true);
  const std::vector<float> expected = ao_of(frame, 0.6);
  frame.depth_scale = 128;
  EXPECT_LE(difference(ao_of(frame, 128 * 0.6), expected).rmse, 1e-5);
}

TEST(Depth, the_host_and_the_kernel_agree_on_what_is_sky) {
  const DepthMap map = depth_map(DepthKind::device, between_planes(kFar, false), PositionSpace::view, {}, 1, 1e9);
  EXPECT_NEAR(planar_depth(map, {device_depth(7, kFar, false, DeviceRange::zero_to_one), 0, 0}, 1), 7, 1e-9);
  for (const double sky : {0.0, 1.0, -1.0, 1e30}) EXPECT_TRUE(std::isinf(planar_depth(map, {sky, 0, 0}, 1))) << sky;
}

// Normals.

/// The frame with the view normal of each surface written in other planes.
HostFrame with_normals(const Rendering& rendering, int planes, NormalEncoding encoding, bool unorm,
                       const std::function<Vec3(Vec3)>& encode) {
  HostFrame frame = rendering.frame;
  const std::size_t pixels = frame.data.pixels();
  frame.normal_encoding = encoding;
  frame.normal_unorm = unorm;
  for (std::size_t i = 0; i < pixels; i++) {
    const Vec3 n = encode({frame.normal[i], frame.normal[i + pixels], frame.normal[i + 2 * pixels]});
    for (const auto& [plane, value] : {std::pair{0, n.x}, {1, n.y}, {2, n.z}})
      frame.normal[i + std::size_t(plane) * pixels] = float(unorm ? 0.5 + 0.5 * value : value);
  }
  frame.normal.resize(std::size_t(planes) * pixels);
  return frame;
}

Vec3 octahedral(Vec3 n) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z), x = n.x / sum, y = n.y / sum;
  return n.z >= 0 ? Vec3{x, y, 0} : Vec3{std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y), 0};
}

/// Of a camera space whose z points away from the camera.
Vec3 spheremap(Vec3 n) {
  const double across = std::hypot(n.x, n.y), radius = std::sqrt(0.5 - 0.5 * n.z);
  return across > 0 ? Vec3{n.x / across * radius, n.y / across * radius, 0} : Vec3{};
}

TEST(Normals, of_every_encoding_are_the_same) {
  const Rendering rendering = furnished();
  const std::vector<float> expected = ao_of(rendering.frame, 1e3);
  const auto check = [&](const char* what, HostFrame frame) {
    const HostResult result = compute_ao(recorder(), frame, with(1e3, ThicknessKind::infinite));
    EXPECT_LE(difference(result.ao, expected).max, 2e-4) << what;
    EXPECT_EQ(result.repaired_normals, 0u) << what;
    const std::size_t pixels = frame.data.pixels();
    std::vector<float> decoded(3 * pixels);
    for (std::size_t i = 0; i < decoded.size(); i++)
      decoded[i] = float(
          decoded_normal(frame.normal, pixels, i % pixels, frame.normal_encoding, frame.normal_unorm)[i / pixels]);
    frame.normal = decoded;
    frame.normal_encoding = NormalEncoding::signed_float;
    frame.normal_unorm = false;
    EXPECT_LE(difference(ao_of(frame, 1e3), expected).max, 2e-4) << what << " decoded on the host";
  };
  const auto same = [](Vec3 n) { return n; };
  check("unorm", with_normals(rendering, 3, NormalEncoding::signed_float, true, same));
  check("two components", with_normals(rendering, 2, NormalEncoding::signed_float, false, same));
  check("two components, unorm", with_normals(rendering, 2, NormalEncoding::signed_float, true, same));
  check("of half the length",
        with_normals(rendering, 3, NormalEncoding::signed_float, false, [](Vec3 n) { return 0.5 * n; }));
  for (const bool unorm : {false, true})
    for (const int planes : {2, 3})
      check("octahedral", with_normals(rendering, planes, NormalEncoding::octahedral, unorm, octahedral));
  HostFrame sphere = with_normals(rendering, 2, NormalEncoding::spheremap, true, spheremap);
  sphere.flip_normal.z = true;
  EXPECT_LE(difference(ao_of(sphere, 1e3), expected).max, 2e-3) << "spheremap is steep at its rim";
}

TEST(Normals, flips_undo_flips) {
  const Rendering rendering = furnished();
  for (const NormalFlips flips : {NormalFlips{true, false, false}, NormalFlips{false, true, false},
                                  NormalFlips{false, false, true}, NormalFlips{true, true, true}}) {
    HostFrame frame = with_normals(rendering, 3, NormalEncoding::signed_float, false, [&](Vec3 n) {
      return Vec3{flips.x ? -n.x : n.x, flips.y ? -n.y : n.y, flips.z ? -n.z : n.z};
    });
    EXPECT_GT(difference(ao_of(frame, 1), ao_of(rendering.frame, 1)).max, 0.1) << to_string(flips);
    frame.flip_normal = flips;
    EXPECT_TRUE(same_bits(ao_of(frame, 1), ao_of(rendering.frame, 1))) << to_string(flips);
  }
}

// The command line.

TEST_F(CommandLine, the_digest_changes_with_every_setting_of_the_input) {
  const auto digest = [](const auto& change) {
    Settings settings;
    settings.estimator.radius = 1;
    change(settings.input);
    return options_digest(settings);
  };
  const std::string plain = digest([](InputSettings&) {});
  const std::pair<const char*, std::string> changed[] = {
      {"--near", digest([](InputSettings& s) { s.depth_range.near = 1; })},
      {"--far", digest([](InputSettings& s) { s.depth_range.far = 1; })},
      {"--reversed-z", digest([](InputSettings& s) { s.depth_range.reversed = true; })},
      {"device-range", digest([](InputSettings& s) { s.depth_range.device = DeviceRange::minus_one_to_one; })},
      {"log-constant", digest([](InputSettings& s) { s.depth_range.log_constant = 2; })},
      {"disparity-scale", digest([](InputSettings& s) { s.depth_range.disparity_scale = 2; })},
      {"disparity-shift", digest([](InputSettings& s) { s.depth_range.disparity_shift = 0; })},
      {"--normal-encoding", digest([](InputSettings& s) { s.normal_encoding = NormalEncoding::unorm; })},
      {"--flip-normal", digest([](InputSettings& s) { s.flip_normal.y = true; })},
      {"position-space", digest([](InputSettings& s) { s.position_space = PositionSpace::world; })},
      {"position-channels", digest([](InputSettings& s) { s.position_channels = "P"; })},
      {"--view", digest([](InputSettings& s) { s.view = "left"; })},
      {"--roi", digest([](InputSettings& s) {
         s.roi = Window{0, 0, 1, 1};
       })},
  };
  for (const auto& [option, other] : changed) EXPECT_NE(plain, other) << option;
}

TEST_F(CommandLine, flips_and_far_are_checked) {
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--flip-normal", "xx"}, {"--flip-normal", "w"}, {"--far", "-1"}, {"--far", "away"}}) {
    const Finished finished = run(wrong);
    EXPECT_EQ(finished.code, 2) << finished;
    EXPECT_THAT(finished.err, HasSubstr(wrong[0]));
  }
}

}  // namespace
}  // namespace alcove::inputs_test
