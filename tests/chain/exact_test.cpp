// The exact search: what its outlines leave out, the CPU reference, what goes on where the picture does not show it,
// surfaces behind the first one that are known, crops, and what it refuses.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/reference/reference.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::exact_test {
namespace {

using namespace test;

EstimatorSettings exact(double radius, Completion complete, bool every_pixel = false) {
  EstimatorSettings settings = test::exact(radius);
  settings.complete = complete;
  settings.every_pixel = every_pixel;
  return settings;
}

/// Floor, wall, ball, a slab in the air, thin posts, and sky; the ball is solid.
const Scene kFurniture = [] {
  Scene scene = kRoom;
  for (int i = 0; i < 6; i++)
    scene.primitives.emplace_back(parallelogram({2.5, 0.2 + 0.15 * i, 0}, {0, 0.03, 0}, {0, 0, 0.6}));
  return scene;
}();
const std::vector<int> kSolidFurniture{2};

Rendering furniture(bool orthographic = false, int width = 160, int height = 120) {
  return render(kFurniture, room_shot(width, height, orthographic));
}

Rendering peeled_furniture(bool orthographic = false, int width = 160, int height = 120) {
  Rendering rendering = furniture(orthographic, width, height);
  add_solid_peels(rendering, kFurniture, 3, kSolidFurniture);
  return rendering;
}

HostFrame without_peels(HostFrame frame) {
  frame.behind.clear();
  frame.behind_depth.clear();
  return frame;
}

/// With each change a Latin square of completions, thicknesses and radii, and a third of those with peels.
TEST(Exact, outlines_give_what_every_pixel_gives) {
  for (const bool orthographic : {false, true}) {
    const HostFrame peeled = peeled_furniture(orthographic, 128, 96).frame, plain = without_peels(peeled);
    for (const auto complete : {Completion::none, Completion::border, Completion::all})
      for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant})
        for (const int size : {0, 1, 2, 3}) {
          const double radius = std::array{0.3, 1.0, 100.0, 0.6}[std::size_t(size)];
          const bool has_peels = radius == 0.6;
          const int rule = int(thickness), completion = int(complete);
          if (has_peels ? thickness != ThicknessKind::automatic || !tried(orthographic + completion, 3)
                        : !tried(size + 2 * (rule + completion), 3) || !tried(orthographic + rule + completion, 2))
            continue;
          EstimatorSettings outlines = exact(radius, complete);
          outlines.thickness = thickness;
          outlines.thickness_length = 0.2;
          EstimatorSettings pixels = outlines;
          pixels.every_pixel = true;
          const HostFrame& frame = has_peels ? peeled : plain;
          const Difference d = difference(ao_of(frame, outlines), ao_of(frame, pixels));
          SCOPED_TRACE(name_of(outlines) + (orthographic ? ", orthographic" : ""));
          // How a surface goes on, two vertices say: of outlines these are far apart, and what a pixel leaves of the
          // straight line counts the more the farther it goes on.
          const bool goes_on = complete == Completion::all && thickness != ThicknessKind::infinite;
          EXPECT_LE(d.rmse, goes_on ? 0.006 : 0.003) << place(d, frame);
          EXPECT_LE(std::abs(d.bias), has_peels || complete != Completion::none ? 0.001 : 0.0005);
          EXPECT_GT(d.max, 0) << "the two searches are one";
        }
  }
}

TEST(Exact, is_what_the_reference_computes) {
  for (const bool orthographic : {false, true}) {
    const HostFrame frame = furniture(orthographic).frame;
    for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant}) {
      EstimatorSettings settings = test::exact(0.6);
      settings.thickness = thickness;
      settings.thickness_length = 0.2;
      ReferenceSettings some = reference_settings_of(settings);
      for (std::size_t i = 0; i < frame.depth.size(); i += long_tests() ? 7 : 23) some.pixels.push_back(i);
      const std::vector<float> reference = reference_ao(frame, some), ao = ao_of(frame, settings);
      std::vector<float> compared;
      for (const std::size_t i : some.pixels) compared.push_back(ao[i]);
      const Difference d = difference(compared, [&](std::size_t i) { return reference[some.pixels[i]]; });
      EXPECT_LE(d.mean, 0.01) << orthographic << ", thickness " << int(thickness) << ", pixel " << some.pixels[d.worst];
      EXPECT_LE(std::abs(d.bias), 0.003) << orthographic << ", thickness " << int(thickness);
    }
  }
}

