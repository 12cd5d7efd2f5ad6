// Every way to read a frame against every way it may be written: the right one is taken without a word, each wrong one
// is noted or refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/option_words.h"
#include "core/frame/pixels/normal_scores.h"
#include "core/frame/pixels/statistics.h"
#include "tests/support/source_frame.h"

namespace alcove::readings_test {
namespace {

using namespace test;

constexpr double kNear = 0.5;

/// A value of depth, and of the sky.
struct Written {
  DepthKind kind;
  bool reversed;
  std::function<double(double z, double ray)> value;
  float sky;
};

double to_range(double z) { return (1 / kNear - 1 / z) / (1 / kNear - 1 / kFar); }
double to_log(double z) { return std::log1p(0.5 * z) / std::log1p(0.5 * kFar); }

const Written kPlanar{DepthKind::planar, false, [](double z, double) { return z; }, 1e10f};
const std::vector<Written>& all_depths() {
  static const std::vector<Written> all{
      kPlanar,
      {DepthKind::ray, false, [](double, double ray) { return ray; }, 1e10f},
      {DepthKind::inverse, false, [](double z, double) { return 1 / z; }, 0},
      {DepthKind::device, false, [](double z, double) { return to_range(z); }, 1},
      {DepthKind::device, true, [](double z, double) { return 1 - to_range(z); }, 0},
      {DepthKind::normalized, false, [](double z, double) { return (z - kNear) / (kFar - kNear); }, 1},
      {DepthKind::log, false, [](double z, double) { return to_log(z); }, 1}};
  return all;
}

Vec3 as_it_is(Vec3 n) { return n; }
Vec3 spheremap(Vec3 n) {
  const double across = std::hypot(n.x, n.y), radius = std::sqrt(0.5 + 0.5 * n.z);
  return across > 0 ? Vec3{n.x / across * radius, n.y / across * radius, 0} : Vec3{};
}
Vec3 unorm(Vec3 n) { return {0.5 + 0.5 * n.x, 0.5 + 0.5 * n.y, 0.5 + 0.5 * n.z}; }

/// A room with a ball, written in some way, and how it is then read.
class Readings : public SettledFile {
 protected:
  Readings() { say_nothing(); }

  void say_nothing() {
    settings = {};
    settings.input = folder / "frame.exr";
    settings.camera = folder / "camera.json";
  }

  void write(const Written& depth, const std::function<Vec3(Vec3)>& normal = as_it_is, bool in_view = false,
             const Rendering& of = rendering()) {
    const Shot& shot = of.shot;
    FrameFile file = file_of(
        of, depth.sky, [&](const test::Hit& hit) { return depth.value(hit.distance, length(hit.position - shot.eye)); },
        [&](const test::Hit& hit) { return normal(in_view ? shot.view_from_world(hit.normal) : hit.normal); });
    file.halves = halves;
    file.attributes = attributes;
    file.write(settings.input);
    give(camera_of(shot));
  }

  void say(const Written& depth) {
    settings.depth_kind = depth.kind;
    const bool is_log = depth.kind == DepthKind::log;
    const bool has_near = depth.kind == DepthKind::device || depth.kind == DepthKind::normalized;
    settings.depth_range = {};
    if (has_near) settings.depth_range.near = kNear;
    if (has_near || is_log) settings.depth_range.far = kFar;
    if (is_log) settings.depth_range.log_constant = 0.5;
    settings.depth_range.reversed = depth.reversed;
  }

