// Normals of the other side, of nearly the same space, without their signs, and with other lengths are told apart.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "tests/support/scenes.h"
#include "tests/support/source_frame.h"

namespace alcove::normals_test {
namespace {

using namespace test;

constexpr int kFloor = 0, kWall = 1, kBall = 2;  // primitives of the rendering

/// A rendering as a file of Z and N, with a camera that is turned by some degrees within a world of the test's own.
class NormalFiles : public SettledFile {
 protected:
  NormalFiles() {
    settings.depth_kind = DepthKind::planar;
    place(turned({0.3, 1, 0.2}, 50));
  }

  /// The rotation about an axis of view space, as rows.
  static std::array<Vec3, 3> turned(Vec3 axis, double degrees) {
    axis = unit(axis);
    const double s = std::sin(degrees * std::numbers::pi / 180), c = std::cos(degrees * std::numbers::pi / 180);
    const auto row = [&](Vec3 e) { return c * e + s * cross(e, axis) + ((1 - c) * dot(axis, e)) * axis; };
    return {row({1, 0, 0}), row({0, 1, 0}), row({0, 0, 1})};
  }

  /// Gives a camera file of which these are the rows that give view space of the world.
  void place(const std::array<Vec3, 3>& rows) {
    view_from_world = rows;
    Shot shot = rendering.shot;
    shot.eye = {};
    shot.right = rows[0], shot.up = rows[1], shot.back = rows[2];
    give(camera_of(shot));
  }
  Vec3 world(Vec3 view) const {
    return view.x * view_from_world[0] + view.y * view_from_world[1] + view.z * view_from_world[2];
  }

  /// Turns to a world in which all that is seen faces up its axes.
  void face_axes() {
    const Shot& shot = rendering.shot;
    place({Vec3{shot.right.x, shot.right.y, shot.right.z}, Vec3{shot.up.x, shot.up.y, shot.up.z},
           Vec3{shot.back.x, shot.back.y, shot.back.z}});
    for (auto& hit : rendering.hits)
      if (hit.primitive == kBall) hit.primitive = -1;
  }

  using Saved = std::function<Vec3(Vec3 view, const test::Hit& hit)>;

  /// Writes normals as `saved` makes them from those of view space.
  void write(const Saved& saved) {
    FrameFile file = file_of(rendering, 1e10f, planar, [&](const test::Hit& hit) {
      return saved(rendering.shot.view_from_world(hit.normal), hit);
    });
    file.halves = halves;
    file.write(settings.input);
  }

  Notes noted() const {
    FrameSource source = settled();
    Notes notes = source.notes;
    add_new(notes, source.suspicious);
    return notes;
  }
  static std::vector<NoteCode> codes_of(const Notes& notes) {
    std::vector<NoteCode> codes;
    for (const auto& note : notes) codes.push_back(note.code);
    return codes;
  }
  void leave_camera_out() {
    const Camera& c = rendering.shot.camera;
    settings.camera.clear();
    settings.fov = 2 * std::atan(0.5 * c.width / c.fx) * 180 / std::numbers::pi;
  }