/// Walls and floors come to light again behind the posts, in the planes in which they went on.
TEST(Exact, the_last_bit_of_the_depth_decides_nothing) {
  for (const bool orthographic : {false, true}) {
    HostFrame frame = furniture(orthographic, 320, 240).frame;
    const std::vector<float> ao = ao_of(frame, test::exact(0.6));
    for (std::size_t i = 0; i < frame.depth.size(); i++)
      if (frame.depth[i] < kSky) frame.depth[i] = std::nextafter(frame.depth[i], i * i % 7 < 4 ? 0.0F : kSky);
    const Difference d = difference(ao, ao_of(frame, test::exact(0.6)));
    EXPECT_LE(d.rmse, 5e-5) << place(d, frame);
  }
}

TEST(Exact, planes_are_open_at_every_tilt) {
  for (const auto& [what, rendering] : slanted_planes({0, 30, 60, 80, 88}, {0, 25, 90}, {60}, 96, 64))
    for (const auto& settings : {test::exact(0.5), shared_directions(0.5), test::exact(50)}) {
      std::vector<float> ao = ao_of(rendering.frame, settings);
      const bool is_steep = -rendering.hits[32 * 96 + 48].normal.x < 0.51;
      for (int i = 0; i < int(ao.size()); i++) {
        const int x = i % 96, y = i / 96;
        // At the horizon, and where it meets the border, nothing tells a plane from an edge.
        if (is_steep && (x < 4 || y < 4 || x >= 92 || y >= 60 || rendering.primitives_within(2, x, y) > 1))
          ao[std::size_t(i)] = 1;
      }
      const Difference d = difference(ao, [](std::size_t) { return 1.0; });
      EXPECT_LE(d.max, 1e-3) << what << ", " << name_of(settings) << ", " << place(d, rendering.frame);
    }
}

// What goes on where the picture does not show it, or is known there.

/// A plate that stands farther than the radius before the corner of floor and wall that it hides, so it blocks nothing.
const Scene kPlateBeforeCorner{{kFloor, kWallX, parallelogram({2.3, -0.6, 2.1}, {0, 1.2, 0}, {-0.14, 0, 0.14})}};

TEST(Exact, a_wall_goes_on_behind_a_plate_and_blocks_where_it_is_known_there) {
  for (const Shot& shot : {Shot::perspective({4, 0, 4}, {0.5, 0, 0.5}, 50, 160, 120),
                           Shot::orthographic({4, 0, 4}, {0.5, 0, 0.5}, 5, 160, 120)}) {
    Rendering rendering = render(kPlateBeforeCorner, shot);
    const HostFrame first = rendering.frame;
    add_solid_peels(rendering, kPlateBeforeCorner, 1);
    const Truth wall = wall_truth(shot, 1);
    const Truth truth = [&](const Hit& hit) { return std::abs(hit.position.y) > 0.8 ? kNone : wall(hit); };
    const auto error = [&](const HostFrame& frame, const EstimatorSettings& settings) {
      const Errors errors = errors_of(rendering, ao_of(frame, settings), truth);
      EXPECT_GT(errors.pixels.size(), 300u);
      return errors.mean;
    };
    const double all = error(first, exact(1, Completion::all)), none = error(first, exact(1, Completion::none));
    EXPECT_LE(all, 0.004) << none;
    EXPECT_GE(none, 3 * all);
    for (const bool every_pixel : {false, true})
      for (const Completion complete : {Completion::none, Completion::all}) {
        if (!tried(shot.camera.orthographic + !every_pixel + (complete == Completion::none), 2)) continue;
        const double known = error(rendering.frame, exact(1, complete, every_pixel));
        EXPECT_LE(known, 0.004) << int(complete);
        if (!shot.camera.orthographic) EXPECT_GT(none, 2 * known);
      }
  }
}