  std::set<std::string> halves;
  std::map<std::string, std::string> attributes;
};

TEST_F(Readings, of_every_kind_of_depth_by_every_other_are_noted) {
  for (const auto& written : all_depths()) {
    write(written);
    say_nothing();
    if (written.kind == DepthKind::planar || written.kind == DepthKind::ray)
      EXPECT_EQ(settled().reading.depth_kind, written.kind);
    if (written.kind == DepthKind::planar) expect(Reply::silent);
    if (written.kind == DepthKind::ray) expect(Reply::noted, {"--depth-kind"});
    for (const auto& read : all_depths()) {
      say(read);
      if (written.kind == DepthKind::ray && read.kind == DepthKind::planar)
        EXPECT_EQ(settled().reading.depth_kind, DepthKind::planar) << "it is what is said";
      // that is 1/z too, but for a scale and next to nothing
      if (written.kind == DepthKind::inverse && read.reversed) continue;
      if (&written == &read)
        EXPECT_THAT(said(), IsEmpty()) << word_of(read.kind) << read.reversed;
      else
        EXPECT_THAT(said(), Contains(HasSubstr("--depth-kind")))
            << word_of(written.kind) << written.reversed << " as " << word_of(read.kind) << read.reversed;
    }
  }
}

TEST_F(Readings, of_inverse_depth_beyond_1_need_no_option) {
  write({DepthKind::inverse, false, [](double z, double) { return 30 / z; }, 0});
  std::string guesses;
  for (const Note& note : settled().notes) guesses += note.text;
  EXPECT_THAT(guesses, HasSubstr("a / z + b, --depth-kind disparity"));
  EXPECT_EQ(settled().reading.depth_kind, DepthKind::inverse);
}

TEST_F(Readings, of_orthographic_depth_need_no_option_and_doubt_nothing_that_is_right) {
  static const Rendering parallel = render(test::scene(), room_shot(160, 120, true, 0, 5));
  write(kPlanar, as_it_is, false, parallel);
  EXPECT_EQ(settled().reading.depth_kind, DepthKind::planar);
  EXPECT_THAT(said(), IsEmpty());
  settings.depth_kind = DepthKind::inverse;
  EXPECT_THAT(said(), Contains(HasSubstr("--depth-kind")));
  for (const bool reversed : {false, true}) {
    const auto linear = [&](double z, double) {
      return reversed ? (kFar - z) / (kFar - kNear) : (z - kNear) / (kFar - kNear);
    };
    for (const DepthKind kind : {DepthKind::device, DepthKind::normalized}) {
      const Written depth{kind, reversed, linear, reversed ? 0.0f : 1.0f};
      write(depth, as_it_is, false, parallel);
      say(depth);
      EXPECT_THAT(said(), IsEmpty()) << word_of(kind) << reversed;
    }
  }
}

TEST_F(Readings, of_orthographic_depth_by_another_camera_are_told_what_helps) {
  const Shot shot = room_shot(160, 120, true, 0, 5);
  write(kPlanar, as_it_is, false, render(test::scene(), shot));
  settings.camera.clear();
  settings.fov = 50;
  EXPECT_THAT(said(), Contains(AllOf(HasSubstr("--ortho-width"), HasSubstr("\"projection\": \"orthographic\""))));
}

TEST_F(Readings, of_a_range_that_begins_among_the_surfaces_are_no_distances_with_an_offset) {
  for (const double begin : {3.0, 4.0, 5.0}) {
    write({DepthKind::normalized, false, [&](double z, double) { return (z - begin) / 3; }, 100});
    EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("--depth-kind normalized"), Not(HasSubstr("subtract it")))))
        << begin;
  }
}

TEST_F(Readings, of_depth_that_ends_at_1_need_to_be_said) {
  for (const auto& written : all_depths())
    if (written.kind == DepthKind::normalized || written.kind == DepthKind::log) {
      write(written);
      EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("frame.exr"), HasSubstr("--depth-kind normalized"),
                                            HasSubstr("--far"), HasSubstr("log"), HasSubstr("--depth-kind planar"))));
      settings.depth_kind = DepthKind::planar;
      EXPECT_EQ(settled().reading.depth_kind, DepthKind::planar) << "what is said is taken";
      settings.depth_kind = DepthKind::automatic;
    }
}

