// What other frames and views show behind the first surface lies where it is in the world, and stands still.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/filters/filters.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/hidden/hidden.h"
#include "core/frame/find/lights.h"
#include "kernels/base/reprojection.h"
#include "kernels/hidden/hidden.h"
#include "tests/support/chain.h"

namespace alcove::other_views_test {
namespace {

using namespace test;

/// A map from the view space of one shot to that of another.
void put_map(OtherView& view, const Shot& from, const Shot& to) {
  const Vec3 axes[] = {to.right, to.up, to.back};
  for (std::size_t i = 0; i < 3; i++)
    view.to_here[i] = {float(dot(axes[i], from.right)), float(dot(axes[i], from.up)), float(dot(axes[i], from.back)),
                       float(dot(axes[i], from.eye - to.eye))};
}

/// The rendering in buffers of the recorder that begin with `name`.
OtherView seen_by(const Rendering& other, const Shot& here, const std::string& name) {
  const GBuffer gbuffer = prepare(recorder(), upload(recorder(), other.frame), name + " ");
  recorder().run();
  OtherView view;
  view.view = gbuffer.view;
  view.depth_precision = gbuffer.depth_precision;
  view.depth = gbuffer.depth;
  view.normal = gbuffer.normal;
  put_map(view, other.shot, here);
  return view;
}

/// Marks what moves in one of several renderings, as all the others tell.
const gpu::Buffer& moving_in(const std::vector<Rendering>& renderings, std::size_t which, const std::string& name) {
  std::vector<OtherView> witnesses;
  for (std::size_t i = 0; i < renderings.size(); i++)
    if (i != which) witnesses.push_back(seen_by(renderings[i], renderings[which].shot, "witness " + std::to_string(i)));
  const OtherView view = seen_by(renderings[which], renderings[which].shot, "witnessed");
  const gpu::Buffer& moving = recorder().buffer(name, view.depth->bytes(), gpu::Use::device);
  surfels(recorder(), view, witnesses, moving);
  recorder().run();
  return moving;
}

/// What lies behind the first surface.
struct Hidden {
  std::vector<float> planes;
  ViewCounts counts{};
};
Hidden hidden_of(const Rendering& here, const std::vector<OtherView>& others, int kept = kMostHidden) {
  FrameInputs inputs = upload(recorder(), here.frame);
  inputs.others = others;
  const Layering layering{kept, -1};
  const GBuffer warped = warp(recorder(), prepare(recorder(), inputs), inputs, layering);
  const GBuffer gbuffer = layers(recorder(), warped, inputs, layering);
  recorder().download(*gbuffer.hidden);
  recorder().download(*gbuffer.view_counts);
  recorder().run();
  const auto planes = gbuffer.hidden->as<float>();
  return {{planes.begin(), planes.end()}, gbuffer.view_counts->as<ViewCounts>()[0]};
}

constexpr int kWidth = 96, kHeight = 64;

/// A plate before a wall that is 4 away and turned away from the camera at the origin, which looks along y.
const Polygon kPlate = parallelogram({-0.4, 2, -0.4}, {0.8, 0, 0}, {0, 0, 0.8});
const Plane kWall{{0, 4, 0}, unit({0.3, -1, 0.2})};

Shot looking(Vec3 eye, Vec3 target, bool orthographic) {
  return orthographic ? Shot::orthographic(eye, target, 3.2, kWidth, kHeight)
                      : Shot::perspective(eye, target, 60, kWidth, kHeight);
}

/// The largest relative error of what was found, and the part of the hidden wall that was found.
struct Outcome {
  double error = 0, found = 0;
};
Outcome wall_behind_plate(const Rendering& here, const Hidden& hidden) {
  const Scene wall{{kWall}};
  Outcome outcome;
  int behind = 0, found = 0;
  for (int y = 0; y < kHeight; y++) {
    for (int x = 0; x < kWidth; x++) {
      const float z = hidden.planes[std::size_t(y * kWidth + x)];
      behind += here.at(x, y).primitive == 0;
      if (z >= kSkyDepth) continue;
      found++;
      const double truth = wall.hit(here.shot.ray(x + 0.5, y + 0.5)).distance;
      EXPECT_EQ(here.at(x, y).primitive, 0) << "nothing is hidden behind the wall at " << x << " " << y;
      outcome.error = std::max(outcome.error, std::abs(double(z) - truth) / truth);
    }
  }
  outcome.found = double(found) / behind;
  return outcome;
}

class Projections : public testing::TestWithParam<std::pair<bool, bool>> {};
INSTANTIATE_TEST_SUITE_P(All, Projections,
                         testing::Values(std::pair{false, false}, std::pair{false, true}, std::pair{true, false},
                                         std::pair{true, true}));

TEST_P(Projections, what_another_view_sees_behind_a_plate_casts_its_shadow) {
  const auto [of_other, of_here] = GetParam();
  const Scene scene{{Plane{{0, 0, -0.6}, {0, 0, 1}}, parallelogram({-0.7, 2, -0.3}, {1.4, 0, 0}, {0, 0, 0.9}),
                     parallelogram({-0.3, 2.6, -0.6}, {0.6, 0, 0}, {0, 0, 0.8})}};
  const Shot shot = looking({0, -1, 0.8}, {0, 2.5, -0.3}, of_here);
  const Rendering here = render(scene, shot);
  const Rendering other = render(scene, looking({0.5, 5.5, 0.8}, {0, 2.5, -0.3}, of_other));
  const Vec3 way{0, 1, 0.8}, toward = shot.view_from_world(unit(way));
  const auto shadow_of = [&](const std::vector<OtherView>& others) {
    OutputSettings output;
    output.lights = "lights.json";
    output.read_lights = lights_of(R"({"lights": [{"name": "a", "kind": "sun", "direction": [0, 0, 1]}]})", "");
    output.aovs = "shadow";
    FrameInputs inputs = upload(recorder(), here.frame);
    inputs.others = others;
    inputs.lights = {{.at = {toward.x, toward.y, toward.z}}};
    EstimatorSettings settings = plain_settings();
    settings.radius = 0.5;
    settings.thickness = ThicknessKind::constant;
    settings.thickness_length = 0.05;
    const FrameOutputs outputs = run_chain(recorder(), inputs, settings, output);
    recorder().run();
    return values_of(outputs.shadow);
  };
  // On the floor before the plate, the far side of the plate hides what casts this shadow below it.
  const auto alone = shadow_of({}), found = shadow_of({seen_by(other, shot, "other")});
  int count = 0, dark_alone = 0, dark_found = 0;
  for (std::size_t i = 0; i < found.size(); i++) {
    const Hit& hit = here.hits[i];
    if (hit.primitive != 0) continue;
    const Hit blocker = scene.hit({hit.position + 1e-6 * hit.normal, way});
    if (blocker.primitive != 2) continue;
    count++;
    dark_alone += alone[i] < 0.5;
    dark_found += found[i] < 0.5;
  }
  EXPECT_GT(count, 50);
  EXPECT_LT(dark_alone, count / 2);
  EXPECT_GT(dark_found, 9 * count / 10);
}

TEST_P(Projections, a_wall_that_another_view_sees_is_found_behind_what_hides_it) {
  const auto [of_other, of_here] = GetParam();
  const Rendering here = render({{kPlate, kWall}}, looking({0, 0, 0}, {0, 4, 0}, of_here));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 8; i++) {
    // From beside the plate, where it hides nothing that it hides here.
    const Vec3 eye{i % 2 ? 1.4 : -1.4, 2.2 + 0.3 * any(random), 0.5 * any(random)};
    const Rendering other =
        render({{kPlate, kWall}}, looking(eye, {0.1 * any(random), 4, 0.1 * any(random)}, of_other));
    const Outcome outcome = wall_behind_plate(here, hidden_of(here, {seen_by(other, here.shot, "other")}));
    EXPECT_LE(outcome.error, 1e-4) << i;
    EXPECT_GE(outcome.found, of_other ? 0.5 : 0.9) << i;
  }
}

TEST(OtherViews, the_same_view_shows_nothing_behind) {
  const Rendering room = furnished_room(kWidth, kHeight);
  const Hidden hidden = hidden_of(room, {seen_by(room, room.shot, "other")});
  EXPECT_THAT(hidden.planes, Each(kSkyDepth));
  EXPECT_EQ(hidden.counts.moved, 0);
}

/// Five frames of a shot: the camera goes to the right along a wall, before which a box jumps to and fro, each time by
/// more than it is wide. In each frame a post hides a place where another frame shows the box.
struct MovingBox {
  static constexpr int kFrames = 5;

