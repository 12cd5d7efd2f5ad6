// What presets and the command line say to settings: options that do not apply, and options that contradict each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/said.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "cli/options.h"
#include "core/base/error.h"
#include "core/options/check.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Words to be typed; a first one is the option that the case is about.
struct ConditionCase {
  std::vector<Words> refused;  // for each condition of the row one that breaks it
  Words taken;
};

/// A case for every row of the table that has a condition.
const std::map<std::string, ConditionCase>& condition_cases() {
  static const Words exact{"--search", "exact"}, by_error{"--tolerance", "0.1"}, crytek{"--estimator", "crytek"};
  static const auto with = [](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  static const std::map<std::string, ConditionCase> cases{
      {"--beauty", {{{"--beauty", "b.exr"}}, {"--beauty", "b.exr", "--composite", "c.exr"}}},
      {"--albedo", {{{"--albedo", "0.5"}}, {"--albedo", "0.5", "--multi-bounce", "--ao-channels", "rgb"}}},
      {"--beauty-channels", {{{"--beauty-channels", "b"}}, {"--beauty-channels", "b", "--composite", "c.exr"}}},
      {"--albedo-channels",
       {{{"--albedo-channels", "d"},
         {"--albedo-channels", "d", "--albedo", "0.5", "--multi-bounce", "--ao-channels", "rgb"}},
        {"--albedo-channels", "d", "--multi-bounce", "--ao-channels", "rgb"}}},
      {"--depth-kind",
       {{{"--depth-kind", "planar", "--position", "p.exr"}}, {"--depth-kind", "position", "--position", "p.exr"}}},
      {"--depth-channel", {{{"--depth-channel", "Z", "--depth-kind", "position"}}, {"--depth-channel", "Z"}}},
      {"--near",
       {{{"--near", "1", "--depth-kind", "planar"}, {"--near", "1", "--source", "octane"}},
        {"--near", "1", "--source", "octane", "--camera", "says.json"}}},
      {"--far", {{{"--far", "9", "--position-channels", "P"}}, {"--far", "9"}}},
      {"--reversed-z", {{{"--reversed-z", "--depth-kind", "ray"}}, {"--reversed-z", "--depth-kind", "log"}}},
      {"--device-range",
       {{{"--device-range", "-1..1", "--depth-kind", "log"}}, {"--device-range", "-1..1", "--depth-kind", "device"}}},
      {"--log-constant",
       {{{"--log-constant", "2", "--depth-kind", "device"}}, {"--log-constant", "2", "--depth-kind", "auto"}}},
      {"--position-space",
       {{{"--position-space", "view", "--depth-kind", "planar"}}, {"--position-space", "view", "--position", "p.exr"}}},
      {"--focal", {{{"--focal", "35"}}, {"--focal", "35", "--aperture", "36"}}},
      {"--normal-channels", {{{"--normal-channels", "N", "--normal", "none"}}, {"--normal-channels", "N"}}},
      {"--normal-space", {{{"--normal-space", "view", "--normal", "none"}}, {"--normal-space", "view"}}},
      {"--normal-encoding", {{{"--normal-encoding", "unorm", "--normal", "None"}}, {"--normal-encoding", "unorm"}}},
      {"--flip-normal", {{{"--flip-normal", "y", "--normal", "none"}}, {"--flip-normal", "y", "--normal", "n.exr"}}},
      {"--aperture", {{{"--aperture", "36"}}, {"--aperture", "36", "--focal", "35"}}},
      {"--behind", {{with({"--behind", "a.exr"}, crytek)}, {"--behind", "a.exr"}}},
      {"--other-views", {{with({"--other-views"}, crytek)}, {"--other-views"}}},
      {"--around", {{with({"--around", "2"}, crytek)}, {"--around", "2"}}},
      {"--behind-channel",
       {{{"--behind-channel", "Z"}, {"--behind-channel", "A,B", "--behind", "a.exr"}},
        {"--behind-channel", "A,B", "--behind", "a.exr", "--behind", "b.exr"}}},
      {"--behind-kind",
       {{{"--behind-kind", "backs"},
         {"--behind-kind", "backs,fronts", "--behind", "a.exr", "--behind", "b.exr", "--behind", "c.exr"}},
        {"--behind-kind", "backs", "--behind", "a.exr", "--behind", "b.exr"}}},
      {"--deep-opacity", {{{"--deep-opacity", "0.2"}}, {"--deep-opacity", "0.2", "--deep", "d.exr"}}},
      {"--matte-outside", {{{"--matte-outside", "0.5"}}, {"--matte-outside", "0.5", "--matte-object", "Hero"}}},
      {"--objects", {{{"--objects", "o.exr", "--ignore", "a.exr"}}, {"--objects", "o.exr", "--ignore", "Hero"}}},
      {"--object-channel", {{{"--object-channel", "Id"}}, {"--object-channel", "Id", "--occluders", "3"}}},
      {"--motion",
       {{{"--motion", "m.exr"}, {"--motion", "m.exr", "--around", "0"}}, {"--motion", "m.exr", "--around", "2"}}},
      {"--motion-channels",
       {{{"--motion-channels", "U,V", "--around", "all"}},
        {"--motion-channels", "U,V", "--motion", "v.exr", "--around", "all"}}},
      {"--motion-kind",
       {{{"--motion-kind", "next", "--around", "2"}}, {"--motion-kind", "next", "--motion", "v.exr", "--around", "2"}}},
      {"--hidden", {{{"--hidden", "1"}}, {"--hidden", "1", "--other-views"}}},
      {"--separation", {{{"--separation", "0.1"}}, {"--separation", "0.1", "--deep", "d.exr"}}},
      {"--falloff",
       {{with({"--falloff", "linear"}, crytek), with({"--falloff", "linear"}, exact)}, {"--falloff", "linear"}}},
      {"--falloff-start",
       {{with({"--falloff-start", "0.2"}, crytek), with({"--falloff-start", "0.2"}, exact), {"--falloff-start", "0.2"}},
        {"--falloff-start", "0.2", "--falloff", "smooth"}}},
      {"--falloff-end", {{with({"--falloff-end", "0.5"}, crytek)}, with({"--falloff-end", "0.5"}, exact)}},
      {"--slices",
       {{with({"--slices", "3"}, crytek), with({"--slices", "3"}, by_error)}, with({"--slices", "3"}, exact)}},
      {"--steps",
       {{with({"--steps", "3"}, crytek), with({"--steps", "3"}, exact)}, {"--steps", "3", "--estimator", "hbao"}}},
      {"--search",
       {{with({"--search", "exact"}, crytek), with({"--search", "steps"}, by_error)}, {"--search", "every-pixel"}}},
      {"--tolerance", {{{"--tolerance", "0.1", "--estimator", "bitmask"}}, {"--tolerance", "0.1"}}},
      {"--samples", {{{"--samples", "8"}}, with({"--samples", "8"}, crytek)}},
      {"--elevation", {{with({"--elevation", "surface"}, crytek)}, {"--elevation", "surface", "--estimator", "hbao"}}},
      {"--sample-kernel", {{{"--sample-kernel", "uniform"}}, with({"--sample-kernel", "uniform"}, crytek)}},
      {"--range-check", {{{"--range-check", "none"}}, with({"--range-check", "none"}, crytek)}},
      {"--thickness", {{with({"--thickness", "1"}, crytek)}, {"--thickness", "1", "--estimator", "bitmask"}}},
      {"--complete", {{{"--complete", "border", "--estimator", "hbao"}}, {"--complete", "border"}}},
      {"--density",
       {{with({"--density", "uniform"}, crytek),
         with({"--density", "uniform"}, exact),
         {"--density", "uniform", "--denoise", "none"}},
        {"--density", "uniform", "--stride", "4"}}},
      {"--stride",
       {{with({"--stride", "4"}, exact), {"--stride", "4", "--denoise", "box"}},
        {"--stride", "4", "--denoise", "bilateral"}}},
      {"--denoise", {{with({"--denoise", "box"}, by_error)}, with({"--denoise", "bilateral"}, exact)}},
      {"--denoise-radius",
       {{{"--denoise-radius", "3", "--denoise", "box"}, with({"--denoise-radius", "3"}, by_error)},
        {"--denoise-radius", "3"}}},
      {"--denoise-kernel",
       {{{"--denoise-kernel", "1,0.5", "--denoise", "none"}, with({"--denoise-kernel", "1,0.5"}, by_error)},
        {"--denoise-kernel", "1,0.5"}}},
      {"--denoise-depth-sigma",
       {{{"--denoise-depth-sigma", "0.1", "--denoise", "none"}, with({"--denoise-depth-sigma", "0.1"}, by_error)},
        {"--denoise-depth-sigma", "0.1", "--denoise", "box"}}},
      {"--fade-start", {{{"--fade-start", "1"}}, {"--fade-start", "1", "--fade-end", "2"}}},
      {"--fade-end", {{{"--fade-end", "2"}}, {"--fade-end", "2", "--fade-start", "1"}}},
      {"--roughness", {{{"--roughness", "0.2"}}, {"--roughness", "0.2", "--aov", "ao,specular-occlusion"}}},
      {"--noise", {{with({"--noise", "animated"}, exact)}, with({"--noise", "animated"}, crytek)}},
      {"--seed", {{with({"--seed", "1"}, exact)}, {"--seed", "1"}}},
      {"--ao-channels", {{{"--ao-channels", "rgb", "--aov", "depth"}}, {"--ao-channels", "rgb"}}},
      {"--aov-space", {{{"--aov-space", "view"}}, {"--aov-space", "view", "--aov", "ao,normal"}}},
      {"--multi-bounce", {{{"--multi-bounce"}}, {"--multi-bounce", "--composite", "c.exr"}}},
      {"--ambient", {{{"--ambient", "GI"}}, {"--ambient", "GI", "--composite", "c.exr"}}},
      {"--display",
       {{{"--display", "sRGB"}, {"--display", "sRGB", "--preview", "p.png"}},
        {"--display", "sRGB", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--view-transform",
       {{{"--view-transform", "Raw"}}, {"--view-transform", "Raw", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--preview-style",
       {{{"--preview-style", "split"}}, {"--preview-style", "split", "--preview", "p.png", "--composite", "c.exr"}}},
      {"--gain", {{{"--gain", "2"}}, {"--gain", "2", "--composite", "c.exr"}}},
      {"--tint", {{{"--tint", "0.1,0,0"}}, {"--tint", "0.1,0,0", "--composite", "c.exr"}}},
      {"--mix", {{{"--mix", "0.5"}}, {"--mix", "0.5", "--composite", "c.exr"}}},
      {"--composite-layers",
       {{{"--composite-layers", "rgba"}}, {"--composite-layers", "rgba", "--composite", "c.exr"}}},
      {"--composite-compression",
       {{{"--composite-compression", "dwaa"}}, {"--composite-compression", "dwaa", "--composite", "c.exr"}}},
      {"--append-ao", {{{"--append-ao", "AO"}}, {"--append-ao", "AO", "--composite", "c.exr"}}},
      {"--chan-rotation",
       {{{"--chan-rotation", "xyz"}, {"--chan-rotation", "xyz", "--camera", "c.json"}},
        {"--chan-rotation", "xyz", "--camera", "c.chan"}}},
      {"--ao-name", {{{"--ao-name", "AO", "--aov", "depth"}}, {"--ao-name", "AO"}}},
      {"--filter",
       {{{"--filter", "box"}, {"--filter", "box", "--supersampling", "1", "--composite", "c.exr"}},
        {"--filter", "box", "--supersampling", "2"}}},
      {"--filter-width", {{{"--filter-width", "2"}}, {"--filter-width", "2", "--composite", "c.exr"}}},
      {"--fog-density", {{{"--fog-density", "1"}}, {"--fog-density", "1", "--composite", "c.exr"}}},
      {"--ocio",
       {{{"--ocio", "a.ocio"}, {"--ocio", "a.ocio", "--preview", "p.png"}},
        {"--ocio", "a.ocio", "--preview", "p.png", "--composite", "c.exr"}}},
  };
  return cases;
}

/// A value of each option that is half of a contradiction.
const std::map<std::string, Words>& contradicting_values() {
  static const std::map<std::string, Words> values{
      {"--depth", {"d.exr"}},      {"--position", {"p.exr"}},
      {"--depth-channel", {"Z"}},  {"--position-channels", {"P"}},
      {"--camera", {"c.json"}},    {"--fov", {"60"}},
      {"--focal", {"35"}},         {"--aperture", {"36"}},
      {"--ortho-width", {"2"}},    {"--tolerance", {"0.1"}},
      {"--resolution", {"half"}},  {"--denoise-kernel", {"1,0.5"}},
      {"--denoise-radius", {"3"}}, {"--quiet", {"true"}},
      {"--verbose", {"true"}},     {"--progress", {"plain"}},
      {"--occluders", {"Hero"}},   {"--ignore", {"Set*"}},
      {"--around", {"2"}},         {"--accumulate", {"2"}},
      {"--other-views", {"true"}}, {"--noise", {"fixed"}},
  };
  return values;
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

  /// A preset of options and their values.
  Words preset(const std::string& name, const std::vector<std::pair<std::string, Words>>& said) const {
    std::string text;
    for (const auto& [option, words] : said) text += fmt::format("{} = \"{}\"\n", option.substr(2), words.front());
    test::write_bytes(folder / name, text);
    return {"--preset", folder / name};
  }

  static Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// The words that the option has in the end.
  static Words value_of(const std::string& option, RunOptions options) {
    const auto table = option_table(options);
    return std::ranges::find(table, option, &OptionRow::long_name)->words();
  }

  static Words usual_value_of(const std::string& option) { return value_of(option, {}); }

  /// Calls it with both options of every pair of the table that contradicts itself, and in both orders.
  template <class Call>
  static void for_each_contradiction(const Call& call) {
    RunOptions options;
    int pairs = 0;
    for (const auto& row : option_table(options))
      for (const auto& contradiction : row.contradictions)
        for (const auto& other : contradiction.options) {
          call(row.long_name(), other);
          call(other, row.long_name());
          pairs++;
        }
    EXPECT_GT(pairs, 10);
  }

  static Words typed(const std::string& option) {
    return {fmt::format("{}={}", option, contradicting_values().at(option).front())};
  }

  const test::TemporaryFolder folder;
};

TEST_F(Said, options_with_a_condition_are_those_of_the_cases) {
  RunOptions options;
  std::set<std::string> with_condition, with_case;
  for (const auto& row : option_table(options))
    if (!row.conditions.empty()) with_condition.insert(row.long_name());
  for (const auto& [option, cases] : condition_cases()) with_case.insert(option);
  EXPECT_EQ(with_condition, with_case) << "whoever adds a condition says when it is broken and when it holds";
}

TEST_F(Said, options_that_do_not_apply_are_refused_for_every_condition_and_else_taken) {
  RunOptions options;
  for (const auto& row : option_table(options)) {
    if (row.conditions.empty()) continue;
    const auto& [refused, taken] = condition_cases().at(row.long_name());
    std::string all;
    for (const auto& words : refused) {
      const std::string text = refusal(words);
      EXPECT_THAT(text,
                  AllOf(testing::StartsWith(row.long_name() + ": applies "), HasSubstr(" only"), HasSubstr(", and ")))
          << testing::PrintToString(words);
      all += text;
    }
    for (const auto& condition : row.conditions) EXPECT_THAT(all, HasSubstr(condition.words)) << row.name;
    EXPECT_EQ(refusal(taken), "") << testing::PrintToString(taken);
  }
}

TEST_F(Said, a_refusal_says_to_what_the_option_applies_and_what_is_so_instead) {
  EXPECT_THAT(refusal({"--samples", "8"}),
              HasSubstr("--samples: applies to --estimator crytek only, and the estimator is gtao"));
  EXPECT_THAT(refusal({"--preset", "reference", "--steps", "8"}), HasSubstr("and the search is exact"));
  const std::pair<Words, const char*> cases[] = {
      {{"--depth-kind", "ray"}, "the depth is said to be ray (--depth-kind)"},
      {{"--source", "octane"}, "the depth is said to be ray (--source octane)"},
      {{"--position", "p.exr"}, "the depth is said to be position (--position)"},
      {{"--position-channels", "P"}, "the depth is said to be position (--position-channels)"}};
  for (const auto& [words, said] : cases) EXPECT_THAT(refusal(joined({"--near", "1"}, words)), HasSubstr(said));
}

TEST_F(Said, options_that_do_not_apply_are_left_out_of_presets) {
  for (const auto& [option, cases] : condition_cases())
    for (const auto& refused : cases.refused) {
      const bool is_flag = refused.size() < 2 || refused[1].starts_with("--");
      const Words value = is_flag ? Words{"true"} : Words{refused[1]};
      const Words others(refused.begin() + (is_flag ? 1 : 2), refused.end());
      const Words all = joined(preset("some.toml", {{option, value}}), others);
      ASSERT_EQ(refusal(all), "") << testing::PrintToString(refused);
      EXPECT_EQ(value_of(option, read(all)), usual_value_of(option)) << testing::PrintToString(refused);
    }
}

TEST_F(Said, what_a_preset_says_without_effect_stays_where_another_one_gives_it_one) {
  const Words samples = preset("samples.toml", {{"--samples", {"8"}}});
  EXPECT_EQ(read(joined(samples, {"--estimator", "crytek"})).settings.estimator.samples, 8);
  const Words crytek = preset("crytek.toml", {{"--estimator", {"crytek"}}});
  EXPECT_EQ(read(joined(samples, crytek)).settings.estimator.samples, 8);
}

TEST_F(Said, options_that_contradict_each_other_are_refused_in_both_orders) {
  for_each_contradiction([](const std::string& one, const std::string& other) {
    EXPECT_THAT(refusal(joined(typed(one), typed(other))),
                AllOf(HasSubstr(one), HasSubstr(other), HasSubstr("contradict each other"), HasSubstr("only one")));
  });
}

TEST_F(Said, a_pair_contradicts_each_other_by_the_values_that_do) {
  EXPECT_EQ(refusal({"--noise", "animated", "--accumulate", "4"}), "") << "they say the same";
  EXPECT_EQ(refusal({"--noise", "fixed", "--accumulate", "0"}), "");
  EXPECT_EQ(refusal({"--accumulate", "4"}), "") << "nobody has said that the noise is fixed, as it usually is";
  EXPECT_EQ(refusal({"--noise", "fixed", "--estimator", "crytek"}), "") << "it has none";
  EXPECT_THAT(refusal({"--noise", "fixed", "--accumulate", "4"}),
              HasSubstr("--noise and --accumulate contradict each other"));
}

TEST_F(Said, what_is_typed_beats_what_contradicts_it_in_a_preset) {
  for_each_contradiction([&](const std::string& one, const std::string& other) {
    const Words all = joined(preset("one.toml", {{one, contradicting_values().at(one)}}), typed(other));
    // Half of a pair that belongs together is refused for that, and not for the preset.
    if (other == "--focal" || other == "--aperture") return;
    ASSERT_EQ(refusal(all), "") << one << " of a preset, " << other;
    EXPECT_EQ(value_of(one, read(all)), usual_value_of(one)) << other;
  });
}

TEST_F(Said, of_two_presets_that_contradict_each_other_the_later_wins_and_one_may_not_contradict_itself) {
  for_each_contradiction([&](const std::string& one, const std::string& other) {
    const std::pair<std::string, Words> first{one, contradicting_values().at(one)};
    const std::pair<std::string, Words> second{other, contradicting_values().at(other)};
    const RunOptions options = read(joined(preset("first.toml", {first}), preset("second.toml", {second})));
    EXPECT_EQ(value_of(one, options), usual_value_of(one)) << other;
    EXPECT_THAT(refusal(preset("both.toml", {first, second})),
                AllOf(HasSubstr("both.toml"), HasSubstr(one), HasSubstr(other)));
  });
}

TEST_F(Said, values_that_ask_for_nothing_are_taken_anywhere) {
  for (const Words& words : std::vector<Words>{{"--tolerance", "0", "--estimator", "hbao", "--resolution", "half"},
                                               {"--complete", "none", "--estimator", "crytek"},
                                               {"--fog-density", "0"},
                                               {"--hidden", "0", "--separation", "auto", "--around", "0"},
                                               {"--stride", "1", "--search", "exact"},
                                               {"--search", "steps", "--estimator", "crytek"},
                                               {"--search", "steps", "--tolerance", "0"},
                                               {"--multi-bounce=false"},
                                               {"--depth-kind", "auto", "--position", "p.exr"}})
    EXPECT_EQ(refusal(words), "") << testing::PrintToString(words);
}

TEST_F(Said, confidence_takes_what_its_own_estimates_take) {
  const Words with{"--aov", "ao,confidence", "--estimator", "crytek"};
  for (const Words& words :
       std::vector<Words>{{"--slices", "3"}, {"--steps", "3"}, {"--falloff", "linear"}, {"--falloff-end", "0.5"}})
    EXPECT_EQ(refusal(joined(words, with)), "") << testing::PrintToString(words);
  EXPECT_EQ(refusal({"--tolerance", "0.1", "--aov", "ao,confidence", "--denoise", "box", "--seed", "1"}), "");
  for (const Words& exact : std::vector<Words>{{"--search", "exact"}, {"--tolerance", "0.1"}})
    EXPECT_EQ(refusal(joined({"--stride", "4", "--aov", "ao,confidence"}, exact)), "") << exact.front();
}

// Where one density lets every pixel have its own estimate and the other does not, the choice is all the more one.
TEST_F(Said, a_density_is_taken_where_the_other_one_would_share_estimates) {
  for (const Words& words : std::vector<Words>{{"--slices", "3"}, {"--slices", "8"}, {"--estimator", "bitmask"}}) {
    const Words uniform = joined(words, {"--density", "uniform"});
    EXPECT_EQ(refusal(uniform), "") << testing::PrintToString(words);
    const Words by_preset = joined(words, preset("density.toml", {{"--density", {"uniform"}}}));
    EXPECT_EQ(read(by_preset).settings.estimator.density, Density::uniform) << testing::PrintToString(words);
  }
  EXPECT_THAT(refusal({"--density", "uniform", "--resolution", "half"}), HasSubstr("every pixel has its own"));
}

// A frame without depth is read by its positions, whatever depth its program writes into others.
TEST_F(Said, the_space_of_positions_may_be_said_of_every_source) {
  for (const char* source : {"arnold", "corona", "pbrt"})
    EXPECT_EQ(refusal({"--source", source, "--position-space", "view"}), "") << source;
}

// Whether it applies shows only with the frame: then what a preset says is left out, and what is typed is refused.
TEST_F(Said, options_that_only_presets_say_are_known_as_such) {
  const Words far = preset("far.toml", {{"--far", {"100"}}, {"--near", {"1"}}});
  EXPECT_THAT(read(far).settings.input.from_presets, testing::UnorderedElementsAre("--near", "--far"));
  EXPECT_THAT(read(joined(far, {"--far", "9"})).settings.input.from_presets, ElementsAre("--near"));
}

// What --aov confidence does not make good is told apart from what it does.
TEST_F(Said, help_says_which_of_the_conditions_confidence_makes_good) {
  RunOptions options;
  const auto table = option_table(options);
  const auto sentence = [&](const char* option) {
    return std::ranges::find(table, option, &OptionRow::long_name)->whole_sentence();
  };
  EXPECT_THAT(sentence("--falloff-start"),
              testing::EndsWith("; applies to --estimator gtao, bitmask or hbao and to --search steps only, or with "
                                "--aov confidence; applies with a --falloff only"));
  EXPECT_THAT(sentence("--samples"), testing::EndsWith("hemisphere; applies to --estimator crytek only"));
  EXPECT_THAT(refusal({"--falloff-start", "0.2", "--aov", "ao,confidence"}), HasSubstr("the falloff is none"));
}

TEST_F(Said, what_farms_pass_always_is_taken_for_a_single_frame) {
  EXPECT_EQ(refusal({"--resume", "--overwrite", "--keep-going", "--missing", "skip", "--chunk", "1/1", "--frames", "1",
                     "--threads", "4", "--memory", "4G", "--progress", "openjd"}),
            "");
}

TEST_F(Said, inspect_goes_by_the_same_rules_but_writes_no_outputs) {
  EXPECT_EQ(refusal({"--beauty", "b.exr", "--albedo", "0.5"}, Reader::inspect), "");
  EXPECT_THAT(refusal({"--near", "1", "--depth-kind", "planar"}, Reader::inspect), HasSubstr("--near: applies"));
  EXPECT_THAT(refusal({"--fov", "60", "--camera", "c.json"}, Reader::inspect), HasSubstr("contradict"));
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
  EXPECT_THAT(refused([](Settings& s) { s.estimator.samples = 8; }), HasSubstr("--samples: applies"));
  EXPECT_THAT(refused([](Settings& s) { s.input.fov = 60, s.input.camera = "c.json"; }),
              AllOf(HasSubstr("--camera"), HasSubstr("--fov")));
}

TEST_F(Said, words_are_taken_in_any_case) {
  RunOptions options = read({"--estimator", "HBAO", "--depth-kind", "Planar", "--aov", "AO,Depth", "--flip-normal",
                             "XY", "--stride", "AUTO", "--preset", "Draft", "--compression", "ZIPS"});
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
    Words all = value_of("--radius", read(words));
    EXPECT_EQ(all.size(), 1 + estimator.further_radii.size());
    return all;
  };
  EXPECT_THAT(radii({"--radius", "0.1,0.5"}), ElementsAre("0.1", "0.5"));
  EXPECT_THAT(radii({"--radius", "0.1, 0.5", "--radius", "2"}), ElementsAre("0.1", "0.5", "2"));
  EXPECT_THAT(radii(preset("radii.toml", {{"--radius", {"0.1,0.5"}}})), ElementsAre("0.1", "0.5"));
  EXPECT_THAT(refusal({"--radius", "0.1,,0.5"}), HasSubstr("--radius: \"\" is not a number"));
  EXPECT_EQ(read({"--preset", "draft,production"}).settings.estimator.slices, 5);
  EXPECT_EQ(read({"--preset", "production,draft"}).settings.estimator.steps, 8);
  const Words behind{"--behind", "a,b.exr", "--behind", "c.exr"};
  const InputSettings input = read(joined(behind, {"--behind-kind", "backs,Fronts"})).settings.input;
  EXPECT_THAT(input.behind, ElementsAre("a,b.exr", "c.exr", "", "", "", "", "", "")) << "a comma of a file's name";
  EXPECT_THAT(input.behind_kinds, ElementsAre(BehindKind::backs, BehindKind::fronts));
  EXPECT_THAT(read(joined(behind, {"--behind-channel", "A", "--behind-channel", "B"})).settings.input.behind_channels,
              ElementsAre("A", "B"));
  const Words commas = preset("a,b.toml", {{"--slices", {"7"}}});
  EXPECT_EQ(read(commas).settings.estimator.slices, 7) << "a file with a comma in its name";
}

}  // namespace
}  // namespace alcove
