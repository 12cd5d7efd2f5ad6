// What the C library refuses, asks for, repairs and notes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/options.h"
#include "tests/support/library.h"

namespace alcove::library_refusals_test {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

TEST_F(Library, refuses_what_makes_no_sense) {
  const Handle handle(alcove_new());
  const std::vector<float> values(64, 1);
  const alcove_layout one = packed(8, 4), other = packed(4, 8), three = packed(4, 4, 3);
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "no plane depth");
  for (const auto& [option, value, sentence] : {std::tuple("radios", "1", "did you mean radius"),
                                                {"radius", "-1", "--radius"},
                                                {"albedo", "file.exr", "the plane albedo"},
                                                {nullptr, "1", "null option"}})
    EXPECT_REFUSED(handle, alcove_set(handle.get(), option, value), ALCOVE_USAGE, sentence);
  for (const auto& [plane, layout, sentence] : {std::tuple("dept", &one, "did you mean depth"),
                                                {nullptr, &one, "null plane"},
                                                {"depth", nullptr, "layout"},
                                                {"depth", &three, "3 components"}})
    EXPECT_REFUSED(handle, alcove_plane(handle.get(), plane, values.data(), layout), ALCOVE_USAGE, sentence);
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
  EXPECT_OK(handle, alcove_set(handle.get(), "device", device().info().name.c_str()));
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

TEST_F(Library, refuses_strides_by_which_values_share_bytes) {
  const Handle handle(alcove_new());
  const std::vector<float> values(4096, 1);
  const std::vector<alcove_layout> wrong{{8, 4, 1, ALCOVE_FLOAT, 2, 0, 0},   {8, 4, 1, ALCOVE_FLOAT, 0, 8, 0},
                                         {8, 4, 3, ALCOVE_FLOAT, 0, 0, 2},   {8, 4, 3, ALCOVE_FLOAT, 8, 0, 0},
                                         {8, 4, 1, ALCOVE_FLOAT, 0, -31, 0}, {8, 4, 3, ALCOVE_FLOAT, 4, 32, 100}};
  for (const auto& layout : wrong)
    EXPECT_REFUSED(handle,
                   alcove_plane(handle.get(), layout.components == 3 ? "normal" : "depth", values.data(), &layout),
                   ALCOVE_USAGE, "strides are in bytes");
  // Columns one behind the other, planes of half floats within pixels, and one row whose stride means nothing.
  const std::vector<alcove_layout> right{
      {8, 4, 1, ALCOVE_FLOAT, 16, 4, 0}, {8, 4, 3, ALCOVE_HALF, 2, 16, 64}, {8, 1, 1, ALCOVE_FLOAT, 0, 1, 0}};
  for (const auto& layout : right)
    EXPECT_OK(handle, alcove_plane(handle.get(), layout.components == 3 ? "normal" : "depth", values.data(), &layout));
}

TEST_F(Library, refuses_what_the_pixels_speak_against) {
  const Handle handle = with_camera();
  give_planes(handle);
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_STREQ(alcove_notes(handle.get()), "");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "view"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "better fits --normal-space world");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "world"));
  EXPECT_OK(handle, alcove_set(handle.get(), "flip-normal", "xyz"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "better fits --normal-space world (");
  EXPECT_OK(handle, alcove_set(handle.get(), "flip-normal", nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", "unorm"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "--normal-encoding signed");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", nullptr));
  std::vector<float> changed = frame().normal;
  for (float& x : changed) x = 0.5F + 0.5F * x;
  alcove_layout three = packed(width(), height(), 3);
  three.pixel_stride = sizeof(float);
  three.component_stride = std::ptrdiff_t(sizeof(float)) * width() * height();
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", changed.data(), &three));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "--normal-encoding unorm");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", "unorm"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", nullptr, nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "100"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_THAT(alcove_notes(handle.get()), HasSubstr("radius"));
  std::vector<float> negative = frame().depth;
  for (float& z : negative) z = z < 1e9F ? -z : z;
  const alcove_layout one = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", negative.data(), &one));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "give -depth");
  EXPECT_STREQ(alcove_notes(handle.get()), "");
}

TEST_F(Library, lets_only_one_thing_say_the_camera_and_the_depth) {
  const Handle handle = with_camera();
  give_planes(handle);
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "only one of them");
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "near", "0.1"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "--near has no effect");
  EXPECT_OK(handle, alcove_set(handle.get(), "near", nullptr));
  EXPECT_OK(handle, alcove_camera_json(handle.get(), ""));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "not a JSON object");
  // A call that fails leaves what was given before.
  const alcove_layout huge{1 << 24, 1 << 24, 1, ALCOVE_FLOAT, 0, 0, 0};
  EXPECT_REFUSED(handle, alcove_plane(handle.get(), "depth", frame().depth.data(), &huge), ALCOVE_USAGE,
                 "more than any device takes");
  const std::string text = read_bytes(ALCOVE_SOURCE_DIR "/examples/interior.camera.json");
  EXPECT_OK(handle, alcove_camera_json(handle.get(), text.c_str()));
  EXPECT_EQ(ao_of(handle), truth());
  EXPECT_REFUSED(handle, alcove_set(handle.get(), "preset", "draft"), ALCOVE_USAGE, "alcove_preset()");
  const std::string error = alcove_error(handle.get());
  EXPECT_REFUSED(handle, alcove_set(handle.get(), alcove_error(handle.get()), "1"), ALCOVE_USAGE, error);
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
  for (const std::size_t sky : {1, 2, 3, 4}) EXPECT_EQ(ao[sky], 1) << sky;
}

TEST_F(Library, takes_or_refuses_every_option_of_the_table) {
  // Of files, frames, reports: whoever adds an option decides whether it is one of these.
  const Options names = typed(
      "accumulate depth normal position beauty material-ao matte occluders ignore objects object-channel "
      "depth-channel normal-channels position-channels beauty-channels ambient material-ao-channel "
      "albedo-channels matte-channel matte-object layer view supersampling roi source strict allow camera "
      "chan-rotation behind behind-channel deep deep-opacity other-views around motion motion-channels "
      "motion-kind frames output-offset chunk missing keep-going warnings-as-errors resume overwrite dry-run "
      "output environment ao-name filter filter-width composite fog-density gain tint mix composite-layers "
      "composite-compression append-ao preview debug type compression no-mkdir ocio display view-transform "
      "preview-style memory threads stats progress log-json verbose quiet print-config set");
  std::set<std::string> refused;
  for (const auto& row : option_table()) {
    const Handle handle(alcove_new());
    const auto words = row.is_key() ? row.words({}) : Words();
    const std::string name = row.key(), value = words.empty() ? "1" : words.front();
    if (alcove_set(handle.get(), name.c_str(), value.c_str()) == ALCOVE_OK) continue;
    if (std::string(alcove_error(handle.get())).find("is of files") != std::string::npos)
      refused.insert(name);
    else
      EXPECT_THAT(alcove_error(handle.get()), HasSubstr(name)) << "a value that is none, but the option is known";
  }
  EXPECT_EQ(refused, std::set<std::string>(names.begin(), names.end()));
}

}  // namespace
}  // namespace alcove::library_refusals_test
