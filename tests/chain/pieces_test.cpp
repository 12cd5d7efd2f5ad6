// What goes on where the picture does not show it, in the searches that take samples: against rays and wider pictures.
// SPDX-License-Identifier: BSD-3-Clause
//
// The scenes are of flat things without thickness, and the searches are told that occluders are thin. Without completed
// surfaces they then miss exactly what is hidden.

#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/reference_planes.h"

namespace alcove::pieces_test {
namespace {

using namespace test;

constexpr double kThin = 0.001;  // scene units
constexpr int kRaysAcross = 64;
constexpr int kEvery = 4;  // px from one receiver to the next
constexpr Estimator kSampled[] = {Estimator::gtao, Estimator::bitmask};

EstimatorSettings thin(Estimator estimator, double radius, Completion complete) {
  EstimatorSettings settings = sampled(estimator, radius, 8, 32);
  settings.thickness = ThicknessKind::constant;
  settings.thickness_length = kThin;
  settings.complete = complete;
  return settings;
}

Planes planes_of(const HostFrame& frame, const EstimatorSettings& settings) {
  return test::planes_of(frame, settings, "ao,ao-scales,confidence", true);
}

double mean_error(const std::vector<float>& ao, const std::vector<std::size_t>& pixels,
                  const std::vector<double>& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < pixels.size(); i++) sum += std::abs(ao[pixels[i]] - truth[i]);
  return sum / double(pixels.size());
}

/// The same view with a principal point off the centre and pixels that are not square.
Shot oblique(Shot shot) {
  shot.camera.cx += 13.7;
  shot.camera.cy -= 8.3;
  shot.camera.fy *= 1.15;
  return shot;
}

// Completed, the chosen surfaces have their true AO to the bound; without, they are at least 3 times as far off. With
// each change each estimator sees each scene by one of its cameras.
TEST(Pieces, of_a_surface_go_on_behind_what_hides_it) {
  const double bounds[]{0.0097, 0.018, 0.0087};
  const std::vector<Hiding> cases = hidings(240, 180);
  for (std::size_t k = 0; k < cases.size(); k++)
    for (const Shot& shot : {oblique(cases[k].perspective), cases[k].orthographic}) {
      int turn = int(k) + shot.camera.orthographic;
      SCOPED_TRACE(cases[k].what);
      const Scene& scene = cases[k].scene;
      const double radius = cases[k].radius;
      const Rendering rendering = render(scene, shot);
      const std::vector<std::size_t> pixels = receivers(rendering, radius, kEvery, cases[k].chosen);
      ASSERT_GE(pixels.size(), 30u);
      std::vector<double> truth;
      for (const std::size_t i : pixels) truth.push_back(true_ao(scene, rendering.hits[i], radius, kRaysAcross));
      for (const Estimator estimator : kSampled) {
        if (!tried(turn++, 2)) continue;
        const double all = mean_error(ao_of(rendering.frame, thin(estimator, radius, Completion::all)), pixels, truth);
        const double none =
            mean_error(ao_of(rendering.frame, thin(estimator, radius, Completion::none)), pixels, truth);
        EXPECT_LE(all, bounds[k]) << int(estimator);
        EXPECT_GE(none, 3 * all) << int(estimator);
      }
    }
}

// Behind the column the wall is taken to go on as far as it is hidden. So what is blocked too much, or too little, is
// no more than the receiver sees of the part of the wall's plane that the column hides: of that without wall, or with
// it.
TEST(Pieces, of_a_wall_that_ends_behind_a_column_err_by_what_it_hides_at_most) {
  const EndingWall wall;
  const Rendering rendering = render(wall.scene, Shot::perspective(wall.eye, {0.3, 0, 0.6}, 50, 240, 180));
  const auto pixels =
      receivers(rendering, 1, kEvery, [](const Hit& hit) { return hit.primitive == 0 && hit.position.x < 0.5; });
  ASSERT_GE(pixels.size(), 30u);
  constexpr double kSampling = 0.008;  // what the distance of the samples costs
  const std::vector<float> of[]{ao_of(rendering.frame, thin(Estimator::gtao, 1, Completion::all)),
                                ao_of(rendering.frame, thin(Estimator::bitmask, 1, Completion::all))};
  double largest = 0;
  for (const std::size_t i : pixels) {
    const auto hidden = wall.hidden_from(rendering.hits[i], 1, kRaysAcross);
    const double truth = true_ao(wall.scene, rendering.hits[i], 1, kRaysAcross);
    for (const auto& ao : of) {
      EXPECT_GE(ao[i], truth - hidden.open - kSampling) << i << ", not wall " << hidden.open;
      EXPECT_LE(ao[i], truth + hidden.wall + kSampling) << i << ", wall " << hidden.wall;
    }
    largest = std::max(largest, hidden.open);
  }
  EXPECT_GE(largest, 5 * kSampling);
}

// A picture of a wall whose upper part is cut off, against the whole.
TEST(Pieces, of_a_wall_go_on_beyond_the_border_as_in_a_wider_picture) {
  for (const Shot& shot : {oblique(Shot::perspective({5, 0.4, 1.8}, {0.3, 0, 0.6}, 50, 240, 180)),
                           Shot::orthographic({5, 0.4, 1.8}, {0.3, 0, 0.6}, 5, 240, 180)}) {
    const CutWall wall(shot);
    const std::vector<std::size_t> pixels = receivers(wall.whole, 1, kEvery, is_floor_by_the_wall);
    ASSERT_GE(pixels.size(), 30u);
    for (const Estimator estimator : kSampled) {
      const std::vector<float> expected = ao_of(wall.whole.frame, thin(estimator, 1, Completion::none));
      std::vector<double> truth;
      std::vector<std::size_t> below;
      for (const std::size_t i : pixels) truth.push_back(expected[i]), below.push_back(wall.below(i));
      const double none = mean_error(ao_of(wall.frame, thin(estimator, 1, Completion::none)), below, truth);
      for (const Completion complete : {Completion::border, Completion::all}) {
        const double error = mean_error(ao_of(wall.frame, thin(estimator, 1, complete)), below, truth);
        EXPECT_LE(error, 0.0095) << "estimator " << int(estimator) << ", completion " << int(complete);
        EXPECT_GE(none, 10 * error) << "estimator " << int(estimator) << ", completion " << int(complete);
      }
    }
  }
}

/// Turns each normal by up to so many degrees.
void roughen(HostFrame& frame, double degrees) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> tilt(-1, 1);
  const double slope = std::tan(degrees * std::numbers::pi / 180) / std::numbers::sqrt2;
  for (std::size_t i = 0; i < frame.depth.size(); i++) {
    const Vec3 n = normal_at(frame, i), across = unit(cross(n, {1, 0, 0}));
    put_normal(frame, i, unit(n + slope * tilt(random) * across + slope * tilt(random) * cross(n, across)));
  }
}

