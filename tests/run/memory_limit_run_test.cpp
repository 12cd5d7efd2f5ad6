// A run keeps within --memory as the kernel counts it: in tiles, and with several frames at once.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/support/sequence_folder.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;
using namespace test;

class MemoryLimit : public SequenceFolder {
 protected:
  void SetUp() override {
#if defined(ALCOVE_SANITIZE_ADDRESS) || defined(ALCOVE_SANITIZE_THREAD)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  }

  /// A run on the CPU; its peak must be within the limit.
  nlohmann::json run_within(int mebibytes, std::vector<std::string> more) const {
    more.insert(more.end(), {"--memory", std::to_string(mebibytes) + "M", "--stats", stats, "--device", "cpu"});
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_LE(finished.peak_mib, mebibytes) << finished;
    return finished.code == 0 ? nlohmann::json::parse(read_bytes(stats)) : nlohmann::json();
  }

  const std::string stats = folder / "stats.json";
};

TEST_F(MemoryLimit, holds_for_a_frame_in_tiles) {
  const Window window{0, 0, 2000, 800};
  FrameFile large = wall_frame(window, window);
  add_beauty(large);
  large.write(input(1));
  write_bytes(camera, wall_camera(window).dump());
  const auto found = run_within(330, {"--frames", "1", "--radius", "0.3", "--slices", "1", "--steps", "2", "-o",
                                      out + "/new/ao.%04d.exr", "--composite", out + "/new/c.%04d.exr"});
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found["frames"][0]["parts"], 1);
}

TEST_F(MemoryLimit, holds_for_several_frames_at_once) {
  const Window window{0, 0, 800, 600};
  wall_frame(window, window).write(input(1));
  for (int frame = 2; frame <= 6; frame++) fs::copy_file(input(1), input(frame));
  write_bytes(camera, wall_camera(window).dump());
  const auto found = run_within(360, {"--frames", "1-6", "--radius", "0.3", "--threads", "4", "--noise", "animated"});
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found["totals"]["at_once"], 1);
}

}  // namespace
}  // namespace alcove
