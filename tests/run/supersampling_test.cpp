// Depth and normals that are so many times larger than what is written: it is filtered as a renderer filters its
// samples.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"
#include "tests/support/scenes.h"

namespace alcove::supersampling_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

const Window kSmall = kWallWindow;

Window times(const Window& window, int factor) {
  return {window.x * factor, window.y * factor, window.width * factor, window.height * factor};
}

/// At a distance from the middle, in px of the picture.
double weight(const std::string& filter, double width, double distance) {
  const double x = std::abs(distance) / width;
  if (x > 0.5) return 0;
  if (filter == "box") return 1;
  if (filter == "gaussian") return std::exp(-2 * 4 * x * x);
  const double turn = 2 * std::numbers::pi * (x + 0.5);
  return 0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2 * turn) - 0.01168 * std::cos(3 * turn);
}

/// A plane over `large` as a renderer filters it to the pixels of `small`, for display windows that begin at 0, 0.
Plane filtered(const Plane& plane, const Window& large, const Window& small, int factor, const std::string& filter,
               double width) {
  Plane result;
  for (int y = small.y; y < small.y + small.height; y++)
    for (int x = small.x; x < small.x + small.width; x++) {
      double sum = 0, weights = 0;
      for (int v = large.y; v < large.y + large.height; v++) {
        const double of_row = weight(filter, width, (v + 0.5) / factor - (y + 0.5));
        if (of_row == 0) continue;
        for (int u = large.x; u < large.x + large.width; u++) {
          const double w = of_row * weight(filter, width, (u + 0.5) / factor - (x + 0.5));
          sum += w * plane[std::size_t(v - large.y) * std::size_t(large.width) + std::size_t(u - large.x)];
          weights += w;
        }
      }
      result.push_back(float(sum / weights));
    }
  return result;
}

class Supersampling : public CommandLine {
 protected:
  /// The wall, with blocks before it that make edges everywhere.
  void write_frame(const Window& data, const Window& display) const {
    FrameFile file = wall_frame(data, display);
    auto& depth = file.planes.at("ViewLayer.Depth.Z");
    for (std::size_t i = 0; i < depth.size(); i++)
      depth[i] -= 0.1f * float((7 * (i % std::size_t(data.width) / 5) + 13 * (i / std::size_t(data.width) / 4)) % 5);
    file.write(frame);
    write_bytes(camera, wall_camera(display).dump());
  }

  void write_beauty(const Window& data, const Window& display) const { beauty_over(data, display).write(beauty); }

  /// Expects of every channel of a picture that it is that of larger planes as a renderer filters them.
  void expect_filtered(const Image& small, const Image& full, int factor, const std::string& filter = "blackman-harris",
                       double width = 3) const {
    EXPECT_EQ(small.display, kSmall);
    ASSERT_EQ(small.names, full.names);
    for (const auto& name : full.names) {
      const auto plane = full.plane(name), result = small.plane(name);
      const Plane expected = filtered({plane.begin(), plane.end()}, full.data, small.data, factor, filter, width);
      if (name != "Z") EXPECT_LT(difference({result.begin(), result.end()}, expected).max, 1e-6) << name;
    }
  }

  const std::string beauty = folder / "beauty.exr", composite = folder / "composite.exr";
  const Options composed{"--beauty", beauty, "--composite", composite};
};

struct FilterCase {
  int factor;
  std::string filter;
  double width;
  const char* more;
};

TEST_F(Supersampling, filters_as_the_formulas_say) {
  for (const FilterCase& c : {FilterCase{2, "blackman-harris", 3, ""},
                              {2, "box", 1, "--set filter=box"},
                              {4, "gaussian", 2, "--set filter=gaussian"},
                              {2, "gaussian", 3.5, "--set filter=gaussian --set filter-width=3.5"},
                              {3, "box", 2, "--set filter=box --set filter-width=2"}}) {
    SCOPED_TRACE(std::to_string(c.factor) + " " + c.filter);
    const Window display = times(kSmall, c.factor);
    write_frame(display, display);
    const Image full = computed({});
    const Image small = computed(typed(fmt::format("--set supersampling={} {}", c.factor, c.more)));
    EXPECT_EQ(small.data, kSmall);
    EXPECT_EQ(text_in(read_header(ao), "alcove/filter"),
              fmt::format("{} x {} px by {} {}", c.factor, c.factor, c.filter, c.width));
    expect_filtered(small, full, c.factor, c.filter, c.width);
    const Plane expected = filtered(full.pixels, display, kSmall, c.factor, c.filter, c.width);
    EXPECT_GT(difference(expected, filtered(full.pixels, display, kSmall, c.factor, "box", 4)).max, 0.01)
        << "else any filter would do";
  }
}

