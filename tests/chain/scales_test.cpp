// Several radii in one run: each is the run with it alone, and the AO their mean.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"
#include "core/formats/exr.h"
#include "core/run/resume.h"
#include "tests/support/chain.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"

namespace alcove::scales_test {
namespace {

using namespace test;
using Values = std::vector<float>;

/// Filters reach no farther than a part of the smallest radius, but as far as this in any case.
constexpr int kSameReach = 3;

EstimatorSettings settings_of(std::vector<double> radii, Estimator estimator = Estimator::gtao) {
  EstimatorSettings settings;  // the default passes
  settings.estimator = estimator;
  settings.radius = radii.front();
  settings.further_radii.assign(radii.begin() + 1, radii.end());
  return settings;
}

Values plane_of(const Values& planes, std::size_t i, const HostFrame& frame) {
  const auto from = planes.begin() + std::ptrdiff_t(i * frame.data.pixels());
  return {from, from + std::ptrdiff_t(frame.data.pixels())};
}

TEST(Scales, each_is_the_run_with_that_radius_alone_whatever_the_chain) {
  const HostFrame frame = furnished_room(96, 64).frame;
  const std::vector<double> radii{3, 4, 5};  // with a smaller one there are more sites, for all of them
  for (const Estimator estimator : {Estimator::gtao, Estimator::bitmask, Estimator::hbao, Estimator::crytek})
    for (const Resolution resolution : {Resolution::full, Resolution::half})
      for (const auto& [denoise, stride] :
           {std::pair{Denoise::none, 1}, {Denoise::bilateral, 1}, {Denoise::bilateral, 2}, {Denoise::bilateral, 16}}) {
        EstimatorSettings several = settings_of(radii, estimator);
        several.resolution = resolution;
        several.denoise = denoise;
        several.stride = stride;
        several.power = 1.5;
        several.denoise_radius = kSameReach;
        const Planes result = planes_of(frame, several, "ao,ao-scales");
        ASSERT_EQ(result.scales.size(), 3 * frame.data.pixels());
        EXPECT_TRUE(same_bits(planes_of(frame, several, "ao").ao, result.ao)) << "the scales change the AO";
        for (std::size_t i = 0; i < radii.size(); i++) {
          EstimatorSettings alone = several;
          alone.radius = radii[i];
          alone.further_radii.clear();
          EXPECT_TRUE(same_bits(plane_of(result.scales, i, frame), planes_of(frame, alone, "ao").ao))
              << "estimator " << int(estimator) << " resolution " << int(resolution) << " denoise " << int(denoise)
              << " radius " << radii[i];
        }
      }
}

/// The mean of three planes at a pixel.
std::function<double(std::size_t)> mean_of_three(const Values& planes) {
  return [&planes, pixels = planes.size() / 3](std::size_t i) {
    return (double(planes[i]) + planes[i + pixels] + planes[i + 2 * pixels]) / 3;
  };
}

TEST(Scales, ao_is_their_mean_shaped) {
  const HostFrame frame = furnished_room(121, 83).frame;
  for (const auto& [resolution, stride] :
       {std::pair{Resolution::full, 0}, {Resolution::full, 1}, {Resolution::quarter, 1}}) {
    EstimatorSettings settings = settings_of({0.1, 0.6, 2});
    settings.resolution = resolution;
    settings.stride = stride;
    const Planes plain = planes_of(frame, settings, "ao,ao-scales");
    const auto mean = mean_of_three(plain.scales);
    EXPECT_LE(difference(plain.ao, mean).max, 5e-5);
    EXPECT_LT(*std::ranges::min_element(plain.ao), 0.6f);
    settings.intensity = 1.2;
    settings.power = 1.4;
    const auto shaped = [&](std::size_t i) { return std::pow(std::max(0.0, 1 - 1.2 * (1 - mean(i))), 1.4); };
    EXPECT_LE(difference(planes_of(frame, settings, "ao").ao, shaped).max, 1e-4);
  }
}

// The filter reaches as far as each radius lets it: beside a small radius, a large one is as smooth as alone.
TEST(Scales, of_a_large_radius_is_as_alone) {
  const HostFrame frame = furnished_room(121, 83).frame;
  const std::size_t pixels = frame.depth.size();
  const Planes alone = planes_of(frame, settings_of({2}), "ao"),
               both = planes_of(frame, settings_of({0.1, 2}), "ao-scales");
  const Difference d = difference(alone.ao, [&](std::size_t i) { return double(both.scales[i + pixels]); });
  EXPECT_LE(d.rmse, 0.013) << place(d, frame);
}

TEST(Scales, order_changes_no_bit) {
  const HostFrame frame = furnished_room(61, 47).frame;
  const Planes first = planes_of(frame, settings_of({0.1, 0.6, 2}), "ao,ao-scales,bent-normal");
  for (const auto& radii : {std::vector<double>{2, 0.1, 0.6}, {0.6, 2, 0.1}}) {
    const Planes other = planes_of(frame, settings_of(radii), "ao,ao-scales,bent-normal");
    EXPECT_TRUE(same_bits(other.ao, first.ao));
    EXPECT_TRUE(same_bits(other.scales, first.scales));
    EXPECT_TRUE(same_bits(other.bent, first.bent));
  }
}

TEST(Scales, bent_normals_are_those_of_the_largest) {
  const HostFrame frame = furnished_room(61, 47).frame;
  EstimatorSettings both = settings_of({2, 0.1}), alone = settings_of({2});
  both.denoise_radius = alone.denoise_radius = kSameReach;
  both.stride = alone.stride = 1;  // sites depend on the smallest radius
  EXPECT_TRUE(same_bits(planes_of(frame, both, "bent-normal").bent, planes_of(frame, alone, "bent-normal").bent));
}

TEST(Scales, share_all_passes_but_the_search_and_the_fit) {
  const HostFrame frame = furnished_room(61, 47).frame;
  using Names = std::vector<std::string>;
  const auto expect_passes = [&](const EstimatorSettings& settings, const std::string& aovs,
                                 std::initializer_list<Names> parts) {
    Names expected{"prepare", "reconstruct"};
    for (const Names& part : parts) expected.insert(expected.end(), part.begin(), part.end());
    EXPECT_EQ(planes_of(frame, settings, aovs).passes, expected);
  };
  const Names sites{"sites"}, search{"classify", "list_sites", "chains", "chain_ends", "backs", "horizon"},
      dense_search{"classify", "chains", "chain_ends", "backs", "horizon"}, combine{"combine"}, fit{"fit_blocks"},
      spread{"spread_blocks"}, denoise{"denoise"};
  for (const char* aovs : {"ao", "ao,ao-scales"})
    expect_passes(settings_of({0.1, 0.6, 2}), aovs, {sites, search, search, search, fit, fit, fit, spread, combine});
  expect_passes(settings_of({0.6}), "ao,ao-scales", {sites, search, fit, spread});
  EstimatorSettings dense = settings_of({0.1, 0.6});
  dense.stride = 1;
  expect_passes(dense, "ao,ao-scales", {dense_search, dense_search, denoise, denoise, combine});
}

// Files and options.

class ScaleFiles : public CommandLine {
 protected:
  /// The input stands behind the radii, which must not swallow it.
  Finished run(const Options& more, const Launch& launch = {}) const override {
    return run_program(joined(joined({"run"}, more), {frame, "-o", ao, "--camera", camera}), launch);
  }
  Image good(const Options& more) const {
    done(more);
    return read_exr_image(ao);
  }
};

TEST_F(ScaleFiles, have_a_channel_each_from_the_smallest_radius_on) {
  const Options alike{"--set", "stride=1", "--set", fmt::format("denoise-radius={}", kSameReach)};
  const Image both =
      good(joined({"--type", "float", "--aov", "ao,ao-scales", "--radius", "2", "--radius", "0.5"}, alike));
  EXPECT_THAT(both.names, UnorderedElementsAre("Y", "scale1.Y", "scale2.Y"));
  EXPECT_EQ(text_in(read_header(ao), "alcove/radii"), "0.5 2");
  const Image small = good(joined({"--type", "float", "--radius", "0.5"}, alike)),
              large = good(joined({"--type", "float", "--radius", "2"}, alike));
  EXPECT_TRUE(std::ranges::equal(both.plane("scale1.Y"), small.plane("Y")));
  EXPECT_TRUE(std::ranges::equal(both.plane("scale2.Y"), large.plane("Y")));
  EXPECT_FALSE(std::ranges::equal(small.plane("Y"), large.plane("Y")));
  EXPECT_THAT(good({"--aov", "ao-scales", "--radius", "2"}).names, ElementsAre("scale1.Y"));
}

TEST_F(ScaleFiles, may_come_from_a_preset_and_are_printed_as_one) {
  const std::string preset = folder / "scales.toml";
  write_bytes(preset, "radius = [0.5, 2]\n");
  const Image typed = good({"--radius", "0.5", "--radius", "2"});
  EXPECT_TRUE(std::ranges::equal(good({"--preset", preset}).plane("Y"), typed.plane("Y")));
  EXPECT_TRUE(
      std::ranges::equal(good({"--preset", preset, "--radius", "3"}).plane("Y"), good({"--radius", "3"}).plane("Y")))
      << "options win";
  const std::string printed = run({"--radius", "0.5", "--radius", "2", "--print-config"}).out;
  EXPECT_THAT(printed, HasSubstr("radius=[0.5, 2]\n"));
  write_bytes(preset, printed);
  ASSERT_EQ(run_program({"run", frame, "--preset", preset}).code, 0);
  EXPECT_TRUE(std::ranges::equal(read_exr_image(ao).plane("Y"), typed.plane("Y")));
}

TEST_F(ScaleFiles, count_in_digest_and_statistics) {
  const auto digest = [](std::vector<double> radii) {
    Settings settings;
    settings.estimator = settings_of(std::move(radii));
    return options_digest(settings);
  };
  EXPECT_NE(digest({1}), digest({1, 2}));
  EXPECT_EQ(digest({1, 2}), digest({2, 1}));
  const json stats = stats_of(typed("--radius 1 --radius 2 --slices 2 --steps 5 --set stride=1"));
  EXPECT_NEAR(stats["frames"][0]["samples_per_pixel"].get<double>(), 2 * 2 * 2 * 5, 1e-9);
}

}  // namespace
}  // namespace alcove::scales_test
