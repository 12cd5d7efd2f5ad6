// The shadows of lights: closed forms by rays, the reference, and what must not matter.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/find/lights.h"
#include "tests/support/chain.h"
#include "tests/support/reference_planes.h"

namespace alcove::shadow_test {
namespace {

using namespace test;

Light sun(Vec3 direction) {
  const Vec3 d = unit(direction);
  return {.at = {d.x, d.y, d.z}};
}
Light lamp(Vec3 place, double size = 0) { return {.is_lamp = true, .at = {place.x, place.y, place.z}, .size = size}; }

/// A light of the world as a shot sees it.
Light seen_by(const Shot& shot, Light light) {
  const Vec3 at{light.at[0], light.at[1], light.at[2]};
  const Vec3 v = shot.view_from_world(light.is_lamp ? at - shot.eye : at);
  light.at = {v.x, v.y, v.z};
  return light;
}

EstimatorSettings settings_of(double radius) {
  EstimatorSettings settings = plain_settings();
  settings.radius = radius;
  settings.thickness = ThicknessKind::automatic;
  return settings;
}

/// The shadows of lights in view space, one plane behind the other; with their confidence, if asked for.
std::vector<float> shadows(const HostFrame& frame, const std::vector<Light>& lights, const EstimatorSettings& settings,
                           const std::string& aovs = "shadow") {
  std::string text;
  for (std::size_t i = 0; i < lights.size(); i++)
    text += fmt::format(R"({}{{"name": "l{}", "kind": "sun", "direction": [0, 0, 1]}})", i == 0 ? "" : ",", i);
  OutputSettings output;
  output.lights = "lights.json";
  output.read_lights = lights_of(R"({"lights": [)" + text + "]}", "lights.json");
  output.aovs = aovs;
  FrameInputs inputs = upload(recorder(), frame);
  inputs.lights = lights;
  const FrameOutputs outputs = run_chain(recorder(), inputs, settings, output);
  recorder().run();
  return values_of(outputs.shadow);
}

/// Whether a ray from a place comes to a light of the world.
bool is_lit(const Scene& scene, const Hit& hit, const Light& light) {
  const Vec3 at{light.at[0], light.at[1], light.at[2]}, way = light.is_lamp ? at - hit.position : at;
  if (dot(way, hit.normal) <= 0) return false;
  const Hit next = scene.hit({hit.position + 1e-6 * hit.normal, way});
  return light.is_lamp ? !(next.distance < 1) : next.primitive < 0;
}

/// The share of pixels that err, without those within so many pixels of a border of the true shadow or of a surface.
double share_wrong(const Rendering& rendering, const Scene& scene, const Light& light, const std::vector<float>& shadow,
                   int clear_px = 1) {
  const int width = rendering.shot.data.width, height = rendering.shot.data.height;
  std::vector<int> truth;
  for (const auto& hit : rendering.hits) truth.push_back(hit.primitive < 0 ? 2 : is_lit(scene, hit, light) ? 1 : 0);
  int count = 0, wrong = 0;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      const std::size_t i = std::size_t(y * width + x);
      bool is_clear = truth[i] < 2;
      for (int v = std::max(0, y - clear_px); v <= std::min(height - 1, y + clear_px); v++)
        for (int u = std::max(0, x - clear_px); u <= std::min(width - 1, x + clear_px); u++)
          is_clear = is_clear && truth[std::size_t(v * width + u)] == truth[i];
      if (!is_clear) continue;
      count++;
      wrong += std::abs(shadow[i] - float(truth[i])) > 0.5;
    }
  return double(wrong) / count;
}

const Plane kGround{.point = {}, .normal = {0, 0, 1}};

/// A box on a floor.
Scene box_on_floor() {
  Scene scene;
  scene.primitives.emplace_back(kGround);
  scene.add(parallelepiped({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}));
  return scene;
}

/// A sun 30 degrees high behind the box, whose shadow comes towards the camera.
const Light kBehind = sun({0.1, std::cos(kPi / 6), std::sin(kPi / 6)});

TEST(Shadow, of_a_box_on_a_floor_ends_within_a_pixel) {
  const Scene scene = box_on_floor();
  for (const bool parallel : {false, true}) {
    const Shot shot = parallel ? Shot::orthographic({0, -3, 3}, {0, -0.5, 0}, 3, 160, 120)
                               : Shot::perspective({0, -3, 3}, {0, -0.5, 0}, 45, 160, 120);
    const Rendering rendering = render(scene, shot);
    const auto shadow = shadows(rendering.frame, {seen_by(shot, kBehind)}, settings_of(0.5));
    // Beside the box the edge of the shadow is within a pixel of a few, below the box.
    EXPECT_LE(share_wrong(rendering, scene, kBehind, shadow), 2e-4) << "parallel: " << parallel;
  }
}

// Else light would come through walls that are farther before the ray than solids are deep in one pixel, and behind it
// in the next.
TEST(Shadow, of_a_box_stays_closed_at_a_radius_below_a_pixel) {
  const Scene scene = box_on_floor();
  const Shot shot = Shot::perspective({0, -3, 3}, {0, -0.5, 0}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  for (const Vec3& direction : {Vec3{0.6, -0.6, 0.5}, Vec3{0.8, 0.3, 0.3}, Vec3{0.1, 0.9, 0.5}}) {
    std::vector<std::vector<float>> by_radius;
    for (const double radius : {0.5, 0.0005}) {
      EstimatorSettings settings = settings_of(radius);
      settings.thickness = ThicknessKind::constant;
      settings.thickness_length = 0.001;
      by_radius.push_back(shadows(rendering.frame, {seen_by(shot, sun(direction))}, settings));
    }
    EXPECT_LT(difference(by_radius[0], by_radius[1]).mean, 2e-3) << direction.x << " " << direction.y;
  }
}

/// The lit part of the pixels in the shadow.
double lit_share(const Rendering& rendering, const Scene& scene, const Light& light, const std::vector<float>& shadow) {
  int count = 0, lit = 0;
  for (std::size_t i = 0; i < shadow.size(); i++) {
    const Hit& hit = rendering.hits[i];
    if (hit.primitive != 0 || is_lit(scene, hit, light)) continue;
    count++;
    lit += shadow[i] > 0.5F;
  }
  EXPECT_GT(count, 100);
  return double(lit) / count;
}

// A pixel alone may hold the place where the ray comes from before a surface to behind it.
TEST(Shadow, of_wires_a_pixel_wide_is_there) {
  Scene scene;
  scene.primitives.emplace_back(kGround);
  for (int i = -3; i <= 3; i++) scene.add(parallelepiped({0.3 * i, 0, 0}, {0.03, 0, 0}, {0, 0.005, 0}, {0, 0, 1}));
  const Shot shot = Shot::perspective({0, -3, 1.5}, {0, 0, 0.3}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  const Light light = sun({0.4, -0.9, 0.5});  // nearly along the eye's rays, so a step changes depth by much
  const auto shadow = shadows(rendering.frame, {seen_by(shot, light)}, settings_of(0.5));
  // Wires of less than two pixels have holes, and rays pass between two pixels.
  EXPECT_LE(lit_share(rendering, scene, light, shadow), 0.2);
}

// The depths of neighbouring pixels differ by fourteen times their width, so they are one surface by its plane alone.
TEST(Shadow, of_a_sheet_seen_nearly_edge_on_is_closed) {
  Scene scene;
  scene.primitives.emplace_back(kGround);
  scene.add(parallelepiped({-1, 0, 1.06}, {2, 0, 0}, {0, 1, -0.06}, {0, 0, 0.002}));
  const Shot shot = Shot::perspective({0, -3, 1.5}, {0, 0, 0.3}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  const Light light = sun({0.2, -0.6, 0.8});
  const auto shadow = shadows(rendering.frame, {seen_by(shot, light)}, settings_of(0.5));
  EXPECT_LE(lit_share(rendering, scene, light, shadow), 0.05);
}

TEST(Shadow, of_a_soft_sun_is_the_part_of_it_that_is_seen) {
  const Scene scene = box_on_floor();
  const Shot shot = Shot::perspective({0, -3, 3}, {0, -0.5, 0}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  Light soft = kBehind;
  soft.size = 10;
  EstimatorSettings settings = settings_of(0.5);
  settings.denoise = Denoise::bilateral;
  const auto shadow = shadows(rendering.frame, {seen_by(shot, soft), seen_by(shot, kBehind)}, settings);
  const Vec3 middle{soft.at[0], soft.at[1], soft.at[2]}, x = unit(cross(middle, {0, 0, 1})), y = cross(x, middle);
  double squares = 0;
  int count = 0, within = 0;
  for (std::size_t i = 0; i < rendering.hits.size(); i++) {
    const Hit& hit = rendering.hits[i];
    if (hit.primitive != 0) continue;
    int seen = 0;
    constexpr int kRays = 64;
    for (int k = 0; k < kRays; k++) {
      const double r = std::sqrt((k + 0.5) / kRays) * std::tan(5 * kRadian), turn = 2.39996 * k;
      seen += is_lit(scene, hit, sun(middle + r * std::cos(turn) * x + r * std::sin(turn) * y));
    }
    within += seen > 8 && seen < 56;
    squares += std::pow(shadow[i] - double(seen) / kRays, 2);
    count++;
  }
  EXPECT_GT(within, 500);
  EXPECT_LT(std::sqrt(squares / count), 0.06);
  // A hard light beside it stays hard.
  for (std::size_t i = rendering.hits.size(); i < shadow.size(); i++) ASSERT_EQ(shadow[i], std::round(shadow[i]));
}

TEST(Shadow, of_the_sun_in_the_sky_has_no_wider_penumbra_than_without_a_filter) {
  const Shot shot = Shot::perspective({0, -3, 3}, {0, -0.5, 0}, 45, 160, 120);
  const Rendering rendering = render(box_on_floor(), shot);
  Light light = seen_by(shot, kBehind);
  light.size = 0.53;
  Light wide = light;
  wide.size = 5;
  std::vector<std::ptrdiff_t> partly_lit;
  for (const Denoise denoise : {Denoise::none, Denoise::bilateral}) {
    EstimatorSettings settings = settings_of(0.5);
    settings.denoise = denoise;
    for (const auto& planes : {shadows(rendering.frame, {light}, settings), shadows(rendering.frame, {wide}, settings)})
      partly_lit.push_back(std::ranges::count_if(planes, [](float x) { return x > 0.05F && x < 0.95F; }));
  }
  EXPECT_GT(partly_lit[0], 10);
  EXPECT_EQ(partly_lit[2], partly_lit[0]);
  EXPECT_GT(partly_lit[3], partly_lit[1]) << "that of a wide sun is filtered";
}

TEST(Shadow, leaves_a_plane_lit_at_every_tilt_unless_it_faces_away) {
  for (const auto& [name, rendering] : slanted_planes({0, 40, 80}, {0, 70}, {60, 0}))
    for (const double elevation : {-20., 2., 30., 90.}) {
      const Hit& middle = rendering.at(32, 24);
      const Vec3 n = middle.normal, side = unit(cross(n, {0.3, 0.4, 0.5}));
      const Light light = sun(std::cos(elevation * kRadian) * side + std::sin(elevation * kRadian) * n);
      const auto shadow = shadows(rendering.frame, {seen_by(rendering.shot, light)}, settings_of(1));
      for (std::size_t i = 0; i < shadow.size(); i++)
        ASSERT_EQ(shadow[i], rendering.hits[i].primitive < 0 || elevation > 0 ? 1 : 0)
            << name << ", elevation " << elevation << ", pixel " << i;
    }
}

TEST(Shadow, of_a_lamp_is_cast_by_what_lies_before_the_lamp_alone) {
  Scene scene = box_on_floor();
  scene.add(parallelepiped({-0.5, -0.5, 1.2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.2}));  // a slab in the air
  const Shot shot = Shot::perspective({0.5, -4, 2}, {0, 0, 0.5}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  for (const Vec3 place : {Vec3{0.1, -0.7, 0.9}, Vec3{-1.2, 0.2, 0.8}}) {
    const Light light = lamp(place);
    const auto shadow = shadows(rendering.frame, {seen_by(shot, light)}, settings_of(0.5));
    // How deep the slab is cannot be seen, so what the lamp lights between slab and box may be dark.
    EXPECT_LE(share_wrong(rendering, scene, light, shadow, 2), 0.015) << place.x;
  }
}

TEST(Shadow, in_a_closed_corner_is_none) {
  Scene scene;
  scene.primitives = {kGround, Plane{.point = {}, .normal = {1, 0, 0}}, Plane{.point = {}, .normal = {0, 1, 0}}};
  const Shot shot = Shot::perspective({3, 3, 2}, {0.5, 0.5, 0.4}, 50, 120, 90);
  const Rendering rendering = render(scene, shot);
  const Light light = lamp({0.4, 0.5, 0.3});
  // Pixels at the crease may see their neighbour rise.
  EXPECT_LE(share_wrong(rendering, scene, light, shadows(rendering.frame, {seen_by(shot, light)}, settings_of(0.5))),
            0.002);
}

TEST(Shadow, of_a_lamp_at_the_eye_is_none) {
  const Rendering room = furnished_room(97, 61);
  for (const double off : {0., 1e-7, 1e-5})
    for (const float seen : shadows(room.frame, {lamp({off, -off, off})}, settings_of(0.5))) ASSERT_EQ(seen, 1) << off;
}

TEST(Shadow, of_sky_is_none_and_ends_with_its_reach) {
  const Scene scene = box_on_floor();
  const Shot shot = Shot::perspective({1, -3, 1}, {0.3, 0, 0.5}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  const Light light = seen_by(shot, sun({-std::cos(kPi / 6), 0.1, std::sin(kPi / 6)}));
  EstimatorSettings settings = settings_of(0.5);
  const auto all = shadows(rendering.frame, {light}, settings);
  settings.shadow_reach = 0.4;
  const auto near = shadows(rendering.frame, {light}, settings);
  int ended = 0, darker = 0;
  for (std::size_t i = 0; i < all.size(); i++) {
    if (rendering.hits[i].primitive < 0) ASSERT_EQ(all[i], 1);
    darker += near[i] < all[i];
    ended += near[i] > all[i];
    // The side of the box is at 0.5.
    if (rendering.hits[i].position.x > 0.5 + 0.45) ASSERT_EQ(near[i], 1);
  }
  EXPECT_GT(ended, 50);
  EXPECT_LE(darker, 5);  // samples lie elsewhere
}

TEST(Shadow, of_a_hard_light_does_not_depend_on_the_seed_nor_on_the_units) {
  const HostFrame room = furnished_room(97, 61).frame;
  const std::vector<Light> lights{sun({0.5, 0.6, 0.3}), lamp({0.2, 0.5, -2})};
  EstimatorSettings settings = settings_of(0.5);
  const auto once = shadows(room, lights, settings);
  for (const float either : {0.0F, 1.0F}) ASSERT_GT(std::ranges::count(once, either), 100);
  settings.seed = 7;
  settings.noise = Noise::animated;
  EXPECT_TRUE(same_bits(once, shadows(room, lights, settings)));
  auto larger = lights;
  for (double& x : larger[1].at) x *= 1024;
  settings.radius = 512;
  EXPECT_TRUE(same_bits(once, shadows(scaled(room, 10), larger, settings)));
}

/// A box on a floor, as much of it as is right of some column.
struct CutBox {
  explicit CutBox(int columns)
      : part(render(box_on_floor(), whole)), frame(crop_of(part.frame, {columns, 0, 160 - columns, 120})) {
    std::erase_if(part.hits, [&, i = 0](const Hit&) mutable { return i++ % 160 < columns; });
    part.shot.data.width = 160 - columns;
    light.at = seen_by(whole, world).at;
  }
  /// The confidence, and what is true, of all pixels.
  std::vector<float> confidence() const {
    const auto planes = shadows(frame, {light}, settings_of(0.5), "confidence,shadow");
    return {planes.begin() + std::ptrdiff_t(planes.size() / 2), planes.end()};
  }

  const Shot whole = Shot::perspective({0.5, -4, 3}, {0.5, -0.2, 0}, 45, 160, 120);
  const Light world = sun({-std::cos(kPi / 6), 0.1, std::sin(kPi / 6)});  // from the left
  Rendering part;
  HostFrame frame;
  Light light;
};

TEST(Shadow, is_confident_where_its_caster_is_in_the_frame_alone) {
  const CutBox whole(0), cut(100);
  const auto of_whole = whole.confidence(), of_cut = cut.confidence();
  double within = 0, without = 0;
  int count = 0;
  for (int y = 0; y < 120; y++)
    for (int x = 100; x < 160; x++) {
      const Hit& hit = whole.part.at(x, y);
      if (hit.primitive != 0 || is_lit(box_on_floor(), hit, whole.world)) continue;
      within += of_whole[std::size_t(160 * y + x)];
      without += of_cut[std::size_t(60 * y + x - 100)];
      count++;
    }
  ASSERT_GT(count, 200);
  EXPECT_GT(within / count, 0.9);
  EXPECT_LT(without / count, 0.5);
}

TEST(Shadow, is_wrong_where_it_is_not_confident) {
  for (const int columns : {0, 60, 100}) {
    const CutBox box(columns);
    const auto shadow = shadows(box.frame, {box.light}, settings_of(0.5));
    const auto confidence = box.confidence();
    double of_right = 0, of_wrong = 0;
    int right = 0, wrong = 0;
    for (std::size_t i = 0; i < shadow.size(); i++) {
      ASSERT_GE(confidence[i], 0);
      ASSERT_LE(confidence[i], 1);
      if (box.part.hits[i].primitive < 0) ASSERT_EQ(confidence[i], 1);
      const bool is_wrong = shadow[i] != (is_lit(box_on_floor(), box.part.hits[i], box.world) ? 1 : 0);
      (is_wrong ? of_wrong : of_right) += confidence[i];
      (is_wrong ? wrong : right)++;
    }
    EXPECT_LT(of_wrong / wrong, 0.7 * of_right / right) << columns << ": " << wrong << " of " << shadow.size();
  }
}

TEST(Shadow, of_a_lamp_in_the_frame_is_known_without_what_is_outside) {
  const HostFrame floor = render({{kGround}}, Shot::perspective({0, -3, 3}, {0, -0.5, 0}, 45, 80, 60)).frame;
  const Light light = lamp({0, 0, -3});
  const auto planes = shadows(floor, {light}, settings_of(0.5), "confidence,shadow");
  for (const float known : planes) ASSERT_EQ(known, 1);
}

TEST(Shadow, of_a_lamp_behind_two_surfaces_is_that_of_the_peels) {
  Scene scene{{kGround}};
  scene.add(parallelepiped({-0.6, 0, 0.4}, {1.2, 0, 0}, {0, 0.05, 0}, {0, 0, 0.8}));
  scene.add(parallelepiped({-0.6, 0.8, 0}, {1.2, 0, 0}, {0, 0.05, 0}, {0, 0, 0.5}));
  const Shot shot = Shot::perspective({0, -4, 2.2}, {0, 0, 0.3}, 45, 160, 120);
  const Rendering rendering = render(scene, shot);
  const Light light = lamp({0, 1.3, 0.3});
  const auto wrong = [&](const HostFrame& frame) {
    return share_wrong(rendering, scene, light, shadows(frame, {seen_by(shot, light)}, settings_of(0.5)), 2);
  };
  const double of_one = wrong(rendering.frame), of_peels = wrong(peeled(scene, shot, 4));
  EXPECT_GT(of_one, 0.05);
  EXPECT_LT(of_peels, 0.01);
}

TEST(Shadow, of_a_wall_goes_on_beyond_the_border_as_the_settings_say) {
  const Shot shot = Shot::perspective({3, 0, 1.5}, {0, 0, 0.2}, 50, 120, 90);
  const CutWall cut(shot);
  const Light light = sun({-1, 0, 1});
  EstimatorSettings settings = settings_of(0.5);
  std::vector<double> dark;  // part of the floor, in the shadow of the wall's part that is cut off
  for (const Completion complete : {Completion::none, Completion::border}) {
    settings.complete = complete;
    const auto shadow = shadows(cut.frame, {seen_by(shot, light)}, settings);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < shadow.size(); i++) {
      const Hit& hit = cut.whole.hits[i + std::size_t(cut.rows * shot.data.width)];
      if (hit.primitive != 0 || hit.position.x < 0.3 || hit.position.x > 0.5) continue;
      sum += 1 - shadow[i];
      count++;
    }
    dark.push_back(sum / count);
  }
  EXPECT_EQ(dark[0], 0);
  EXPECT_GT(dark[1], 0.9);
}

/// The share of pixels that differ from the reference, of every seventh.
double share_off(const HostFrame& frame, const Light& light, const EstimatorSettings& settings, double& dark) {
  ReferenceSettings exact = reference_settings_of(settings);
  for (std::size_t i = 0; i < frame.data.pixels(); i += 7) exact.pixels.push_back(i);
  const auto plane = shadows(frame, {light}, settings);
  const auto truth = reference_shadow(frame, exact, {light.is_lamp, {light.at[0], light.at[1], light.at[2]}}, 1e6);
  int wrong = 0, blocked = 0;
  for (const std::size_t i : exact.pixels) {
    wrong += std::abs(plane[i] - truth[i]) > 0.5;
    blocked += truth[i] < 0.5;
  }
  dark = double(blocked) / double(exact.pixels.size());
  return double(wrong) / double(exact.pixels.size());
}

TEST(Shadow, is_near_the_reference) {
  for (const char* scene : {"colonnade", "interior"})
    for (const Light& light : {sun({0.6, 0.6, 0.4}), lamp({0.5, 0.7, -3})})
      for (const auto thickness : {ThicknessKind::infinite, ThicknessKind::constant, ThicknessKind::automatic}) {
        EstimatorSettings settings = settings_of(0.5);
        settings.search = SliceSearch::exact;
        settings.complete = Completion::none;
        settings.thickness = thickness;
        settings.thickness_length = 0.2;
        double dark = 0;
        // The rules of `auto` differ between a search by samples and an exact one.
        EXPECT_LE(share_off(rendered_frame(scene), light, settings, dark),
                  thickness == ThicknessKind::automatic ? 0.08 : 0.04)
            << scene << ", lamp: " << light.is_lamp << ", " << name_of(settings);
        EXPECT_GT(dark, 0.03);
      }
}

}  // namespace
}  // namespace alcove::shadow_test