TEST(Pieces, of_a_floor_that_the_border_cuts_stay_below_the_receiver) {
  for (const Shot& shot :
       {Shot::perspective({0, -3, 2}, {0, 0, 0}, 40, 120, 90), Shot::orthographic({0, -3, 2}, {0, 0, 0}, 3, 120, 90)}) {
    for (const double degrees : {0.0, 3.0}) {
      HostFrame floor = render({{kFloor}}, shot).frame;
      if (degrees > 0) roughen(floor, degrees);
      for (const Estimator estimator : kSampled) {
        const std::vector<float> none = ao_of(floor, thin(estimator, 1, Completion::none));
        const std::vector<float> all = ao_of(floor, thin(estimator, 1, Completion::all));
        const Difference d = difference(all, none);
        EXPECT_EQ(d.max, 0) << "estimator " << int(estimator) << ", " << place(d, floor);
      }
    }
  }
}

TEST(Pieces, are_not_of_a_thing_alone_before_the_sky) {
  for (const HostFrame& frame : things_before_the_sky(120, 96))
    for (const Estimator estimator : kSampled) {
      const Planes all = planes_of(frame, thin(estimator, 0.8, Completion::all));
      EXPECT_TRUE(same_bits(all.ao, ao_of(frame, thin(estimator, 0.8, Completion::none)))) << int(estimator);
      EXPECT_EQ(all.completed, std::vector<float>(all.ao.size(), 0.0f)) << int(estimator);
    }
}

/// The picture in which a plate hides a part of a wall.
const HostFrame& plate_frame() {
  static const HostFrame frame =
      render(kPlateScene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.6}, 50, 160, 120)).frame;
  return frame;
}

TEST(Pieces, of_several_radii_are_those_of_each) {
  for (const Estimator estimator : kSampled) {
    EstimatorSettings settings = thin(estimator, 1, Completion::all);
    const std::vector<float> alone = ao_of(plate_frame(), settings);
    settings.further_radii = {0.3};
    const Planes both = planes_of(plate_frame(), settings);
    ASSERT_EQ(both.scales.size(), 2 * alone.size());
    EXPECT_TRUE(same_bits(alone, {both.scales.begin() + std::ptrdiff_t(alone.size()), both.scales.end()}));
  }
}

