// A GPU with little memory of its own: fewer frames at once, then tiles, and always the same bits.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/support/sequence_folder.h"

namespace alcove {
namespace {

namespace fs = std::filesystem;
using namespace test;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kMiB = 1 << 20;
constexpr int kFrames = 8;

class DeviceMemory : public SequenceFolder {
 protected:
  DeviceMemory() {
    const Window window{0, 0, 320, 180};
    wall_frame(window, window).write(input(1));
    for (int frame = 2; frame <= kFrames; frame++) fs::copy_file(input(1), input(frame));
    write_bytes(camera, wall_camera(window).dump());
  }

  /// A run on a discrete GPU that has `bytes` of memory and says to have `stated`.
  Finished run_with(std::uint64_t bytes, std::uint64_t stated, std::vector<std::string> more = {},
                    std::map<std::string, std::optional<std::string>> environment = {}) const {
    more.insert(more.end(), {"--threads", "4", "--noise", "animated", "--radius", "0.1", "--stats", stats});
    environment.insert({{"ALCOVE_HEAP", std::to_string(bytes)},
                        {"ALCOVE_HEAP_SAYS", std::to_string(stated)},
                        {"ALCOVE_TEST_DEVICE", std::nullopt}});
    return run(more, {.environment = environment, .preload = ALCOVE_POOR_DEVICE});
  }
  json of_stats() const { return json::parse(read_bytes(stats)); }

  const std::string stats = folder / "stats.json";
};

TEST_F(DeviceMemory, decides_how_many_frames_are_computed_at_once) {
  const Finished rich = run_with(1024 * kMiB, 1024 * kMiB);
  ASSERT_EQ(rich.code, 0) << rich;
  EXPECT_EQ(of_stats()["totals"]["at_once"], 6) << "four threads, and two frames that wait for the device";
  const auto whole = outputs();

  remove_outputs();
  const Finished poor = run_with(16 * kMiB, 16 * kMiB);
  ASSERT_EQ(poor.code, 0) << poor;
  EXPECT_LT(of_stats()["totals"]["at_once"], 6);
  EXPECT_THAT(poor.err, Not(HasSubstr("had no memory"))) << "it was planned for";
  EXPECT_TRUE(outputs() == whole);

  remove_outputs();
  const Finished shared = run_with(1024 * kMiB, 1024 * kMiB, {}, {{"ALCOVE_HEAP_USED", std::to_string(1008 * kMiB)}});
  ASSERT_EQ(shared.code, 0) << shared;
  EXPECT_LT(of_stats()["totals"]["at_once"], 6) << "other programs have taken all but 16 MiB";
  EXPECT_TRUE(outputs() == whole);

  remove_outputs();
  const Finished poorest = run_with(3 * kMiB, 3 * kMiB);
  ASSERT_EQ(poorest.code, 0) << poorest;
  EXPECT_EQ(of_stats()["totals"]["at_once"], 1);
  EXPECT_GT(of_stats()["frames"][0]["parts"], 1);
  EXPECT_TRUE(outputs() == whole);
}

TEST_F(DeviceMemory, that_runs_out_halves_the_frames_at_once_and_then_the_tiles) {
  ASSERT_EQ(run_with(1024 * kMiB, 1024 * kMiB).code, 0);
  const auto whole = outputs();

  remove_outputs();
  const Finished fewer = run_with(6 * kMiB, 1024 * kMiB);
  ASSERT_EQ(fewer.code, 0) << fewer;
  EXPECT_THAT(of_stats()["frames"].dump(),
              AllOf(HasSubstr("had no memory for 6 frames at once; from here on it computes 3"),
                    Not(HasSubstr("pixels at once"))));
  EXPECT_LE(of_stats()["totals"]["at_once"], 3);
  EXPECT_TRUE(outputs() == whole);

  remove_outputs();
  const Finished in_tiles = run_with(2 * kMiB, 1024 * kMiB);
  ASSERT_EQ(in_tiles.code, 0) << in_tiles;
  EXPECT_THAT(of_stats()["frames"].dump(), HasSubstr("had no memory for 57600 pixels at once; now at most 28800"));
  EXPECT_EQ(of_stats()["totals"]["at_once"], 1);
  EXPECT_GT(of_stats()["frames"][kFrames - 1]["parts"], 1);
  EXPECT_TRUE(outputs() == whole);
}

TEST_F(DeviceMemory, that_runs_out_for_an_estimate_halves_its_parts) {
  const std::vector<std::string> options{
      "run", in + "/f.%04d.exr", "-o",  out + "/ao.%04d.exr", "--camera", camera, "--radius", "0.1", "--frames",
      "2",   "--stats",          stats, "--accumulate",       "1"};
  ASSERT_EQ(run_program(options).code, 0);
  const auto whole = outputs();
  remove_outputs();
  // One of them is the driver's own. The frame fails at once, and once more when it is alone and without the buffers of
  // the first time.
  const Finished finished =
      run_program(options, {.environment = {{"ALCOVE_FIRST", "3"}}, .preload = ALCOVE_POOR_DEVICE});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(of_stats()["frames"].dump(), HasSubstr("had no memory for 57600 pixels at once; now at most 28800"));
  EXPECT_GT(of_stats()["frames"][0]["parts"], 1);
  EXPECT_TRUE(outputs() == whole);
}

TEST_F(DeviceMemory, that_six_frames_miss_side_by_side_halves_their_number_once) {
  const Finished finished = run_with(1024 * kMiB, 1024 * kMiB, {}, {{"ALCOVE_TOGETHER", "6"}});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("had no memory for 6 frames at once; from here on it computes 3"),
                                  Not(HasSubstr("had no memory for 3 frames"))));
  EXPECT_EQ(of_stats()["totals"]["at_once"], 3);
  EXPECT_EQ(outputs().size(), std::size_t(kFrames));
}

TEST_F(DeviceMemory, that_is_missing_for_a_second_device_leaves_one_lane) {
  const Finished finished =
      run({"--device", "cpu", "--threads", "2", "--radius", "0.1", "--stats", stats},
          {.environment = {{"ALCOVE_LACKS", "memory for a second device"}}, .preload = ALCOVE_POOR_DEVICE});
  ASSERT_EQ(finished.code, 0) << finished;
  EXPECT_THAT(finished.err, HasSubstr("had no memory for 2 frames at once; from here on it computes 1"));
  EXPECT_EQ(of_stats()["totals"]["at_once"], 1);
  EXPECT_EQ(outputs().size(), std::size_t(kFrames));
}

TEST_F(DeviceMemory, that_is_not_enough_for_any_tile_fails_the_frame_by_name) {
  const Finished finished = run_with(kMiB / 4, 1024 * kMiB);
  EXPECT_EQ(finished.code, 5) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("f.0001.exr"), HasSubstr("no room for a buffer")));
  EXPECT_TRUE(outputs().empty());
}

TEST_F(DeviceMemory, that_runs_out_for_a_picture_of_the_whole_frame_fails_the_frame) {
  const Finished finished = run_with(3 * kMiB / 2, 1024 * kMiB, {"--preview", out + "/p.%04d.png"});
  EXPECT_EQ(finished.code, 5) << finished;
  EXPECT_THAT(finished.err, AllOf(HasSubstr("no room for a buffer"), HasSubstr("--preview needs it whole")));
  EXPECT_THAT(names_in(out), testing::IsEmpty());
}

}  // namespace
}  // namespace alcove
