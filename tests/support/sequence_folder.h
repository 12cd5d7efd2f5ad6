// What the tests of batches share: a folder with a sequence, its camera, and runs on it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

class SequenceFolder : public testing::Test {
 protected:
  SequenceFolder() {
    std::filesystem::create_directory(in);
    std::filesystem::create_directory(out);
    write_bytes(camera, wall_camera().dump());
  }

  void write_frames(int first, int last) const {
    wall_frame().write(input(first));
    for (int frame = first + 1; frame <= last; frame++) std::filesystem::copy_file(input(first), input(frame));
  }
  std::string input(int frame) const { return fmt::format("{}/f.{:04}.exr", in, frame); }
  std::string output(int frame) const { return fmt::format("{}/ao.{:04}.exr", out, frame); }

  /// `run` on the sequence with these arguments and, where they say nothing else, its camera and a radius of 1.
  Finished run(const std::vector<std::string>& more = {}, const Surroundings& surroundings = {}) const {
    std::vector<std::string> arguments{"run", in + "/f.%04d.exr"};
    for (const auto& [option, value] :
         {std::pair<std::string, std::string>("-o", out + "/ao.%04d.exr"), {"--camera", camera}, {"--radius", "1"}})
      if (std::ranges::find(more, option) == more.end()) arguments.insert(arguments.end(), {option, value});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments, surroundings);
  }

  void remove_outputs() const {
    std::filesystem::remove_all(out);
    std::filesystem::create_directory(out);
  }

  /// The bytes of every output, by name.
  std::map<std::string, std::string> outputs() const {
    std::map<std::string, std::string> files;
    for (const auto& name : names_in(out)) files[name] = read_bytes(out + "/" + name);
    return files;
  }

  /// Whether these runs, one after the other, write what was written before.
  void expect_same_outputs(const std::map<std::string, std::string>& before,
                           const std::vector<std::vector<std::string>>& runs) const {
    remove_outputs();
    for (const auto& arguments : runs) {
      const Finished finished = run(arguments);
      EXPECT_EQ(finished.code, 0) << finished;
    }
    EXPECT_TRUE(outputs() == before) << testing::PrintToString(runs);
  }

  TemporaryFolder folder;
  const std::string in = folder / "in", out = folder / "out", camera = folder / "camera.json";
};

}  // namespace alcove::test
