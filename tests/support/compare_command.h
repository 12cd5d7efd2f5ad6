// A folder of pictures, and `alcove compare` on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

  Finished compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    return run_program(arguments);
  }

  nlohmann::json measured(std::vector<std::string> arguments, int code = 0) const {
    arguments.push_back("--json");
    const Finished finished = compare(arguments);
    EXPECT_EQ(finished.code, code) << finished;
    return nlohmann::json::parse(finished.out);
  }

  void expect_error(int code, const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const Finished finished = compare(arguments);
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_THAT(finished.err, testing::HasSubstr(word));
  }

  TemporaryFolder folder;
};

}  // namespace alcove::test
