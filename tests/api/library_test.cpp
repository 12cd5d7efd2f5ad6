// The C library gives the chain's bits however planes lie, does what its header says, and keeps handles apart.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <memory>
#include <set>
#include <thread>

#include "api/alcove/alcove.h"
#include "core/base/version.h"
#include "core/chain/compute.h"
#include "core/frame/host_frame.h"
#include "core/options/options.h"
#include "tests/support/device.h"
#include "tests/support/program.h"

namespace alcove {
namespace {

using namespace test;
using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Free {
  void operator()(alcove_session* handle) const { alcove_free(handle); }
};
using Handle = std::unique_ptr<alcove_session, Free>;

alcove_layout packed(int width, int height, int components = 1) {
  return {width, height, components, ALCOVE_FLOAT, 0, 0, 0};
}

#define EXPECT_OK(handle, call) EXPECT_EQ(call, ALCOVE_OK) << alcove_error((handle).get())
#define EXPECT_REFUSED(handle, call, code, sentence)                \
  do {                                                              \
    EXPECT_EQ(call, code);                                          \
    EXPECT_THAT(alcove_error((handle).get()), HasSubstr(sentence)); \
  } while (false)

/// The shipped frame, and what the chain makes of it.
struct Library : testing::Test {
  static const HostFrame& frame() {
    static const HostFrame read = [] {
      InputSettings settings;
      settings.input = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
      settings.camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
      return read_host_frame(settings, 0);
    }();
    return read;
  }
  static int width() { return frame().data.width; }
  static int height() { return frame().data.height; }
  static const std::vector<float>& truth() {
    static const std::vector<float> ao = [] {
      EstimatorSettings settings;
      settings.radius = 0.35;
      return compute_ao(recorder(), frame(), settings).ao;
    }();
    return ao;
  }

  /// A handle with all that the frame says but its planes.
  static Handle with_camera() {
    Handle handle(alcove_new());
    const std::string text = read_bytes(ALCOVE_SOURCE_DIR "/examples/interior.camera.json");
    EXPECT_OK(handle, alcove_camera_json(handle.get(), text.c_str()));
    EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.35"));
    EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "world"));
    EXPECT_OK(handle, alcove_set(handle.get(), "device", "cpu"));
    return handle;
  }
  static void give_planes(const Handle& handle) {
    const alcove_layout one = packed(width(), height());
    alcove_layout three = packed(width(), height(), 3);
    three.pixel_stride = sizeof(float);
    three.component_stride = std::ptrdiff_t(sizeof(float)) * width() * height();
    EXPECT_OK(handle, alcove_plane(handle.get(), "depth", frame().depth.data(), &one));
    EXPECT_OK(handle, alcove_plane(handle.get(), "normal", frame().normal.data(), &three));
  }
  static std::vector<float> ao_of(const Handle& handle) {
    std::vector<float> ao(frame().data.pixels(), -1);
    const alcove_layout one = packed(width(), height());
    EXPECT_OK(handle, alcove_run(handle.get(), 0));
    EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
    return ao;
  }
};

TEST_F(Library, gives_the_bits_of_the_chain) {
  const Handle handle = with_camera();
  give_planes(handle);
  EXPECT_EQ(ao_of(handle), truth());
  EXPECT_EQ(ao_of(handle), truth());  // a handle may run again
  EXPECT_GT(alcove_number(handle.get(), "compute-ms"), 0);
  EXPECT_EQ(alcove_number(handle.get(), "radius"), 0.35);
  EXPECT_TRUE(std::isnan(alcove_number(handle.get(), "nothing")));
  EXPECT_STRNE(alcove_device(handle.get()), "");
  EXPECT_STREQ(alcove_version(), kVersion);
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
      {0x1p-25F, 0},          {0x1.8p-24F, 2},        {0x1p-14F - 0x1p-26F, 0x400}, {70000, 0x7c00}};
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
  const Handle handle = with_camera();
  give_planes(handle);
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.1,0.35"));
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", "ao,bent-normal,ao-scales"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_EQ(alcove_components(handle.get(), "ao"), 1);
  EXPECT_EQ(alcove_components(handle.get(), "bent-normal"), 3);
  EXPECT_EQ(alcove_components(handle.get(), "ao-scales"), 2);
  EXPECT_EQ(alcove_components(handle.get(), "depth"), 0);
  std::vector<float> bent(3 * frame().data.pixels());
  const alcove_layout three = packed(width(), height(), 3), one = packed(width(), height());
  EXPECT_OK(handle, alcove_get(handle.get(), "bent-normal", bent.data(), &three));
  for (std::size_t i = 0; i < bent.size(); i += 3) {
    const double length = std::hypot(bent[i], bent[i + 1], bent[i + 2]);
    ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-3) << i << ": " << length;
  }
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "bent-normal", bent.data(), &one), ALCOVE_USAGE, "of 3 components");
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "depth", bent.data(), &one), ALCOVE_USAGE, "aov");
}

