// The rules of completed surfaces one by one, in single slices: which ends go on, how far, and how thick runs are.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/reference_planes.h"
#include "tests/support/scenes.h"

namespace alcove::completion_rules_test {
namespace {

using namespace test;

const Plane kFloor{.point = {}, .normal = {0, 0, 1}};

/// A parallel view, 50 pixels wide per unit, whose rows each have one depth, from the top; 0 is sky.
HostFrame rows_of(const std::vector<float>& depths) {
  HostFrame frame;
  frame.data = frame.display = {0, 0, 3, int(depths.size())};
  frame.camera.orthographic = true;
  frame.camera.width = 3;
  frame.camera.height = int(depths.size());
  frame.camera.fx = frame.camera.fy = 50;
  for (const float depth : depths) frame.depth.insert(frame.depth.end(), 3, depth);
  frame.normal.assign(2 * frame.depth.size(), 0.0f);
  frame.normal.resize(3 * frame.depth.size(), 1.0f);
  return frame;
}

/// What completed surfaces block at the middle of row 20, in a slice along the column.
float completed_at_row_20(const HostFrame& frame) {
  ReferenceSettings settings;
  settings.radius = 1;
  settings.slices = 1;
  settings.thickness = ThicknessRule::constant;
  settings.thickness_length = 1e-4;
  settings.complete = Completion::all;
  settings.pixels = {20 * 3 + 1};
  return reference_completed(frame, settings)[settings.pixels[0]];
}

TEST(Completion, of_a_run_of_one_pixel_is_nothing) {
  for (const int pixels : {1, 2}) {
    std::vector<float> depths(60, 5.0f);
    std::fill_n(depths.begin() + 25, pixels, 4.7f);
    std::fill_n(depths.begin() + 25 + pixels, 3, 4.05f);
    const float completed = completed_at_row_20(rows_of(depths));
    if (pixels == 1)
      EXPECT_EQ(completed, 0);
    else
      EXPECT_GE(completed, 0.01);
  }
}

// The end of the run lies 0.12 away on the image and 0.3 deeper than the receiver. Behind what hides it the run comes
// to stand above the tangent plane of the receiver either way.
TEST(Completion, begins_above_the_tangent_plane_alone) {
  std::vector<float> depths(60, 5.0f);
  std::fill_n(depths.begin() + 25, 2, 5.3f);
  std::fill_n(depths.begin() + 27, 14, 4.5f);
  std::fill(depths.begin() + 41, depths.end(), 0.0f);
  for (const double slope : {1.5, 4.0}) {
    HostFrame frame = rows_of(depths);
    frame.normal[frame.depth.size() + 61] = float(-slope / std::hypot(1, slope));
    frame.normal[2 * frame.depth.size() + 61] = float(1 / std::hypot(1, slope));
    const float completed = completed_at_row_20(frame);
    if (slope < 2)
      EXPECT_EQ(completed, 0);
    else
      EXPECT_GE(completed, 0.001);
  }
}

// Where the sky shows nothing is hidden, as where the floor does.
TEST(Completion, ends_before_the_sky) {
  std::vector<float> depths(60, 5.0f);
  std::fill_n(depths.begin() + 25, 2, 4.7f);
  std::fill_n(depths.begin() + 27, 3, 4.05f);
  const float before_floor = completed_at_row_20(rows_of(depths));
  std::fill(depths.begin() + 30, depths.end(), 0.0f);
  EXPECT_EQ(completed_at_row_20(rows_of(depths)), before_floor);
  EXPECT_GE(before_floor, 0.01);
}

// The run turns away so steeply that its line lies behind the next pixel at once.
TEST(Completion, is_behind_what_is_nearer_than_the_end_alone) {
  for (const float next : {4.8f, 4.3f}) {
    std::vector<float> depths(60, 0.0f);
    std::fill_n(depths.begin(), 25, 5.0f);
    depths[25] = 4.45f;
    depths[26] = 4.6f;
    depths[27] = next;
    HostFrame frame = rows_of(depths);
    frame.normal[frame.depth.size() + 26 * 3 + 1] = float(-15 / std::hypot(1, 15));
    frame.normal[2 * frame.depth.size() + 26 * 3 + 1] = float(1 / std::hypot(1, 15));
    const float completed = completed_at_row_20(frame);
    if (next > depths[26])
      EXPECT_EQ(completed, 0);
    else
      EXPECT_GE(completed, 0.001);
  }
}

/// A strip along the rows above a floor, seen from straight above, and one slice across it.
struct Strip {
  HostFrame frame;
  ReferenceSettings settings;
};

Strip strip(int rows, bool at_border) {
  constexpr double kPixel = 0.02;
  const double top = at_border ? 5 : 0.2;
  const Scene scene{{kFloor, parallelogram({-9, top - (at_border ? 4.6 : rows * kPixel), 0.3}, {18, 0, 0},
                                           {0, at_border ? 4.6 : rows * kPixel, 0})}};
  Strip strip{render(scene, Shot::orthographic({0, 0.001, 5}, {0, 0.001, 0}, 60 * kPixel, 60, 48)).frame, {}};
  strip.settings.radius = 0.6;
  strip.settings.slices = 1;
  strip.settings.thickness = ThicknessRule::width;
  return strip;
}

TEST(Thickness, levels_off_from_a_share_of_the_width_and_some_pixels) {
  for (const auto& [share, pixels] : {std::pair(1.0, 0.0), std::pair(0.5, 1.0), std::pair(0.7, 2.0)}) {
    Strip wide = strip(7, false);
    wide.settings.width_share = share;
    wide.settings.width_pixels = pixels;
    const std::vector<float> by_width = reference_ao(wide.frame, wide.settings);
    wide.settings.thickness = ThicknessRule::constant;
    const double width = (share * 7 + pixels) * 0.02, most = 4 * wide.settings.radius;
    wide.settings.thickness_length = width - width * width * width / (3 * most * most);
    const std::vector<float> by_length = reference_ao(wide.frame, wide.settings);
    for (std::size_t i = 0; i < by_width.size(); i++)
      // the strip's own depth is another matter: it is endless for itself
      if (wide.frame.depth[i] > 4.9) EXPECT_NEAR(by_width[i], by_length[i], 1e-6) << share << " pixel " << i;
  }
}

TEST(Thickness, of_a_long_run_grows_no_more) {
  Strip wide = strip(7, false);
  wide.settings.width_share = 100;
  const std::vector<float> by_width = reference_ao(wide.frame, wide.settings);
  wide.settings.thickness = ThicknessRule::constant;
  wide.settings.thickness_length = 8.0 / 3 * wide.settings.radius;
  const std::vector<float> by_length = reference_ao(wide.frame, wide.settings);
  for (std::size_t i = 0; i < by_width.size(); i++)
    if (wide.frame.depth[i] > 4.9) EXPECT_NEAR(by_width[i], by_length[i], 1e-6) << "pixel " << i;
}

TEST(Thickness, of_a_run_that_the_border_cuts_is_a_radius_at_least_where_it_is_flat) {
  Strip cut = strip(7, true);
  cut.settings.complete = Completion::border;
  cut.settings.width_share = 0.01;
  const std::vector<float> by_width = reference_ao(cut.frame, cut.settings);
  cut.settings.thickness = ThicknessRule::constant;
  cut.settings.thickness_length = cut.settings.radius;
  EXPECT_EQ(reference_ao(cut.frame, cut.settings), by_width);
}

TEST(Settings, of_the_estimators_become_the_references) {
  EstimatorSettings settings;
  settings.radius = 1;
  const ReferenceSettings all = reference_settings_of(settings);
  EXPECT_EQ(all.complete, Completion::all);
  EXPECT_EQ(all.width_share, 0.5);
  EXPECT_EQ(all.width_pixels, 1);
  for (const Completion complete : {Completion::none, Completion::border}) {
    settings.complete = complete;
    const ReferenceSettings other = reference_settings_of(settings);
    EXPECT_EQ(other.complete, complete);
    EXPECT_EQ(other.width_share, 1);
    EXPECT_EQ(other.width_pixels, 0);
  }
}

}  // namespace
}  // namespace alcove::completion_rules_test
