// What completed surfaces take of the visibility: who asks for it, its sums, its picture, and what is said of it.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/estimate.h"
#include "core/chain/results/debug.h"
#include "core/chain/reuse.h"
#include "core/run/frame_tally.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/site_frames.h"

namespace alcove::completion_test {
namespace {

using namespace test;

constexpr float kBefore = 0.5f;  // what stands in a plane before a pass that must leave it

TEST(Completion, behind_others_is_of_occluders_with_an_end) {
  for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek})
    for (const Completion complete : {Completion::none, Completion::border, Completion::all})
      for (const ThicknessKind thickness :
           {ThicknessKind::automatic, ThicknessKind::constant, ThicknessKind::infinite}) {
        EstimatorSettings settings;
        settings.estimator = estimator;
        settings.complete = complete;
        settings.thickness = thickness;
        const bool knows = estimator == Estimator::gtao || estimator == Estimator::bitmask;
        const bool ends = thickness != ThicknessKind::infinite;
        EXPECT_EQ(completes(settings), knows && ends && complete == Completion::all)
            << int(estimator) << int(complete) << int(thickness);
        EXPECT_EQ(completes_anywhere(settings), knows && complete != Completion::none)
            << int(estimator) << int(complete) << int(thickness);
        EXPECT_EQ(reach_of(settings, 1).complete, complete);
      }
}

/// A frame with sky on the device, at an odd place of its display window, and planes that a test fills by hand.
class CompletedPlanes : public testing::Test {
 protected:
  CompletedPlanes() {
    frame.data.x = frame.display.x + 3;
    frame.data.y = frame.display.y + 5;
    frame.camera.cx += 3;
    frame.camera.cy += 5;
    inputs = upload(recorder(), frame);
    gbuffer = reconstruct(recorder(), prepare(recorder(), inputs));
  }

  bool is_sky(int x, int y) const { return frame.depth[index(x, y)] >= kSky; }
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(frame.data.width) + std::size_t(x); }
  int width() const { return frame.data.width; }
  int height() const { return frame.data.height; }

  /// Whether a pixel is on the lattice of that spacing, which has the pixels beside the middles of blocks.
  static bool is_receiver(int x, int y, int spacing) { return is_on_lattice(x + 3 - 1, y + 5 - 1, spacing); }

  Sites sites_of(int spacing) const { return sites(recorder(), gbuffer, {spacing, false}); }

  /// Sixteenths, so that sums of them have no error.
  static float value(int x, int y, int factor) { return float((x * 3 + y * factor) % 17) / 16; }

  /// A plane that is NaN wherever the pass has no business.
  std::vector<float> receivers_only(int spacing, int factor) const {
    std::vector<float> values(frame.data.pixels(), kNan);
    for (int y = 0; y < height(); y++)
      for (int x = 0; x < width(); x++)
        if (is_receiver(x, y, spacing) && !is_sky(x, y)) values[index(x, y)] = value(x, y, factor);
    return values;
  }

  /// What a pixel shows: the value of the nearest receiver within 4 pixels in x and in y, of several the first row by
  /// row; 0 where there is none.
  float shown_at(int x, int y, int spacing) const {
    int nearest = 1000;
    float shown = 0;
    for (int j = std::max(y - 4, 0); j <= std::min(y + 4, height() - 1); j++)
      for (int i = std::max(x - 4, 0); i <= std::min(x + 4, width() - 1); i++) {
        const int distance = (i - x) * (i - x) + (j - y) * (j - y);
        if (distance >= nearest || !is_receiver(i, j, spacing) || is_sky(i, j)) continue;
        nearest = distance;
        shown = value(i, j, 7);
      }
    return shown;
  }

  HostFrame frame = furnished_room(161, 123).frame;
  FrameInputs inputs;
  GBuffer gbuffer;
};