  static Scene still() {
    return {{Plane{{0, 5, 0}, unit({0.1, -1, 0.1})}, parallelogram({-0.3, 2, -2}, {0.5, 0, 0}, {0, 0, 4})}};
  }
  static Scene at(int frame) {
    Scene scene = still();
    const double left = std::array{-0.6, -1.05, 0.65, 0.2, 1.1}[std::size_t(frame)];
    scene.primitives.push_back(parallelogram({left, 3.5, -0.3}, {0.4, 0, 0}, {0, 0, 0.6}));
    scene.primitives.push_back(parallelogram({left, 3.5, -0.3}, {0, 0.4, 0}, {0, 0, 0.6}));
    scene.primitives.push_back(parallelogram({left + 0.4, 3.5, -0.3}, {0, 0.4, 0}, {0, 0, 0.6}));
    scene.primitives.push_back(parallelogram({left, 3.5, 0.3}, {0.4, 0, 0}, {0, 0.4, 0}));
    return scene;
  }
  static std::vector<Rendering> renderings() {
    std::vector<Rendering> all;
    for (int frame = 0; frame < kFrames; frame++) {
      const Vec3 eye{-0.6 + 0.3 * frame, 0, 0.1};
      all.push_back(render(at(frame), Shot::perspective(eye, eye + Vec3{0, 5, 0}, 50, kWidth, kHeight)));
    }
    return all;
  }
};

/// The others of a frame of the shot; with what moves, or without.
std::vector<OtherView> others_of(const std::vector<Rendering>& shot, std::size_t frame, bool judged) {
  std::vector<OtherView> others;
  for (std::size_t i = 0; i < shot.size(); i++) {
    if (i == frame) continue;
    OtherView view = seen_by(shot[i], shot[frame].shot, "frame " + std::to_string(i));
    if (judged) view.moving = &moving_in(shot, i, "moving " + std::to_string(i));
    others.push_back(view);
  }
  return others;
}

/// Hidden surfaces that are none of the scene's that stands still.
int ghosts(const Rendering& here, const Hidden& hidden) {
  const Scene still = MovingBox::still();
  int count = 0;
  for (std::size_t i = 0; i < hidden.planes.size(); i++) {
    const float z = hidden.planes[i];
    if (z >= kSkyDepth) continue;
    const auto pixel = int(i % here.hits.size());
    const Ray ray = here.shot.ray(pixel % kWidth + 0.5, pixel / kWidth + 0.5);
    const bool is_still = std::ranges::any_of(still.primitives, [&](const auto& primitive) {
      return std::abs(Scene{{primitive}}.hit(ray).distance / double(z) - 1) < 0.005;
    });
    count += !is_still;
  }
  return count;
}

int surfaces(const Hidden& hidden) {
  return int(std::ranges::count_if(hidden.planes, [](float z) { return z < kSkyDepth; }));
}

TEST(OtherViews, what_moves_leaves_nothing_behind) {
  const std::vector<Rendering> shot = MovingBox::renderings();
  for (std::size_t frame = 0; frame < shot.size(); frame++) {
    const Hidden hidden = hidden_of(shot[frame], others_of(shot, frame, true));
    EXPECT_EQ(ghosts(shot[frame], hidden), 0) << frame;
    EXPECT_GT(surfaces(hidden), 500) << frame;
    EXPECT_GT(hidden.counts.moved, 200u) << frame;
    EXPECT_GT(ghosts(shot[frame], hidden_of(shot[frame], others_of(shot, frame, false))), 20)
        << "the test shows nothing: without judging nothing goes wrong in frame " << frame;
  }
}

TEST(OtherViews, what_stands_still_is_confirmed) {
  const Scene still = MovingBox::still();
  std::vector<Rendering> shot;
  for (int frame = 0; frame < 3; frame++) {
    const Vec3 eye{-0.3 + 0.3 * frame, 0, 0.1};
    shot.push_back(render(still, Shot::perspective(eye, eye + Vec3{0, 5, 0}, 50, kWidth, kHeight)));
  }
  const gpu::Buffer& moving = moving_in(shot, 1, "moving");
  recorder().download(moving);
  recorder().run();
  const auto flags = moving.as<const uint>();
  EXPECT_EQ(std::ranges::count(flags, kFlagMoves), 0);
  EXPECT_GT(std::ranges::count(flags, 0u), std::ptrdiff_t(0.95 * double(flags.size())));
}

TEST(OtherViews, their_order_changes_no_bit) {
  const std::vector<Rendering> shot = MovingBox::renderings();
  std::vector<OtherView> others = others_of(shot, 2, true);
  const Hidden hidden = hidden_of(shot[2], others);
  std::ranges::reverse(others);
  EXPECT_EQ(hidden_of(shot[2], others).planes, hidden.planes);
  std::swap(others[0], others[1]);
  EXPECT_EQ(hidden_of(shot[2], others).planes, hidden.planes);
}

TEST(OtherViews, are_the_same_in_any_units) {
  const std::vector<Rendering> shot = MovingBox::renderings();
  const Hidden expected = hidden_of(shot[2], others_of(shot, 2, true));
  ASSERT_GT(surfaces(expected), 100);
  for (const int exponent : {-50, 50}) {
    std::vector<Rendering> there = shot;
    for (auto& rendering : there) {
      rendering.frame = scaled(rendering.frame, exponent);
      rendering.shot.eye = std::ldexp(1.0, exponent) * rendering.shot.eye;
    }
    Hidden hidden = hidden_of(there[2], others_of(there, 2, true));
    for (float& z : hidden.planes) z = z < kSkyDepth ? std::ldexp(z, -exponent) : z;
    EXPECT_TRUE(same_bits(hidden.planes, expected.planes)) << exponent;
    EXPECT_EQ(hidden.counts.moved, expected.counts.moved) << exponent;
  }
}

TEST(OtherViews, parts_of_the_frame_have_the_bits_of_the_whole_and_share_what_is_counted) {
  const std::vector<Rendering> shot = MovingBox::renderings();
  const std::vector<OtherView> others = others_of(shot, 2, true);
  const Hidden whole = hidden_of(shot[2], others);
  ViewCounts sum{};
  for (const Window& window :
       {Window{31, 7, 40, 45}, {0, 0, kWidth / 2, kHeight}, {kWidth / 2, 0, kWidth / 2, kHeight}}) {
    Shot part = shot[2].shot;
    part.data = window;
    const Hidden hidden = hidden_of(render(MovingBox::at(2), part), others);
    EXPECT_EQ(hidden.planes, cropped(whole.planes, shot[2].shot.data, window));
    EXPECT_GT(surfaces(hidden), 100);
    if (window.height < kHeight) continue;
    sum.moved += hidden.counts.moved;
    sum.unconfirmed += hidden.counts.unconfirmed;
  }
  EXPECT_GT(whole.counts.moved, 200u);
  EXPECT_GE(sum.moved, whole.counts.moved);
  EXPECT_LE(sum.moved, whole.counts.moved + whole.counts.moved / 8) << "what lies on the border is of both";
  EXPECT_LE(sum.unconfirmed, whole.counts.unconfirmed + whole.counts.unconfirmed / 8 + 8);
}

TEST(OtherViews, surfaces_of_files_and_of_views_are_one_list) {
  const std::vector<Rendering> shot = MovingBox::renderings();
  Rendering here = shot[2];
  here.frame.behind = {{}};
  here.frame.behind_depth.assign(here.hits.size(), 3.0f);
  const Hidden of_views = hidden_of(shot[2], others_of(shot, 2, true), 1);
  const Hidden of_both = hidden_of(here, others_of(shot, 2, true), 2);
  int both = 0;
  for (std::size_t i = 0; i < here.hits.size(); i++) {
    if (here.frame.depth[i] > 2.5f || of_views.planes[i] < 3.5f || of_views.planes[i] >= kSkyDepth) continue;
    both++;
    EXPECT_EQ(of_both.planes[i], 3.0f) << i;
    EXPECT_EQ(of_both.planes[i + here.hits.size()], of_views.planes[i]) << i;
  }
  EXPECT_GT(both, 300);
}

/// A room, and the part of its picture in the middle, which others see whole.
struct Part {
  static constexpr ivec2 kAround{24, 16};  // px of the whole to each side of the part