TEST(Exact, a_wall_goes_on_beyond_the_border) {
  const Rendering rendering = render({{kFloor, kWallX}}, Shot::perspective({3, 0, 1}, {0.15, 0, 0.1}, 70, 360, 60));
  const auto error = [&](Completion complete) {
    const Errors errors = errors_of(rendering, ao_of(rendering.frame, exact(1, complete)), [](const Hit& hit) {
      if (std::abs(hit.position.y) > 0.7) return kNone;
      return beside_wall(hit.primitive == 0 ? hit.position.x : hit.position.z);
    });
    EXPECT_GT(errors.pixels.size(), 500u);
    return errors.mean;
  };
  const double none = error(Completion::none);
  for (const Completion complete : {Completion::border, Completion::all})
    EXPECT_LE(error(complete), 0.25 * none) << none;
}

/// A scene whose hidden surfaces are known, against its first surfaces alone.
struct Known {
  const char* what;
  Scene scene;
  std::vector<int> solids;
  Shot shot;
  double radius;
  Completion known, guessed;
  Truth truth;
  double most, gain;  // the mean error, and by how much that of the first surfaces is larger
};

/// One in so many hits, by where it lies.
bool is_sample(const Hit& hit, int every) {
  return int(1000 * (hit.position.x + 7 * hit.position.y + 13 * hit.position.z)) % every == 0;
}

TEST(ExactHidden, what_is_known_is_what_rays_see) {
  const Scene balls{{Plane{.point = {0, 0, -0.8}, .normal = {0, 0, 1}}, Sphere{.center = {0, 0, 0}, .radius = 0.7},
                     Sphere{.center = {1.6, 0.2, 0.3}, .radius = 0.5}}};
  // Two walls, of which a post hides a part of one and of the floor. It stands too far away to block anything there.
  const Scene corridor{{kFloor, kWallX, Plane{.point = {1.5, 0, 0}, .normal = {1, 0, 0}},
                        parallelogram({0.15, -1.9, 1.2}, {0.4, 0, 0}, {0, 0.3, 0.5})}};
  const Known cases[]{
      {"a ball before a ball",
       balls,
       {1, 2},
       Shot::perspective({6, 0, 2.5}, {0.4, 0, -0.2}, 40, 200, 150),
       1.2,
       Completion::border,
       Completion::all,
       [&](const Hit& hit) {
         if (std::abs(hit.position.y) > 1 || hit.position.x < -1 || hit.position.x > 2.6 || !is_sample(hit, 7))
           return kNone;
         return true_ao(balls, hit, 1.2, 40);
       },
       0.005,
       2},
      {"a corridor behind the post in it",
       corridor,
       {},
       Shot::perspective({0.75, -3, 2.2}, {0.75, 0.5, 0}, 50, 240, 180),
       1,
       Completion::none,
       Completion::none,
       [](const Hit& hit) {
         if (hit.primitive != 0 || std::abs(hit.position.y) > 0.6) return kNone;
         return beside_wall(hit.position.x) + beside_wall(1.5 - hit.position.x) - 1;
       },
       0.005,
       1.3},
      {"a furnished room", kFurniture, kSolidFurniture, furniture().shot, 0.6, Completion::all, Completion::all,
       [](const Hit& hit) {
         return is_sample(hit, 11) && hit.position.x < 3 ? true_ao(kFurniture, hit, 0.6, 40) : kNone;
       },
       1, 1.25}};
  for (const Known& known : cases) {
    SCOPED_TRACE(known.what);
    Rendering rendering = render(known.scene, known.shot);
    const std::vector<float> first = ao_of(rendering.frame, exact(known.radius, known.guessed));
    add_solid_peels(rendering, known.scene, 3, known.solids);
    const Errors errors = errors_of(rendering, ao_of(rendering.frame, exact(known.radius, known.known)), known.truth);
    EXPECT_GT(errors.pixels.size(), 200u);
    EXPECT_LE(errors.mean, known.most);
    double guessed = 0;
    for (std::size_t i = 0; i < errors.pixels.size(); i++)
      guessed += std::abs(first[errors.pixels[i]] - errors.truths[i]) / double(errors.pixels.size());
    EXPECT_GE(guessed, known.gain * errors.mean);
  }
}

