// What the tests of batches share: a folder with a sequence, its camera, and runs on it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/command_line.h"

namespace alcove::test {

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