TEST_F(CompletedPlanes, are_added_up_tile_by_tile_over_the_receivers_of_surfaces) {
  for (const int spacing : {1, 2, 4, 8, 16})
    for (const std::size_t radii : {1, 3}) {
      std::vector<float> ao(frame.data.pixels() * (radii - 1), kNan);
      const std::vector<float> largest = receivers_only(spacing, 5);
      ao.insert(ao.end(), largest.begin(), largest.end());
      Estimate estimate;
      estimate.ao = &given("ao of a test", ao);
      estimate.completed = &given("completed of a test", receivers_only(spacing, 7));
      gpu::Buffer* result = completion(recorder(), gbuffer, estimate, sites_of(spacing));
      ASSERT_NE(result, nullptr);
      const std::vector<float> sums = downloaded<float>(*result);
      const int columns = (width() + kTile - 1) / kTile;
      const int rows = (height() + kTile - 1) / kTile;
      std::vector<float> expected(std::size_t(2 * columns * rows), 0.0f);
      int receivers = 0;
      for (int y = 0; y < height(); y++)
        for (int x = 0; x < width(); x++) {
          if (!is_receiver(x, y, spacing) || is_sky(x, y)) continue;
          const std::size_t tile = std::size_t(y / kTile * columns + x / kTile);
          expected[2 * tile] += value(x, y, 7);
          expected[2 * tile + 1] += 1 - value(x, y, 5);
          receivers++;
        }
      EXPECT_EQ(sums, expected) << "spacing " << spacing << ", radii " << radii;
      EXPECT_GT(receivers * spacing, 100);
      EXPECT_LT(receivers * spacing, width() * height()) << "or else no sky was left out";
    }
}

TEST_F(CompletedPlanes, are_shown_in_grey_from_0_to_1_and_sky_apart) {
  OutputSettings settings;
  settings.debug = "completed";
  const DebugView& view = *debug_views_of(settings).at(0);
  EXPECT_TRUE(view.is_grey && view.scale == DebugScale::fixed && view.low == 0 && view.high == 1);
  for (const int spacing : {1, 2, 4, 8, 16}) {
    DebugStages stages{gbuffer};
    stages.raw_ao = &given("ao of a test", std::vector<float>(frame.data.pixels(), kBefore));
    stages.denoised_ao = stages.raw_ao;
    stages.sites = sites_of(spacing);
    stages.completed = &given("completed of a test", receivers_only(spacing, 7));
    const DebugPlane shown = debug(recorder(), view, gbuffer, stages, inputs);
    const std::vector<float> values = downloaded<float>(*shown.values);
    for (int y = 0; y < height(); y++)
      for (int x = 0; x < width(); x++) {
        if (is_sky(x, y)) ASSERT_EQ(values[index(x, y)], kSkyDepth) << x << " " << y;
        if (is_sky(x, y)) continue;
        ASSERT_EQ(values[index(x, y)], shown_at(x, y, spacing)) << x << " " << y << " spacing " << spacing;
      }
  }
}

TEST_F(CompletedPlanes, are_0_in_tiles_that_are_left_out_and_else_as_they_were) {
  const float radius = 0.05f;
  Reach reach{};
  reach.radius = reach.front = radius;
  // What nobody needs is left out too.
  const Skipping skipping{.skips_sky = true, .changes = nullptr, .needed = {{20, 12}, gbuffer.view.size}};
  for (const int spacing : {1, 4, 16}) {
    Estimate out;
    out.ao = &given("ao of a test", std::vector<float>(frame.data.pixels(), kBefore));
    out.completed = &given("completed of a test", std::vector<float>(frame.data.pixels(), kBefore));
    const TileList list = classify(recorder(), gbuffer, skipping, reach, sites_of(spacing), out);
    recorder().download(*list.kinds);
    recorder().download(*out.ao);
    const std::vector<float> completed = downloaded<float>(*out.completed);
    const auto ao = out.ao->as<const float>();
    const auto kinds = list.kinds->as<const uint>();
    int open = 0;  // of surfaces
    for (int y = 0; y < height(); y++)
      for (int x = 0; x < width(); x++) {
        const std::size_t tile = std::size_t(y / kTile * ((width() + kTile - 1) / kTile) + x / kTile);
        // Where not every pixel is a receiver, none of the sky is.
        const bool is_written = is_receiver(x, y, spacing) && (spacing == 1 || !is_sky(x, y));
        const bool is_open = kinds[tile] == kTileOpen && is_written;
        ASSERT_EQ(completed[index(x, y)], is_open ? 0 : kBefore) << x << " " << y << " spacing " << spacing;
        ASSERT_EQ(ao[index(x, y)], is_open ? 1 : kBefore) << x << " " << y << " spacing " << spacing;
        open += is_open && !is_sky(x, y);
      }
    EXPECT_GT(open, 0);
    EXPECT_LT(open, width() * height() / spacing);
  }
}