TEST_F(Library, takes_presets_which_options_beat) {
  EstimatorSettings settings;
  settings.radius = 0.35;
  settings.slices = 3;
  Handle handle = with_camera();
  give_planes(handle);
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
  const Handle handle = with_camera();
  give_planes(handle);
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

TEST_F(Library, asks_for_words_where_planes_do_not_tell) {
  const Handle handle = with_camera();
  give_planes(handle);
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", nullptr));
  const std::string without = R"({"resolution": [8, 4], "fx": 9, "fy": 9, "cx": 4, "cy": 2, "world_to_camera":
    [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})";
  EXPECT_OK(handle, alcove_camera_json(handle.get(), without.c_str()));
  const std::vector<float> values(8 * 4 * 3, 0.5F);
  const alcove_layout one = packed(8, 4), three = packed(8, 4, 3);
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", values.data(), &one));
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", values.data(), &three));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "normal-space");
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", nullptr, nullptr));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "position", values.data(), &three));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "position-space");
}

TEST_F(Library, multiplies_and_chooses_by_further_planes) {
  const Handle handle = with_camera();
  give_planes(handle);
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
  for (const float value : ao_of(handle)) ASSERT_TRUE(value == 0.25F || value == 1.0F) << value;
  EXPECT_OK(handle, alcove_set(handle.get(), "matte-outside", nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "matte", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "occluders", none.data(), &one));
  for (const float value : ao_of(handle)) ASSERT_EQ(value, 1);
  EXPECT_OK(handle, alcove_plane(handle.get(), "occluders", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "ignore", none.data(), &one));
  EXPECT_EQ(ao_of(handle), truth());
}

TEST_F(Library, takes_what_lies_behind) {
  HostFrame known = frame();
  known.behind_depth = frame().depth;
  for (float& z : known.behind_depth) z *= 1.25F;
  known.behind = {{.kind = BehindKind::backs}};
  EstimatorSettings settings;
  settings.radius = 0.35;
  const Handle handle = with_camera();
  give_planes(handle);
  const alcove_layout one = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "behind", known.behind_depth.data(), &one));
  EXPECT_OK(handle, alcove_set(handle.get(), "behind-kind", "backs"));
  const std::vector<float> ao = ao_of(handle);
  EXPECT_EQ(ao, compute_ao(recorder(), known, settings).ao);
  EXPECT_NE(ao, truth());
  EXPECT_OK(handle, alcove_set(handle.get(), "behind-kind", "backs,fronts"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "--behind-kind");
}

TEST_F(Library, refuses_what_makes_no_sense) {
  const Handle handle(alcove_new());
  const std::vector<float> values(64, 1);
  const alcove_layout one = packed(8, 4), other = packed(4, 8), three = packed(4, 4, 3);
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "no plane depth");
  EXPECT_REFUSED(handle, alcove_set(handle.get(), "radios", "1"), ALCOVE_USAGE, "did you mean --radius");
  EXPECT_REFUSED(handle, alcove_set(handle.get(), "radius", "-1"), ALCOVE_USAGE, "--radius");
  EXPECT_REFUSED(handle, alcove_set(handle.get(), "albedo", "file.exr"), ALCOVE_USAGE, "the plane albedo");
  EXPECT_REFUSED(handle, alcove_set(handle.get(), nullptr, "1"), ALCOVE_USAGE, "null option");
  EXPECT_REFUSED(handle, alcove_plane(handle.get(), "dept", values.data(), &one), ALCOVE_USAGE, "did you mean depth");
  EXPECT_REFUSED(handle, alcove_plane(handle.get(), nullptr, values.data(), &one), ALCOVE_USAGE, "null plane");
  EXPECT_REFUSED(handle, alcove_plane(handle.get(), "depth", values.data(), nullptr), ALCOVE_USAGE, "layout");
  EXPECT_REFUSED(handle, alcove_plane(handle.get(), "depth", values.data(), &three), ALCOVE_USAGE, "3 components");
  for (const alcove_layout& wrong :
       {packed(0, 4), packed(8, -1), packed(8, 4, 0), alcove_layout{8, 4, 1, alcove_type(7), 0, 0, 0}})
    EXPECT_REFUSED(handle, alcove_plane(handle.get(), "depth", values.data(), &wrong), ALCOVE_USAGE, "a plane of");
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", values.data(), &one));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "radius");
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.5"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "no camera");
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  EXPECT_OK(handle, alcove_set(handle.get(), "depth-kind", "normalized"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "--far");
  EXPECT_OK(handle, alcove_set(handle.get(), "depth-kind", "planar"));
  EXPECT_OK(handle, alcove_plane(handle.get(), "material-ao", values.data(), &other));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT,
                 "material ao has 4 x 8 pixels, and the depth 8 x 4");
  EXPECT_OK(handle, alcove_plane(handle.get(), "material-ao", nullptr, nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "device", "nothing of the kind"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_DEVICE, "nothing of the kind");
  EXPECT_OK(handle, alcove_set(handle.get(), "device", "cpu"));
  std::vector<float> ao(64);
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "ao", ao.data(), &one), ALCOVE_USAGE, "nothing was computed");
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "ao", ao.data(), &other), ALCOVE_USAGE, "8 x 4");
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "ao", nullptr, &one), ALCOVE_USAGE, "no place");
  EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
  EXPECT_STREQ(alcove_error(handle.get()), "");
  EXPECT_EQ(alcove_run(nullptr, 0), ALCOVE_USAGE);
  EXPECT_EQ(alcove_components(nullptr, "ao"), 0);
  alcove_free(nullptr);
}

