// What presets and the command line say to settings: what has no effect, alone or beside another one.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/options.h"

#include "cli/options.h"
#include "core/base/error.h"
#include "tests/support/program.h"

namespace alcove::said_test {
namespace {

using namespace test;

/// A setting that may have no effect.
struct Case {
  std::string setting;               // as it is typed
  std::vector<std::string> refused;  // for each reason of the row, what is typed beside it where the reason holds
  std::string taken;                 // what is typed beside it where it has an effect

  bool is_key() const { return setting.starts_with("--set "); }
  std::string option() const { return setting.substr(0, setting.find(is_key() ? '=' : ' ')); }
};

/// A case or two for every setting that may have no effect, but for those of pairs().
const std::vector<Case>& cases_without_effect() {
  static const std::string exact = "--search exact", by_error = "--tolerance 0.1", crytek = "--estimator crytek",
                           composite = "--composite c.exr", none = "--normal none",
                           bounces = "--set multi-bounce=true --set ao-channels=rgb", behind = "--behind a.exr",
                           two_behind = "--behind a.exr --behind b.exr", position = "--depth-kind position",
                           shown = "--preview p.png --composite c.exr", box = "--denoise box",
                           unfiltered = "--denoise none";
  static const std::vector<Case> cases{
      {"--beauty b.exr", {""}, composite},
      {"--set albedo=0.5", {""}, bounces},
      {"--set beauty-channels=b", {""}, composite},
      {"--set albedo-channels=d", {"", "--set albedo=0.5 " + bounces}, bounces},
      {"--depth-kind planar", {"--position p.exr"}, ""},
      {"--depth-channel Z", {position}, ""},
      {"--set ramps=cut", {position}, ""},
      {"--near 1", {"--depth-kind planar", "--source octane"}, "--source octane --camera says.json"},
      {"--far 9", {"--set position-channels=P"}, ""},
      {"--reversed-z", {"--depth-kind ray"}, "--depth-kind log"},
      {"--set device-range=-1..1", {"--depth-kind log"}, "--depth-kind device"},
      {"--set log-constant=2", {"--depth-kind device"}, "--depth-kind auto"},
      {"--set disparity-scale=2", {"--depth-kind inverse"}, "--depth-kind disparity"},
      {"--set disparity-shift=2", {"--depth-kind ray"}, "--depth-kind disparity"},
      {"--set position-space=view", {"--depth-kind planar"}, "--position p.exr"},
      {"--focal 35", {""}, "--aperture 36"},
      {"--aperture 36", {""}, "--focal 35"},
      {"--normal-channels N", {none}, ""},
      {"--normal-space view", {none}, ""},
      {"--normal-encoding unorm", {"--normal None"}, ""},
      {"--flip-normal y", {none}, "--normal n.exr"},
      {"--behind a.exr", {crytek}, crytek + " --lights l.json"},
      {"--set other-views=true", {crytek}, crytek + " --lights l.json"},
      {"--around 2", {crytek}, crytek + " --lights l.json"},
      {"--set behind-channel=A,B", {"", behind}, two_behind},
      {"--behind-kind backs", {""}, two_behind},
      {"--behind-kind backs,fronts", {two_behind + " --behind c.exr"}, two_behind},
      {"--set deep-opacity=0.2", {""}, "--deep d.exr"},
      {"--matte-outside 0.5", {""}, "--matte-object Hero"},
      {"--set objects=o.exr", {"--set ignore=a.exr"}, "--set ignore=Hero"},
      {"--set object-channel=Id", {""}, "--set occluders=3"},
      {"--motion m.exr", {"", "--around 0"}, "--around 2"},
      {"--set motion-channels=U,V", {"--around all"}, "--motion v.exr --around all"},
      {"--set motion-kind=next", {"--around 2"}, "--motion v.exr --around 2"},
      {"--set hidden=1", {""}, "--set other-views=true"},
      {"--set separation=0.1", {""}, "--deep d.exr"},
      {"--falloff linear", {crytek, exact}, ""},
      {"--set falloff-start=0.2", {crytek, exact, ""}, "--falloff smooth"},
      {"--set falloff-end=0.5", {crytek}, exact},
      {"--slices 3", {crytek, by_error}, exact},
      {"--steps 3", {crytek, exact}, "--estimator hbao"},
      {"--search exact", {crytek}, ""},
      {"--search steps", {by_error}, ""},
      {"--tolerance 0.1", {"--estimator bitmask"}, ""},
      {"--samples 8", {""}, crytek},
      {"--set shadow-reach=2", {""}, "--lights l.json"},
      {"--set sun-azimuth=90", {""}, "--lights l.json"},
      {"--set sun-elevation=9", {""}, "--lights l.json"},
      {"--set sun=key", {"", "--lights l.json"}, "--lights l.json --set sun-azimuth=90"},
      {"--set shadow-layers=key:Key", {composite, "--lights l.json"}, "--lights l.json " + composite},
      {"--set elevation=surface", {crytek}, "--estimator hbao"},
      {"--set sample-kernel=uniform", {""}, crytek},
      {"--set range-check=none", {""}, crytek},
      {"--thickness 1", {crytek}, "--estimator bitmask"},
      {"--set complete=border", {"--estimator hbao"}, ""},
      {"--set density=uniform", {crytek, exact, unfiltered}, "--set stride=4"},
      {"--set stride=4", {exact, box}, "--denoise bilateral"},
      {"--denoise box", {by_error}, exact},
      {"--set denoise-radius=3", {box, by_error}, ""},
      {"--set denoise-kernel=1,0.5", {unfiltered, by_error}, ""},
      {"--set denoise-depth-sigma=0.1", {unfiltered, by_error}, box},
      {"--set fade-start=1", {""}, "--set fade-end=2"},
      {"--set fade-end=2", {""}, "--set fade-start=1"},
      {"--roughness 0.2", {""}, "--aov ao,specular-occlusion"},
      {"--noise animated", {exact}, crytek},
      {"--seed 1", {exact}, ""},
      {"--set ao-channels=rgb", {"--aov depth"}, ""},
      {"--set aov-space=view", {""}, "--aov ao,normal"},
      {"--set multi-bounce=true", {""}, composite},
      {"--set ambient=GI", {""}, composite},
      {"--set display=sRGB", {"", "--preview p.png"}, shown},
      {"--set view-transform=Raw", {""}, shown},
      {"--set preview-style=split", {""}, shown},
      {"--set gain=2", {""}, composite},
      {"--set tint=0.1,0,0", {""}, composite},
      {"--set mix=0.5", {""}, composite},
      {"--set composite-layers=rgba", {""}, composite},
      {"--set composite-compression=dwaa", {""}, composite},
      {"--set append-ao=AO", {""}, composite},
      {"--chan-rotation xyz", {"", "--camera c.json"}, "--camera c.chan"},
      {"--set ao-name=AO", {"--aov depth"}, ""},
      {"--set filter=box", {"", "--set supersampling=1 " + composite}, "--set supersampling=2"},
      {"--set filter-width=2", {"", composite}, "--set supersampling=2"},
      {"--set fog-density=1", {""}, composite},
      {"--set ocio=a.ocio", {"", "--preview p.png"}, shown},
  };
  return cases;
}

/// A setting as key and value.
struct Value {
  std::string key, value;
};

/// Settings that say something else of the same thing, so that neither has an effect beside the other.
const std::vector<std::pair<Value, Value>>& pairs() {
  static const Value camera{"camera", "c.json"}, fov{"fov", "60"}, ortho{"ortho-width", "2"},
      tall{"vertical-fov", "40"}, pixels{"focal-px", "900"};
  static const Value position{"position", "p.exr"}, depth_channel{"depth-channel", "Z"};
  static const Value occluders{"occluders", "Hero"}, ignore{"ignore", "Set*"}, around{"around", "2"};
  static const Value views{"other-views", "true"}, tolerance{"tolerance", "0.1"}, quiet{"quiet", "true"};
  static const Value channels{"position-channels", "P"}, half{"resolution", "half"}, mean{"accumulate", "2"};
  static const Value kernel{"denoise-kernel", "1,0.5"}, reach{"denoise-radius", "3"}, depth{"depth", "d.exr"};
  static const Value verbose{"verbose", "true"}, progress{"progress", "plain"};
  static const std::vector<std::pair<Value, Value>> all{{depth, position},
                                                        {depth_channel, position},
                                                        {depth_channel, channels},
                                                        {camera, fov},
                                                        {camera, ortho},
                                                        {fov, ortho},
                                                        {fov, tall},
                                                        {camera, tall},
                                                        {tall, ortho},
                                                        {tall, pixels},
                                                        {pixels, ortho},
                                                        {tolerance, half},
                                                        {tolerance, mean},
                                                        {kernel, reach},
                                                        {quiet, verbose},
                                                        {quiet, progress},
                                                        {occluders, ignore},
                                                        {occluders, around},
                                                        {occluders, views},
                                                        {ignore, around},
                                                        {ignore, views}};
  return all;
}

class Said : public testing::Test {
 protected:
  Said() {
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
    fs::create_directories(folder / "elsewhere");
  }

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