/// Every way to search that completes, without filters, so that the AO is the estimate.
std::vector<EstimatorSettings> searches() {
  EstimatorSettings plain = plain_settings();
  plain.radius = 0.6;
  plain.thickness = ThicknessKind::automatic;
  std::vector<EstimatorSettings> all(6, plain);
  all[1].estimator = Estimator::bitmask;
  all[2].search = SliceSearch::exact;
  all[3].tolerance = 0.05;
  all[4].steps = 64;
  all[5].complete = Completion::border;
  return all;
}

OutputSettings with_stats() {
  OutputSettings output;
  output.stats = "stats.json";
  return output;
}

TEST(Completion, takes_no_more_than_is_blocked_and_changes_no_bit_where_it_is_asked_for) {
  const HostFrame frame = furnished_room(80, 60).frame;
  for (const EstimatorSettings& settings : searches()) {
    const std::vector<float> before = compute_ao(recorder(), frame, settings).ao;
    const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, with_stats());
    ASSERT_NE(outputs.completed, nullptr);
    ASSERT_NE(outputs.completion, nullptr);
    recorder().download(*outputs.completed);
    recorder().run();
    const auto completed = outputs.completed->as<const float>();
    const auto ao = outputs.ao->as<const float>();
    EXPECT_TRUE(std::ranges::equal(ao, before)) << int(settings.estimator) << int(settings.search);
    double by_completed = 0;
    double whole = 0;
    for (std::size_t i = 0; i < ao.size(); i++) {
      ASSERT_GE(completed[i], 0) << i;
      ASSERT_LE(completed[i], 1 - ao[i] + 1e-5f) << i;
      by_completed += completed[i];
      whole += 1 - ao[i];
    }
    vec2 sums{};
    for (const vec2& tile : outputs.completion->as<const vec2>()) {
      sums.x += tile.x;
      sums.y += tile.y;
    }
    EXPECT_NEAR(sums.x, by_completed, 1e-4 * whole);
    EXPECT_NEAR(sums.y, whole, 1e-4 * whole);
    EXPECT_GT(whole, 0);
  }
}

TEST(Completion, is_made_only_where_something_is_completed_and_somebody_asks) {
  const HostFrame frame = furnished_room(64, 36).frame;
  const auto is_made = [&](const EstimatorSettings& settings, const OutputSettings& output) {
    const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
    recorder().run();
    EXPECT_EQ(outputs.completed != nullptr, outputs.completion != nullptr);
    return outputs.completed != nullptr;
  };
  OutputSettings shown, hidden;  // a view of it needs the estimate
  shown.aovs = hidden.aovs = "depth";
  shown.debug = "completed";
  hidden.debug = "raw-ao";
  EXPECT_TRUE(is_made(searches().front(), shown));
  EXPECT_FALSE(is_made(searches().front(), hidden));
  for (EstimatorSettings settings : searches()) {
    EXPECT_TRUE(is_made(settings, with_stats()));
    EXPECT_FALSE(is_made(settings, {}));
    settings.complete = Completion::none;
    EXPECT_FALSE(is_made(settings, with_stats()));
  }
  for (const Estimator estimator : {Estimator::hbao, Estimator::crytek})
    EXPECT_FALSE(is_made(sampled(estimator, 0.6, 3, 6), with_stats()));
}

TEST(Completion, stays_in_tiles_that_are_as_in_the_frame_before) {
  EstimatorSettings settings = searches().front();
  settings.radius = 0.05;
  HostFrame frame = furnished_room(256, 192).frame;
  LastFrame last;
  const auto run = [&](FrameInputs inputs) {
    EXPECT_FALSE(last.is_same(recorder(), inputs, settings));
    const FrameOutputs outputs = run_chain(recorder(), inputs, settings, with_stats());
    recorder().download(*outputs.completed);
    recorder().run();
    last.keep(outputs);
    return outputs;
  };
  gpu::Buffer& completed = *run(upload(recorder(), frame)).completed;
  std::ranges::fill(completed.as<float>(), kBefore);
  recorder().upload(completed);
  frame.depth.back() *= 0.999f;
  const FrameOutputs outputs = run(upload(recorder(), frame));
  ASSERT_GT(outputs.tiles->as<TileCounts>()[0].kept, 0);
  const auto values = outputs.completed->as<const float>();
  const auto kept = std::ranges::count(values, kBefore);
  EXPECT_GT(kept, std::ptrdiff_t(values.size() / 4));
  double by_completed = 0;
  for (const vec2& tile : outputs.completion->as<const vec2>()) by_completed += tile.x;
  EXPECT_GE(by_completed, kBefore * double(values.size() / 4)) << "what stays counts";
}

