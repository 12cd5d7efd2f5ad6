// The C library gives the chain's bits however planes lie, does what its header says, and keeps handles apart.
// SPDX-License-Identifier: BSD-3-Clause
#include <thread>

#include "core/base/half.h"
#include "core/base/version.h"
#include "core/frame/pixels/ramps.h"
#include "tests/api/library.h"
#include "tests/support/scenes.h"

namespace alcove::library_test {
namespace {

using namespace test;

TEST_F(Library, gives_the_bits_of_the_chain) {
  const Handle handle = with_planes();
  EXPECT_EQ(ao_of(handle), truth());
  EXPECT_EQ(ao_of(handle), truth());  // a handle may run again
  EXPECT_GT(alcove_number(handle.get(), "compute-ms"), 0);
  EXPECT_EQ(alcove_number(handle.get(), "radius"), 0.35);
  EXPECT_TRUE(std::isnan(alcove_number(handle.get(), "nothing")));
  EXPECT_STRNE(alcove_device(handle.get()), "");
  EXPECT_STREQ(alcove_version(), kVersion);
}

TEST_F(Library, cuts_ramps_in_a_copy_and_says_so) {
  const Handle handle = with_planes();
  EXPECT_OK(handle, alcove_set(handle.get(), "ramps", "cut"));
  HostFrame cut = frame();
  cut.cuts_ramps = true;
  cut_ramps(cut, cut.depth);
  const std::vector<float> wanted = chain_of(cut);
  EXPECT_NE(wanted, truth());
  for (int run = 0; run < 2; run++) {
    EXPECT_EQ(ao_of(handle), wanted) << run;
    EXPECT_THAT(alcove_notes(handle.get()), HasSubstr("lay on ramps"));
  }
  EXPECT_OK(handle, alcove_set(handle.get(), "ramps", "keep"));
  EXPECT_EQ(ao_of(handle), truth());
}

TEST_F(Library, takes_planes_however_they_lie) {
  const Handle handle = with_camera();
  // One buffer of pixels with depth behind the normal and a byte of something else, its last row first.
  constexpr std::ptrdiff_t kPixel = 17;
  const std::ptrdiff_t row = kPixel * width() + 3;
  std::vector<char> buffer(std::size_t(row * height()) + 64);
  const auto pixels = frame().data.pixels();
  for (int y = 0; y < height(); y++)
    for (int x = 0; x < width(); x++) {
      char* pixel = buffer.data() + row * (height() - 1 - y) + kPixel * x;
      const std::size_t i = std::size_t(y) * std::size_t(width()) + std::size_t(x);
      for (std::size_t c = 0; c < 3; c++) std::memcpy(pixel + 4 * c, &frame().normal[i + c * pixels], 4);
      std::memcpy(pixel + 12, &frame().depth[i], 4);
    }
  char* const upper_left = buffer.data() + row * (height() - 1);
  const alcove_layout depth{width(), height(), 1, ALCOVE_FLOAT, kPixel, -row, 0};
  const alcove_layout normal{width(), height(), 3, ALCOVE_FLOAT, kPixel, -row, 4};
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", upper_left + 12, &depth));
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", upper_left, &normal));
  std::ranges::fill(buffer, 0);  // what was given is the library's own
  EXPECT_EQ(ao_of(handle), truth());
  // And the AO into such a buffer.
  EXPECT_OK(handle, alcove_get(handle.get(), "ao", upper_left + 5, &depth));
  for (const int x : {0, 7, width() - 1})
    for (const int y : {0, 5, height() - 1}) {
      float value = 0;
      std::memcpy(&value, upper_left + 5 - row * y + kPixel * x, 4);
      EXPECT_EQ(value, truth()[std::size_t(y) * std::size_t(width()) + std::size_t(x)]) << x << " " << y;
    }
}

TEST_F(Library, converts_half_floats_exactly) {
  const Handle handle(alcove_new());
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", "depth"));
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  // All positive finite half floats but the largest, which stands for what is too far away; they come back as they are.
  std::vector<std::uint16_t> halves(0x7bff), back(halves.size());
  for (std::size_t i = 0; i < halves.size(); i++) halves[i] = std::uint16_t(i);
  const alcove_layout layout{int(halves.size()), 1, 1, ALCOVE_HALF, 0, 0, 0};
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", halves.data(), &layout));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_OK(handle, alcove_get(handle.get(), "depth", back.data(), &layout));
  for (std::size_t i = 1; i < halves.size(); i++) ASSERT_EQ(back[i], halves[i]);
  std::vector<float> values(halves.size());
  const alcove_layout floats = packed(int(halves.size()), 1);
  EXPECT_OK(handle, alcove_get(handle.get(), "depth", values.data(), &floats));
  EXPECT_EQ(values[0x3c00], 1.0F);
  EXPECT_EQ(values[0x3555], 0.333251953125F);
  EXPECT_EQ(values[1], 0x1p-24F);
}

TEST_F(Library, rounds_to_the_nearest_half_float_to_even) {
  const Handle handle(alcove_new());
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", "depth"));
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  const std::vector<std::pair<float, std::uint16_t>> cases{
      {1 + 0x1p-11F, 0x3c00}, {1 + 0x3p-11F, 0x3c02}, {1 + 0x1.8p-11F, 0x3c01},     {2 - 0x1p-12F, 0x4000},
      {0x1p-25F, 0},          {0x1.8p-24F, 2},        {0x1p-14F - 0x1p-26F, 0x400}, {65519, 0x7bff},
      {65520, 0x7c00},        {70000, 0x7c00}};
  std::vector<float> depth;
  for (const auto& [value, half] : cases) depth.push_back(value);
  std::vector<std::uint16_t> back(depth.size());
  alcove_layout layout = packed(int(depth.size()), 1);
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", depth.data(), &layout));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  layout.type = ALCOVE_HALF;
  EXPECT_OK(handle, alcove_get(handle.get(), "depth", back.data(), &layout));
  for (std::size_t i = 0; i < cases.size(); i++) EXPECT_EQ(back[i], cases[i].second) << cases[i].first;
}

TEST_F(Library, gives_what_aov_names_with_its_components) {
  const Handle handle = with_planes();
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.1,0.35"));
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", "ao,bent-normal,ao-scales,transfer"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_EQ(alcove_components(handle.get(), "ao"), 1);
  EXPECT_EQ(alcove_components(handle.get(), "bent-normal"), 3);
  EXPECT_EQ(alcove_components(handle.get(), "transfer"), 9);
  EXPECT_EQ(alcove_components(handle.get(), "ao-scales"), 2);
  EXPECT_EQ(alcove_components(handle.get(), "depth"), 0);
  std::vector<float> bent(3 * frame().data.pixels(), NAN);
  const alcove_layout three = packed(width(), height(), 3), one = packed(width(), height());
  EXPECT_OK(handle, alcove_get(handle.get(), "bent-normal", bent.data(), &three));
  std::size_t units = 0;
  for (std::size_t i = 0; i < bent.size(); i += 3) {
    const double length = std::hypot(bent[i], bent[i + 1], bent[i + 2]);
    ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-3) << i << ": " << length;
    units += length > 0;
  }
  EXPECT_GT(units, frame().data.pixels() / 2);
  EXPECT_EQ(alcove_components(handle.get(), "BENT-normal"), 3);
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "bent-normal", bent.data(), &one), ALCOVE_USAGE, "of 3 components");
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "depth", bent.data(), &one), ALCOVE_USAGE, "aov");
}

