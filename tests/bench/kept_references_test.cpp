// The CPU references of the benchmark's small frames, which are kept in files: each is what reference.cpp computes, and
// none is taken for another.
// SPDX-License-Identifier: BSD-3-Clause
//
// With every change some pixels of each are computed anew, with ALCOVE_TEST_LONG all. After a change of the reference
// or of what the presets ask of it, write them with
//   build/tests/bench_tests --gtest_also_run_disabled_tests --gtest_filter='*writes_them'

#include "core/bench/bench.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"

namespace alcove::kept_references_test {
namespace {

using namespace test;

/// Half floats from 0.5 to 1 are 2^-11 apart.
constexpr float kRounding = 0x1p-12f;

Suite suite() { return read_suite(ALCOVE_SOURCE_DIR "/examples/bench/suite.toml", ""); }

ReferenceSettings reference_of(const SuiteCandidate& candidate, const SuiteFrame& frame, int slices) {
  EstimatorSettings estimator = estimator_of(candidate.arguments);
  estimator.radius = frame.radius;
  ReferenceSettings settings = reference_settings_of(estimator);
  settings.slices = slices;
  return settings;
}

/// Rounded to half floats.
void write_kept_reference(const std::string& path, const ReferenceSettings& settings, const HostFrame& frame,
                          const std::vector<float>& ao) {
  FrameFile{frame.data, frame.display, 1, {{"Y", ao}}, {"Y"}, {{"alcove/reference", text_of(settings)}}}.write(path);
}

TEST(KeptReferences, are_what_the_reference_computes) {
  const Suite all = suite();
  for (const auto& frame : all.frames) {
    const HostFrame host = rendered_frame(frame.name);
    ReferenceSettings settings = reference_of(all.candidates.front(), frame, all.reference_slices);
    const std::vector<float> kept = read_kept_reference(frame.reference, settings, host.data);
    ASSERT_EQ(kept.size(), host.data.pixels()) << frame.name;
    for (std::size_t i = 17; i < kept.size(); i += long_tests() ? 1 : 397) settings.pixels.push_back(i);
    const std::vector<float> computed = reference_ao(host, settings);
    int surfaces = 0;
    for (const std::size_t i : settings.pixels) {
      surfaces += computed[i] < 1;
      ASSERT_NEAR(kept[i], computed[i], kRounding) << frame.name << " pixel " << i;
    }
    EXPECT_GT(surfaces, 50) << frame.name;
  }
}

// Else the suite would compute them, which takes over a minute.
TEST(KeptReferences, are_those_of_all_presets) {
  const Suite all = suite();
  for (const auto& frame : all.frames)
    for (const auto& candidate : all.candidates)
      EXPECT_EQ(attribute_of_whole_exr(frame.reference, "alcove/reference"),
                text_of(reference_of(candidate, frame, all.reference_slices)))
          << frame.name << " " << candidate.name;
}

TEST(KeptReferences, are_taken_for_the_settings_they_were_made_with_alone) {
  const TemporaryFolder folder;
  const std::string path = folder / "kept.exr";
  HostFrame frame;
  frame.data = frame.display = {0, 0, 3, 2};
  ReferenceSettings made;
  made.radius = 0.7;
  const std::vector<float> ao{1, 0.5f, 0.25f, 0, 0.75f, 1};
  write_kept_reference(path, made, frame, ao);
  EXPECT_EQ(read_kept_reference(path, made, frame.data), ao);
  std::vector<ReferenceSettings> others(10, made);
  others[0].radius = 0.71;
  others[1].falloff = Falloff::linear;
  others[2].falloff_start = 0.1;
  others[3].slices = 17;
  others[4].thickness = ThicknessRule::width;
  others[5].thickness_length = 0.1;
  others[6].bias = 0.1;
  others[7].width_share = 0.5;
  others[8].width_pixels = 1;
  others[9].complete = Completion::border;
  for (std::size_t i = 0; i < others.size(); i++)
    EXPECT_TRUE(read_kept_reference(path, others[i], frame.data).empty()) << i;
}

TEST(KeptReferences, of_suites_from_before_lists_were_those_of_compare_too) {
  const TemporaryFolder folder;
  const std::string path = folder / "suite.toml";
  write_bytes(path, R"(title = "t"
[[candidate]]
name = "c"
[[frame]]
name = "f"
input = "f.exr"
camera = "f.json"
radius = 1
truth = "t.exr"
reference = "kept.exr"
)");
  EXPECT_EQ(read_suite(path, "").frames.at(0).reference, folder / "kept.exr");
}

TEST(KeptReferences, of_another_window_or_none_at_all_are_refused) {
  const TemporaryFolder folder;
  const std::string path = folder / "kept.exr";
  HostFrame frame;
  frame.data = frame.display = {0, 0, 3, 2};
  ReferenceSettings settings;
  settings.radius = 1;
  write_kept_reference(path, settings, frame, std::vector<float>(6, 1.0f));
  const auto expect_refused = [&](const std::string& of, const Window& data, const std::string& word) {
    expect_error(ErrorKind::input, {word}, [&] { read_kept_reference(of, settings, data); });
  };
  expect_refused(path, {0, 0, 2, 3}, path);
  expect_refused(path, {1, 0, 3, 2}, path);
  expect_refused(ALCOVE_SOURCE_DIR "/examples/bench/machine.ao.a.exr", {0, 0, 3, 2}, "alcove/reference");
}

TEST(KeptReferences, are_what_a_suite_measures_against) {
  const TemporaryFolder folder;
  Suite all = suite();
  const auto machine = std::ranges::find(all.frames, "machine", &SuiteFrame::name);
  all.frames = {*machine};
  all.repeats = 1;
  SuiteFrame& frame = all.frames.front();
  frame.reference = folder / "kept.exr";
  const HostFrame host = rendered_frame(frame.name);
  constexpr float kKept = 0.25f;
  write_kept_reference(frame.reference, reference_of(all.candidates.front(), frame, all.reference_slices), host,
                       std::vector<float>(host.data.pixels(), kKept));
  BenchCandidate candidate{"draft", "", estimator_of(all.candidates.front().arguments)};
  candidate.estimator.radius.reset();
  const BenchReport report = run_bench(device(), all, {candidate}, {});
  double sum = 0, surfaces = 0;
  for (std::size_t i = 0; i < host.depth.size(); i++) {
    if (!(host.depth[i] < host.sky)) continue;
    sum += std::pow(report.rows.at(0).ao[i] - kKept, 2);
    surfaces++;
  }
  EXPECT_NEAR(report.rows[0].estimator_rmse.value(), std::sqrt(sum / surfaces), 1e-6);
}

TEST(KeptReferences, DISABLED_writes_them) {
  const Suite all = suite();
  for (const auto& frame : all.frames) {
    const HostFrame host = rendered_frame(frame.name);
    const ReferenceSettings settings = reference_of(all.candidates.front(), frame, all.reference_slices);
    write_kept_reference(frame.reference, settings, host, reference_ao(host, settings));
  }
}

}  // namespace
}  // namespace alcove::kept_references_test
