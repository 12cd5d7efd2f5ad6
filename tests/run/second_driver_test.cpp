// SwiftShader, which Debian has in chromium-common, computes what lavapipe does, and the same to the bit in other ways.
// SPDX-License-Identifier: BSD-3-Clause
//
// It takes half a minute for a kernel of horizon.comp, and seconds for others, so these stand for them where they can.
#include "core/base/text.h"
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

  /// All floats that a run on the second frame writes, in tiles where it may take only so many bytes.
  std::vector<float> computed(const std::string& device, const std::string& more, std::uint64_t bytes = 0) const {
    Options options = joined(arguments(typed("--type float --frames 2 --device " + device)), typed(more));
    const bool composes = more.find("--composite") != std::string::npos;
    if (composes) options = joined(options, {composite});
    const RunReport report = run_here(options, bytes);
    EXPECT_EQ(report.done, 1) << (report.stop ? report.stop->what() : "") << more;
    if (report.done != 1) return {};
    EXPECT_THAT(lower_case(report.device), HasSubstr(device));
    std::vector<float> values = read_exr_image(output(2)).pixels;
    if (composes) {
      const auto colors = read_exr_image(composite).pixels;
      values.insert(values.end(), colors.begin(), colors.end());
    }
    return values;
  }

  const std::string composite = folder / "composite.exr";
};

TEST_F(SecondDriver, computes_what_the_first_does) {
  for (const std::string& more :
       {std::string("--slices 2 --steps 8"), std::string("--search exact --slices 2"),
        std::string("--estimator crytek"), "--search exact --slices 2 --behind " + (folder / "behind.exr"),
        std::string("--search exact --slices 2 --accumulate 1"),
        std::string("--search exact --slices 2 --composite")}) {
    const auto first = computed("llvmpipe", more), second = computed("swiftshader", more);
    ASSERT_EQ(first.size(), second.size());
    double squares = 0;
    for (std::size_t i = 0; i < first.size(); i++) squares += std::pow(double(first[i]) - second[i], 2);
    const double rms = std::sqrt(squares / double(first.size()));
    RecordProperty(more, fmt::format("{:.7f}", rms));
    EXPECT_LE(rms, 1e-4) << more;
    EXPECT_LT(*std::ranges::min_element(first), 0.9) << more << ": a frame that says little";
  }
}

TEST_F(SecondDriver, gives_the_same_bits_in_tiles_without_skipping_and_again) {
  for (const std::string more : {"--estimator crytek", "--search exact --slices 2"}) {
    const auto whole = computed("swiftshader", more);
    EXPECT_TRUE(same_bits(computed("swiftshader", more, kLittleMemory), whole)) << more;
    EXPECT_TRUE(same_bits(computed("swiftshader", more + " --no-skip"), whole)) << more;
    EXPECT_TRUE(same_bits(computed("swiftshader", more), whole)) << more;
  }
}

}  // namespace
}  // namespace alcove::second_driver_test