TEST_F(Readings, between_wrong_planes_are_noted) {
  const Written& device = all_depths()[3];
  write(device);
  say(device);
  settings.depth_range.far = 10;
  EXPECT_THAT(said(), Contains(HasSubstr("--far"))) << "of device depth";
  say(device);
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  EXPECT_THAT(said(), Contains(HasSubstr("--set device-range"))) << "0..1 as -1..1";
  const Written gl{DepthKind::device, false,
                   [](double z, double) { return 2 * (1 / 2.9 - 1 / z) / (1 / 2.9 - 1 / kFar) - 1; }, 1};
  write(gl);
  say(gl);
  settings.depth_range.near = 2.9;
  EXPECT_THAT(said(), Contains(HasSubstr("--set device-range"))) << "-1..1 as 0..1";
  settings.depth_range.device = DeviceRange::minus_one_to_one;
  EXPECT_THAT(said(), IsEmpty());
  write(all_depths()[5]);
  say(all_depths()[5]);
  settings.depth_range.near = std::nullopt;
  EXPECT_THAT(said(), Contains(HasSubstr("--near"))) << "of normalized depth";
  write(all_depths()[6]);
  say(all_depths()[6]);
  settings.depth_range.log_constant = 0.1;
  EXPECT_THAT(said(), Contains(HasSubstr("--depth-kind"))) << "the constant of log depth";
}

TEST_F(Readings, by_the_rules_of_another_program_are_noted) {
  write(kPlanar);
  settings.source = "octane";
  EXPECT_THAT(said(), Contains(HasSubstr("--source"))) << "its depth is along the ray";
}

struct Encoded {
  NormalEncoding encoding;
  bool between_0_and_1;
  Vec3 (*encode)(Vec3);
};
constexpr Encoded kEncodings[]{
    {NormalEncoding::signed_float, false, as_it_is}, {NormalEncoding::unorm, true, as_it_is},
    {NormalEncoding::octahedral, false, octahedral}, {NormalEncoding::octahedral, true, octahedral},
    {NormalEncoding::spheremap, false, spheremap},   {NormalEncoding::spheremap, true, spheremap}};

TEST_F(Readings, of_every_encoding_are_found_and_by_every_other_are_noted) {
  for (const auto& written : kEncodings) {
    write(
        kPlanar, [&](Vec3 n) { return written.between_0_and_1 ? unorm(written.encode(n)) : written.encode(n); }, true);
    say_nothing();
    const FrameSource found = settled();
    const auto vectors = [](NormalEncoding e) { return e == NormalEncoding::unorm ? NormalEncoding::signed_float : e; };
    EXPECT_EQ(vectors(found.reading.normal_encoding), vectors(written.encoding))
        << int(written.encoding) << written.between_0_and_1;
    EXPECT_EQ(found.reading.normal_unorm, written.between_0_and_1) << int(written.encoding);
    EXPECT_EQ(found.reading.normal_space, NormalSpace::view);
    settings.normal_space = NormalSpace::view;
    for (const NormalEncoding read :
         {NormalEncoding::signed_float, NormalEncoding::unorm, NormalEncoding::octahedral, NormalEncoding::spheremap}) {
      settings.normal_encoding = read;
      if (read == written.encoding)
        EXPECT_THAT(said(), IsEmpty()) << int(read) << written.between_0_and_1;
      else
        EXPECT_THAT(said(), Contains(HasSubstr("--normal-encoding")))
            << int(written.encoding) << written.between_0_and_1 << " as " << int(read);
    }
  }
}

TEST_F(Readings, in_every_space_with_every_flip_are_found_and_by_every_other_are_noted) {
  for (const bool in_view : {false, true})
    for (int flips = 0; flips < 8; flips++) {
      const NormalFlips written{(flips & 1) != 0, (flips & 2) != 0, (flips & 4) != 0};
      write(
          kPlanar,
          [&](Vec3 n) {
            return Vec3{written.x ? -n.x : n.x, written.y ? -n.y : n.y, written.z ? -n.z : n.z};
          },
          in_view);
      say_nothing();
      EXPECT_EQ(settled().reading.normal_space, in_view ? NormalSpace::view : NormalSpace::world) << flips;
      EXPECT_EQ(to_string(settled().reading.flip_normal), to_string(written));
      for (const bool as_view : {false, true})
        for (const bool is_flipped : {false, true}) {
          settings.normal_space = as_view ? NormalSpace::view : NormalSpace::world;
          settings.flip_normal = written;
          // in view space a flip of y looks as if the picture was upside down, and that is said
          bool& axis = flips % 3 == 1 && !as_view ? settings.flip_normal.y
                       : flips % 3 == 2           ? settings.flip_normal.z
                                                  : settings.flip_normal.x;
          axis = axis != is_flipped;
          if (as_view == in_view && !is_flipped)
            EXPECT_THAT(said(), IsEmpty()) << flips;
          else
            EXPECT_THAT(said(), Contains(AnyOf(HasSubstr("--normal-space"), HasSubstr("--flip-normal"))))
                << flips << as_view << is_flipped;
        }
    }
}

