// The presets of the source systems: each gives what its own definition gives, evaluated slowly, in double, without
// noise (tests/bench/source_presets.exr).
// SPDX-License-Identifier: BSD-3-Clause
//
// The goldens are reference_estimate() of a preset's settings on a part of a rendered frame, one channel a preset; a
// test computes some of their pixels anew. After a change of a preset or a definition, write them with
//   build/tests/bench_tests --gtest_also_run_disabled_tests --gtest_filter='*writes_the_goldens'

#include "core/measure/metrics.h"
#include "core/reference/reference.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"

namespace alcove::source_presets_test {
namespace {

using namespace test;

const char* const kGoldens = ALCOVE_SOURCE_DIR "/tests/bench/source_presets.exr";
const std::vector<std::string> kPresets{"forfun-crytek", "forfun-gtao", "forfun-hbao",      "forfun-plan",
                                        "fp-asm",        "source15",    "taos-performance", "taos-quality"};

/// The two of Taos have no radius; all others have 0.5.
EstimatorSettings settings_of(const std::string& name) {
  EstimatorSettings settings = preset("source/" + name);
  if (!settings.radius) settings.radius = 0.5;
  return settings;
}

/// A part of the frame `monkeys`: an ear, a jaw, a box, and the ground behind them.
HostFrame part_of_frame() {
  const HostFrame whole = rendered_frame("monkeys");
  return crop_of(whole, {whole.data.x + 190, whole.data.y + 90, 160, 120});
}

std::vector<float> golden_of(const std::string& preset) { return read_exr_image(kGoldens, {preset}).pixels; }

class SourcePreset : public testing::TestWithParam<std::string> {};

TEST_P(SourcePreset, gives_what_its_definition_gives) {
  const HostFrame frame = part_of_frame();
  const std::vector<float> ao = ao_of(frame, settings_of(GetParam())), golden = golden_of(GetParam());
  const auto similarity = ssim(frame.data.width, frame.data.height, ao, golden);
  ASSERT_TRUE(similarity.has_value());
  RecordProperty("ssim", std::to_string(*similarity));
  EXPECT_GE(*similarity, 0.90);
  // A picture may be alike and too bright: the mean is right too. Four steps per side (forfun-plan) miss some
  // occluders: 0.025.
  EXPECT_LE(std::abs(compare_planes(ao, golden).bias), 0.04);
}

TEST_P(SourcePreset, is_the_one_that_its_golden_was_made_of) {
  const HostFrame frame = part_of_frame();
  std::vector<std::size_t> some;
  for (std::size_t i = 17; i < frame.data.pixels(); i += 191) some.push_back(i);
  const std::vector<float> reference = reference_estimate(frame, settings_of(GetParam()), some),
                           golden = golden_of(GetParam());
  for (const std::size_t i : some) EXPECT_NEAR(golden[i], reference[i], 1e-3) << "pixel " << i;
}

INSTANTIATE_TEST_SUITE_P(All, SourcePreset, testing::ValuesIn(kPresets), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

TEST(SourcePresets, are_these) {
  std::vector<std::string> files;
  for (const auto& preset : kPresets) files.push_back(preset + ".toml");
  EXPECT_EQ(names_in(ALCOVE_SOURCE_DIR "/presets/source"), files);
}

TEST(SourcePresets, DISABLED_writes_the_goldens) {
  const HostFrame frame = part_of_frame();
  const Window window{0, 0, frame.data.width, frame.data.height};
  FrameFile file{window, window, 1, {}, {kPresets.begin(), kPresets.end()}};
  for (const auto& preset : kPresets) file.planes[preset] = reference_estimate(frame, settings_of(preset));
  file.write(kGoldens);
}

}  // namespace
}  // namespace alcove::source_presets_test
