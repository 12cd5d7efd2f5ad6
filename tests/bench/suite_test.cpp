// Suites of the benchmark: at which radius each candidate is measured.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;

class SuiteRadius : public CommandLine {
 protected:
  /// Measures the candidates on the wall, whose truth is what a run computes at the radius 1. Gives the RMSE of each.
  std::map<std::string, double> errors_of(const std::string& candidates) {
    EXPECT_EQ(run({"--type", "float"}).code, 0);
    write_bytes(folder / "suite.toml",
                "title = \"radii\"\nrepeats = 1\nreference-slices = 0\n[[frame]]\nname = \"wall\"\ninput = "
                "\"wall.0042.exr\"\ncamera = \"camera.json\"\nradius = 1\ntruth = \"ao.exr\"\n" +
                    candidates);
    const std::string file = folder / "report.json";
    const Finished finished = run_program({"bench", folder / "suite.toml", "-q", "--json", file});
    EXPECT_EQ(finished.code, 0) << finished;
    const auto report = nlohmann::json::parse(read_bytes(file));
    std::map<std::string, double> errors;
    for (const auto& row : report["rows"]) errors[row["candidate"]] = row["rmse"];
    return errors;
  }
};

TEST_F(SuiteRadius, is_the_candidates_own_where_it_names_one) {
  const auto errors = errors_of(
      "[[candidate]]\nname = \"the frame's\"\nslices = 2\n"
      "[[candidate]]\nname = \"its own\"\nradius = 0.1\n"
      "[[sweep]]\nradius = [1, 0.1]\n");
  EXPECT_LT(errors.at("the frame's"), 1e-6);
  EXPECT_GT(errors.at("its own"), 0.01);
  EXPECT_LT(errors.at("radius 1"), 1e-6);
  EXPECT_EQ(errors.at("radius 0.1"), errors.at("its own"));
}

TEST_F(SuiteRadius, is_the_frames_whatever_a_preset_says) {
  write_bytes(folder / "one.toml", "radius = 0.1\n");
  write_bytes(folder / "two.toml", "radius = [0.1, 0.2]\n");
  const auto errors = errors_of("[[candidate]]\nname = \"one\"\npreset = \"" + folder / "one.toml" +
                                "\"\n[[candidate]]\nname = \"two\"\npreset = \"" + folder / "two.toml" + "\"\n");
  EXPECT_LT(errors.at("one"), 1e-6);
  EXPECT_LT(errors.at("two"), 1e-6);
}

}  // namespace
}  // namespace alcove