TEST(Exact, a_thing_alone_before_the_sky_is_not_completed) {
  const Scene scene{
      {Sphere{.center = {0, 0, 0}, .radius = 1}, parallelogram({1.2, -0.5, -0.5}, {0.3, 0, 0}, {0, 0, 1})}};
  const HostFrame frame = render(scene, Shot::perspective({0.3, -6, 0.5}, {0, 0, 0}, 40, 160, 120)).frame;
  EstimatorSettings settings = test::exact(1);
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = 0.2;
  const std::vector<float> all = ao_of(frame, settings);
  settings.complete = Completion::none;
  // Drivers may round the last bits of this kernel otherwise.
  const Difference d = difference(all, ao_of(frame, settings));
  EXPECT_LE(d.max, 1e-6) << place(d, frame);
}

TEST(Exact, completed_surfaces_take_what_is_blocked_with_them_and_not_without) {
  const HostFrame frame = furniture().frame;
  for (const double tolerance : {0.0, 0.001}) {
    EstimatorSettings settings = test::exact(0.6, 64);
    settings.tolerance = tolerance;
    settings.thickness = ThicknessKind::constant;
    settings.thickness_length = 0.2;
    const Planes all = planes_of(frame, settings, "ao", true);
    settings.complete = Completion::none;
    const std::vector<float> none = ao_of(frame, settings);
    const Difference d = difference(all.completed, [&](std::size_t i) { return none[i] - all.ao[i]; });
    EXPECT_LE(d.rmse, tolerance > 0 ? 0.002 : 1e-3) << tolerance << ", " << place(d, frame);
    EXPECT_GT(*std::ranges::max_element(all.completed), 0.05);
  }
}

// A block whose pixels did not all have their share would keep what the frame before has left in its buffers.
TEST(Exact, directions_are_shared_by_all_pixels_of_a_block) {
  const HostFrame other = furniture(true, 96, 72).frame;
  for (const double stretch : {1.0, 1.5}) {
    HostFrame frame = furniture(false, 96, 72).frame;
    frame.camera.fy *= stretch;  // so that other directions go along columns
    const std::vector<float> all = ao_of(frame, test::exact(0.6));
    for (int slices = 1; slices <= 8; slices++) {
      EstimatorSettings settings = shared_directions(0.6);
      settings.slices = slices;
      const std::vector<float> ao = ao_of(frame, settings);
      ao_of(other, settings);
      EXPECT_TRUE(same_bits(ao, ao_of(frame, settings))) << slices << " slices, pixels stretched by " << stretch;
      EXPECT_LE(difference(ao, all).mean, 0.02) << slices << " slices, pixels stretched by " << stretch;
    }
  }
  const HostFrame frame = furniture().frame;
  const Difference d = difference(ao_of(frame, shared_directions(0.6)), ao_of(frame, test::exact(0.6)));
  EXPECT_LE(d.mean, 0.01) << place(d, frame);
  EXPECT_LE(std::abs(d.bias), 0.002);
}

// Surfaces behind the first one.

TEST(ExactHidden, copies_of_the_first_depth_and_surfaces_beyond_the_radius_change_no_bit) {
  for (const bool orthographic : {false, true}) {
    const HostFrame frame = furniture(orthographic, 64, 48).frame;
    std::vector<float> far;
    for (const float z : frame.depth) far.push_back(z < kSky ? 60 + z : kSky);
    for (const auto& fronts : {frame.depth, far}) {
      HostFrame with = frame;
      with.behind.push_back({BehindKind::fronts});
      with.behind_depth = fronts;
      for (const auto thickness : {ThicknessKind::automatic, ThicknessKind::infinite, ThicknessKind::constant})
        for (const Completion complete : {Completion::none, Completion::border, Completion::all}) {
          // Where surfaces are known, widths make runs thinner, as where they are completed.
          if (thickness == ThicknessKind::automatic && complete == Completion::border) continue;
          EstimatorSettings settings = exact(0.6, complete);
          settings.thickness = thickness;
          settings.thickness_length = 0.2;
          const std::vector<float> ao = ao_of(with, settings), alone = ao_of(frame, settings);
          // These are two kernels, of which a driver may round one otherwise in the last digit.
          const bool same = complete == Completion::none ? difference(ao, alone).max <= 2.4e-7 : same_bits(ao, alone);
          EXPECT_TRUE(same) << name_of(settings) << (orthographic ? ", orthographic" : "");
        }
    }
  }
}