TEST_F(Readings, that_do_equally_well_are_refused_with_what_decides) {
  attributes["Software"] = "Octane";  // which writes distances along the ray
  write({DepthKind::planar, false, [](double z, double) { return z < 4.2 ? z : 40 / z; }, 1e10f});
  EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("frame.exr"), HasSubstr("--depth-kind planar"),
                                        HasSubstr("--depth-kind inverse"))));
  attributes.clear();
  write(kPlanar, as_it_is, true);
  // so that one space is the other with flips
  json camera = camera_of(shot());
  camera["world_to_camera"] = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}};
  give(camera);
  EXPECT_THAT(said(), ElementsAre(AllOf(HasSubstr("view"), HasSubstr("world"), HasSubstr("flips xz"),
                                        HasSubstr("--normal-space"), HasSubstr("--flip-normal"))));
}

TEST_F(Readings, with_a_flip_and_no_space_are_noted_too) {
  write(kPlanar);
  settings.flip_normal.y = true;
  EXPECT_THAT(said(), Contains(HasSubstr("--flip-normal")));
}

TEST_F(Readings, of_a_z_buffer_need_its_planes_and_take_its_direction_from_the_sky) {
  Written device = all_depths()[3];
  write(device);
  expect(Reply::refused, {"device", "inverse", "--near", "--far", "frame.exr", "--depth-kind disparity"});
  for (const bool reversed : {false, true}) {
    device = all_depths()[reversed ? 4 : 3];
    write(device);
    say(device);
    settings.depth_range.reversed = false;
    settings.depth_kind = DepthKind::automatic;
    EXPECT_EQ(settled().reading.depth_kind, DepthKind::device);
    EXPECT_EQ(settled().reading.depth_range.reversed, reversed);
  }
  device.sky = 0.5f;
  write(device);
  expect(Reply::refused, {"--reversed-z"});
}

TEST_F(Readings, that_nothing_says_are_errors_where_all_is_to_be_said) {
  write(kPlanar);
  settings.strict = true;
  expect(Reply::refused, {"--strict", "--depth-kind", "planar"});
  settings.depth_kind = DepthKind::planar;
  expect(Reply::refused, {"--strict", "--normal-space", "world"});
  settings.normal_space = NormalSpace::world;
  expect(Reply::silent);
}

TEST_F(Readings, of_positions_that_are_not_on_their_pixels_are_refused) {
  write(kPlanar);
  FrameFile file = file_of(rendering(), 0, planar, [](const test::Hit& hit) { return hit.position; });
  for (const char* c : {"X", "Y", "Z"}) file.rename(std::string("N.") + c, std::string("P.") + c);
  file.planes.erase("Z");
  file.write(settings.input);
  EXPECT_EQ(settled().reading.position_space, PositionSpace::world);
  settings.position_space = PositionSpace::view;
  expect(Reply::refused, {"frame.exr", "pixels", "--set position-space", "--camera"});
}

TEST_F(Readings, of_what_is_beyond_half_floats_are_sky) {
  halves = {"Z"};
  write({DepthKind::planar, false, kPlanar.value, 65504});
  settings.depth_kind = DepthKind::planar;
  const FrameSource source = settled();
  EXPECT_TRUE(std::isinf(planar_depth(depth_map_of(source.reading), {65504, 0, 0}, 1)));
  EXPECT_FALSE(std::isinf(planar_depth(depth_map_of(source.reading), {65472, 0, 0}, 1)));
  EXPECT_THAT(texts_of(source.suspicious), ElementsAre(AllOf(HasSubstr("half float"), HasSubstr("0.0039"))));
}

}  // namespace
}  // namespace alcove::readings_test