  /// The words that the setting has in the end.
  static Words value_of(const std::string& key, RunOptions options) { return row_of_key(key).words(options.settings); }

  static Words usual_value_of(const std::string& key) { return value_of(key, {}); }

  static Settings whole(const Words& words) {
    const RunOptions options = read(words);
    return with_idle_values(options.settings, options.values);
  }
  static std::string printed(const Words& words) { return preset_text(whole(words)); }
  static std::string shared(const Words& words) { return shareable_text(whole(words)); }

  /// The words of all settings.
  static std::map<std::string, Words> values_in(const Settings& settings) {
    std::map<std::string, Words> values;
    for (const auto& row : option_table()) {
      if (!row.is_key()) continue;
      for (const auto& word : row.words(settings))
        values[row.key()].push_back(row.names_file(word) ? fs::absolute(word).string() : word);
    }
    return values;
  }

  /// Expects that the presets of the words, printed as one, are as they are, alone and beside more words.
  void expect_printed_alike(const Words& presets, const Words& more) const {
    const std::string text = printed(presets);
    write_bytes(folder / "elsewhere/printed.toml", text);
    const Words again{"--preset", folder / "elsewhere/printed.toml"};
    EXPECT_EQ(printed(again), text) << testing::PrintToString(presets);
    EXPECT_EQ(values_in(read(joined(again, more)).settings), values_in(read(joined(presets, more)).settings))
        << testing::PrintToString(joined(presets, more));
  }