/// The report of a frame whose parts have these sums by tile.
json report_of(const std::vector<std::vector<vec2>>& parts) {
  FrameReport report;
  FrameTally tally(report);
  gpu::Buffer& counts = recorder().buffer("counts of a test", sizeof(FrameCounts), gpu::Use::upload);
  counts.as<FrameCounts>()[0] = {};
  for (const auto& tiles : parts) {
    FrameOutputs outputs;
    outputs.counts = &counts;
    outputs.completion = &recorder().buffer("sums of a test", tiles.size() * sizeof(vec2), gpu::Use::upload);
    std::ranges::copy(tiles, outputs.completion->as<vec2>().begin());
    tally.add_outputs(outputs, {0, 0, 8, 8}, false);
  }
  return json::parse(frame_json(report));
}

TEST(Completion, of_a_frame_is_its_share_of_all_that_is_blocked_in_all_parts) {
  EXPECT_EQ(report_of({{{1, 4}, {0, 2}}}).at("completed"), 1.0 / 6);
  EXPECT_EQ(report_of({{{1, 4}, {0, 2}}, {{2, 2}}}).at("completed"), 3.0 / 8) << "not the mean of the parts' shares";
  EXPECT_EQ(report_of({{{0, 0}}}).at("completed"), 0) << "nothing is occluded";
  EXPECT_FALSE(report_of({}).contains("completed"));
}

TEST(Completion, of_millions_of_tiles_loses_none) {
  // From 2^24 on single precision has no odd numbers.
  const std::vector<vec2> tiles(std::size_t(1) << 19, vec2{21, 63});
  const double count = 3 * double(tiles.size());
  EXPECT_EQ(report_of({tiles, tiles, tiles, {{0, 64}}}).at("completed"), 21 * count / (63 * count + 64));
}

class CompletionStats : public CommandLine {
 protected:
  /// What the statistics say of the frame.
  json stats_of(const Options& more) const { return CommandLine::stats_of(more)["frames"][0]; }
};

TEST_F(CompletionStats, are_there_wherever_ao_is_and_0_where_nothing_is_completed) {
  for (const char* more : {"--set complete=none", "--estimator hbao", "--estimator crytek"})
    EXPECT_EQ(stats_of(typed(more)).at("completed"), 0) << more;
  for (const char* more : {"", "--set complete=border", "--resolution half", "--search exact"}) {
    const json share = stats_of(typed(more)).at("completed");
    EXPECT_TRUE(share.is_number() && share >= 0 && share <= 1) << share << more;
  }
  EXPECT_FALSE(stats_of({"--aov", "depth"}).contains("completed"));
}

TEST_F(CompletionStats, of_sky_are_0) {
  FrameFile input = wall_frame();
  std::ranges::fill(input.planes["ViewLayer.Depth.Z"], 1e10f);
  input.write(frame);
  EXPECT_EQ(stats_of({}).at("completed"), 0);
  EXPECT_EQ(stats_of({"--no-skip"}).at("completed"), 0);
}

TEST_F(CompletionStats, and_views_change_no_bit_of_the_ao_and_are_in_no_log_that_nobody_made_them_for) {
  const std::string log = folder / "log";
  done({"--log-json", log});
  EXPECT_THAT(read_bytes(log), Not(HasSubstr("\"completed\"")));
  const std::string before = read_bytes(ao);
  stats_of({"--log-json", log, "--set", "debug=completed"});
  EXPECT_THAT(read_bytes(log), HasSubstr("\"completed\""));
  EXPECT_TRUE(read_bytes(ao) == before);
}

TEST_F(CompletionStats, of_a_view_without_any_are_refused) {
  for (const auto& [option, value, words] :
       {std::tuple{"--set", "complete=none", "border"}, {"--estimator", "hbao", "gtao and bitmask"}})
    expect_refused(2, {option, value, "--set", "debug=completed"}, {"--set debug=completed", value, words});
}

}  // namespace
}  // namespace alcove::completion_test
