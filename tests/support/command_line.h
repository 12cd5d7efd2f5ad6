// What the tests of the command line share: a folder with the frame of the wall and its camera, and a run on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/formats/exr.h"
#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove::test {

class CommandLine : public testing::Test {
 protected:
  CommandLine() {
    wall_frame().write(frame);
    write_bytes(camera, wall_camera().dump());
  }

  /// `run` on the frame with its camera, a radius of 1 and these arguments.
  Finished run(const std::vector<std::string>& more, const Surroundings& surroundings = {}) const {
    std::vector<std::string> arguments{"run", frame, "-o", ao, "--camera", camera, "--radius", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments, surroundings);
  }

  /// Makes a run that must end with this code and one line that holds the words, and must leave nothing behind.
  void expect_run_refused(int code, const std::vector<std::string>& words, const std::vector<std::string>& more) const {
    SCOPED_TRACE(testing::PrintToString(more));
    const auto before = names_in(folder.path());
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, code) << finished;
    EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
    for (const auto& word : words) EXPECT_NE(finished.err.find(word), std::string::npos) << word << finished;
    EXPECT_EQ(names_in(folder.path()), before);
  }

  /// The same without a radius; it must succeed, and OUTPUT is returned.
  Image written(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"run", frame, "-o", ao, "--camera", camera, "--type", "float"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = run_program(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    return read_exr_image(ao);
  }

  /// Expects that a region has the bits of the whole, in all channels, and returns the whole.
  Image expect_region_of_whole(std::vector<std::string> more, const Window& region) const {
    const Image whole = written(more);
    more.insert(more.end(), {"--roi", fmt::format("{},{},{},{}", region.x, region.y, region.width, region.height)});
    const Image part = written(more);
    EXPECT_EQ(part.data, region);
    EXPECT_EQ(part.names, whole.names);
    EXPECT_TRUE(part.pixels == cropped(whole.pixels, whole.data, region)) << testing::PrintToString(more);
    return whole;
  }

  TemporaryFolder folder;
  const std::string frame = folder / "wall.0042.exr", camera = folder / "camera.json", ao = folder / "ao.exr";
};

}  // namespace alcove::test