  Rendering rendering = furnished();
  std::array<Vec3, 3> view_from_world{};
  std::set<std::string> halves;
};

// Normals of the other side.

TEST_F(NormalFiles, of_the_other_side_of_some_things_leave_the_reading_as_it_is) {
  for (const std::set<int>& things : std::vector<std::set<int>>{{kFloor}, {kWall}, {kBall}, {kFloor, kBall}})
    for (const bool in_view : {false, true}) {
      write([&](Vec3 n, const test::Hit& hit) {
        const Vec3 faced = things.contains(hit.primitive) ? -n : n;
        return in_view ? faced : world(faced);
      });
      const FrameSource source = settled();
      const std::string what = testing::PrintToString(things) + (in_view ? " in view" : " in the world");
      EXPECT_EQ(source.reading.normal_space, in_view ? NormalSpace::view : NormalSpace::world)
          << what << testing::PrintToString(texts_of(source.notes));
      EXPECT_EQ(to_string(source.reading.flip_normal), "none") << what;
      EXPECT_THAT(codes_of(source.notes), Not(Contains(NoteCode::normals_disagree))) << what;
    }
}

TEST_F(NormalFiles, that_are_all_zero_decide_nothing) {
  write([](Vec3, const test::Hit&) { return Vec3{}; });
  EXPECT_EQ(settled().reading.normal_space, NormalSpace::world) << "the usual one";
  EXPECT_FALSE(settled().evidence->tells) << "so that a sequence is read as a later frame";
  leave_camera_out();
  EXPECT_EQ(settled().reading.normal_space, NormalSpace::view) << "without a matrix";
}

TEST_F(NormalFiles, that_may_be_flipped_or_mirrored_are_turned_round_and_both_causes_are_said) {
  const Shot& shot = rendering.shot;
  const Vec3 x = shot.view_from_world({1, 0, 0}), y = shot.view_from_world({0, 1, 0}),
             z = shot.view_from_world({0, 0, 1});
  place({Vec3{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}});
  // The wall faces along x, and the floor across it.
  write([](Vec3, const test::Hit& hit) {
    return hit.primitive == kBall ? Vec3{} : Vec3{-hit.normal.x, hit.normal.y, hit.normal.z};
  });
  EXPECT_EQ(to_string(settled().reading.flip_normal), "none");
  EXPECT_THAT(texts_of(settled().notes), Contains(HasSubstr("give --flip-normal x")));
}

TEST_F(NormalFiles, that_are_all_flipped_are_still_found) {
  for (const NormalFlips flips : {NormalFlips{false, true, false}, {true, false, false}, {true, true, true}}) {
    write([&](Vec3 n, const test::Hit& hit) {
      const Vec3 w = world(hit.primitive == kBall ? -n : n);  // which is mirrored beside
      return Vec3{flips.x ? -w.x : w.x, flips.y ? -w.y : w.y, flips.z ? -w.z : w.z};
    });
    EXPECT_EQ(to_string(settled().reading.flip_normal), to_string(flips));
  }
}

// Components that are not where they are looked for.

TEST_F(NormalFiles, in_another_order_are_refused_with_the_order) {
  write([&](Vec3 n, const test::Hit&) {
    const Vec3 w = world(n);
    return Vec3{w.z, w.y, w.x};
  });
  expect(Reply::refused, {"another order of components", "--normal-channels N.Z,N.Y,N.X"});
}

TEST_F(NormalFiles, of_two_channels_that_were_saved_as_three_are_refused_with_the_two) {
  write([](Vec3 n, const test::Hit&) { return Vec3{0.5 + 0.5 * n.x, 0.5 + 0.5 * n.y, 0}; });
  expect(Reply::refused, {"two components", "--normal-channels N.X,N.Y"});
}

TEST_F(NormalFiles, that_all_look_the_same_way_are_those_of_tangent_space) {
  write([](Vec3, const test::Hit& hit) {
    return unit(Vec3{0.05 * std::sin(double(hit.position.x) * 9), 0.05 * std::cos(double(hit.position.y) * 7), 1});
  });
  expect(Reply::refused, {"tangent space", "--normal none"});
}

/// The wall has its own normals, and nothing else has.
TEST_F(NormalFiles, of_which_less_than_half_agree_are_used_only_where_that_is_allowed) {
  write([&](Vec3 n, const test::Hit& hit) {
    return world(hit.primitive == kWall ? n : unit(cross(n, Vec3{0.31, 0.52, 0.79})));
  });
  const auto lines = said();
  ASSERT_EQ(lines.size(), 1);
  EXPECT_THAT(lines[0], HasSubstr("--set allow=normals-disagree"));
  settings.allow = "normals-disagree";
  EXPECT_THAT(codes_of(noted()), Contains(NoteCode::normals_disagree));
}

TEST_F(NormalFiles, that_fit_neither_way_are_not_called_flipped) {
  halves = {"Z"};  // by which nothing is refused
  write([&](Vec3 n, const test::Hit&) { return world(unit(cross(n, Vec3{0.31, 0.52, 0.79}))); });
  EXPECT_THAT(codes_of(noted()), Contains(NoteCode::normals_disagree));
  EXPECT_THAT(codes_of(noted()), Not(Contains(NoteCode::turned_normals)));
}

TEST_F(NormalFiles, do_not_blame_the_camera_for_a_flip_that_is_given_wrongly) {
  settings.normal_space = NormalSpace::view;
  write([](Vec3 n, const test::Hit&) { return n; });
  settings.flip_normal.y = true;
  expect(Reply::refused, {"--flip-normal y does not fit", "leave it out"});
  settings.flip_normal.x = true;
  expect(Reply::refused, {"--flip-normal xy does not fit", "leave it out"});
  write([](Vec3 n, const test::Hit&) { return Vec3{-n.x, n.y, n.z}; });
  expect(Reply::refused, {"--flip-normal xy does not fit", "give that"});
  // A floor and a wall along axes of the world, half of them then turned round.
  settings.normal_space = NormalSpace::world;
  settings.flip_normal = {true, false, false};
  const Shot& shot = rendering.shot;
  place({shot.right, shot.up, shot.back});
  write([](Vec3, const test::Hit& hit) { return hit.primitive == kBall ? Vec3{} : hit.normal; });
  expect(Reply::refused, {"--flip-normal x does not fit", "leave it out"});
}

TEST_F(NormalFiles, of_two_components_are_those_of_view_space_or_refused) {
  const auto write_two = [&](bool in_view) {
    FrameFile file = file_of(rendering, 1e10f, planar, [&](const test::Hit& hit) {
      const Vec3 n = rendering.shot.view_from_world(hit.normal);
      return in_view ? n : world(n);
    });
    file.planes.erase("N.Z");
    file.write(settings.input);
  };
  settings.normal_channels = "N.X,N.Y";
  write_two(true);
  EXPECT_EQ(settled().reading.normal_space, NormalSpace::view);
  EXPECT_THAT(noted(), Each(testing::Field(&Note::code, NoteCode::proven_reading)));
  settings.normal_space = NormalSpace::world;
  write_two(false);
  expect(Reply::refused, {"N.X, N.Y", "sign of z in world space", "--normal-space view"});
  settings.normal_space = NormalSpace::automatic;
  expect(Reply::refused, {"--normal none"});
}

TEST(NormalScores, of_another_camera_or_order_are_no_cause_where_few_agree_or_all_are_turned) {
  NormalScore score{NormalSpace::world, {}};
  score.agreement = 0.9;
  EXPECT_TRUE(score.may_be_right());
  score.turn = {0, 0.1, 0};
  EXPECT_FALSE(score.may_be_right()) << "by six degrees";
  score.turn = {};
  score.agreement = 0.62;
  EXPECT_FALSE(score.may_be_right()) << "as of rooms by chance";
}

TEST_F(NormalFiles, show_square_pixels_beside_a_stale_pixel_aspect) {
  settings.normal_space = NormalSpace::view;
  leave_camera_out();
  FrameFile file = file_of(rendering, 1e10f, planar,
                           [&](const test::Hit& hit) { return rendering.shot.view_from_world(hit.normal); });
  file.pixel_aspect = 2;
  file.write(settings.input);
  EXPECT_THAT(texts_of(noted()), Contains(HasSubstr("but with square pixels")));
  EXPECT_THAT(codes_of(noted()), Not(Contains(NoteCode::field_of_view)));
}

// Spaces that are turned by little against each other.

TEST_F(NormalFiles, are_of_the_space_that_fits_however_little_the_camera_is_turned) {
  struct Case {
    Vec3 axis;
    double degrees;
  };
  for (const auto& [axis, degrees] : {Case{{1, 0, 0}, 1.5},
                                      {{0, 1, 0}, 3},
                                      {{0, 0, 1}, 5},
                                      {{1, 1, 0}, -8},
                                      {{1, 0, 0}, -12},
                                      {{0.2, 1, 0.4}, 16},
                                      {{1, -1, 1}, 19}}) {
    place(turned(axis, degrees));
    for (const bool as_halves : {false, true})
      for (const double bumps : {0.0, 0.1}) {
        halves = as_halves ? std::set<std::string>{"N.X", "N.Y", "N.Z"} : std::set<std::string>{};
        const auto bumpy = [&](Vec3 n, const test::Hit& hit) {
          const Vec3 p = 40 * hit.position;
          return unit(n + bumps * Vec3{std::sin(p.x + p.y), std::cos(p.y - p.z), std::sin(p.z + p.x)});
        };
        const auto what = testing::Message() << degrees << " degrees, halves " << as_halves << ", bumps " << bumps;
        write(bumpy);
        FrameSource source = settled();
        EXPECT_EQ(source.reading.normal_space, NormalSpace::view) << what;
        EXPECT_THAT(codes_of(source.notes), Not(Contains(NoteCode::field_of_view))) << what;
        write([&](Vec3 n, const test::Hit& hit) { return world(bumpy(n, hit)); });
        source = settled();
        EXPECT_EQ(source.reading.normal_space, NormalSpace::world) << what;
        EXPECT_THAT(source.notes, Each(testing::Field(&Note::code, NoteCode::normals_disagree))) << what;
      }
  }
}

TEST_F(NormalFiles, of_a_camera_that_is_not_turned_are_read_as_usual_and_nothing_is_said) {
  place(turned({1, 0, 0}, 0));
  write([](Vec3 n, const test::Hit&) { return n; });
  EXPECT_EQ(settled().reading.normal_space, NormalSpace::world);
  EXPECT_THAT(settled().notes, IsEmpty());
}

TEST_F(NormalFiles, in_the_wrong_space_by_an_option_are_not_blamed_on_the_lens) {
  place(turned({1, 0, 0}, -9));
  write([](Vec3 n, const test::Hit&) { return n; });
  settings.normal_space = NormalSpace::world;
  const Notes notes = settled().notes;
  EXPECT_THAT(codes_of(notes), ElementsAre(NoteCode::normals_disagree));
  EXPECT_THAT(notes.at(0).text, AllOf(HasSubstr("view"), ContainsRegex("turned by (8.9|9.0) degrees")));
}

TEST_F(NormalFiles, of_the_world_without_a_matrix_are_refused_as_such) {
  for (const double degrees : {5.0, 12.0, 18.0}) {
    place(turned({1, 0.3, 0}, degrees));
    leave_camera_out();
    write([&](Vec3 n, const test::Hit&) { return world(n); });
    SCOPED_TRACE(degrees);
    expect(Reply::refused, {"world space", "--camera", "--normal none"});
    write([](Vec3 n, const test::Hit&) { return n; });
    EXPECT_EQ(settled().reading.normal_space, NormalSpace::view) << degrees;
  }
}

// Components that were lost, and lengths.

TEST_F(NormalFiles, without_signs_are_told_from_those_that_need_none) {
  const auto absolute = [](Vec3 n) { return Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)}; };
  const auto clamped = [](Vec3 n) { return Vec3{std::max(n.x, 0.0), std::max(n.y, 0.0), std::max(n.z, 0.0)}; };
  settings.normal_space = NormalSpace::view;
  write([&](Vec3 n, const test::Hit&) { return absolute(n); });
  expect(Reply::refused, {"absolute values were saved", "N.X, N.Y, N.Z"});
  write([&](Vec3 n, const test::Hit&) { return clamped(n); });
  expect(Reply::refused, {"values below 0 were cut off"});
  EXPECT_THAT(said(), Each(Not(HasSubstr("averaged"))));
  settings.normal_space = NormalSpace::automatic;
  face_axes();
  write([&](Vec3 n, const test::Hit&) { return world(n); });
  EXPECT_THAT(noted(), IsEmpty());
}

