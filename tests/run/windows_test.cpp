// A beauty, mattes and other colours whose data windows are not the depth's.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/image.h"
#include "tests/support/command_line.h"

namespace alcove::windows_test {
namespace {

using namespace test;
using Plane = std::vector<float>;

const Window kDisplay = kWallWindow, kOverscan{-9, -5, 82, 46}, kCrop{13, 7, 30, 20}, kShifted{-4, 11, 40, 30},
             kTall{20, -8, 10, 60}, kApart{100, 0, 8, 8};

class Windows : public CommandLine {
 protected:
  void write_beauty(const Window& data, const Window& display = kDisplay) const {
    beauty_over(data, display).write(beauty);
  }

  Finished composite_with(const Options& more = {}) const {
    return run(joined({"--type", "float", "--beauty", beauty, "--composite", composite}, more));
  }
  /// The composite and the AO of a depth and a beauty with these windows.
  std::pair<Image, Image> composed(const Window& depth, const Window& of_beauty, const Options& more = {}) const {
    wall_frame(depth, kDisplay).write(frame);
    write_beauty(of_beauty);
    const Finished finished = composite_with(more);
    EXPECT_EQ(finished.code, 0) << finished;
    return {read_exr_image(composite), read_exr_image(ao)};
  }
  Plane ao_with(const Options& more) const { return computed(more).pixels; }

  const std::string beauty = folder / "beauty.exr", composite = folder / "composite.exr", other = folder / "other.exr";
};

TEST_F(Windows, the_composite_is_as_large_as_the_beauty_and_has_ao_where_there_is_depth) {
  const std::vector<Window> depths{kDisplay, kOverscan, kCrop, kShifted}, beauties{kDisplay, kOverscan, kCrop, kTall};
  for (std::size_t i = 0; i < depths.size(); i++) {
    const Window& depth = depths[i];
    const auto [same, same_ao] = composed(depth, depth);
    for (const Window& of_beauty : {beauties[(i + 1) % 4], beauties[(i + 3) % 4]}) {
      SCOPED_TRACE("depth " + to_string(depth) + ", beauty " + to_string(of_beauty));
      const auto [result, result_ao] = composed(depth, of_beauty);
      EXPECT_EQ(result.data, of_beauty);
      EXPECT_EQ(result.display, kDisplay);
      EXPECT_EQ(result_ao.data, depth);
      EXPECT_EQ(result_ao.pixels, same_ao.pixels);
      for (auto& [name, expected] : beauty_over(of_beauty, kDisplay).planes) {
        copy_common(same.plane(name).data(), depth, expected.data(), of_beauty);
        EXPECT_TRUE(std::ranges::equal(result.plane(name), expected)) << name;
      }
    }
  }
  const auto [whole, whole_ao] = composed(kDisplay, kShifted);
  const auto [part, part_ao] = composed(kDisplay, kShifted, {"--roi", "10,5,40,20"});
  const Window region{10, 5, 40, 20}, common = common_part(region, kShifted);
  EXPECT_EQ(part_ao.data, region);
  EXPECT_EQ(part.data, common);
  EXPECT_EQ(part.pixels, cropped(whole.pixels, whole.data, common));
}

TEST_F(Windows, a_preview_shows_the_beauty_where_there_is_no_depth) {
  const std::string shown = folder / "shown.png", plain = folder / "plain.png";
  composed(kDisplay, kDisplay, {"--intensity", "0", "--preview", plain});
  composed(kShifted, kDisplay, {"--preview", shown});
  Plane outside(kDisplay.pixels(), 1);
  copy_common(Plane(kShifted.pixels()).data(), kShifted, outside.data(), kDisplay);
  write_plane(other, "Y", outside);
  run_well({"compare", shown, plain, "--mask", other, "--max-rmse", "0"});
  const Finished all = run_program({"compare", shown, plain, "--max-rmse", "0"});
  EXPECT_EQ(all.code, 6) << all;
}

TEST_F(Windows, other_windows_are_noted_once_and_those_that_nothing_matches_are_refused) {
  write_beauty(kCrop);
  const std::string said = composite_with().err, note = "the beauty is 30x20 at (13, 7)";
  EXPECT_NE(said.find(note), said.npos);
  EXPECT_EQ(said.find(note), said.rfind(note));
  test::expect_refused(composite_with({"--roi", "50,30,10,5"}), 2, {"--roi"});
  write_beauty(kApart);
  test::expect_refused(composite_with(), 3, {"beauty.exr", "share no pixel", to_string(kApart), "--beauty"});
  write_beauty({0, 0, 128, 72}, {0, 0, 128, 72});
  test::expect_refused(composite_with(), 3, {"beauty.exr", "same display window", "--beauty"});
}

TEST_F(Windows, normals_may_be_cut_to_the_surfaces) {
  constexpr int kSkyRows = 9;
  FrameFile whole = wall_frame();
  for (auto& [name, plane] : whole.planes)
    std::fill_n(plane.begin(), kSkyRows * kDisplay.width, name.ends_with("Depth.Z") ? 1e10F : 0.0F);
  whole.write(frame);
  const Plane ao_of_whole = ao_with({});
  const auto with_normals_of = [&](const Window& data) {
    FrameFile normals{data, kDisplay, 1, {}, {}, {}};
    for (const auto& [name, plane] : whole.planes)
      if (name.find("Normal") != name.npos) normals.planes[name] = cropped(plane, kDisplay, data);
    normals.write(other);
    return done({"--type", "float", "--normal", other});
  };
  const Finished cut = with_normals_of({0, kSkyRows, kDisplay.width, kDisplay.height - kSkyRows});
  EXPECT_EQ(read_exr_image(ao).pixels, ao_of_whole);
  EXPECT_THAT(cut.err, Not(HasSubstr("usable normal"))) << "the sky needs none";
  const Finished more = with_normals_of({0, kSkyRows + 4, kDisplay.width, kDisplay.height - kSkyRows - 4});
  EXPECT_THAT(more.err, AllOf(HasSubstr("256 pixels had no usable normal"), HasSubstr("other.exr"),
                              HasSubstr("(--normal), or if this is sky, its depth (--sky)")));
}

TEST_F(Windows, materials_without_pixels_are_open_and_mattes_without_pixels_take_nothing) {
  const Plane open = ao_with({});
  Plane in_crop(kDisplay.pixels(), 0);
  const Plane ones(kCrop.pixels(), 1), halves(kCrop.pixels(), 0.5f);
  copy_common(ones.data(), kCrop, in_crop.data(), kDisplay);

  write_plane(other, "Y", ones, kCrop, kDisplay);
  const Plane with_matte = ao_with({"--matte", other, "--matte-outside", "0.25"});
  for (std::size_t i = 0; i < open.size(); i++) ASSERT_EQ(with_matte[i], in_crop[i] == 1 ? open[i] : 0.25f) << i;

  write_plane(other, "id.Y", Plane(kCrop.pixels(), 0), kCrop, kDisplay);
  EXPECT_EQ(ao_with(typed("--set matte-channel=id.Y --matte-object 0 --matte-outside 0.25 --matte " + other)),
            with_matte);

  write_plane(other, "AO", halves, kCrop, kDisplay);
  const Plane with_material = ao_with({"--set", "material-ao=" + other});
  for (std::size_t i = 0; i < open.size(); i++)
    ASSERT_EQ(with_material[i], in_crop[i] == 1 ? 0.5f * open[i] : open[i]) << i;
}

}  // namespace
}  // namespace alcove::windows_test
