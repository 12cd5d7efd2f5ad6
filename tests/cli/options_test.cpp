// The table of options: rows read what they say, and those that change pixels are in the digest that --resume knows.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/options.h"

#include "core/base/error.h"
#include "core/base/toml.h"
#include "core/run/resume.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::options_test {
namespace {

using namespace test;

static_assert(!std::is_constructible_v<OptionGroup<Settings>, std::vector<SettingRow>&, std::string>,
              "a row without a declared effect must not compile");

class Options : public CommandLine {
 protected:
  Options() {
    settings.estimator.radius = 1;
    // They differ in the middle alone, as the camera of one frame in a long list does.
    const std::string half(1 << 18, ' ');
    write_bytes(file, half + "a" + half);
    write_bytes(same, half + "a" + half);
    write_bytes(other, half + "b" + half);
  }

  std::string digest() const { return options_digest(settings); }
  std::string identity() const {
    const FramePlan plan(settings);
    return InputIdentities(plan).of(plan.frames().front());
  }

  /// Gives the row another value than it has: one of its own words, else what it takes of a number or a text.
  bool change(const SettingRow& row) {
    const Words before = row.words(settings);
    Words candidates{"true"};
    for (std::size_t at = 0; at != std::string::npos && at <= row.value.size();) {
      const std::size_t bar = std::min(row.value.find('|', at), row.value.size());
      candidates.push_back(row.value.substr(at, bar - at));
      at = bar + 1;
    }
    candidates.insert(candidates.end(),
                      {"0.5", "0.05", "2", "5", "x", "1,2", "1,2,3,4", "0.1,0.2,0.3", "2/3", "4G", "half-depth"});
    for (const auto& candidate : candidates) {
      try {
        row.read(settings, {candidate});
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage) << row.name;
        EXPECT_THAT(error.what(), HasSubstr(row.long_name()));
        continue;
      }
      if (row.words(settings) != before) return true;
    }
    return false;
  }

  /// Calls it with each row of the effect that is a setting, and with the settings as they are by default.
  void for_each(Effect effect, const std::function<void(const SettingRow&)>& call) {
    const Settings defaults = settings;
    int rows = 0;
    for (const auto& row : option_table())
      if (row.effect == effect && row.is_key()) {
        settings = defaults;
        call(row);
        rows++;
      }
    settings = defaults;
    EXPECT_GT(rows, 0);
  }

  /// Calls it with each row of a setting that names inputs.
  void for_each_input(const std::function<void(const SettingRow&)>& call) {
    for_each(Effect::pixels, [&](const SettingRow& row) {
      settings.input.input = frame;
      if (row.role == FileRole::input) call(row);
    });
  }

  Settings settings;
  const std::string file = folder / "file.exr", same = folder / "same.exr", other = folder / "other.exr";
};

TEST_F(Options, of_every_row_take_what_they_say) {
  for (const auto& row : option_table()) {
    if (!row.is_key()) continue;
    ASSERT_TRUE(change(row)) << row.name << " has no other value";
    Settings fresh;
    row.read(fresh, row.words(settings));
    EXPECT_EQ(row.words(fresh), row.words(settings)) << row.name;
  }
}