TEST(ExactHidden, fronts_never_open_what_is_blocked) {
  // What touches another surface is taken for it where its own is hidden, so all of these hover.
  const Scene scene{{kFloor, parallelogram({0, -0.6, 0.5}, {0.8, 0, 0}, {0, 1, 0.2}),
                     parallelogram({0.4, -0.2, 1.1}, {0.7, 0.1, 0}, {0, 0.8, 0}),
                     Sphere{.center = {-0.6, 0.3, 0.8}, .radius = 0.3}}};
  Rendering rendering = render(scene, Shot::perspective({0.6, -2.4, 3}, {0.2, 0, 0.3}, 45, 160, 120));
  const std::vector<float> first = ao_of(rendering.frame, exact(0.9, Completion::none));
  add_solid_peels(rendering, scene, 3);
  const std::vector<float> all = ao_of(rendering.frame, exact(0.9, Completion::none));
  double most = 0, least = 0;
  for (std::size_t i = 0; i < all.size(); i++) {
    most = std::max(most, double(all[i] - first[i]));
    least = std::min(least, double(all[i] - first[i]));
  }
  EXPECT_LE(most, 0.006);
  EXPECT_LT(least, -0.05);
}

TEST(ExactHidden, a_tolerance_comes_to_the_same) {
  const HostFrame frame = peeled_furniture(false, 64, 48).frame;
  EstimatorSettings all = test::exact(0.6, 64), until = all;
  const std::vector<float> ao = ao_of(frame, all);
  for (const auto& [tolerance, bound] : {std::pair{0.01, 0.02}, {1e-6, 1e-3}}) {
    until.tolerance = tolerance;
    EXPECT_LE(difference(ao_of(frame, until), ao).rmse, bound);
  }
}

TEST(ExactHidden, a_known_back_ends_what_is_blocked) {
  // A slab in the air over a floor. Its width would be taken for its thickness.
  const Scene scene{{kFloor, parallelogram({0, -1, 0.6}, {0.5, 0, 0}, {0, 2, 0})}};
  Rendering rendering = render(scene, Shot::perspective({0.25, 0.2, 4}, {0.25, 0, 0}, 50, 160, 120));
  HostFrame& frame = rendering.frame;
  EstimatorSettings thin = exact(1, Completion::none), constant = thin;
  const std::vector<float> first = ao_of(frame, thin);
  frame.behind.push_back({BehindKind::thickness});
  for (const Hit& hit : rendering.hits) frame.behind_depth.push_back(hit.primitive == 1 ? 0.02f : 0.0f);
  thin.separation = 0.001;
  const std::vector<float> known = ao_of(frame, thin);
  constant.thickness = ThicknessKind::constant;
  constant.thickness_length = 0.02;
  const std::vector<float> expected = ao_of(without_peels(frame), constant);
  double gained = 0, off = 0;
  int receivers = 0;
  for (std::size_t i = 0; i < known.size(); i++) {
    const Hit& hit = rendering.hits[i];
    if (hit.primitive != 0 || std::abs(hit.position.y) > 0.5) continue;
    gained = std::max(gained, double(known[i] - first[i]));
    off += std::abs(known[i] - expected[i]);
    receivers++;
  }
  EXPECT_GT(gained, 0.05);
  EXPECT_LE(off / receivers, 0.003);
}

/// A wall at 5, and before its left part a board far before it. Behind that, up to column 40, a sheet at `sheet`, and
/// from there on one at 4.8 that goes on to column 60, beside the board.
HostFrame sheets_behind_board(float sheet) {
  constexpr int kWidth = 128, kHeight = 64;
  HostFrame frame = render({{kFloor}}, Shot::orthographic({0, 0, 5}, {0, 0.001, 0}, 1.28, kWidth, kHeight)).frame;
  frame.behind.assign(1, {});
  frame.behind_depth.assign(std::size_t(kWidth * kHeight), 0);
  for (int y = 0; y < kHeight; y++)
    for (int x = 0; x < 60; x++) {
      const auto i = std::size_t(y * kWidth + x);
      frame.depth[i] = x < 58 ? 4.5F : 4.8F;
      if (x < 58) frame.behind_depth[i] = x < 40 ? sheet : 4.8F;
    }
  return frame;
}

