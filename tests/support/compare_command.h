// A folder of pictures, and `alcove compare` on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

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

}  // namespace alcove::test