TEST_F(Options, refuse_what_hidden_surfaces_cannot_be) {
  const auto read = [&](const char* option, const Words& words) {
    std::ranges::find(option_table(), std::string(option), &OptionRow::long_name)->read(settings, words);
  };
  const auto refusal = [&](const char* option, const Words& words) {
    try {
      read(option, words);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal("--behind", Words(9, "a.exr")), HasSubstr("there are 9 files; a run takes at most 8"));
  EXPECT_EQ(refusal("--behind", Words(8, "a.exr")), "");
  for (const auto& [option, word, said] : {std::tuple("--behind-kind", "fronts,back", "--behind-kind: back is none of"),
                                           {"--around", "33", "neither all nor a whole number from 0 to 32"},
                                           {"--set separation", "-1", "neither auto nor a length"},
                                           {"--set separation", "inf", "neither auto nor a length"},
                                           {"--set separation", "nan", "neither auto nor a length"},
                                           {"--set separation", "near", "neither auto nor a length"},
                                           {"--set hidden", "4", "out of range: 0 to 3"}})
    EXPECT_THAT(refusal(option, {word}), HasSubstr(said));
  read("--around", {"ALL"});
  EXPECT_TRUE(settings.input.around_all);
  read("--around", {"4"});
  EXPECT_FALSE(settings.input.around_all);
  read("--set separation", {"0.5"});
  read("--set separation", {"auto"});
  EXPECT_FALSE(settings.estimator.separation);
}

TEST_F(Options, say_numbers_to_the_last_bit) {
  const SettingRow& radius = row_of_key("radius");
  for (const double value : {0.1, 1.0 / 3, 1e-300, 0x1.fffffffffffffp+58}) {
    settings.estimator.radius = value;
    radius.read(settings, radius.words(settings));
    EXPECT_EQ(settings.estimator.radius, value);
  }
}

TEST_F(Options, that_change_pixels_change_the_digest_each_in_its_own_way) {
  const std::string plain = digest();
  std::set<std::string> digests;
  int rows = 0;
  for_each(Effect::pixels, [&](const SettingRow& row) {
    EXPECT_TRUE(change(row));
    EXPECT_NE(digest(), plain) << row.name;
    digests.insert(digest());
    rows++;
  });
  EXPECT_EQ(digests.size(), rows);
}

TEST_F(Options, that_change_no_pixels_are_these_and_not_in_the_digest) {
  const std::string plain = digest();
  Words names;
  for_each(Effect::none, [&](const SettingRow& row) {
    EXPECT_TRUE(change(row));
    EXPECT_EQ(digest(), plain) << row.name;
    names.push_back(row.long_name());
  });
  EXPECT_THAT(names,
              ElementsAre("--strict", "--set allow", "--frames", "--set output-offset", "--chunk", "--set missing",
                          "--keep-going", "--set warnings-as-errors", "--resume", "--set overwrite", "--no-skip",
                          "--output", "--composite", "--preview", "--set debug", "--set compression", "--set no-mkdir",
                          "--set ocio", "--device", "--set require-gpu", "--validate", "--memory", "--threads",
                          "--stats", "--progress", "--log-json", "--verbose", "--quiet"))
      << "whoever adds to this list says that the pixels come out the same";
}

TEST_F(Options, that_name_inputs_count_by_being_given) {
  const std::string plain = digest();
  for_each_input([&](const SettingRow& row) {
    row.read(settings, {file});
    const std::string given = digest();
    EXPECT_NE(given, plain) << row.name;
    row.read(settings, {other});
    EXPECT_EQ(digest(), given) << row.name << ": inputs are known by their bytes";
  });
  settings.input.albedo_value = 0.5;
  const std::string half = digest();
  settings.input.albedo_value = 0.25;
  EXPECT_NE(digest(), half);
}

TEST_F(Options, that_name_a_picture_or_objects_count_by_being_given_or_by_the_objects) {
  for (const char* key : {"occluders", "ignore"}) {
    const SettingRow& row = row_of_key(key);
    row.read(settings, {"a.exr"});
    const std::string given = digest();
    row.read(settings, {"Hero"});
    const std::string hero = digest();
    EXPECT_NE(hero, given) << row.name;
    row.read(settings, {"Villain"});
    EXPECT_NE(digest(), hero) << row.name;
  }
}

TEST_F(Options, that_name_inputs_are_told_apart_by_every_byte_wherever_they_lie) {
  for_each_input([&](const SettingRow& row) {
    const std::string none = identity();
    row.read(settings, {file});
    const std::string first = identity();
    EXPECT_NE(first, none) << row.name;
    row.read(settings, {same});
    EXPECT_EQ(identity(), first) << row.name << ": another place";
    row.read(settings, {other});
    EXPECT_NE(identity(), first) << row.name;
  });
}

TEST_F(Options, of_the_display_count_where_a_preview_shows_a_composite) {
  settings.input.input = frame;
  ::setenv("OCIO", file.c_str(), 1);
  const std::string plain = identity();
  for (std::string* const path : {&settings.output.preview, &settings.output.composite}) {
    *path = folder / "a.file";
    ::setenv("OCIO", other.c_str(), 1);
    EXPECT_EQ(identity(), plain) << "a preview of the AO, or a composite alone";
    path->clear();
  }
  settings.output.preview = settings.output.composite = folder / "a.file";
  const std::string shown = identity();
  EXPECT_NE(shown, plain) << "the preview was of the AO";
  ::setenv("OCIO", file.c_str(), 1);
  EXPECT_NE(identity(), shown);
  ::unsetenv("OCIO");
}

TEST_F(Options, that_are_zero_or_given_twice_or_run_into_each_other_have_digests_of_their_own) {
  const std::string plain = digest();
  settings.estimator.fade_start = 0;
  EXPECT_NE(digest(), plain) << "not those that are not set";
  settings.input.layer = "a\n--view 1 b";
  const std::string one_text = digest();
  settings.input.layer = "a";
  settings.input.view = "b";
  EXPECT_NE(digest(), one_text);
  settings.input.behind = {"a.exr"};
  const std::string one_file = digest();
  settings.input.behind = {"b.exr"};
  EXPECT_EQ(digest(), one_file);
  settings.input.behind = {"a.exr", "b.exr"};
  EXPECT_NE(digest(), one_file);
}

TEST_F(Options, as_a_preset_are_what_they_are) {
  const auto preset_of = [&](const std::string& text) {
    settings.input.layer = text;
    return preset_text(settings);
  };
  for (const std::string text :
       {"a b", "a \"b\"", "it's", "c:\\d", "'\"\\\t\x7f'", "\n", "007", "1001", "inf", "true", "ü#"}) {
    const auto entries = parse_flat_toml(preset_of(text));
    const auto layer = std::ranges::find(entries, "layer", &FlatEntry::key);
    ASSERT_NE(layer, entries.end());
    EXPECT_THAT(layer->values, ElementsAre(text));
  }
}

// The digest through the program.

TEST_F(Options, of_the_camera_count_by_what_it_says_and_not_where_it_lies) {
  const auto identity_in_file = [&] {
    done();
    return text_in(read_header(ao), "alcove/inputs");
  };
  const std::string before = identity_in_file();
  json fields = wall_camera();
  fields["fx"] = 59;
  write_bytes(camera, fields.dump());
  EXPECT_NE(identity_in_file(), before) << "another focal length";
  fs::create_directory(folder / "moved");
  write_bytes(folder / "moved/camera.json", wall_camera().dump());
  EXPECT_EQ(run_program({"run", frame, "-o", ao, "--camera", folder / "moved/camera.json", "--radius", "1"}).code, 0);
  EXPECT_EQ(text_in(read_header(ao), "alcove/inputs"), before) << "the same camera in another folder";
}

/// A configuration whose only view multiplies by `factor`.
std::string display_config(const char* factor) {
  constexpr const char* kText = R"(ocio_profile_version: 1
roles: {{default: scene, scene_linear: scene}}
displays:
  screen:
    - !<View> {{name: darker, colorspace: dark}}
colorspaces:
  - !<ColorSpace> {{name: scene}}
  - !<ColorSpace> {{name: dark, from_reference: !<MatrixTransform> {{matrix: [{0}, 0, 0, 0, 0, {0}, 0, 0, 0, 0, {0}, 0, 0, 0, 0, 1]}}}}
)";
  return fmt::format(kText, factor);
}