TEST_F(Supersampling, a_picture_has_the_pixels_whose_middle_the_depth_has) {
  struct Windows {
    Window depth, picture;
  };
  // The middle of a block of 2 is its lower right pixel.
  for (const auto& [depth, picture] :
       {Windows{{-7, -3, 140, 80}, {-4, -2, 70, 40}}, Windows{{13, 8, 61, 30}, {6, 4, 31, 15}},
        Windows{{12, 7, 61, 31}, {6, 3, 30, 16}}}) {
    write_frame(depth, times(kSmall, 2));
    const Image full = computed({}), small = computed({"--set", "supersampling=2"});
    EXPECT_EQ(small.data, picture);
    expect_filtered(small, full, 2);
  }
}

TEST_F(Supersampling, a_smaller_beauty_needs_it_and_takes_the_filtered_ao) {
  for (const auto& [factor, window] : {std::pair(2, kSmall), {3, Window{-3, 2, 40, 50}}, {4, Window{-3, 2, 40, 50}}}) {
    const Window display = times(kSmall, factor);
    write_frame(display, display);
    const std::string mend = fmt::format("--set supersampling={}", factor);
    const Image filtered_ao = computed(typed(mend));
    write_beauty(window, kSmall);
    expect_refused(3, composed, {"beauty.exr", fmt::format("{} times as large", factor), mend});
    done(joined(composed, typed("--type float --set append-ao=AO " + mend)));
    EXPECT_EQ(read_exr_image(ao).pixels, filtered_ao.pixels);
    const Image result = read_exr_image(composite);
    EXPECT_EQ(result.data, window);
    EXPECT_EQ(result.display, kSmall);
    for (int y = window.y; y < window.y + window.height; y++)
      for (int x = window.x; x < window.x + window.width; x++) {
        const auto at = std::size_t(y - window.y) * std::size_t(window.width) + std::size_t(x - window.x);
        const bool has_ao = x >= 0 && y >= 0 && x < kSmall.width && y < kSmall.height;
        const float ao_there =
            has_ao ? filtered_ao.pixels[std::size_t(y) * std::size_t(kSmall.width) + std::size_t(x)] : 1;
        ASSERT_EQ(result.plane("AO.Y")[at], ao_there) << x << ", " << y;
        for (int c = 0; c < 3; c++)
          ASSERT_NEAR(result.plane(std::string(1, "RGB"[c]))[at], ao_there * beauty_at(x, y, c), 1e-6)
              << x << ", " << y;
      }
  }
}

TEST_F(Supersampling, a_region_counts_in_pixels_of_the_picture_and_has_the_bits_of_the_whole) {
  const Window display = times(kSmall, 3), region{11, 7, 30, 20};
  write_frame(display, display);
  write_beauty(kSmall, kSmall);
  // A filter that reaches farther than all else.
  const Options options = joined(
      composed, typed("--set supersampling=3 --set filter=box --set filter-width=16 --denoise none --radius 0.1"));
  const Image whole = computed(options), whole_composite = read_exr_image(composite);
  const Image part = computed(joined(options, {"--roi", "11,7,30,20"}));
  EXPECT_EQ(part.data, region);
  EXPECT_EQ(part.pixels, cropped(whole.pixels, kSmall, region));
  const Image part_composite = read_exr_image(composite);
  EXPECT_EQ(part_composite.data, region);
  EXPECT_EQ(part_composite.pixels, cropped(whole_composite.pixels, kSmall, region));
  expect_refused(2, typed("--set supersampling=3 --roi 40,7,30,20"), {"30x20 at (40, 7)", to_string(kSmall)});
}

