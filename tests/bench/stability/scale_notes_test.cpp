// A run says where its numbers cannot carry the radius; steps of device depth are known; the report of `bench
// --stability` holds together.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/bench/stability.h"
#include "core/frame/pixels/radius.h"
#include "tests/bench/stability/cases.h"
#include "tests/support/command_line.h"
#include "tests/support/device.h"
#include "tests/support/scenes.h"

namespace alcove::scale_notes_test {
namespace {

using namespace test;

/// What is said of the room at this radius.
std::vector<std::string> said(const HostFrame& frame, double radius) {
  DepthSample sample;
  const FrameInputs inputs = upload(recorder(), frame);
  sample.add(inputs.view, inputs.depth_map, inputs.depth_precision, inputs[RawPlane::depth]->as<float>());
  return texts_of(sample.notes(radius, radius, frame.data.width, frame.data.height));
}

TEST(ScaleNotes, are_silent_where_all_is_well) {
  for (const double radius : {0.3, 0.6, 2.0})
    EXPECT_THAT(said(room(55, 1, 0, 96, 72).frame, radius), IsEmpty()) << radius;
}

TEST(ScaleNotes, name_a_radius_below_a_pixel_and_one_beyond_the_picture) {
  const HostFrame frame = room(55, 1, 0, 96, 72).frame;
  EXPECT_THAT(said(frame, 0.01), ElementsAre(AllOf(HasSubstr("less than a pixel over 100 %"), HasSubstr("--radius"))));
  EXPECT_THAT(said(frame, 1000), ElementsAre(AllOf(HasSubstr("pixels at the median depth"), HasSubstr("96x72"))));
}

TEST(ScaleNotes, name_a_radius_within_the_depths_precision) {
  const HostFrame frame = room(0.3, 1, 0, 96, 72).frame;
  EXPECT_THAT(said(frame, 0.65), IsEmpty());
  EXPECT_THAT(said(stored(frame, Storage::half_float, 0), 0.65),
              ElementsAre(AllOf(HasSubstr("times the depth's precision"), HasSubstr("more bits"))));
}

TEST(ScaleNotes, name_the_precision_that_is_lost_by_storage) {
  for (const auto& [spec, is_lost] : {std::pair{Spec{.fov = 1.5, .storage = Storage::half_float}, true},
                                      {Spec{.fov = 3, .storage = Storage::half_float}, false},
                                      {Spec{.width = 48, .height = 36, .storage = Storage::far_positions}, true}}) {
    const Case made = test::made(spec);
    EXPECT_EQ(testing::Matches(Contains(HasSubstr("times the depth's precision")))(said(made.frame, made.radius)),
              is_lost)
        << to_string(spec);
  }
}

TEST(ScaleNotes, know_positions_that_are_far_from_their_origin_in_any_direction) {
  HostFrame frame = room(55, 1, 0, 96, 72).frame;
  frame.depth_kind = DepthKind::position;
  frame.position_space = PositionSpace::world;
  frame.camera.view_from_world = Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::size_t pixels = frame.data.pixels();
  for (const double far : {0.0, 1e7}) {
    frame.camera.view_from_world_offset = {-far, 0, 0};
    std::vector<float> positions(3 * pixels);
    for (std::size_t i = 0; i < pixels; i++) positions[i] = float(far), positions[i + 2 * pixels] = -4;
    frame.depth = positions;
    EXPECT_EQ(said(frame, 0.65).size(), far > 0 ? 1u : 0u) << far;
  }
}

TEST(DepthStep, is_that_of_16_and_24_bits) {
  const HostFrame frame = room(1.5, 1, 0, 64, 48).frame;
  const double depth = 172;
  EXPECT_NEAR(stored(frame, Storage::bits_16, depth).depth_step, 1 / 65535.0, 1e-12);
  EXPECT_EQ(stored(frame, Storage::bits_24, depth).depth_step, 0) << "floats near 1 are as coarse";
  HostFrame far = frame;
  for (float& z : far.depth) z = z < kSky ? 500 * z : kSky;
  EXPECT_NEAR(stored(far, Storage::bits_24_reversed, depth).depth_step, 1 / 16777215.0, 1e-14);
}

TEST(DepthStep, of_floats_and_half_floats_is_none) {
  std::vector<float> values(5000);
  for (std::size_t i = 0; i < values.size(); i++) values[i] = float(std::fmod(double(i + 1) * 0.618033988749895, 1.0));
  EXPECT_EQ(step_of(values), 0);
  for (float& value : values) value = std::ldexp(std::round(std::ldexp(value, 11)), -11);
  EXPECT_EQ(step_of(values), 0);
  EXPECT_EQ(step_of(std::vector<float>(5000, 0.0f)), 0) << "all sky";
  EXPECT_EQ(step_of({}), 0);
}

// A flat step would be taken for a wall: without it the plane is darkened everywhere.
TEST(DepthStep, keeps_a_plane_of_16_bits_open) {
  const Plane plane{.point = {5, 0, 0}, .normal = unit({-1, 0.5, 0.7})};
  const HostFrame frame =
      stored(render({{plane}}, Shot::perspective({}, {1, 0, 0}, 5, 96, 72)).frame, Storage::bits_16, 0.4);
  HostFrame unknown = frame;
  unknown.depth_step = 0;
  const auto darkened = [](const HostFrame& f) {
    return difference(compute_ao(recorder(), f, with_radius(plain_settings(), 0.05)).ao,
                      [](std::size_t) { return 1.0; })
        .max;
  };
  EXPECT_LE(darkened(frame), 1e-3);
  EXPECT_GT(darkened(unknown), 0.05);
}

TEST_F(CommandLine, a_run_says_that_its_radius_is_below_a_pixel) {
  const Finished tiny = done({"--radius", "1e-6"});
  EXPECT_THAT(tiny.err, HasSubstr("less than a pixel"));
  EXPECT_THAT(run({}).err, Not(HasSubstr("less than a pixel")));
}

/// A report of two points whose names are hostile.
StabilityReport hostile() {
  StabilityReport report{"<script>alert(1)</script>", {{"gtao", 0.01}}, {}};
  report.axes.push_back({"a \"quoted\" <axis>",
                         "units & more",
                         {{1, {}}, {10, {{NoteCode::radius_below_pixel, "<b>radius</b>"}}}, {100, {}}},
                         {{"gtao", {0.01, 0.2, 0.3}, {1}, true}}});
  return report;
}

TEST(StabilityReport, is_json_with_every_curve) {
  const json axis = json::parse(stability_json(hostile()))["axes"][0], curve = axis["curves"][0];
  EXPECT_EQ(axis["name"], "a \"quoted\" <axis>");
  EXPECT_EQ(axis["points"][1]["notes"].size(), 1u);
  EXPECT_EQ(curve["estimator"], "gtao");
  EXPECT_EQ(curve["rmse"], json({0.01, 0.2, 0.3}));
  EXPECT_EQ(curve["breaks_at"], json({10.0}));
}

TEST(StabilityReport, is_a_line_for_each_curve) {
  EXPECT_THAT(lines_of(stability_text(hostile())),
              ElementsAre(StartsWith("axis"), ContainsRegex("^a \"quoted\" <axis> +gtao +0.3000 10, said$")));
}

TEST(StabilityReport, is_a_page_with_a_row_for_each_point) {
  const json report = json::parse(data_of_page(stability_page(hostile())));
  EXPECT_EQ(report["device"], "<script>alert(1)</script>");
  ASSERT_EQ(report["rows"].size(), 3u);
  EXPECT_EQ(report["rows"][1]["frame"], "a \"quoted\" <axis> 10 units & more");
  EXPECT_EQ(report["rows"][1]["fails"], true);
  EXPECT_EQ(report["rows"][1]["warnings"], 1);
  EXPECT_EQ(report["rows"][2]["fails"], false);
  EXPECT_THAT(report["candidates"][0]["settings"], HasSubstr("at 10, said"));
}

}  // namespace
}  // namespace alcove::scale_notes_test