// A piece weighs by the distance of its middle, and the reference by that of each of its parts.
TEST(Pieces, weigh_by_the_falloff) {
  const auto share = [](const std::vector<float>& faded, const std::vector<float>& hard) {
    return std::accumulate(faded.begin(), faded.end(), 0.0) / std::accumulate(hard.begin(), hard.end(), 0.0);
  };
  for (const Estimator estimator : kSampled) {
    EstimatorSettings settings = thin(estimator, 1, Completion::all);
    ReferenceSettings some = reference_settings_of(settings);
    for (std::size_t i = 0; i < plate_frame().data.pixels(); i += 121) some.pixels.push_back(i);
    const std::vector<float> exact = reference_completed(plate_frame(), some);
    const std::vector<float> hard = planes_of(plate_frame(), settings).completed;
    settings.falloff = Falloff::smooth;
    some.falloff = Falloff::smooth;
    const double expected = share(reference_completed(plate_frame(), some), exact);
    const double weight = share(planes_of(plate_frame(), settings).completed, hard);
    EXPECT_NEAR(weight, expected, 0.33 * expected) << int(estimator);
  }
}

// Interruptions are found among 32 samples at a time. A run that crosses from one lot to the next hides no more than to
// the end of its lot, so that of 70 samples up to 3 tenths of what goes on is missed. A radius is 70 pixels wide here.
// With each change each number is that of one estimator.
TEST(Pieces, are_found_among_any_number_of_samples) {
  const HostFrame frame = render(kPlateScene, Shot::perspective({5, 0.3, 1.8}, {0.3, 0, 0.4}, 25, 160, 120)).frame;
  ReferenceSettings some = reference_settings_of(thin(Estimator::gtao, 1, Completion::all));
  for (std::size_t i = 0; i < frame.data.pixels(); i += 97) some.pixels.push_back(i);
  const std::vector<float> expected = reference_completed(frame, some);
  double whole = 0;
  for (const std::size_t i : some.pixels) whole += expected[i];
  int turn = 0;
  for (const Estimator estimator : kSampled) {
    for (const int steps : {32, 40, 70}) {
      if (!tried(turn++, 2)) continue;
      EstimatorSettings settings = thin(estimator, 1, Completion::all);
      settings.steps = steps;
      const std::vector<float> completed = planes_of(frame, settings).completed;
      double sum = 0;
      for (const std::size_t i : some.pixels) sum += completed[i];
      EXPECT_GE(sum / whole, 0.69) << "estimator " << int(estimator) << ", steps " << steps;
      EXPECT_LE(sum / whole, 1.05) << "estimator " << int(estimator) << ", steps " << steps;
    }
  }
}

TEST(Pieces, tell_what_would_be_open_without_them) {
  for (const Estimator estimator : kSampled) {
    const Planes all = planes_of(plate_frame(), thin(estimator, 1, Completion::all));
    const std::vector<float> none = ao_of(plate_frame(), thin(estimator, 1, Completion::none));
    const Difference d = difference(all.completed, [&](std::size_t i) { return none[i] - all.ao[i]; });
    const double sum = std::accumulate(all.completed.begin(), all.completed.end(), 0.0);
    EXPECT_LE(std::abs(d.bias), 0.01 * sum / double(all.ao.size())) << int(estimator);
    EXPECT_LE(d.rmse, 1e-3) << int(estimator);
    EXPECT_GT(std::ranges::max(all.completed), 0.2);
  }
}

TEST(Pieces, are_none_of_other_estimators) {
  const Planes all = planes_of(plate_frame(), thin(Estimator::hbao, 1, Completion::all)),
               none = planes_of(plate_frame(), thin(Estimator::hbao, 1, Completion::none));
  EXPECT_TRUE(all.completed.empty());
  EXPECT_TRUE(same_bits(all.ao, none.ao));
  EXPECT_TRUE(same_bits(all.confidence, none.confidence));
}

using PiecesOfFiles = CommandLine;

TEST_F(PiecesOfFiles, of_a_region_are_those_of_the_whole_where_normals_come_from_depth) {
  const Window data{-8, -4, 500, 200}, display{0, 0, 490, 190}, region{159, 14, 127, 60};
  FrameFile barred = wall_frame(data, display);
  for (const char* axis : {"X", "Y", "Z"}) barred.planes.erase(std::string("ViewLayer.Normal.") + axis);
  std::vector<float>& depth = barred.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) {
    const auto x = i % std::size_t(data.width), y = i / std::size_t(data.width);
    depth[i] *= float(1 + 0.01 * std::sin(0.1 * double(x)) * std::sin(0.07 * double(y)) - (x / 20 % 3 == 0 ? 0.1 : 0));
  }
  barred.write(frame);
  write_bytes(camera, wall_camera(display).dump());
  for (const char* estimator : {"gtao", "bitmask"}) {
    const std::vector<std::string> arguments{"--radius", "0.6", "--estimator", estimator};
    const Image whole = expect_region_of_whole(arguments, region);
    const Image none = written({"--radius", "0.6", "--estimator", estimator, "--set", "complete=none"});
    EXPECT_FALSE(same_bits(cropped(none.pixels, none.data, region), cropped(whole.pixels, whole.data, region)));
  }
}

}  // namespace
}  // namespace alcove::pieces_test