TEST_F(Supersampling, amounts_and_directions_are_filtered_and_depth_is_that_of_the_middle) {
  const Window display = times(kSmall, 2);
  write_frame(display, display);
  // Multi-bounce is that of each sample.
  const std::string lights = folder / "lights.json";
  write_bytes(lights, R"({"lights": [{"name": "key", "kind": "sun", "direction": [0, 1, 2]}]})");
  const Options aovs = typed(
      "--radius 0.4 --set aov-space=view --set ao-channels=rgb --set multi-bounce=true --set albedo=0.8 "
      "--aov ao,normal,bent-normal,transfer,depth,confidence,specular-occlusion,ao-scales,shadow --lights " +
      lights);
  const Image full = computed(aovs), small = computed(joined(aovs, {"--set", "supersampling=2"}));
  expect_filtered(small, full, 2);
  for (std::size_t i = 0; i < kSmall.pixels(); i++)
    ASSERT_EQ(small.plane("Z")[i], full.plane("Z")[(2 * (i / 64) + 1) * 128 + 2 * (i % 64) + 1]) << i;
}

TEST_F(Supersampling, a_matte_of_the_pictures_size_counts_for_its_blocks) {
  const Window display = times(kSmall, 2);
  write_frame(display, display);
  const auto by_matte = [&](const Window& window, int factor) {
    Plane matte;
    for (int y = 0; y < window.height; y++)
      for (int x = 0; x < window.width; x++)
        matte.push_back(x / factor > 20 && (x / factor + y / factor) % 11 > 3 ? 1.0f : 0.0f);
    write_plane(folder / "matte.exr", "Y", matte, window);
    return computed({"--set", "supersampling=2", "--matte", folder / "matte.exr"}).pixels;
  };
  const Plane by_large = by_matte(display, 2);
  EXPECT_EQ(by_matte(kSmall, 1), by_large);
  EXPECT_NE(computed({"--set", "supersampling=2"}).pixels, by_large);
}

TEST_F(Supersampling, a_preview_is_as_large_as_the_picture) {
  const Window display = times(kSmall, 2);
  const std::string preview = folder / "preview.png";
  write_frame(display, display);
  write_beauty(kSmall, kSmall);
  for (const char* style : {"ao", "composite"}) {
    done(joined(composed,
                {"--preview", preview, "--set", std::string("preview-style=") + style, "--set", "supersampling=2"}));
    EXPECT_EQ(open_image(preview, "the test", Formats::all).parts()[0].data, kSmall);
  }
  // Two bytes of a PNG may differ by rounding.
  done(typed("--type float --set supersampling=2 --preview " + preview));
  run_well({"compare", preview, ao, "--max-rmse", "0.003"});
}

TEST_F(Supersampling, sky_counts_as_open) {
  const Window display = times(kSmall, 2);
  FrameFile file = wall_frame(display, display);
  Plane& depth = file.planes.at("ViewLayer.Depth.Z");
  for (std::size_t i = 0; i < depth.size(); i++)
    if (i % 128 > 63) depth[i] = 1e10f;
  file.write(frame);
  write_bytes(camera, wall_camera(display).dump());
  const Image full = computed({}), small = computed({"--set", "supersampling=2"});
  EXPECT_EQ(small.pixels[63], 1);
  expect_filtered(small, full, 2);
}

TEST_F(Supersampling, sizes_that_do_not_fit_are_refused_and_one_keeps_every_pixel) {
  const Window display = times(kSmall, 2);
  write_frame(display, display);
  write_beauty(display, display);
  expect_refused(3, joined(composed, {"--set", "supersampling=2"}),
                 {"beauty.exr", "128x72", "--set supersampling=2", "64x36"});
  write_beauty({0, 0, 42, 24}, {0, 0, 42, 24});
  expect_refused(3, composed, {"beauty.exr", "--set supersampling"});
  write_beauty({0, 0, 256, 144}, {0, 0, 256, 144});
  expect_refused(3, composed, {"beauty.exr", "--resolution half"});
  write_beauty(kSmall, kSmall);
  expect_refused(3, joined(composed, {"--set", "supersampling=1"}), {"beauty.exr", "--set supersampling"});
  const Image full = computed({});
  EXPECT_EQ(full.data, display);
  EXPECT_EQ(computed({"--set", "supersampling=1"}).pixels, full.pixels);
  write_frame(kSmall, {0, 0, 64, 37});
  expect_refused(3, {"--set", "supersampling=2"}, {"wall.0042.exr", "64x37", "--set supersampling=2"});
}

}  // namespace
}  // namespace alcove::supersampling_test