TEST_F(Library, takes_presets_which_options_beat) {
  EstimatorSettings settings;
  settings.radius = 0.35;
  settings.slices = 3;
  Handle handle = with_planes();
  EXPECT_OK(handle, alcove_set(handle.get(), "--slices", "3"));
  const std::vector<float> three = compute_ao(recorder(), frame(), settings).ao;
  EXPECT_EQ(ao_of(handle), three);
  EXPECT_OK(handle, alcove_preset(handle.get(), "Draft"));
  const std::vector<float> draft = ao_of(handle);
  EXPECT_NE(draft, three);
  EXPECT_OK(handle, alcove_set(handle.get(), "slices", nullptr));
  EXPECT_NE(ao_of(handle), draft);
  EXPECT_OK(handle, alcove_preset(handle.get(), nullptr));
  EXPECT_EQ(ao_of(handle), truth());
  EXPECT_REFUSED(handle, alcove_preset(handle.get(), "drafft"), ALCOVE_USAGE, "did you mean draft");
  EXPECT_EQ(ao_of(handle), truth());  // a call that fails changes nothing
}

TEST_F(Library, takes_a_camera_of_numbers) {
  const Handle handle = with_planes();
  const Camera& camera = frame().camera;
  const auto& m = *camera.view_from_world;
  const auto& t = camera.view_from_world_offset;
  std::vector<double> matrix;
  for (std::size_t row = 0; row < 3; row++) matrix.insert(matrix.end(), {m[row][0], m[row][1], m[row][2], t[row]});
  matrix.insert(matrix.end(), {0, 0, 0, 1});
  EXPECT_OK(handle, alcove_camera_json(handle.get(), nullptr));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "no camera");
  EXPECT_OK(handle, alcove_camera(handle.get(), camera.fx, camera.fy, camera.cx, camera.cy, matrix.data()));
  EXPECT_EQ(ao_of(handle), truth());
  EXPECT_OK(handle, alcove_camera(handle.get(), camera.fx, camera.fy, camera.cx, camera.cy, nullptr));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "world_to_camera");
  matrix[0] = 2;
  EXPECT_OK(handle, alcove_camera(handle.get(), camera.fx, camera.fy, camera.cx, camera.cy, matrix.data()));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "no rotation");
  EXPECT_REFUSED(handle, alcove_camera(handle.get(), NAN, 1, 0, 0, nullptr), ALCOVE_INPUT, "NaN");
}