  static Words set(const Value& one) { return {"--set", one.key + "=" + one.value}; }
  static std::string refusal(const std::string& words, Reader reader = Reader::run) {
    return refusal(typed(words), reader);
  }

  const test::TemporaryFolder folder;
};

TEST_F(Said, settings_that_may_have_no_effect_are_those_of_the_cases) {
  std::set<std::string> with_reason, with_case;
  for (const auto& row : option_table())
    if (!row.idle_reasons.empty()) with_reason.insert(row.long_name());
  for (const auto& [ones, others, why] : rivals())
    for (const auto& key : joined(ones, others)) with_reason.insert(row_of_key(key).long_name());
  for (const auto& one : cases_without_effect()) with_case.insert(one.option());
  for (const auto& [one, other] : pairs())
    for (const auto& value : {one, other}) with_case.insert(row_of_key(value.key).long_name());
  EXPECT_EQ(with_reason, with_case) << "whoever says why a setting may have no effect shows both here";
}

TEST_F(Said, what_has_no_effect_is_refused_where_it_is_typed_and_left_out_of_presets) {
  for (const auto& one : cases_without_effect()) {
    SCOPED_TRACE(one.setting);
    EXPECT_EQ(refusal(one.setting + " " + one.taken), "");
    const Words words = typed(one.setting);
    const std::size_t equals = words.back().find('=');
    const Value value = one.is_key() ? Value{words[1].substr(0, equals), words[1].substr(equals + 1)}
                                     : Value{words[0].substr(2), words.size() > 1 ? words[1] : "true"};
    for (const auto& beside : one.refused) {
      EXPECT_THAT(refusal(one.setting + " " + beside), StartsWith(one.option() + " has no effect: ")) << beside;
      const Words by_preset = joined(preset("some.toml", {value}), typed(beside));
      ASSERT_EQ(refusal(by_preset), "") << beside;
      EXPECT_EQ(value_of(value.key, read(by_preset)), usual_value_of(value.key)) << beside;
    }
  }
}

TEST_F(Said, what_shadows_of_lights_take_has_an_effect_beside_them) {
  for (const char* words :
       {"--estimator crytek --thickness 1", "--estimator hbao --set complete=border", "--search exact --seed 1",
        "--search exact --noise animated", "--tolerance 0.1 --denoise box", "--tolerance 0.1 --set denoise-radius=3"}) {
    EXPECT_THAT(refusal(words), HasSubstr("has no effect")) << words;
    EXPECT_EQ(refusal(std::string("--lights l.json ") + words), "") << words;
  }
}

TEST_F(Said, a_refusal_says_what_the_setting_is_for_and_what_is_in_its_way) {
  for (const auto& [words, said] :
       {std::pair("--samples 8", "--samples has no effect: it is for --estimator crytek, and here that is gtao"),
        {"--preset reference --steps 8", "it is for --search steps, and here that is exact"},
        {"--near 1 --depth-kind ray", "--depth-kind says ray"},
        {"--near 1 --source octane", "--source octane says ray"},
        {"--near 1 --position p.exr", "--position says position"},
        {"--near 1 --set position-channels=P", "--set position-channels says position"},
        {"--set density=uniform --resolution half", "every pixel has its own"},
        {"--noise fixed --accumulate 4", "--noise has no effect: --accumulate is given, and it animates the noise"}})
    EXPECT_THAT(refusal(words), HasSubstr(said));
}

TEST_F(Said, what_a_preset_says_without_effect_stays_where_another_one_gives_it_one) {
  const Words samples = preset("samples.toml", {{"samples", "8"}});
  EXPECT_EQ(read(joined(samples, {"--estimator", "crytek"})).settings.estimator.samples, 8);
  const Words crytek = preset("crytek.toml", {{"estimator", "crytek"}});
  EXPECT_EQ(read(joined(samples, crytek)).settings.estimator.samples, 8);
}

TEST_F(Said, of_a_pair_only_one_may_be_typed) {
  for (const auto& [one, other] : pairs())
    for (const auto& words : {joined(set(one), set(other)), joined(set(other), set(one))})
      EXPECT_THAT(refusal(words), AllOf(HasSubstr(row_of_key(one.key).key()), HasSubstr(row_of_key(other.key).key()),
                                        HasSubstr("only one of them")));
}

TEST_F(Said, of_a_pair_what_is_typed_beats_a_preset_and_a_later_preset_an_earlier_one) {
  for (const auto& pair : pairs())
    for (const auto& [first, second] : {pair, std::pair(pair.second, pair.first)}) {
      const Words one = preset("first.toml", {first});
      for (const auto& words : {joined(one, set(second)), joined(one, preset("second.toml", {second}))}) {
        ASSERT_EQ(refusal(words), "") << first.key << " of a preset, " << second.key;
        EXPECT_EQ(value_of(first.key, read(words)), usual_value_of(first.key)) << second.key;
        EXPECT_NE(value_of(second.key, read(words)), usual_value_of(second.key)) << first.key;
      }
    }
}

TEST_F(Said, a_lens_is_said_in_one_way) {
  const Words lens{"--focal", "35", "--aperture", "36"};
  EXPECT_EQ(refusal(lens), "");
  for (const Value& other : std::vector<Value>{
           {"camera", "c.json"}, {"fov", "60"}, {"vertical-fov", "40"}, {"focal-px", "900"}, {"ortho-width", "2"}}) {
    EXPECT_THAT(refusal(joined(lens, {"--" + other.key, other.value})),
                AllOf(HasSubstr("--" + other.key), HasSubstr("only one of them")));
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

TEST_F(Said, values_that_ask_for_nothing_or_the_same_are_taken_anywhere) {
  for (const char* words :
       {"--tolerance 0 --estimator hbao --resolution half", "--set complete=none --estimator crytek",
        "--set fog-density=0", "--set hidden=0 --set separation=auto --around 0", "--set stride=1 --search exact",
        "--search steps --estimator crytek", "--search steps --tolerance 0", "--set multi-bounce=false",
        "--depth-kind auto --position p.exr", "--depth-kind position --position p.exr",
        "--noise animated --accumulate 4", "--noise fixed --accumulate 0",
        "--accumulate 4",  // nobody has said that the noise is fixed, as it usually is
        "--noise fixed --estimator crytek",
        // What confidence takes for its own estimates.
        "--slices 3 --aov ao,confidence --estimator crytek", "--steps 3 --aov ao,confidence --estimator crytek",
        "--falloff linear --aov ao,confidence --estimator crytek",
        "--set falloff-end=0.5 --aov ao,confidence --estimator crytek",
        "--tolerance 0.1 --aov ao,confidence --denoise box --seed 1",
        "--set stride=4 --aov ao,confidence --search exact", "--set stride=4 --aov ao,confidence --tolerance 0.1",
        // A frame without depth is read by its positions, whatever depth its program writes.
        "--source arnold --set position-space=view", "--source corona --set position-space=view",
        "--source pbrt --set position-space=view",
        // What farms pass always.
        "--resume --set overwrite=true --keep-going --set missing=skip --chunk 1/1 --frames 1 "
        "--threads 4 --memory 4G --progress openjd"})
    EXPECT_EQ(refusal(words), "") << words;
}

// Where one density lets every pixel have its own estimate and the other does not, the choice is all the more one.
TEST_F(Said, a_density_is_taken_where_the_other_one_would_share_estimates) {
  for (const char* words : {"--slices 3", "--slices 8", "--estimator bitmask"}) {
    EXPECT_EQ(refusal(std::string("--set density=uniform ") + words), "") << words;
    const Words by_preset = joined(typed(words), preset("density.toml", {{"density", "uniform"}}));
    EXPECT_EQ(read(by_preset).settings.estimator.density, Density::uniform) << words;
  }
}

// What is printed of them.

TEST_F(Said, settings_as_they_are_printed_are_a_preset_that_gives_them) {
  std::vector<Words> several;
  const std::vector<std::string> further{"", "draft", "reference", "source/forfun-hbao", "source/source15"};
  for (const auto& name : preset_names())
    for (const auto& other : further)
      several.push_back(other.empty() ? Words{"--preset", name} : Words{"--preset", name, "--preset", other});
  for (const auto& [one, other] : pairs())
    several.push_back(joined(preset("one.toml", {one}), preset("other-" + other.key + ".toml", {other})));
  several.push_back(joined(preset("late.toml", {{"denoise-kernel", "1,0.5"}}),
                           preset("none.toml", {{"denoise", "none"}, {"denoise-radius", "3"}})));
  EXPECT_GT(several.size(), 150);
  for (const auto& words : several) expect_printed_alike(words, {});
}

TEST_F(Said, settings_without_effect_are_printed_and_have_their_effect_where_they_may) {
  for (const auto& one : cases_without_effect()) {
    const std::string key = one.option().substr(one.is_key() ? 6 : 2);
    const bool is_flag = one.setting == one.option();
    const std::string value = is_flag ? "true" : one.setting.substr(one.option().size() + 1);
    expect_printed_alike(preset("one.toml", {{key, value}}), typed(one.taken));
  }
  EXPECT_THAT(printed(preset("gain.toml", {{"gain", "1.2"}})), HasSubstr("gain=1.2\n"));
  EXPECT_THAT(printed({}), Not(HasSubstr("gain="))) << "a default without effect is none of the settings";
}

TEST_F(Said, settings_that_are_shared_are_those_that_are_no_defaults) {
  EXPECT_EQ(shared({}), "");
  EXPECT_EQ(shared({"--preset", "standard"}), "");
  EXPECT_EQ(shared(joined({"--preset", "production"}, preset("gain.toml", {{"gain", "1.2"}}))),
            "slices=10\ndensity=\"edges\"\ngain=1.2\n");
  for (const auto& name : preset_names()) {
    const std::string text = shared({"--preset", name});
    write_bytes(folder / "shared.toml", text);
    EXPECT_EQ(shared({"--preset", folder / "shared.toml"}), text) << name;
  }
}

// Whether it applies shows only with the frame: then what a preset says is left out, and what is typed is refused.
TEST_F(Said, options_that_only_presets_say_are_known_as_such) {
  const Words far = preset("far.toml", {{"far", "100"}, {"near", "1"}});
  EXPECT_THAT(read(far).settings.input.from_presets,
              ElementsAre(testing::Key("--far"), testing::Pair("--near", testing::EndsWith("far.toml"))));
  EXPECT_THAT(read(joined(far, {"--far", "9"})).settings.input.from_presets, ElementsAre(testing::Key("--near")));
}

TEST_F(Said, settings_are_set_by_key_and_value) {
  EXPECT_EQ(read({"--set", "stride=4", "--set", "Radius=0.5"}).settings.estimator.stride, 4);
  EXPECT_EQ(read({"--set", "radius=0.5"}).settings.estimator.radius, 0.5) << "of options too";
  EXPECT_TRUE(read({"--set", "warnings-as-errors"}).settings.frames.warnings_as_errors) << "as git -c takes it";
  for (const auto& [words, said] :
       {std::pair("--set stride", "--set: stride is not KEY=VALUE: stride takes auto|1|2|4|8|16"),
        {"--set strid=4", "there is no setting strid (did you mean stride"},
        {"--set zzzz=4", "there is no setting zzzz; alcove run --help-markdown lists all"},
        {"--set samples=12", "--set samples has no effect: it is for --estimator crytek"},
        {"--set samples=few", "--set samples: few is not a number"},
        {"--set steps=4 --search exact", "--set steps has no effect: it is for --search steps"},
        {"--steps 4 --search exact", "--steps has no effect: it is for --search steps"},
        {"--focal 50", "--focal has no effect: there is no --aperture: add it"},
        {"--set stride=3", "--set stride: 3 is none of"},
        {"--set dry-run=true", "dry-run is an option of the command line only"},
        {"--set stride=4 --set stride=2", "is given more than once"},
        {"--slices 4 --set slices=2", "is given more than once"}})
    EXPECT_THAT(refusal(words), HasSubstr(said));
}

TEST_F(Said, a_key_that_is_typed_as_an_option_says_what_to_type) {
  int keys = 0;
  for (const auto& row : option_table()) {
    if (!row.is_only_key()) continue;
    const std::string value = row.is_flag() ? "true" : "1";
    const std::string said = fmt::format("--{} is a setting: write --set {}={}", row.name, row.name, value);
    EXPECT_THAT(refusal(Words{"--" + row.name, "1"}), HasSubstr(said));
    EXPECT_THAT(refusal("--" + row.name + "=1"), HasSubstr(fmt::format("write --set {}=1", row.name)));
    keys++;
  }
  EXPECT_GT(keys, 50);
}

TEST_F(Said, inspect_goes_by_the_same_rules_but_writes_no_outputs) {
  for (const auto& [words, said] : {std::pair("--near 1 --depth-kind planar", "--near has no effect"),
                                    {"--fov 60 --camera c.json", "only one of them"},
                                    {"--slices 4 --estimator crytek", "--slices has no effect"}})
    EXPECT_THAT(refusal(words, Reader::inspect), HasSubstr(said));
  for (const char* words : {"--beauty b.exr --set albedo=0.5", "--roughness 0.5 --set preview-style=split"})
    EXPECT_EQ(refusal(words, Reader::inspect), "");
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
  const RunOptions options =
      read(typed("--estimator HBAO --depth-kind Planar --aov AO,Depth --flip-normal XY --set "
                 "stride=AUTO --preset Draft --set compression=ZIPS"));
  EXPECT_EQ(options.settings.estimator.estimator, Estimator::hbao);
  EXPECT_EQ(options.settings.output.aovs, "ao,depth");
  EXPECT_TRUE(options.settings.input.flip_normal.y);
  EXPECT_EQ(options.settings.output.compression, "zips");
  EXPECT_EQ(options.settings.estimator.steps, 12);
  EXPECT_THAT(refusal("--estimator GTOA"), HasSubstr("did you mean gtao"));
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
  EXPECT_THAT(refusal("--radius 0.1,,0.5"), HasSubstr("--radius: \"\" is not a number"));
  EXPECT_EQ(read({"--preset", "draft,production"}).settings.estimator.slices, 10);
  EXPECT_EQ(read({"--preset", "production,draft"}).settings.estimator.steps, 12);
  EXPECT_EQ(read({"--preset", "draft,standard"}).settings.estimator.search, SliceSearch::steps);
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
}  // namespace alcove::said_test