TEST_F(NormalFiles, that_were_scaled_or_moved_to_0_to_1_are_right_and_are_not_called_averaged) {
  for (const double factor : {0.5, 3.0}) {
    write([&](Vec3 n, const test::Hit&) { return factor * world(n); });
    EXPECT_THAT(codes_of(noted()), ElementsAre(NoteCode::scaled_normals)) << factor;
    EXPECT_THAT(warnings_of(noted()), IsEmpty());
  }
  write([&](Vec3 n, const test::Hit&) { return 0.5 * world(n) + Vec3{0.5, 0.5, 0.5}; });
  settings.normal_space = NormalSpace::world;
  for (const bool strict : {false, true}) {
    settings.strict = strict;
    EXPECT_TRUE(settled().reading.normal_unorm) << "proven by their lengths";
    EXPECT_THAT(codes_of(noted()), ElementsAre(NoteCode::proven_reading));
    EXPECT_THAT(warnings_of(noted()), IsEmpty());
  }
}

TEST_F(NormalFiles, that_went_through_a_curve_for_colours_are_refused_with_the_cause) {
  const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  write([&](Vec3 n, const test::Hit&) {
    const Vec3 w = world(n);
    return Vec3{linear(0.5 + 0.5 * w.x), linear(0.5 + 0.5 * w.y), linear(0.5 + 0.5 * w.z)};
  });
  expect(Reply::refused, {"0.5 + 0.5 n that was converted from sRGB to linear", "N.X, N.Y, N.Z", "--normal none"});
}