TEST_F(Library, multiplies_and_chooses_by_further_planes) {
  const Handle handle = with_planes();
  const std::vector<float> half(frame().data.pixels(), 0.5F), none(frame().data.pixels(), 0);
  const alcove_layout one = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "material-ao", half.data(), &one));
  const std::vector<float> dimmed = ao_of(handle);
  // Where nothing is there is no material either.
  std::size_t surfaces = 0;
  for (std::size_t i = 0; i < dimmed.size(); i++)
    if (truth()[i] < 1) {
      ASSERT_NEAR(dimmed[i], 0.5F * truth()[i], 1e-6) << i;
      surfaces++;
    }
  EXPECT_GT(surfaces, dimmed.size() / 2);
  EXPECT_OK(handle, alcove_plane(handle.get(), "material-ao", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "matte", none.data(), &one));
  EXPECT_OK(handle, alcove_set(handle.get(), "matte-outside", "0.25"));
  const std::vector<float> outside = ao_of(handle);
  for (const float value : outside) ASSERT_TRUE(value == 0.25F || value == 1.0F) << value;
  EXPECT_GT(std::ranges::count(outside, 0.25F), std::ssize(outside) / 2);
  EXPECT_OK(handle, alcove_set(handle.get(), "matte-outside", nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "matte", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "occluders", none.data(), &one));
  for (const float value : ao_of(handle)) ASSERT_EQ(value, 1);
  EXPECT_OK(handle, alcove_plane(handle.get(), "occluders", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "ignore", none.data(), &one));
  EXPECT_EQ(ao_of(handle), truth());
  const std::vector<float> all(frame().data.pixels(), 1);
  EXPECT_OK(handle, alcove_plane(handle.get(), "ignore", all.data(), &one));
  for (const float value : ao_of(handle)) ASSERT_EQ(value, 1);
}

TEST_F(Library, brightens_colours_by_the_plane_albedo) {
  const Handle handle = with_planes();
  std::vector<float> albedo(3 * frame().data.pixels(), 0);
  for (std::size_t i = 0; i < albedo.size(); i += 3) albedo[i] = 0.8F;  // red
  const alcove_layout three = packed(width(), height(), 3);
  EXPECT_OK(handle, alcove_set(handle.get(), "multi-bounce", "true"));
  EXPECT_OK(handle, alcove_set(handle.get(), "ao-channels", "rgb"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "the plane albedo");
  EXPECT_OK(handle, alcove_plane(handle.get(), "albedo", albedo.data(), &three));
  std::vector<float> ao(albedo.size(), -1);
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &three));
  std::size_t brighter = 0;
  for (std::size_t i = 0; i < ao.size(); i += 3) {
    ASSERT_GE(ao[i], ao[i + 1]);
    ASSERT_EQ(ao[i + 1], ao[i + 2]);
    brighter += ao[i] > ao[i + 1] + 0.01F;
  }
  EXPECT_GT(brighter, ao.size() / 12);
}

TEST_F(Library, takes_what_lies_behind) {
  HostFrame known = frame();
  known.behind_depth = frame().depth;
  for (float& z : known.behind_depth) z *= 1.25F;
  known.behind = {{.kind = BehindKind::backs}};
  const Handle handle = with_planes();
  const alcove_layout one = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "behind", known.behind_depth.data(), &one));
  EXPECT_OK(handle, alcove_set(handle.get(), "behind-kind", "backs"));
  const std::vector<float> ao = ao_of(handle);
  EXPECT_EQ(ao, chain_of(known));
  EXPECT_NE(ao, truth());
  EXPECT_OK(handle, alcove_set(handle.get(), "behind-kind", "backs,fronts"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "'behind-kind'");
}

// What the program measures of files.

TEST_F(Library, measures_how_depth_was_rounded) {
  const Handle handle = with_planes();
  const alcove_layout one = packed(width(), height());
  std::vector<float> depth = frame().depth;
  for (float& z : depth) z = std::round(z * 50) / 50;
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", depth.data(), &one));
  HostFrame known = frame();
  known.depth = depth;
  const std::vector<float> unmeasured = chain_of(known);
  known.depth_step = 0.02;
  known.depth_is_coarse = true;
  const std::vector<float> measured = chain_of(known), ao = ao_of(handle);
  EXPECT_LT(difference(ao, measured).rmse, 1e-4);
  EXPECT_GT(difference(ao, unmeasured).rmse, 0.01);
  EXPECT_THAT(alcove_notes(handle.get()), HasSubstr("depth was rounded: at its median"));
}

