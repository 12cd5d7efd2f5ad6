// What the tests of the command line share: a folder with the frame of the wall and its camera, and a run on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

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

  TemporaryFolder folder;
  const std::string frame = folder / "wall.0042.exr", camera = folder / "camera.json", ao = folder / "ao.exr";
};

}  // namespace alcove::test
