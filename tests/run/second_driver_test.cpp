// SwiftShader, which Debian has in chromium-common, computes what lavapipe does, and the same to the bit in other ways.
// SPDX-License-Identifier: BSD-3-Clause
//
// It takes minutes for the kernel of the exact search, which is left to long runs.
#include "core/base/text.h"
#include "tests/support/long_tests.h"
#include "tests/support/walked_shot.h"

namespace alcove::second_driver_test {
namespace {

using namespace test;

constexpr const char* kSwiftShader = "/usr/lib/chromium/vk_swiftshader_icd.json";
constexpr Window kWindow{0, 0, 160, 90};
constexpr std::uint64_t kLittleMemory = 3 << 20;

/// The second of two frames past a board, with a beauty, and with a wall behind the board.
class SecondDriver : public WalkedShot {
 protected:
  void SetUp() override {
    if (!fs::exists(kSwiftShader)) {
      if (std::getenv("CI")) FAIL() << "there is no SwiftShader (Debian package chromium-common)";
      GTEST_SKIP() << "there is no SwiftShader (Debian package chromium-common)";
    }
    ::setenv("VK_ADD_DRIVER_FILES", kSwiftShader, 1);
    ::setenv("ALCOVE_PRESETS", ALCOVE_SOURCE_DIR "/presets", 1);
    write_shot(2, kWindow);
    FrameFile frame = with_board(2, kWindow);
    write_plane(folder / "behind.exr", "Z", wall_frame(kWindow, kWindow).planes.at("ViewLayer.Depth.Z"), kWindow);
    add_beauty(frame);
    frame.write(input(2));
  }
  ~SecondDriver() override { ::unsetenv("VK_ADD_DRIVER_FILES"); }

  struct Result {
    std::vector<float> values;  // all floats that the run writes
    int parts = 0;
  };
  /// A run on the second frame, in tiles where it may take only so many bytes.
  Result computed(const std::string& device, const std::string& more, std::uint64_t bytes = 0) const {
    Options options = joined(arguments(typed("--type float --frames 2 --device " + device)), typed(more));
    options = joined(options, {"--stats", folder / "stats.json"});  // else no frame is in the report
    const bool composes = more.find("--composite") != std::string::npos;
    if (composes) options = joined(options, {composite});
    const RunReport report = run_here(options, bytes);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "") << more;
    if (report.done != 1) return {};
    EXPECT_THAT(lower_case(report.device), HasSubstr(device));
    Result result{read_exr_image(output(2)).pixels, report.frames[0].parts};
    if (composes) std::ranges::copy(read_exr_image(composite).pixels, std::back_inserter(result.values));
    return result;
  }
  /// What SwiftShader computes, which must be what lavapipe does.
  std::vector<float> compared(const std::string& more) {
    const auto first = computed("llvmpipe", more).values, second = computed("swiftshader", more).values;
    EXPECT_EQ(first.size(), second.size()) << more;
    if (first.size() != second.size() || first.empty()) return second;
    const double rms = difference(first, second).rmse;
    RecordProperty("rms" + more, fmt::format("{:.7f}", rms));
    EXPECT_LE(rms, 1e-4) << more;
    EXPECT_LT(*std::ranges::min_element(first), 0.9) << more << ": a frame that says little";
    return second;
  }
  void expect_same(const std::vector<float>& whole, const std::string& more, std::uint64_t bytes = 0) const {
    const Result result = computed("swiftshader", more, bytes);
    EXPECT_TRUE(bytes ? result.parts > 1 : result.parts == 1) << result.parts << more;
    EXPECT_TRUE(same_bits(result.values, whole)) << more;
  }

  const std::string composite = folder / "composite.exr";
};

TEST_F(SecondDriver, searches_slices_as_the_first_does) { compared("--slices 2 --steps 8"); }

TEST_F(SecondDriver, searches_exactly_as_the_first_does_and_the_same_bits_in_tiles) {
  if (!long_tests()) GTEST_SKIP() << "SwiftShader takes minutes for the kernel: see tests/long.sh";
  const std::string search = "--search exact --slices 2";
  expect_same(compared(search), search, kLittleMemory);
}

TEST_F(SecondDriver, takes_hidden_surfaces_as_the_first_does) {
  if (!long_tests()) GTEST_SKIP() << "SwiftShader takes minutes for the kernel: see tests/long.sh";
  compared("--search exact --slices 2 --behind " + (folder / "behind.exr"));
}

TEST_F(SecondDriver, accumulates_and_composes_as_the_first_does) {
  const std::string crytek = "--estimator crytek";
  const auto whole = compared(crytek);
  EXPECT_FALSE(same_bits(compared(crytek + " --accumulate 1"), whole));
  compared(crytek + " --composite");
  expect_same(whole, crytek, kLittleMemory);
  expect_same(whole, crytek + " --no-skip");
  expect_same(whole, crytek);
}

}  // namespace
}  // namespace alcove::second_driver_test