// The curve of sRGB makes vectors of averages of two axes, too: (0.5, 0.5, 0) becomes (0.74, 0.74, 0).
TEST_F(NormalFiles, of_a_room_are_averages_at_edges_and_went_through_no_curve) {
  face_axes();
  int number = 0;
  write([&](Vec3 n, const test::Hit&) {
    const Vec3 w = world(n);
    return number++ % 6 ? w : 0.5 * w + 0.5 * Vec3{w.y, w.z, w.x};
  });
  EXPECT_THAT(codes_of(noted()), Contains(NoteCode::shortened_normals));
  number = 0;
  write([&](Vec3 n, const test::Hit&) { return (number++ % 16 ? 1 : 0.7) * world(n); });
  EXPECT_THAT(codes_of(noted()), ElementsAre(NoteCode::shortened_normals)) << "most have length 1: they are not scaled";
}

TEST_F(NormalFiles, are_named_where_they_are_files_of_their_own) {
  write([&](Vec3 n, const test::Hit&) { return 0.5 * world(n) + Vec3{0.5, 0.5, 0.5}; });
  settings.depth = settings.input;
  settings.normal = folder / "normals.exr";
  write_bytes(settings.normal, read_bytes(settings.input));
  settings.input.clear();
  ASSERT_EQ(noted().size(), 1);
  EXPECT_EQ(noted()[0].file, settings.normal);
  EXPECT_THAT(line_of(noted()[0], settings.depth), StartsWith(settings.normal + ": normal encoding"));
  settings.strict = true;
  expect(Reply::refused, {settings.normal + ": --strict, and the normal space is a guess"});
}

}  // namespace
}  // namespace alcove::normals_test