TEST_F(Library, repairs_and_counts_what_is_no_depth) {
  const Handle handle(alcove_new());
  const std::vector<float> depth{1, NAN, -3, 0, kInfinity, 2};
  const alcove_layout one = packed(6, 1);
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", depth.data(), &one));
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.5"));
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_EQ(alcove_number(handle.get(), "repaired-depth"), 2);
  EXPECT_EQ(alcove_number(handle.get(), "sky-pixels"), 4);
  std::vector<float> ao(6, -1);
  EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
  for (const float value : ao) EXPECT_TRUE(value >= 0 && value <= 1) << value;
}

TEST_F(Library, takes_or_refuses_every_option_of_the_table) {
  // Of files, frames, reports: whoever adds an option decides whether it is one of these.
  const std::set<std::string> of_files{"--preset",
                                       "--depth",
                                       "--normal",
                                       "--position",
                                       "--beauty",
                                       "--material-ao",
                                       "--matte",
                                       "--occluders",
                                       "--ignore",
                                       "--objects",
                                       "--object-channel",
                                       "--depth-channel",
                                       "--normal-channels",
                                       "--position-channels",
                                       "--beauty-channels",
                                       "--ambient",
                                       "--material-ao-channel",
                                       "--albedo-channels",
                                       "--matte-channel",
                                       "--matte-object",
                                       "--layer",
                                       "--view",
                                       "--supersampling",
                                       "--roi",
                                       "--source",
                                       "--strict",
                                       "--camera",
                                       "--chan-rotation",
                                       "--behind",
                                       "--behind-channel",
                                       "--deep",
                                       "--deep-opacity",
                                       "--other-views",
                                       "--around",
                                       "--motion",
                                       "--motion-channels",
                                       "--motion-kind",
                                       "--frames",
                                       "--output-offset",
                                       "--chunk",
                                       "--missing",
                                       "--keep-going",
                                       "--warnings-as-errors",
                                       "--resume",
                                       "--overwrite",
                                       "--dry-run",
                                       "--output",
                                       "--ao-name",
                                       "--filter",
                                       "--filter-width",
                                       "--composite",
                                       "--fog-density",
                                       "--gain",
                                       "--tint",
                                       "--mix",
                                       "--composite-layers",
                                       "--composite-compression",
                                       "--append-ao",
                                       "--preview",
                                       "--debug",
                                       "--type",
                                       "--compression",
                                       "--no-mkdir",
                                       "--ocio",
                                       "--display",
                                       "--view-transform",
                                       "--preview-style",
                                       "--memory",
                                       "--threads",
                                       "--stats",
                                       "--progress",
                                       "--log-json",
                                       "--verbose",
                                       "--quiet",
                                       "--print-config"};
  RunOptions options;
  std::set<std::string> refused;
  for (const auto& row : option_table(options)) {
    const Handle handle(alcove_new());
    const auto words = row.words();
    const std::string name = row.long_name(), value = words.empty() ? "1" : words.front();
    if (alcove_set(handle.get(), name.c_str(), value.c_str()) == ALCOVE_OK) continue;
    if (std::string(alcove_error(handle.get())).find("is of files") != std::string::npos)
      refused.insert(name);
    else
      EXPECT_THAT(alcove_error(handle.get()), HasSubstr(name)) << "a value that is none, but the option is known";
  }
  EXPECT_EQ(refused, of_files);
}

TEST_F(Library, keeps_handles_of_several_threads_apart) {
  truth();
  std::vector<std::vector<float>> found(3);
  {
    std::vector<std::jthread> threads;
    for (auto& ao : found)
      threads.emplace_back([&ao] {
        const Handle handle = with_camera();
        give_planes(handle);
        EXPECT_NE(alcove_set(handle.get(), "radius", "none"), ALCOVE_OK);
        ao = ao_of(handle);
      });
  }
  for (const auto& ao : found) EXPECT_EQ(ao, truth());
}

}  // namespace
}  // namespace alcove
