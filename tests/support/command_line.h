// Folders with rendered frames and their cameras, and runs on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/options.h"
#include "core/formats/exr.h"
#include "tests/support/program.h"
#include "tests/support/test.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

/// Whatever `run` runs on.
class Runs : public testing::Test {
 protected:
  Runs() { write_bytes(camera, wall_camera().dump()); }

  virtual Finished run(const Options& more, const Launch& launch = {}) const = 0;

  /// A run that must succeed.
  Finished done(const Options& more = {}, const Launch& launch = {}) const {
    const Finished finished = run(more, launch);
    EXPECT_EQ(finished.code, 0) << testing::PrintToString(more) << finished;
    return finished;
  }
  /// What such a run's statistics say.
  json stats_of(const Options& more, const Launch& launch = {}) const {
    done(joined(more, {"--stats", folder / "stats.json"}), launch);
    return json::parse(read_bytes(folder / "stats.json"));
  }
  /// The passes of its first frame.
  std::vector<std::string> passes_of(const Options& more) const {
    const json stats = stats_of(more);
    std::vector<std::string> names;
    for (const auto& pass : stats["frames"][0]["passes"]) names.push_back(pass["name"]);
    return names;
  }
  /// A run that must end with this code and one line that holds these texts.
  void expect_refused(int code, const Options& more, const Options& texts, const Launch& launch = {}) const {
    SCOPED_TRACE(testing::PrintToString(more));
    test::expect_refused(run(more, launch), code, texts);
  }

  /// The same of a run that must leave nothing behind.
  void expect_run_refused(int code, const Options& texts, const Options& more) const {
    const auto before = names_in(folder.path());
    expect_refused(code, more, texts);
    EXPECT_EQ(names_in(folder.path()), before);
  }

  TemporaryFolder folder;
  const std::string camera = folder / "camera.json";
};

/// The frame of the wall.
class CommandLine : public Runs {
 protected:
  CommandLine() { wall_frame().write(frame); }

  /// `run` on the frame with its camera, a radius of 1 and these arguments.
  Finished run(const Options& more, const Launch& launch = {}) const override {
    return run_program(joined({"run", frame, "-o", ao, "--camera", camera, "--radius", "1"}, more), launch);
  }
  /// What a run that must succeed writes as floats: all channels of the AO's file.
  Image computed(const Options& more) const {
    return done(joined({"--type", "float"}, more)).code == 0 ? read_exr_image(ao) : Image();
  }

  /// The same without a radius.
  Image written(const Options& more) const {
    run_well(joined({"run", frame, "-o", ao, "--camera", camera, "--type", "float"}, more));
    return read_exr_image(ao);
  }
  /// Expects that a region has the bits of the whole, in all channels, and returns the whole.
  Image expect_region_of_whole(const Options& more, const Window& region) const {
    const Image whole = written(more);
    const Image part =
        written(joined(more, {"--roi", fmt::format("{},{},{},{}", region.x, region.y, region.width, region.height)}));
    EXPECT_EQ(part.data, region);
    EXPECT_EQ(part.names, whole.names);
    EXPECT_TRUE(part.pixels == cropped(whole.pixels, whole.data, region)) << testing::PrintToString(more);
    return whole;
  }

  const std::string frame = folder / "wall.0042.exr", ao = folder / "ao.exr";
};

// The settings of the presets that are installed.

/// What `run` takes these words for.
inline EstimatorSettings estimator_of(const Options& words) {
  ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
  RunOptions options;
  parse_run_options(words, options);
  return options.settings.estimator;
}
inline EstimatorSettings preset(const std::string& name) { return estimator_of({"--preset", name}); }
inline EstimatorSettings preset(const std::string& name, double radius) {
  return estimator_of({"--preset", name, "--radius", std::to_string(radius)});
}

// A folder of pictures, and `alcove compare` on them.

class CompareCommand : public testing::Test {
 protected:
  /// Writes an EXR and gives its path.
  std::string exr_of(const std::string& name, const std::map<std::string, std::vector<float>>& planes,
                     const Window& data) const {
    FrameFile file;
    file.data = file.display = data;
    file.planes = planes;
    file.write(folder / name);
    return folder / name;
  }

  Finished compare(const Options& arguments) const { return run_program(joined({"compare"}, arguments)); }

  json measured(const Options& arguments, int code = 0) const {
    const Finished finished = compare(joined(arguments, {"--json"}));
    EXPECT_EQ(finished.code, code) << finished;
    return json::parse(finished.out);
  }

  void expect_error(int code, const Options& arguments, const Options& words) const {
    expect_refused(compare(arguments), code, words);
  }

  TemporaryFolder folder;
};

// What the tests of batches share: a folder with a sequence, its camera, and runs on it.

class SequenceFolder : public Runs {
 protected:
  SequenceFolder() {
    fs::create_directory(in);
    fs::create_directory(out);
  }

  void write_frames(int first, int last, const FrameFile& frame = wall_frame()) const {
    frame.write(input(first));
    for (int other = first + 1; other <= last; other++) fs::copy_file(input(first), input(other));
  }
  std::string input(int frame) const { return fmt::format("{}/f.{:04}.exr", in, frame); }
  std::string output(int frame) const { return fmt::format("{}/ao.{:04}.exr", out, frame); }

  /// `run` on the sequence with these arguments and, where they say nothing else, its camera and a radius of 1.
  Finished run(const Options& more = {}, const Launch& launch = {}) const override {
    return run_program(joined({"run"}, arguments(more)), launch);
  }
  Options arguments(const Options& more) const {
    Options all{in + "/f.%04d.exr"};
    for (const auto& [option, value] :
         {std::pair<std::string, std::string>("-o", out + "/ao.%04d.exr"), {"--camera", camera}, {"--radius", "1"}})
      if (std::ranges::find(more, option) == more.end()) all.insert(all.end(), {option, value});
    return joined(all, more);
  }

  void remove_outputs() const {
    fs::remove_all(out);
    fs::create_directory(out);
  }

  /// The bytes of every output, by name.
  std::map<std::string, std::string> outputs() const {
    std::map<std::string, std::string> files;
    for (const auto& name : names_in(out)) files[name] = read_bytes(out + "/" + name);
    return files;
  }

  /// These runs, one after the other, must write what was written before.
  void expect_same_outputs(const std::map<std::string, std::string>& before, const std::vector<Options>& runs) const {
    remove_outputs();
    for (const auto& more : runs) done(more);
    EXPECT_TRUE(outputs() == before) << testing::PrintToString(runs);
  }

  const std::string in = folder / "in", out = folder / "out";
};

}  // namespace alcove::test
