// What presets and the command line say to settings: what has no effect, alone or beside another one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "cli/options.h"
#include "core/base/error.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Words to be typed; a first one is the option that the case is about.
struct Case {
  std::vector<Words> refused;  // for each reason of the row one that it holds for
  Words taken;
};

/// A case for every setting that may have no effect, but for those of pairs().
const std::map<std::string, Case>& cases_without_effect() {
  static const Words exact{"--search", "exact"}, by_error{"--tolerance", "0.1"}, crytek{"--estimator", "crytek"};
  static const auto with = [](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  static const std::map<std::string, Case> cases{
      {"--beauty", {{{"--beauty", "b.exr"}}, {"--beauty", "b.exr", "--composite", "c.exr"}}},
      {"--set albedo",
       {{{"--set", "albedo=0.5"}}, {"--set", "albedo=0.5", "--set", "multi-bounce=true", "--set", "ao-channels=rgb"}}},
      {"--set beauty-channels",
       {{{"--set", "beauty-channels=b"}}, {"--set", "beauty-channels=b", "--composite", "c.exr"}}},
      {"--set albedo-channels",
       {{{"--set", "albedo-channels=d"},
         {"--set", "albedo-channels=d", "--set", "albedo=0.5", "--set", "multi-bounce=true", "--set",
          "ao-channels=rgb"}},
        {"--set", "albedo-channels=d", "--set", "multi-bounce=true", "--set", "ao-channels=rgb"}}},
      {"--depth-kind",
       {{{"--depth-kind", "planar", "--position", "p.exr"}}, {"--depth-kind", "position", "--position", "p.exr"}}},
      {"--depth-channel", {{{"--depth-channel", "Z", "--depth-kind", "position"}}, {"--depth-channel", "Z"}}},
      {"--near",
       {{{"--near", "1", "--depth-kind", "planar"}, {"--near", "1", "--source", "octane"}},
        {"--near", "1", "--source", "octane", "--camera", "says.json"}}},
      {"--far", {{{"--far", "9", "--position-channels", "P"}}, {"--far", "9"}}},
      {"--reversed-z", {{{"--reversed-z", "--depth-kind", "ray"}}, {"--reversed-z", "--depth-kind", "log"}}},
      {"--set device-range",
       {{{"--set", "device-range=-1..1", "--depth-kind", "log"}},
        {"--set", "device-range=-1..1", "--depth-kind", "device"}}},
      {"--set log-constant",
       {{{"--set", "log-constant=2", "--depth-kind", "device"}}, {"--set", "log-constant=2", "--depth-kind", "auto"}}},
      {"--set position-space",
       {{{"--set", "position-space=view", "--depth-kind", "planar"}},
        {"--set", "position-space=view", "--position", "p.exr"}}},
      {"--focal", {{{"--focal", "35"}}, {"--focal", "35", "--aperture", "36"}}},
      {"--normal-channels", {{{"--normal-channels", "N", "--normal", "none"}}, {"--normal-channels", "N"}}},
      {"--normal-space", {{{"--normal-space", "view", "--normal", "none"}}, {"--normal-space", "view"}}},
      {"--normal-encoding", {{{"--normal-encoding", "unorm", "--normal", "None"}}, {"--normal-encoding", "unorm"}}},
      {"--flip-normal", {{{"--flip-normal", "y", "--normal", "none"}}, {"--flip-normal", "y", "--normal", "n.exr"}}},
      {"--aperture", {{{"--aperture", "36"}}, {"--aperture", "36", "--focal", "35"}}},
      {"--behind", {{with({"--behind", "a.exr"}, crytek)}, {"--behind", "a.exr"}}},
      {"--set other-views", {{with({"--set", "other-views=true"}, crytek)}, {"--set", "other-views=true"}}},
      {"--around", {{with({"--around", "2"}, crytek)}, {"--around", "2"}}},
      {"--set behind-channel",
       {{{"--set", "behind-channel=Z"}, {"--set", "behind-channel=A,B", "--behind", "a.exr"}},
        {"--set", "behind-channel=A,B", "--behind", "a.exr", "--behind", "b.exr"}}},
      {"--behind-kind",
       {{{"--behind-kind", "backs"},
         {"--behind-kind", "backs,fronts", "--behind", "a.exr", "--behind", "b.exr", "--behind", "c.exr"}},
        {"--behind-kind", "backs", "--behind", "a.exr", "--behind", "b.exr"}}},
      {"--set deep-opacity", {{{"--set", "deep-opacity=0.2"}}, {"--set", "deep-opacity=0.2", "--deep", "d.exr"}}},
      {"--matte-outside", {{{"--matte-outside", "0.5"}}, {"--matte-outside", "0.5", "--matte-object", "Hero"}}},
      {"--set objects",
       {{{"--set", "objects=o.exr", "--set", "ignore=a.exr"}}, {"--set", "objects=o.exr", "--set", "ignore=Hero"}}},
      {"--set object-channel",
       {{{"--set", "object-channel=Id"}}, {"--set", "object-channel=Id", "--set", "occluders=3"}}},
      {"--motion",
       {{{"--motion", "m.exr"}, {"--motion", "m.exr", "--around", "0"}}, {"--motion", "m.exr", "--around", "2"}}},
      {"--set motion-channels",
       {{{"--set", "motion-channels=U,V", "--around", "all"}},
        {"--set", "motion-channels=U,V", "--motion", "v.exr", "--around", "all"}}},
      {"--set motion-kind",
       {{{"--set", "motion-kind=next", "--around", "2"}},
        {"--set", "motion-kind=next", "--motion", "v.exr", "--around", "2"}}},
      {"--set hidden", {{{"--set", "hidden=1"}}, {"--set", "hidden=1", "--set", "other-views=true"}}},
      {"--set separation", {{{"--set", "separation=0.1"}}, {"--set", "separation=0.1", "--deep", "d.exr"}}},
      {"--falloff",
       {{with({"--falloff", "linear"}, crytek), with({"--falloff", "linear"}, exact)}, {"--falloff", "linear"}}},
      {"--set falloff-start",
       {{with({"--set", "falloff-start=0.2"}, crytek),
         with({"--set", "falloff-start=0.2"}, exact),
         {"--set", "falloff-start=0.2"}},
        {"--set", "falloff-start=0.2", "--falloff", "smooth"}}},
      {"--set falloff-end", {{with({"--set", "falloff-end=0.5"}, crytek)}, with({"--set", "falloff-end=0.5"}, exact)}},
      {"--slices",
       {{with({"--slices", "3"}, crytek), with({"--slices", "3"}, by_error)}, with({"--slices", "3"}, exact)}},
      {"--steps",
       {{with({"--steps", "3"}, crytek), with({"--steps", "3"}, exact)}, {"--steps", "3", "--estimator", "hbao"}}},
      {"--search",
       {{with({"--search", "exact"}, crytek), with({"--search", "steps"}, by_error)}, {"--search", "every-pixel"}}},
      {"--tolerance", {{{"--tolerance", "0.1", "--estimator", "bitmask"}}, {"--tolerance", "0.1"}}},
      {"--samples", {{{"--samples", "8"}}, with({"--samples", "8"}, crytek)}},
      {"--set elevation",
       {{with({"--set", "elevation=surface"}, crytek)}, {"--set", "elevation=surface", "--estimator", "hbao"}}},
      {"--set sample-kernel", {{{"--set", "sample-kernel=uniform"}}, with({"--set", "sample-kernel=uniform"}, crytek)}},
      {"--set range-check", {{{"--set", "range-check=none"}}, with({"--set", "range-check=none"}, crytek)}},
      {"--thickness", {{with({"--thickness", "1"}, crytek)}, {"--thickness", "1", "--estimator", "bitmask"}}},
      {"--set complete", {{{"--set", "complete=border", "--estimator", "hbao"}}, {"--set", "complete=border"}}},
      {"--set density",
       {{with({"--set", "density=uniform"}, crytek),
         with({"--set", "density=uniform"}, exact),
         {"--set", "density=uniform", "--denoise", "none"}},
        {"--set", "density=uniform", "--set", "stride=4"}}},
      {"--set stride",
       {{with({"--set", "stride=4"}, exact), {"--set", "stride=4", "--denoise", "box"}},
        {"--set", "stride=4", "--denoise", "bilateral"}}},
      {"--denoise", {{with({"--denoise", "box"}, by_error)}, with({"--denoise", "bilateral"}, exact)}},
      {"--set denoise-radius",
       {{{"--set", "denoise-radius=3", "--denoise", "box"}, with({"--set", "denoise-radius=3"}, by_error)},
        {"--set", "denoise-radius=3"}}},
      {"--set denoise-kernel",
       {{{"--set", "denoise-kernel=1,0.5", "--denoise", "none"}, with({"--set", "denoise-kernel=1,0.5"}, by_error)},
        {"--set", "denoise-kernel=1,0.5"}}},
      {"--set denoise-depth-sigma",
       {{{"--set", "denoise-depth-sigma=0.1", "--denoise", "none"},
         with({"--set", "denoise-depth-sigma=0.1"}, by_error)},
        {"--set", "denoise-depth-sigma=0.1", "--denoise", "box"}}},
      {"--set fade-start", {{{"--set", "fade-start=1"}}, {"--set", "fade-start=1", "--set", "fade-end=2"}}},
      {"--set fade-end", {{{"--set", "fade-end=2"}}, {"--set", "fade-end=2", "--set", "fade-start=1"}}},
      {"--roughness", {{{"--roughness", "0.2"}}, {"--roughness", "0.2", "--aov", "ao,specular-occlusion"}}},
      {"--noise", {{with({"--noise", "animated"}, exact)}, with({"--noise", "animated"}, crytek)}},
      {"--seed", {{with({"--seed", "1"}, exact)}, {"--seed", "1"}}},
      {"--set ao-channels", {{{"--set", "ao-channels=rgb", "--aov", "depth"}}, {"--set", "ao-channels=rgb"}}},
      {"--set aov-space", {{{"--set", "aov-space=view"}}, {"--set", "aov-space=view", "--aov", "ao,normal"}}},
      {"--set multi-bounce",
       {{{"--set", "multi-bounce=true"}}, {"--set", "multi-bounce=true", "--composite", "c.exr"}}},
      {"--set ambient", {{{"--set", "ambient=GI"}}, {"--set", "ambient=GI", "--composite", "c.exr"}}},
      {"--set display",
       {{{"--set", "display=sRGB"}, {"--set", "display=sRGB", "--preview", "p.png"}},
        {"--set", "display=sRGB", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--set view-transform",
       {{{"--set", "view-transform=Raw"}},
        {"--set", "view-transform=Raw", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--set preview-style",
       {{{"--set", "preview-style=split"}},
        {"--set", "preview-style=split", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--set gain", {{{"--set", "gain=2"}}, {"--set", "gain=2", "--composite", "c.exr"}}},
      {"--set tint", {{{"--set", "tint=0.1,0,0"}}, {"--set", "tint=0.1,0,0", "--composite", "c.exr"}}},
      {"--set mix", {{{"--set", "mix=0.5"}}, {"--set", "mix=0.5", "--composite", "c.exr"}}},
      {"--set composite-layers",
       {{{"--set", "composite-layers=rgba"}}, {"--set", "composite-layers=rgba", "--composite", "c.exr"}}},
      {"--set composite-compression",
       {{{"--set", "composite-compression=dwaa"}}, {"--set", "composite-compression=dwaa", "--composite", "c.exr"}}},
      {"--set append-ao", {{{"--set", "append-ao=AO"}}, {"--set", "append-ao=AO", "--composite", "c.exr"}}},
      {"--chan-rotation",
       {{{"--chan-rotation", "xyz"}, {"--chan-rotation", "xyz", "--camera", "c.json"}},
        {"--chan-rotation", "xyz", "--camera", "c.chan"}}},
      {"--set ao-name", {{{"--set", "ao-name=AO", "--aov", "depth"}}, {"--set", "ao-name=AO"}}},
      {"--set filter",
       {{{"--set", "filter=box"}, {"--set", "filter=box", "--set", "supersampling=1", "--composite", "c.exr"}},
        {"--set", "filter=box", "--set", "supersampling=2"}}},
      {"--set filter-width", {{{"--set", "filter-width=2"}}, {"--set", "filter-width=2", "--composite", "c.exr"}}},
      {"--set fog-density", {{{"--set", "fog-density=1"}}, {"--set", "fog-density=1", "--composite", "c.exr"}}},
      {"--set ocio",
       {{{"--set", "ocio=a.ocio"}, {"--set", "ocio=a.ocio", "--preview", "p.png"}},
        {"--set", "ocio=a.ocio", "--preview", "p.png", "--composite", "c.exr"}}},
  };
  return cases;
}

/// A setting as key and value.
struct Value {
  std::string key, value;
};

/// Settings that say something else of the same thing, so that neither has an effect beside the other.
const std::vector<std::pair<Value, Value>>& pairs() {
  static const Value camera{"camera", "c.json"}, fov{"fov", "60"}, ortho{"ortho-width", "2"};
  static const Value position{"position", "p.exr"}, depth_channel{"depth-channel", "Z"};
  static const Value occluders{"occluders", "Hero"}, ignore{"ignore", "Set*"}, around{"around", "2"};
  static const Value views{"other-views", "true"}, tolerance{"tolerance", "0.1"}, quiet{"quiet", "true"};
  static const std::vector<std::pair<Value, Value>> all{{{"depth", "d.exr"}, position},
                                                        {depth_channel, position},
                                                        {depth_channel, {"position-channels", "P"}},
                                                        {camera, fov},
                                                        {camera, ortho},
                                                        {fov, ortho},
                                                        {tolerance, {"resolution", "half"}},
                                                        {tolerance, {"accumulate", "2"}},
                                                        {{"denoise-kernel", "1,0.5"}, {"denoise-radius", "3"}},
                                                        {quiet, {"verbose", "true"}},
                                                        {quiet, {"progress", "plain"}},
                                                        {occluders, ignore},
                                                        {occluders, around},
                                                        {occluders, views},
                                                        {ignore, around},
                                                        {ignore, views}};
  return all;
}

class Said : public testing::Test {
 protected:
  Said() { ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1); }

  static RunOptions read(Words words, Reader reader = Reader::run) {
    words.insert(words.begin(), {"in.exr", "-o", "ao.exr"});
    InspectOptions options;
    if (reader == Reader::run)
      parse_run_options(words, options.run);
    else
      parse_inspect_options(words, options);
    return options.run;
  }

  /// What is said where the words are refused, "" where they are taken.
  static std::string refusal(const Words& words, Reader reader = Reader::run) {
    try {
      read(words, reader);
      return "";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage) << error.what();
      return error.what();
    }
  }

  /// A preset of settings.
  Words preset(const std::string& name, const std::vector<Value>& said) const {
    std::string text;
    for (const auto& [key, value] : said) text += fmt::format("{} = \"{}\"\n", key, value);
    test::write_bytes(folder / name, text);
    return {"--preset", folder / name};
  }

  static Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// The words that the setting has in the end.
  static Words value_of(const std::string& key, RunOptions options) {
    return row_of_key(option_table(options), key).words();
  }

  static Words usual_value_of(const std::string& key) { return value_of(key, {}); }

  static Words typed(const Value& one) { return {"--set", one.key + "=" + one.value}; }

  const test::TemporaryFolder folder;
};

TEST_F(Said, settings_that_may_have_no_effect_are_those_of_the_cases) {
  RunOptions options;
  std::set<std::string> with_reason, with_case;
  for (const auto& row : option_table(options))
    if (row.why_without_effect) with_reason.insert(row.long_name());
  for (const auto& [option, cases] : cases_without_effect()) with_case.insert(option);
  for (const auto& [one, other] : pairs())
    for (const auto& value : {one, other}) {
      const auto table = option_table(options);
      with_case.insert(row_of_key(table, value.key).long_name());
    }
  EXPECT_EQ(with_reason, with_case) << "whoever says why a setting may have no effect shows both here";
}

TEST_F(Said, what_is_typed_and_has_no_effect_is_refused_and_else_taken) {
  for (const auto& [option, cases] : cases_without_effect()) {
    for (const auto& words : cases.refused)
      EXPECT_THAT(refusal(words), testing::StartsWith(option + " has no effect: ")) << testing::PrintToString(words);
    EXPECT_EQ(refusal(cases.taken), "") << testing::PrintToString(cases.taken);
  }
}

TEST_F(Said, a_refusal_says_what_the_setting_is_for_and_what_is_in_its_way) {
  EXPECT_THAT(refusal({"--samples", "8"}),
              HasSubstr("--samples has no effect: it is for --estimator crytek, and here that is gtao"));
  EXPECT_THAT(refusal({"--preset", "reference", "--steps", "8"}),
              HasSubstr("it is for --search steps, and here that is exact"));
  const std::pair<Words, const char*> cases[] = {{{"--depth-kind", "ray"}, "--depth-kind says ray"},
                                                 {{"--source", "octane"}, "--source octane says ray"},
                                                 {{"--position", "p.exr"}, "--position says position"},
                                                 {{"--position-channels", "P"}, "--position-channels says position"}};
  for (const auto& [words, said] : cases) EXPECT_THAT(refusal(joined({"--near", "1"}, words)), HasSubstr(said));
}

TEST_F(Said, what_has_no_effect_is_left_out_of_presets) {
  for (const auto& [option, cases] : cases_without_effect())
    for (const auto& refused : cases.refused) {
      const bool is_set = refused[0] == "--set";
      const bool is_flag = !is_set && (refused.size() < 2 || refused[1].starts_with("--"));
      const std::size_t equals = is_set ? refused[1].find('=') : 0;
      const Value value{is_set ? refused[1].substr(0, equals) : refused[0].substr(2),
                        is_set    ? refused[1].substr(equals + 1)
                        : is_flag ? "true"
                                  : refused[1]};
      const Words others(refused.begin() + (is_flag ? 1 : 2), refused.end());
      const Words all = joined(preset("some.toml", {value}), others);
      ASSERT_EQ(refusal(all), "") << testing::PrintToString(refused);
      EXPECT_EQ(value_of(value.key, read(all)), usual_value_of(value.key)) << testing::PrintToString(refused);
    }
}

TEST_F(Said, what_a_preset_says_without_effect_stays_where_another_one_gives_it_one) {
  const Words samples = preset("samples.toml", {{"samples", "8"}});
  EXPECT_EQ(read(joined(samples, {"--estimator", "crytek"})).settings.estimator.samples, 8);
  const Words crytek = preset("crytek.toml", {{"estimator", "crytek"}});
  EXPECT_EQ(read(joined(samples, crytek)).settings.estimator.samples, 8);
}

TEST_F(Said, of_a_pair_only_one_may_be_typed) {
  RunOptions options;
  const auto table = option_table(options);
  for (const auto& [one, other] : pairs())
    for (const auto& words : {joined(typed(one), typed(other)), joined(typed(other), typed(one))})
      EXPECT_THAT(refusal(words),
                  AllOf(HasSubstr(row_of_key(table, one.key).long_name()),
                        HasSubstr(row_of_key(table, other.key).long_name()), HasSubstr("only one of them")));
}

TEST_F(Said, noise_that_is_fixed_is_none_of_a_mean) {
  EXPECT_EQ(refusal({"--noise", "animated", "--accumulate", "4"}), "") << "they say the same";
  EXPECT_EQ(refusal({"--noise", "fixed", "--accumulate", "0"}), "");
  EXPECT_EQ(refusal({"--accumulate", "4"}), "") << "nobody has said that the noise is fixed, as it usually is";
  EXPECT_EQ(refusal({"--noise", "fixed", "--estimator", "crytek"}), "") << "it has none";
  EXPECT_THAT(refusal({"--noise", "fixed", "--accumulate", "4"}),
              HasSubstr("--noise has no effect: --accumulate is given, and it animates the noise"));
}

TEST_F(Said, of_a_pair_what_is_typed_beats_a_preset_and_a_later_preset_an_earlier_one) {
  for (const auto& pair : pairs())
    for (const auto& [first, second] : {pair, std::pair(pair.second, pair.first)}) {
      const Words one = preset("first.toml", {first});
      for (const auto& words : {joined(one, typed(second)), joined(one, preset("second.toml", {second}))}) {
        ASSERT_EQ(refusal(words), "") << first.key << " of a preset, " << second.key;
        EXPECT_EQ(value_of(first.key, read(words)), usual_value_of(first.key)) << second.key;
        EXPECT_NE(value_of(second.key, read(words)), usual_value_of(second.key)) << first.key;
      }
    }
}

TEST_F(Said, a_lens_is_said_in_one_way) {
  const Words lens{"--focal", "35", "--aperture", "36"};
  EXPECT_EQ(refusal(lens), "");
  for (const Words& other : std::vector<Words>{{"--camera", "c.json"}, {"--fov", "60"}, {"--ortho-width", "2"}})
    EXPECT_THAT(refusal(joined(lens, other)), AllOf(HasSubstr(other[0]), HasSubstr("only one of them"))) << other[0];
  for (const Value& other : std::vector<Value>{{"camera", "c.json"}, {"fov", "60"}, {"ortho-width", "2"}}) {
    const Words words = joined(preset("other.toml", {other}), lens);
    ASSERT_EQ(refusal(words), "") << other.key << " of a preset";
    EXPECT_EQ(value_of(other.key, read(words)), usual_value_of(other.key));
  }
}

TEST_F(Said, a_preset_may_not_contradict_itself) {
  for (const auto& [one, other] : pairs())
    EXPECT_THAT(refusal(preset("both.toml", {one, other})),
                AllOf(HasSubstr("both.toml"), HasSubstr(one.key), HasSubstr(other.key), HasSubstr("only one of them")));
}

TEST_F(Said, what_had_no_effect_beside_something_that_is_left_out_itself_is_taken) {
  const Words tolerance = preset("tolerance.toml", {{"tolerance", "0.05"}});
  const RunOptions options = read(joined({"--preset", "production"}, joined(tolerance, {"--resolution", "half"})));
  EXPECT_EQ(options.settings.estimator.tolerance, 0);
  EXPECT_EQ(options.settings.estimator.slices, read({"--preset", "production"}).settings.estimator.slices);
}

TEST_F(Said, values_that_ask_for_nothing_are_taken_anywhere) {
  for (const Words& words : std::vector<Words>{{"--tolerance", "0", "--estimator", "hbao", "--resolution", "half"},
                                               {"--set", "complete=none", "--estimator", "crytek"},
                                               {"--set", "fog-density=0"},
                                               {"--set", "hidden=0", "--set", "separation=auto", "--around", "0"},
                                               {"--set", "stride=1", "--search", "exact"},
                                               {"--search", "steps", "--estimator", "crytek"},
                                               {"--search", "steps", "--tolerance", "0"},
                                               {"--set", "multi-bounce=false"},
                                               {"--depth-kind", "auto", "--position", "p.exr"}})
    EXPECT_EQ(refusal(words), "") << testing::PrintToString(words);
}

TEST_F(Said, confidence_takes_what_its_own_estimates_take) {
  const Words with{"--aov", "ao,confidence", "--estimator", "crytek"};
  for (const Words& words :
       std::vector<Words>{{"--slices", "3"}, {"--steps", "3"}, {"--falloff", "linear"}, {"--set", "falloff-end=0.5"}})
    EXPECT_EQ(refusal(joined(words, with)), "") << testing::PrintToString(words);
  EXPECT_EQ(refusal({"--tolerance", "0.1", "--aov", "ao,confidence", "--denoise", "box", "--seed", "1"}), "");
  for (const Words& exact : std::vector<Words>{{"--search", "exact"}, {"--tolerance", "0.1"}})
    EXPECT_EQ(refusal(joined({"--set", "stride=4", "--aov", "ao,confidence"}, exact)), "") << exact.front();
}

// Where one density lets every pixel have its own estimate and the other does not, the choice is all the more one.
TEST_F(Said, a_density_is_taken_where_the_other_one_would_share_estimates) {
  for (const Words& words : std::vector<Words>{{"--slices", "3"}, {"--slices", "8"}, {"--estimator", "bitmask"}}) {
    const Words uniform = joined(words, {"--set", "density=uniform"});
    EXPECT_EQ(refusal(uniform), "") << testing::PrintToString(words);
    const Words by_preset = joined(words, preset("density.toml", {{"density", "uniform"}}));
    EXPECT_EQ(read(by_preset).settings.estimator.density, Density::uniform) << testing::PrintToString(words);
  }
  EXPECT_THAT(refusal({"--set", "density=uniform", "--resolution", "half"}), HasSubstr("every pixel has its own"));
}

// A frame without depth is read by its positions, whatever depth its program writes into others.
TEST_F(Said, the_space_of_positions_may_be_said_of_every_source) {
  for (const char* source : {"arnold", "corona", "pbrt"})
    EXPECT_EQ(refusal({"--source", source, "--set", "position-space=view"}), "") << source;
}

// Whether it applies shows only with the frame: then what a preset says is left out, and what is typed is refused.
TEST_F(Said, options_that_only_presets_say_are_known_as_such) {
  const Words far = preset("far.toml", {{"far", "100"}, {"near", "1"}});
  EXPECT_THAT(read(far).settings.input.from_presets, testing::UnorderedElementsAre("--near", "--far"));
  EXPECT_THAT(read(joined(far, {"--far", "9"})).settings.input.from_presets, ElementsAre("--near"));
}

TEST_F(Said, settings_are_set_by_key_and_value) {
  EXPECT_EQ(read({"--set", "stride=4", "--set", "Radius=0.5"}).settings.estimator.stride, 4);
  EXPECT_EQ(read({"--set", "radius=0.5"}).settings.estimator.radius, 0.5) << "of options too";
  EXPECT_TRUE(read({"--set", "warnings-as-errors"}).settings.frames.warnings_as_errors) << "as git -c takes it";
  EXPECT_THAT(refusal({"--set", "stride"}), HasSubstr("--set: stride is not KEY=VALUE: stride takes auto|1|2|4|8|16"));
  EXPECT_THAT(refusal({"--set", "strid=4"}), HasSubstr("there is no setting strid (did you mean stride"));
  EXPECT_THAT(refusal({"--set", "stride=3"}), HasSubstr("--set stride: 3 is none of"));
  EXPECT_THAT(refusal({"--set", "dry-run=true"}), HasSubstr("dry-run is an option of the command line only"));
  for (const Words& twice :
       std::vector<Words>{{"--set", "stride=4", "--set", "stride=2"}, {"--slices", "4", "--set", "slices=2"}})
    EXPECT_THAT(refusal(twice), HasSubstr("is given more than once")) << testing::PrintToString(twice);
}

TEST_F(Said, a_key_that_is_typed_as_an_option_says_what_to_type) {
  RunOptions options;
  int keys = 0;
  for (const auto& row : option_table(options)) {
    if (!row.is_only_key()) continue;
    const std::string value = row.is_flag() ? "true" : "1";
    const std::string said = fmt::format("--{} is a setting: write --set {}={}", row.name, row.name, value);
    EXPECT_THAT(refusal({"--" + row.name, "1"}), HasSubstr(said));
    EXPECT_THAT(refusal({"--" + row.name + "=1"}), HasSubstr(fmt::format("write --set {}=1", row.name)));
    keys++;
  }
  EXPECT_GT(keys, 50);
}

TEST_F(Said, what_farms_pass_always_is_taken_for_a_single_frame) {
  EXPECT_EQ(refusal({"--resume", "--set", "overwrite=true", "--keep-going", "--set", "missing=skip", "--chunk", "1/1",
                     "--frames", "1", "--threads", "4", "--memory", "4G", "--progress", "openjd"}),
            "");
}

TEST_F(Said, inspect_goes_by_the_same_rules_but_writes_no_outputs) {
  EXPECT_EQ(refusal({"--beauty", "b.exr", "--set", "albedo=0.5"}, Reader::inspect), "");
  EXPECT_THAT(refusal({"--near", "1", "--depth-kind", "planar"}, Reader::inspect), HasSubstr("--near has no effect"));
  EXPECT_THAT(refusal({"--fov", "60", "--camera", "c.json"}, Reader::inspect), HasSubstr("only one of them"));
  EXPECT_THAT(refusal({"--slices", "4", "--estimator", "crytek"}, Reader::inspect),
              HasSubstr("--slices has no effect"));
  EXPECT_EQ(refusal({"--roughness", "0.5", "--set", "preview-style=split"}, Reader::inspect), "");
}

TEST_F(Said, settings_that_nobody_typed_are_held_to_the_same_table) {
  const auto refused = [](const auto& change) {
    Settings settings = read({"--radius", "1"}).settings;
    change(settings);
    try {
      check_settings(settings);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](Settings&) {}), "");
  EXPECT_THAT(refused([](Settings& s) { s.estimator.samples = 8; }), HasSubstr("--samples has no effect"));
  EXPECT_THAT(refused([](Settings& s) { s.input.fov = 60, s.input.camera = "c.json"; }),
              AllOf(HasSubstr("--camera"), HasSubstr("--fov")));
}

TEST_F(Said, words_are_taken_in_any_case) {
  RunOptions options = read({"--estimator", "HBAO", "--depth-kind", "Planar", "--aov", "AO,Depth", "--flip-normal",
                             "XY", "--set", "stride=AUTO", "--preset", "Draft", "--set", "compression=ZIPS"});
  EXPECT_EQ(options.settings.estimator.estimator, Estimator::hbao);
  EXPECT_EQ(options.settings.output.aovs, "ao,depth");
  EXPECT_TRUE(options.settings.input.flip_normal.y);
  EXPECT_EQ(options.settings.output.compression, "zips");
  EXPECT_EQ(options.settings.estimator.steps, 8);
  EXPECT_THAT(refusal({"--estimator", "GTOA"}), HasSubstr("did you mean gtao"));
}

TEST_F(Said, lists_with_commas_are_what_repeated_options_are) {
  const auto radii = [](const Words& words) {
    const EstimatorSettings estimator = read(words).settings.estimator;
    Words all = value_of("radius", read(words));
    EXPECT_EQ(all.size(), 1 + estimator.further_radii.size());
    return all;
  };
  EXPECT_THAT(radii({"--radius", "0.1,0.5"}), ElementsAre("0.1", "0.5"));
  EXPECT_THAT(radii({"--radius", "0.1, 0.5", "--radius", "2"}), ElementsAre("0.1", "0.5", "2"));
  EXPECT_THAT(radii(preset("radii.toml", {{"radius", "0.1,0.5"}})), ElementsAre("0.1", "0.5"));
  EXPECT_THAT(refusal({"--radius", "0.1,,0.5"}), HasSubstr("--radius: \"\" is not a number"));
  EXPECT_EQ(read({"--preset", "draft,production"}).settings.estimator.slices, 5);
  EXPECT_EQ(read({"--preset", "production,draft"}).settings.estimator.steps, 8);
  const Words behind{"--behind", "a,b.exr", "--behind", "c.exr"};
  const InputSettings input = read(joined(behind, {"--behind-kind", "backs,Fronts"})).settings.input;
  EXPECT_THAT(input.behind, ElementsAre("a,b.exr", "c.exr", "", "", "", "", "", "")) << "a comma of a file's name";
  EXPECT_THAT(input.behind_kinds, ElementsAre(BehindKind::backs, BehindKind::fronts));
  EXPECT_THAT(
      read(joined(behind, {"--set", "behind-channel=A", "--set", "behind-channel=B"})).settings.input.behind_channels,
      ElementsAre("A", "B"));
  const Words commas = preset("a,b.toml", {{"slices", "7"}});
  EXPECT_EQ(read(commas).settings.estimator.slices, 7) << "a file with a comma in its name";
}

}  // namespace
}  // namespace alcove