// Its pixels list as many surfaces as there are, so more may be behind them: what is seen goes on there, but not what
// is hidden itself.
TEST(ExactHidden, hidden_surfaces_do_not_go_on) {
  const EstimatorSettings settings = exact(0.3, Completion::all);  // 30 px
  const std::vector<float> near = ao_of(sheets_behind_board(4.95F), settings);
  const std::vector<float> nearer = ao_of(sheets_behind_board(4.9F), settings);
  for (std::size_t i = 0; i < near.size(); i++)
    if (i % 128 >= 72) EXPECT_EQ(near[i], nearer[i]) << i % 128 << " " << i / 128;
}

// From row to row its depth changes by as much as the two are apart, somewhere.
TEST(ExactHidden, a_floor_seen_aslant_is_open_above_its_underside) {
  const Shot shot = Shot::perspective({0, 0, 1.7}, {0, 10, 1}, 60, 160, 120);
  HostFrame frame = render({{kFloor}}, shot).frame;
  frame.behind.assign(1, {});
  frame.behind_depth = render({{Plane{.point = {0, 0, -0.1}, .normal = {0, 0, 1}}}}, shot).frame.depth;
  const EstimatorSettings settings = exact(1, Completion::none);
  const std::vector<float> ao = ao_of(frame, settings), alone = ao_of(without_peels(frame), settings);
  int floor = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    if (frame.depth[i] > 60) continue;
    floor++;
    EXPECT_NEAR(ao[i], alone[i], 1e-3) << i % 160 << " " << i / 160 << " z " << frame.depth[i];
  }
  EXPECT_GT(floor, 5000);
}

// Crops.

TEST(ExactHidden, crops_have_the_bits_of_the_whole) {
  const Window part{48, 36, 180, 132}, compared{96, 84, 84, 36};
  const Rendering whole = peeled_furniture(false, 240, 180);
  HostFrame crop = crop_of(whole.frame, part);
  crop.behind_depth = cropped(whole.frame.behind_depth, whole.frame.data, part);
  const EstimatorSettings settings = exact(0.05, Completion::none);
  EXPECT_TRUE(same_bits(cropped(ao_of(crop, settings), part, compared),
                        cropped(ao_of(whole.frame, settings), whole.frame.data, compared)));
}

TEST_F(CommandLine, an_exact_search_of_a_region_is_that_part_of_the_whole) {
  const Window data{-8, -4, 500, 200}, display{0, 0, 490, 190}, region{159, 57, 64, 30};
  FrameFile rough = wall_frame(data, display);
  std::vector<float>& depth = rough.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width), y = i / std::size_t(data.width);
    depth[i] *= float(1 + 0.002 * std::sin(0.2 * double(x)) * std::sin(0.14 * double(y)) -
                      ((x / 20 * 7 + y / 12 * 3) % 5 == 0 ? 0.01 : 0));
  }
  rough.write(frame);
  write_bytes(camera, wall_camera(display).dump());
  int number = 0;
  for (const std::string more :
       {"--preset reference", "--search exact --slices 2", "--search exact --resolution half", "--tolerance 0.05"}) {
    if (!tried(number++, 2)) continue;
    const Options arguments = typed("--radius 0.1 --aov ao,bent-normal,transfer,specular-occlusion " + more);
    EXPECT_LT(std::ranges::min(expect_region_of_whole(arguments, region).plane("Y")), 0.8);
  }
}

TEST_F(CommandLine, a_surface_goes_on_into_a_region_from_far_beyond_its_reach) {
  const Window data{0, 0, 500, 150}, region{220, 30, 15, 15};
  // Left of a bar the wall is at 6, right of it at 5.8, and that goes on behind the bar.
  FrameFile barred = wall_frame(data, data);
  std::vector<float>& depth = barred.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width);
    if (x >= 240) depth[i] *= float(x < 340 ? 4.8 / 6 : 5.8 / 6);
  }
  barred.write(frame);
  write_bytes(camera, wall_camera(data).dump());
  const Image whole = expect_region_of_whole({"--radius", "0.5", "--preset", "reference"}, region);
  EXPECT_FALSE(same_bits(written({"--radius", "0.5", "--preset", "reference", "--set", "complete=border"}).pixels,
                         whole.pixels));
}

}  // namespace
}  // namespace alcove::exact_test
