// File names may hold any bytes: what is no UTF-8 is escaped wherever a name is shown, and outputs stay valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::file_names_test {
namespace {

using namespace test;

/// Bytes of Latin-1, and how they are shown.
const std::string kName = "caf\xe9 \xff", kShown = "caf\\xe9 \\xff";

class FileNames : public CommandLine {
 protected:
  FileNames() { wall_frame().write(input); }

  Finished run(const Options& more, const Launch& launch = {}) const override {
    return run_program(joined({"run", input, "-o", output, "--camera", camera, "--radius", "1"}, more), launch);
  }

  /// Nothing but UTF-8, with the name as it is to be shown.
  static void expect_shown(const std::string& text) {
    EXPECT_NO_THROW((void)json(text).dump()) << "not UTF-8";
    EXPECT_THAT(text, HasSubstr(kShown));
    EXPECT_THAT(text, Not(HasSubstr("\xef\xbf\xbd"))) << "a replacement character hides which byte it was";
  }

  const std::string input = folder / (kName + ".exr"), output = folder / (kName + ".ao.exr");
};

TEST_F(FileNames, in_reports_of_a_run) {
  const std::string log = folder / "log.json";
  expect_shown(done({"--log-json", log, "-v"}).err);
  const json frame = stats_of({})["frames"][0];
  EXPECT_EQ(frame["input"], folder / (kShown + ".exr"));
  EXPECT_EQ(frame["output"], folder / (kShown + ".ao.exr"));
  bool is_logged = false;
  for (const auto& line : lines_of(read_bytes(log)))
    is_logged = is_logged || json::parse(line).value("input", "") == folder / (kShown + ".exr");
  EXPECT_TRUE(is_logged) << read_bytes(log);
}

TEST_F(FileNames, in_the_plan_of_a_dry_run_and_in_errors) {
  expect_shown(done({"--dry-run"}).out);
  write_bytes(input, "no picture");
  const Finished error = run({});
  EXPECT_EQ(error.code, 3);
  expect_shown(error.err);
}

TEST_F(FileNames, in_what_inspect_says_of_them_and_of_channels_and_attributes) {
  FrameFile file = wall_frame();
  file.attributes = {{"note \xff", "caf\xe9"}};
  file.planes["odd\xff.R"] = file.planes["ViewLayer.Depth.Z"];
  file.write(input);
  const Finished text = run_program({"inspect", input, "--camera", camera}),
                 quoted = run_well({"inspect", input, "--camera", camera, "--json"});
  expect_shown(text.out);
  const json found = json::parse(quoted.out)["files"][0], part = found["parts"][0];
  EXPECT_EQ(found["path"], folder / (kShown + ".exr"));
  EXPECT_EQ(part["attributes"]["note \\xff"], "caf\\xe9");
  EXPECT_THAT(part["channels"].dump(), HasSubstr("odd\\\\xff.R"));
}

TEST_F(FileNames, in_what_compare_says) {
  const std::string page = folder / "page.html";
  const Options arguments{"compare", input, input, "--channel", "ViewLayer.Depth.Z"};
  const Finished text = run_well(arguments), parsed = run_well(joined(arguments, {"--json", "--report", page}));
  expect_shown(text.out);
  EXPECT_EQ(json::parse(parsed.out)["result"], folder / (kShown + ".exr"));
  EXPECT_THAT(read_bytes(page), HasSubstr("caf\\\\xe9 \\\\xff"));
}

}  // namespace
}  // namespace alcove::file_names_test
