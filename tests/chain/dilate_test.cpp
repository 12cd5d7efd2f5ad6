// What the filters leave out because of what tiles hold: the result has the bits of the whole.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/estimate/sites.h"
#include "core/chain/filters/filters.h"
#include "tests/support/chain.h"

namespace alcove::dilate_test {
namespace {

using namespace test;

/// A floor, on which any two neighbours mix.
HostFrame floor_of(int width, int height) {
  return render({{kFloor}}, Shot::perspective({0, -3, 3}, {0, 0, 0}, 30, width, height)).frame;
}

/// The denoiser, or upsampling from the settings' resolution.
struct Filter {
  HostFrame frame;
  EstimatorSettings settings;
  std::vector<uint> tiles;  // as classify leaves them
  std::vector<float> ao;    // where no tile is open

  ivec2 size() const {  // px of the estimate
    const int factor = int(settings.resolution);
    const auto blocks = [&](int begin, int pixels) { return (begin % factor + pixels + factor - 1) / factor; };
    return {blocks(frame.data.x - frame.display.x, frame.data.width),
            blocks(frame.data.y - frame.display.y, frame.data.height)};
  }
  int tile_columns() const { return (size().x + kTile - 1) / kTile; }
  uint tile_at(int x, int y) const { return tiles[std::size_t(y / kTile * tile_columns() + x / kTile)]; }
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(size().x) + std::size_t(x); }
};

/// What the filter makes of the frame after one with the visibility `before`: where it has work, as the tiles say, or
/// everywhere.
std::vector<float> run(const Filter& filter, const std::vector<float>& before, bool listed) {
  gpu::Recorder gpu(device());
  const FrameInputs inputs = upload(gpu, filter.frame);
  const GBuffer gbuffer = prepare(gpu, inputs);
  const GBuffer low = downsample(gpu, gbuffer, block_grid(inputs, int(filter.settings.resolution)));
  const Denoiser denoiser = denoiser_of(filter.settings);
  const Sites chosen = sites(gpu, low, site_rule_of(filter.settings));
  EXPECT_EQ(chosen.words != nullptr, filter.settings.stride > 1);
  const auto filtered = [&](gpu::Buffer& ao, const FilterRuns& runs) {
    return &upsample(gpu, gbuffer, low, smooth(gpu, low, ao, chosen, denoiser, "", runs), "", runs);
  };
  gpu::Buffer& ao = given("ao", before, gpu);
  gpu::Buffer& words = given("words", filter.tiles, gpu);
  filtered(ao, {});
  gpu.run();
  std::ranges::copy(filter.ao, ao.as<float>().begin());
  gpu.upload(ao);
  TileList list;
  list.kinds = &words;
  list.skips_surfaces = true;
  const FilterRuns runs = listed ? dilate(gpu, low, list, denoiser) : FilterRuns{};
  EXPECT_EQ(runs.rows.runs != nullptr, listed && !denoiser.weights.empty());
  EXPECT_EQ(runs.blocks.runs != nullptr, listed && filter.settings.resolution != Resolution::full);
  return downloaded<float>(*filtered(ao, runs), gpu);
}

EstimatorSettings filtering(int radius, int stride, Density density = Density::uniform) {
  EstimatorSettings settings = plain_settings();
  settings.denoise = Denoise::bilateral;
  settings.denoise_radius = radius;
  settings.stride = stride;
  settings.density = density;
  return settings;
}

TEST(Dilate, what_is_left_out_is_1_or_as_it_was) {
  std::mt19937 random(8);
  const auto whole = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  for (int round = 0; round < 240 && !HasFailure(); round++) {
    const EstimatorSettings settings = filtering(whole(0, 8), 1 << whole(0, 4), Density(round / 4 % 2));
    Filter filter{floor_of(whole(1, 120), whole(1, 120)), settings, {}, {}};
    if (round % 4 >= 2) {
      filter.settings.stride = 1;
      filter.settings.resolution = round % 8 < 4 ? Resolution::half : Resolution::quarter;
      filter.frame.data.x += whole(0, 3), filter.frame.data.y += whole(0, 3);
      if (round % 3 == 0) filter.settings.denoise = Denoise::none;
    }
    const int width = filter.size().x, height = filter.size().y, columns = filter.tile_columns();
    // One kind of tiles, and a few rectangles of the others on it.
    const uint kinds[] = {kTileOpen, kTileKept, kTileListed};
    filter.tiles.assign(std::size_t(columns * ((height + kTile - 1) / kTile)), kinds[round % 2]);
    for (int i = whole(0, 3); i > 0; i--)
      filter.tiles[std::size_t(whole(0, int(filter.tiles.size()) - 1))] = kinds[whole(0, 2)];
    filter.ao.assign(filter.at(width - 1, height - 1) + 1, 1.0f);
    std::vector<float> before = filter.ao;
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++) {
        const uint tile = filter.tile_at(x, y);
        if (tile != kTileOpen) filter.ao[filter.at(x, y)] = float(whole(0, 1000)) / 1000;
        before[filter.at(x, y)] = tile == kTileKept ? filter.ao[filter.at(x, y)] : float(whole(0, 1000)) / 1000;
      }
    EXPECT_TRUE(same_bits(run(filter, before, true), run(filter, before, false)))
        << width << " x " << height << ", radius " << filter.settings.denoise_radius << ", stride "
        << filter.settings.stride << ", round " << round;
  }
}

TEST(Dilate, nothing_is_filtered_where_nothing_can_change) {
  Filter filter{floor_of(77, 61), filtering(4, 1), {}, {}};
  filter.ao.assign(filter.at(76, 60) + 1, kNan);
  const std::vector<float> before(filter.ao.size(), 0.25f), ones(filter.ao.size(), 1.0f);
  filter.tiles.assign(80, kTileKept);
  EXPECT_EQ(run(filter, before, true), before) << "not read";
  filter.tiles.assign(80, kTileOpen);
  EXPECT_EQ(run(filter, before, true), ones) << "not read";
}

}  // namespace
}  // namespace alcove::dilate_test
