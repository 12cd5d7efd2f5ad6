// Runs keep within the memory that there is: a GPU with little of its own gets fewer frames at once, then tiles, and
// always the same bits; the host keeps within --memory as the kernel counts it.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"

namespace alcove::device_memory_test {
namespace {

using namespace test;

constexpr double kMiB = 1 << 20, kRich = 1024;
constexpr int kFrames = 7;

class DeviceMemory : public SequenceFolder {
 protected:
  DeviceMemory() {
    const Window window{0, 0, 320, 180};
    write_frames(1, kFrames, wall_frame(window, window));
    write_bytes(camera, wall_camera(window).dump());
  }

  /// A discrete GPU that has `mebibytes` of memory and says to have `stated`.
  static Launch with(double mebibytes, double stated,
                     std::map<std::string, std::optional<std::string>> environment = {}) {
    environment.insert({{"ALCOVE_HEAP", std::to_string(std::uint64_t(mebibytes * kMiB))},
                        {"ALCOVE_HEAP_SAYS", std::to_string(std::uint64_t(stated * kMiB))},
                        {"ALCOVE_TEST_DEVICE", std::nullopt}});
    return {.environment = environment, .preload = ALCOVE_POOR_DEVICE};
  }
  /// A run on it, which must write what was written before.
  json expect_whole(const Launch& launch, const Options& more = kOptions) {
    remove_outputs();
    said = "";
    const Finished finished = done(joined(more, {"--stats", folder / "stats.json"}), launch);
    said = finished.err;
    if (whole.empty()) whole = outputs();
    EXPECT_TRUE(outputs() == whole);
    return json::parse(read_bytes(folder / "stats.json"));
  }