  Rendering whole = furnished_room(kWidth, kHeight), part = whole;
  Part() {
    part.shot.data = {kAround.x, kAround.y, kWidth - 2 * kAround.x, kHeight - 2 * kAround.y};
    part.frame = crop_of(whole.frame, part.shot.data);
  }

  std::vector<float> ao_with(const Margin& margin, const EstimatorSettings& settings, uint* tiles = nullptr) const {
    const OtherView other = seen_by(whole, whole.shot, "other");
    FrameInputs inputs = upload(recorder(), part.frame);
    inputs.others = {other};
    inputs.margin = margin;
    const FrameOutputs outputs = run_chain(recorder(), inputs, settings);
    recorder().run();
    if (tiles) *tiles = outputs.tiles->as<TileCounts>()[0].listed;
    return values_of(outputs.ao);
  }
};

TEST(OtherViews, what_they_show_around_the_picture_blocks_at_its_border) {
  const Part room;
  EstimatorSettings settings = plain_settings();
  settings.radius = 1;
  settings.slices = 16;
  const std::vector<float> truth =
      cropped(ao_of(room.whole.frame, settings), room.whole.shot.data, room.part.shot.data);
  const double without = difference(room.ao_with({}, settings), truth).rmse;
  const double with = difference(room.ao_with({Part::kAround, Part::kAround}, settings), truth).rmse;
  const double half = difference(room.ao_with({{12, 8}, {12, 8}}, settings), truth).rmse;
  // Planes that go on beyond the border leave little of it.
  EXPECT_GT(without, 0.007);
  EXPECT_LT(half, without);
  EXPECT_LT(with, 0.2 * without);
}

TEST(OtherViews, estimates_of_a_margin_that_nobody_needs_are_left_out) {
  const Part room;
  EstimatorSettings plain = plain_settings();
  plain.radius = 0.3;
  EstimatorSettings filtered = plain, box = plain, shared = plain, half = plain, bitmask = plain;
  filtered.denoise = Denoise::bilateral;
  box.denoise = Denoise::box;
  shared.denoise = Denoise::bilateral;
  shared.slices = 2;
  shared.density = Density::adaptive;
  half.resolution = Resolution::half;
  half.denoise = Denoise::bilateral;
  bitmask.estimator = Estimator::bitmask;
  for (const EstimatorSettings& settings : {plain, filtered, box, shared, half, bitmask})
    for (const Margin& margin : {Margin{{24, 16}, {24, 16}}, Margin{{23, 9}, {17, 13}}, Margin{{24, 0}, {0, 16}}}) {
      uint some = 0, all = 0;
      const std::vector<float> ao = room.ao_with(margin, settings, &some);
      EstimatorSettings without = settings;
      without.no_skip = true;
      const std::vector<float> whole = room.ao_with(margin, without, &all);
      EXPECT_TRUE(same_bits(ao, whole)) << int(settings.denoise) << " " << margin.before.x;
      if (filter_reach_of(settings) < kTile) EXPECT_LT(some, all) << int(settings.denoise) << " " << margin.before.x;
    }
  uint tiles = 0;
  room.ao_with({Part::kAround, Part::kAround}, plain, &tiles);
  EXPECT_EQ(tiles, room.part.shot.data.pixels() / (kTile * kTile)) << "those of the frame alone";
}

TEST(OtherViews, a_margin_on_one_side_leaves_the_frame_in_its_place) {
  const Part room;
  EstimatorSettings settings;
  settings.radius = 0.6;
  settings.stride = 1;
  const std::vector<float> without = room.ao_with({}, settings);
  for (const Margin& margin : {Margin{{8, 0}, {}}, Margin{{0, 16}, {}}, Margin{{}, {8, 0}}, Margin{{}, {0, 8}}}) {
    const Difference shift = difference(room.ao_with(margin, settings), without);
    EXPECT_LT(shift.rmse, 0.05) << "it moved";
    EXPECT_GT(shift.rmse, 0) << "there is no margin";
  }
}

/// Where others show the frame alone, the margin must go on from the surfaces as they are.
TEST(OtherViews, normals_at_the_border_are_those_without_a_margin) {
  const Part room;
  HostFrame without_normals = room.part.frame;
  without_normals.normal.clear();
  EstimatorSettings settings = plain_settings();
  settings.radius = 0.5;
  OutputSettings output;
  output.aovs = "ao,normal";
  const auto normals_with = [&](const Margin& margin) {
    const OtherView other = seen_by(room.part, room.part.shot, "other");
    FrameInputs inputs = upload(recorder(), without_normals);
    inputs.others = {other};
    inputs.margin = margin;
    const FrameOutputs outputs = run_chain(recorder(), inputs, settings, output);
    recorder().run();
    return values_of(outputs.normal);
  };
  EXPECT_EQ(normals_with({{8, 8}, {8, 8}}), normals_with({}));
}

TEST(OtherViews, a_part_has_a_margin_where_it_ends_with_the_frame) {
  const Window frame{-4, 2, 80, 40};
  const auto sides = [&](const Window& part) {
    const Margin m = margin_of(part, frame);
    return std::array{m.before.x, m.before.y, m.after.x, m.after.y};
  };
  EXPECT_EQ(sides(frame), (std::array{10, 10, 10, 10}));
  EXPECT_EQ(sides({-4, 2, 40, 20}), (std::array{10, 10, 0, 0}));
  EXPECT_EQ(sides({36, 22, 40, 20}), (std::array{0, 0, 10, 10}));
  EXPECT_EQ(sides({0, 10, 20, 20}), (std::array{0, 0, 0, 0}));
}

}  // namespace
}  // namespace alcove::other_views_test
