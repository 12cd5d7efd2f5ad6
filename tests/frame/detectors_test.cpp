// Detectors: each speaks on the numbers of its fault, and is silent on those of frames that are sound.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/pixels/findings.h"

#include <set>

#include "tests/support/program.h"

namespace alcove::detectors_test {
namespace {

using namespace test;

/// The numbers of a frame without a fault: some outlines, a sky, planes at an angle.
Findings sound() {
  Findings f;
  f.depth_channel = "Z";
  f.pixels = 20000;
  f.surfaces = 15000;
  f.grain = {.median = 4};
  f.repeats = {Repeats{959, 900, 0, 850}, Repeats{539, 500, 0, 500}};
  f.outlines = {Outlines{400, 340, 300, 30}, Outlines{300, 240, 200, 20}};
  f.holes = {Holes{15000, 90, 20, 50, 5}, Holes{15000, 90, 20, 50, 5}};
  f.unevenness = {6000, 1e-7, 0.4};
  f.curve = {200, 0.501, 0.002, 4, 0.002, true};
  f.wrapping = {60, 5, 3.1, 5};
  f.borders = Borders{BorderRows{80, 0.1}, BorderRows{0, 1}, BorderRows{0, 0.8}, BorderRows{0, 0.8}};
  f.plateau = Plateau{9, 0.2, 300, 1, 0.6};
  f.normals = {200, 190, 0};
  return f;
}

std::set<std::string> spoken(const Findings& f) {
  std::set<std::string> codes;
  for (const Note& note : detected(f)) codes.insert(facts_of(note.code).name);
  return codes;
}

using Codes = std::set<std::string>;

TEST(Detectors, nothing_is_said_of_a_sound_frame) { EXPECT_EQ(spoken(sound()), Codes{}); }

TEST(Detectors, ramps_that_a_cut_leaves_are_told_and_so_is_the_cut) {
  Findings f = sound();
  f.cut_pixels = 1234;
  const Notes cut = detected(f);
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_EQ(cut[0].code, NoteCode::smoothed_depth);
  EXPECT_THAT(cut[0].text, HasSubstr("1234 pixels"));
  f.outlines[1] = {300, 5, 0, 0};
  f.outlines[0] = {400, 100, 300, 250};
  EXPECT_EQ(spoken(f), (Codes{"smoothed-depth", "antialiased-depth"}));
  for (const Note& note : detected(f))
    EXPECT_THAT(note.text, AllOf(HasSubstr("1234 pixels"), Not(HasSubstr("--set ramps=cut"))));
}

TEST(Detectors, each_fault_is_told_by_its_numbers_and_by_nothing_else) {
  struct Case {
    const char* code;
    std::function<void(Findings&)> spoil;
  };
  const std::vector<Case> cases{
      {"no-surfaces", [](Findings& f) { f.surfaces = 0; }},
      {"holes-in-depth",
       [](Findings& f) {
         f.holes[1] = {7500, 7000, 0, 50, 48};
       }},
      {"holes-in-depth",
       [](Findings& f) {
         f.holes[0] = {15000, 800, 700, 50, 48};
       }},
      {"enlarged-depth",
       [](Findings& f) {
         f.repeats[0] = {959, 900, 450, 440};
       }},
      {"enlarged-depth",
       [](Findings& f) {
         f.repeats[1] = {539, 500, 60, 430};
       }},
      {"smoothed-depth",
       [](Findings& f) {
         f.outlines[1] = {300, 5, 0, 0};
       }},
      {"antialiased-depth",
       [](Findings& f) {
         f.outlines[0] = {400, 100, 300, 250};
       }},
      {"noisy-depth",
       [](Findings& f) {
         f.unevenness = {6000, 6e-3, 0.73};
       }},
      {"jittered-depth", [](Findings& f) { f.jitter = 0.29; }},
      {"half-depth", [](Findings& f) { f.has_half_type = true; }},
      {"letterbox-bars",
       [](Findings& f) {
         f.borders = Borders{BorderRows{60, 1}, BorderRows{60, 1}, BorderRows{}, BorderRows{}};
       }},
      {"part-of-picture",
       [](Findings& f) {
         f.borders = Borders{BorderRows{}, BorderRows{36, 1}, BorderRows{}, BorderRows{64, 0.7}};
       }},
      {"missing-tile", [](Findings& f) { f.rectangle = EmptyRectangle{64, 32, 128, 64, 0, true, false}; }},
      {"missing-tile",
       [](Findings& f) {
         f.borders = Borders{BorderRows{0, 0.9}, BorderRows{0, 1}, BorderRows{}, BorderRows{48, 1}};
       }},
      {"depth-offset", [](Findings& f) { f.curve.offset = 0.75; }},
      {"depth-offset", [](Findings& f) { f.said_offset = 2; }},
      {"depth-curve", [](Findings& f) { f.curve.slope = 0, f.curve.offset = 1; }},
      {"depth-curve", [](Findings& f) { f.curve.slope = 0.3125; }},
      {"clamped-depth",
       [](Findings& f) {
         f.plateau = Plateau{6, 0.3, 300, 12, 0.2};
       }},
      {"overflown-depth",
       [](Findings& f) {
         f.overflow = {0.4, true};
       }},
      {"wrapped-depth",
       [](Findings& f) {
         f.wrapping = {60, 55, 65536, 65530};
       }},
      {"displaced-normals",
       [](Findings& f) {
         f.normals = {200, 20, 3};
       }},
  };
  std::set<NoteCode> told;
  for (const auto& [code, spoil] : cases) {
    Findings f = sound();
    spoil(f);
    EXPECT_EQ(spoken(f), Codes{code});
    for (const Note& note : detected(f)) told.insert(note.code);
  }
  for (const Detector& d : detectors()) EXPECT_TRUE(told.contains(d.code)) << facts_of(d.code).name << " has no case";
}

TEST(Detectors, the_distance_of_displaced_normals_is_a_median) {
  Findings f = sound();
  f.normals = {200, 20, 3};
  ASSERT_EQ(detected(f).size(), 1);
  EXPECT_THAT(detected(f)[0].text,
              HasSubstr("along 90 % of the outlines the normals change beside the depth, by 3 px in "
                        "the median"));
}

TEST(Detectors, the_better_depth_of_the_same_file_is_named) {
  Findings f = sound();
  f.has_half_type = true;
  f.other_depths = {"Z"};
  ASSERT_EQ(detected(f).size(), 1);
  EXPECT_THAT(detected(f)[0].text, HasSubstr("--depth-channel Z"));
}

TEST(Detectors, one_field_is_told_as_holes_and_not_as_bars_of_one_row) {
  Findings f = sound();
  f.holes[1] = {7500, 7000, 0, 50, 48};
  f.borders = Borders{BorderRows{1, 1}, BorderRows{1, 1}, BorderRows{}, BorderRows{}};
  EXPECT_EQ(spoken(f), Codes{"holes-in-depth"});
}

TEST(Detectors, an_offset_is_mended_by_what_the_depth_is_read_by) {
  const auto said = [](double offset, DepthKind kind, double said_offset) {
    Findings f = sound();
    f.depth_kind = kind;
    f.curve.offset = offset / 2;
    f.said_offset = said_offset;
    const Notes notes = detected(f);
    return notes.size() == 1 ? notes[0].text : "";
  };
  EXPECT_THAT(said(-1, DepthKind::planar, 0), HasSubstr("something was added to the depth, an offset of 1"));
  EXPECT_THAT(said(-7, DepthKind::planar, 0),
              AllOf(HasSubstr("--depth-kind normalized --reversed-z --near N --far F"), HasSubstr("F / (F - N) = 7")));
  EXPECT_THAT(said(-7, DepthKind::normalized, -5),
              AllOf(HasSubstr("(depth - 5)"), HasSubstr("--near or --far does not fit"), Not(HasSubstr("subtract"))));
  EXPECT_THAT(said(2, DepthKind::normalized, -5), HasSubstr("without --reversed-z"));
  EXPECT_THAT(said(2, DepthKind::normalized, 1), AllOf(HasSubstr("--near does not fit"), Not(HasSubstr("reversed"))));
}

TEST(Detectors, of_a_range_that_begins_behind_most_surfaces_no_offset_tells) {
  Findings f = sound();
  f.curve.offset = 0.75;
  f.begins_behind = true;
  EXPECT_EQ(spoken(f), Codes{});
}

TEST(Detectors, half_floats_that_do_not_reach_their_end_have_a_sky) {
  Findings f = sound();
  f.overflow = {0.4, false};
  EXPECT_EQ(spoken(f), Codes{});
  f.overflow = {0, true};
  EXPECT_EQ(spoken(f), Codes{});
}

TEST(Detectors, few_planes_or_values_of_one_size_speak_for_no_offset) {
  Findings f = sound();
  f.curve = {19, 0.5, 0.75, 4, 0.002, true};
  EXPECT_EQ(spoken(f), Codes{});
  f.curve = {200, 0.5, 0.75, 4, 0.002, false};
  EXPECT_EQ(spoken(f), Codes{});
  f.curve = {200, 0.5, 0.75, 4, 0.2, true};
  EXPECT_EQ(spoken(f), Codes{});
}

TEST(Detectors, the_page_lists_them) {
  const std::string page = read_bytes(ALCOVE_SOURCE_DIR "/docs/troubleshooting.md");
  const std::size_t begin = page.find("<!-- detectors -->"), end = page.find("<!-- /detectors -->");
  std::vector<std::string> listed, known;
  for (const auto& line : lines_of(page.substr(begin, end - begin)))
    if (line.starts_with("| `")) listed.push_back(line.substr(3, line.find('`', 3) - 3));
  for (const Detector& d : detectors()) known.emplace_back(facts_of(d.code).name);
  EXPECT_EQ(listed, known);
}

}  // namespace
}  // namespace alcove::detectors_test