  inline static const Options kOptions = typed("--threads 4 --noise animated --radius 0.04 --slices 1 --steps 2");
  std::map<std::string, std::string> whole;
  std::string said;  // by the last run
};

TEST_F(DeviceMemory, decides_how_many_frames_are_computed_at_once) {
  EXPECT_EQ(expect_whole(with(kRich, kRich))["totals"]["at_once"], 6)
      << "four threads, and two frames that wait for the device";
  EXPECT_LT(expect_whole(with(16, 16))["totals"]["at_once"], 6);
  EXPECT_THAT(said, Not(HasSubstr("had no memory"))) << "it was planned for";
  const std::string used = std::to_string(std::uint64_t(1008 * kMiB));
  EXPECT_LT(expect_whole(with(kRich, kRich, {{"ALCOVE_HEAP_USED", used}}))["totals"]["at_once"], 6)
      << "other programs have taken all but 16 MiB";
  const json poorest = expect_whole(with(3, 3));
  EXPECT_EQ(poorest["totals"]["at_once"], 1);
  EXPECT_GT(poorest["frames"][0]["parts"], 1);
}

TEST_F(DeviceMemory, that_the_host_does_not_see_keeps_what_is_as_in_the_frame_before) {
  const Window window{0, 0, 320, 180};
  for (int i = 1; i <= kFrames; i++) {
    FrameFile frame = wall_frame(window, window);
    for (int x = 0; x < 20; x++) frame.planes.at("ViewLayer.Depth.Z")[std::size_t(320 * 90 + 30 * i + x)] *= 0.9f;
    frame.write(input(i));
  }
  const Options options = typed("--threads 1 --radius 0.1");
  expect_whole(with(kRich, kRich), joined(options, {"--no-skip"}));
  const json frames = expect_whole(with(kRich, kRich), options)["frames"];
  EXPECT_GT(frames[kFrames - 1]["tiles"]["kept"], 0);
}

TEST_F(DeviceMemory, that_runs_out_halves_the_frames_at_once_and_then_the_tiles) {
  expect_whole(with(kRich, kRich));
  const json fewer = expect_whole(with(6, kRich));
  EXPECT_THAT(fewer["frames"].dump(), AllOf(HasSubstr("had no memory for 6 frames at once; from here on it computes 3"),
                                            Not(HasSubstr("pixels at once"))));
  EXPECT_LE(fewer["totals"]["at_once"], 3);
  const json in_tiles = expect_whole(with(2, kRich));
  EXPECT_THAT(in_tiles["frames"].dump(), HasSubstr("had no memory for 57600 pixels at once; now at most 28800"));
  EXPECT_EQ(in_tiles["totals"]["at_once"], 1);
  EXPECT_GT(in_tiles["frames"][kFrames - 1]["parts"], 1);
}

TEST_F(DeviceMemory, that_runs_out_for_an_estimate_halves_its_parts) {
  const Options options = typed("--radius 0.02 --thickness 0.02 --frames 2 --accumulate 1");
  expect_whole({}, options);
  // One of them is the driver's own. The frame fails at once, and once more when it is alone and without the buffers of
  // the first time.
  const json first = expect_whole({.environment = {{"ALCOVE_FIRST", "3"}}, .preload = ALCOVE_POOR_DEVICE}, options);
  EXPECT_THAT(first["frames"].dump(), HasSubstr("had no memory for 57600 pixels at once; now at most 28800"));
  EXPECT_GT(first["frames"][0]["parts"], 1);
}

TEST_F(DeviceMemory, that_six_frames_miss_side_by_side_halves_their_number_once) {
  EXPECT_EQ(expect_whole(with(kRich, kRich, {{"ALCOVE_TOGETHER", "6"}}))["totals"]["at_once"], 3);
  EXPECT_THAT(said, AllOf(HasSubstr("had no memory for 6 frames at once; from here on it computes 3"),
                          Not(HasSubstr("had no memory for 3 frames"))));
  EXPECT_EQ(outputs().size(), std::size_t(kFrames));
}

TEST_F(DeviceMemory, that_is_too_little_lets_frames_that_were_begun_go_before_the_rest) {
  const Options one_thread = typed("--threads 1 --noise animated --radius 0.1");
  EXPECT_EQ(expect_whole(with(kRich, kRich, {{"ALCOVE_TOGETHER", "3"}}), one_thread)["totals"]["at_once"], 1);
  const auto written = [&](int frame) { return fs::last_write_time(output(frame)); };
  for (int begun = 1; begun <= 3; begun++)
    for (int later = 4; later <= kFrames; later++) EXPECT_LE(written(begun), written(later)) << begun << " " << later;
}

TEST_F(DeviceMemory, that_is_missing_for_a_second_device_leaves_one_lane) {
  const Launch lacking{.environment = {{"ALCOVE_LACKS", "memory for a second device"}}, .preload = ALCOVE_POOR_DEVICE};
  EXPECT_EQ(expect_whole(lacking, typed("--device cpu --threads 2 --radius 0.1"))["totals"]["at_once"], 1);
  EXPECT_THAT(said, HasSubstr("had no memory for 2 frames at once; from here on it computes 1"));
  EXPECT_EQ(outputs().size(), std::size_t(kFrames));
}

TEST_F(DeviceMemory, that_is_not_enough_fails_the_frame_by_name) {
  for (const auto& [mebibytes, more, text] : {std::tuple(0.25, std::string(), "f.0001.exr"),
                                              {1.5, "--preview " + out + "/p.%04d.png", "--preview needs it whole"}}) {
    const Finished finished = run(joined(kOptions, typed(more)), with(mebibytes, kRich));
    EXPECT_EQ(finished.code, 5) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr(text), HasSubstr("no room for a buffer")));
    EXPECT_THAT(names_in(out), IsEmpty());
  }
}

class MemoryLimit : public SequenceFolder {
 protected:
  void SetUp() override {
#if defined(ALCOVE_SANITIZE_ADDRESS) || defined(ALCOVE_SANITIZE_THREAD)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  }

  /// A run on the CPU, of copies of a frame of this size; its peak must be within the limit.
  json run_within(int mebibytes, int frames, const Window& window, const std::string& more) const {
    FrameFile large = wall_frame(window, window);
    if (frames == 1) add_beauty(large);
    write_frames(1, frames, large);
    write_bytes(camera, wall_camera(window).dump());
    const std::string stats = folder / "stats.json";
    const Finished finished = done(typed(fmt::format(
        "--radius 0.1 --memory {}M --device cpu --stats {} --frames 1-{} {}", mebibytes, stats, frames, more)));
    EXPECT_LE(finished.peak_mib, mebibytes) << finished;
    return json::parse(read_bytes(stats));
  }
};

TEST_F(MemoryLimit, holds_for_a_frame_in_tiles) {
  const std::string to = out + "/new/";
  EXPECT_GT(run_within(
                360, 1, {0, 0, 2000, 800},
                "--slices 1 --steps 2 -o " + to + "ao.%04d.exr --composite " + to + "c.%04d.exr")["frames"][0]["parts"],
            1);
}

TEST_F(MemoryLimit, holds_for_several_frames_at_once) {
  EXPECT_GT(run_within(360, 6, {0, 0, 800, 600}, "--threads 4 --noise animated")["totals"]["at_once"], 1);
}

}  // namespace
}  // namespace alcove::device_memory_test