TEST_F(Library, tells_of_half_floats_and_refuses_depth_of_8_bits) {
  const Handle handle = with_planes();
  std::vector<std::uint16_t> halves;
  for (const float z : frame().depth) halves.push_back(to_half(z));
  alcove_layout one = packed(width(), height());
  one.type = ALCOVE_HALF;
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", halves.data(), &one));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_THAT(alcove_notes(handle.get()), HasSubstr("depth is stored as half float"));
  one.type = ALCOVE_FLOAT;
  std::vector<float> bytes = frame().depth;
  for (float& z : bytes) z = std::round(std::min(255.0F, 20 * z)) / 255;
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", bytes.data(), &one));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "depth holds only values of 8 bits");
}

// What is left.

TEST_F(Library, writes_results_over_the_planes_that_were_given) {
  const Handle handle = with_planes();
  std::vector<float> plane = frame().depth;
  const alcove_layout one = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", plane.data(), &one));
  for (int time = 0; time < 2; time++) {
    EXPECT_OK(handle, alcove_run(handle.get(), 0));
    EXPECT_OK(handle, alcove_get(handle.get(), "ao", plane.data(), &one));
    EXPECT_EQ(plane, truth()) << time;
  }
}

TEST_F(Library, stays_usable_after_calls_that_failed) {
  const Handle handle = with_planes();
  EXPECT_EQ(ao_of(handle), truth());
  // All but a run leaves the results, and what they are written into.
  std::vector<float> untouched(frame().data.pixels(), -1);
  const alcove_layout one = packed(width(), height()), narrow = packed(width() - 1, height());
  EXPECT_NE(alcove_set(handle.get(), "radius", "none"), ALCOVE_OK);
  EXPECT_NE(alcove_plane(handle.get(), "depth", untouched.data(), nullptr), ALCOVE_OK);
  EXPECT_NE(alcove_get(handle.get(), "bent-normal", untouched.data(), &one), ALCOVE_OK);
  EXPECT_NE(alcove_get(handle.get(), "ao", untouched.data(), &narrow), ALCOVE_OK);
  EXPECT_NE(alcove_get(handle.get(), "ao", untouched.data(), nullptr), ALCOVE_OK);
  EXPECT_EQ(untouched, std::vector<float>(untouched.size(), -1));
  std::vector<float> ao(untouched);
  EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
  EXPECT_EQ(ao, truth());
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", "nothing"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "nothing");
  EXPECT_EQ(alcove_components(handle.get(), "ao"), 0);
  EXPECT_TRUE(std::isnan(alcove_number(handle.get(), "radius")));
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "ao", untouched.data(), &one), ALCOVE_USAGE, "nothing was computed");
  EXPECT_EQ(untouched, std::vector<float>(untouched.size(), -1));
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", nullptr));
  EXPECT_EQ(ao_of(handle), truth());
}

TEST_F(Library, takes_pictures_of_one_pixel_one_row_and_one_column) {
  const Handle handle(alcove_new());
  EXPECT_OK(handle, alcove_set(handle.get(), "device", device().info().name.c_str()));
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.5"));
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  const std::vector<float> depth(70'000, 1);
  for (const auto& [width, height] : {std::pair(1, 1), {70'000, 1}, {1, 70'000}}) {
    const alcove_layout one = packed(width, height);
    std::vector<float> ao(std::size_t(width) * std::size_t(height), -1);
    EXPECT_OK(handle, alcove_plane(handle.get(), "depth", depth.data(), &one));
    EXPECT_OK(handle, alcove_run(handle.get(), 0));
    EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
    EXPECT_GE(*std::ranges::min_element(ao), 0) << width << " x " << height;
  }
}

TEST_F(Library, keeps_handles_of_several_threads_apart) {
  constexpr std::array radii{"0.2", "0.35", "0.6"};
  std::vector<std::vector<float>> found(radii.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < found.size(); i++)
      threads.emplace_back([&ao = found[i], radius = radii[i]] {
        const Handle handle = with_planes();
        EXPECT_OK(handle, alcove_set(handle.get(), "radius", radius));
        EXPECT_NE(alcove_set(handle.get(), "radius", "none"), ALCOVE_OK);
        ao = ao_of(handle);
      });
  }
  for (std::size_t i = 0; i < found.size(); i++)
    EXPECT_EQ(found[i], chain_of(frame(), std::stod(radii[i]))) << radii[i];
}

}  // namespace
}  // namespace alcove::library_test