class Previews : public CommandLine {
 protected:
  Previews() {
    FrameFile input = wall_frame();
    add_beauty(input);
    input.write(frame);
    write_bytes(half, display_config("0.5"));
    write_bytes(quarter, display_config("0.25"));
  }

  /// The preview after a run with --resume; the variable OCIO has this value, or none.
  std::string preview_of(const Words& more, std::optional<std::string> variable = {}) {
    const Finished finished = done(joined(more, {"--preview", preview, "--resume", "--progress", "plain"}),
                                   {.environment = {{"OCIO", variable}}});
    is_kept = finished.err.find("whole, kept") != std::string::npos;
    return read_bytes(preview);
  }

  const std::string preview = folder / "preview.png", half = folder / "half.ocio", quarter = folder / "quarter.ocio";
  const Words shown{"--composite", folder / "composite.exr"};
  bool is_kept = false;
};

TEST_F(Previews, are_made_again_for_another_configuration_of_the_display) {
  const Words by_half = joined(shown, {"--set", "ocio=" + half}),
              by_quarter = joined(shown, {"--set", "ocio=" + quarter});
  const std::string halved = preview_of(by_half);
  EXPECT_EQ(preview_of(by_half), halved);
  EXPECT_TRUE(is_kept);
  const std::string quartered = preview_of(by_quarter);
  EXPECT_NE(quartered, halved) << "another configuration";
  EXPECT_EQ(preview_of(shown, quarter), quartered);
  EXPECT_TRUE(is_kept) << "the variable OCIO says what ocio said";
  EXPECT_NE(preview_of(shown, half), quartered) << "the variable OCIO";
  EXPECT_NE(preview_of(shown), halved) << "the built-in configuration";
  write_bytes(half, display_config("0.25"));
  EXPECT_NE(preview_of(by_half), halved) << "another text in the same file";
  const std::string of_composite = preview_of(shown);
  EXPECT_NE(preview_of({}), of_composite) << "the composite is not asked for any more";
  preview_of({});
  EXPECT_TRUE(is_kept);
}

}  // namespace
}  // namespace alcove::options_test
