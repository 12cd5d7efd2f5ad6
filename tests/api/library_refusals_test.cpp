// What the C library refuses, asks for, repairs and notes.
// SPDX-License-Identifier: BSD-3-Clause
#include <set>
#include <sstream>

#include "core/options/options.h"
#include "tests/api/library.h"

namespace alcove::library_refusals_test {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST_F(Library, asks_for_words_where_planes_do_not_tell) {
  const Handle handle = with_planes();
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
                                                {"radius", "-1", "'radius': -1 is out of range"},
                                                {"albedo", "file.exr", "the plane albedo"},
                                                {"threads", "2", "threads is not available in the library"},
                                                {"depth", "file.exr", "alcove_plane()"},
                                                {"camera", "file.json", "alcove_camera()"},
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
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "give 'far'");
  EXPECT_OK(handle, alcove_set(handle.get(), "depth-kind", "position"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "'depth-kind' position takes the plane position");
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

TEST_F(Library, refuses_strides_that_no_address_reaches) {
  const Handle handle = with_planes();
  constexpr std::ptrdiff_t kMost = std::numeric_limits<std::ptrdiff_t>::max(),
                           kLeast = std::numeric_limits<std::ptrdiff_t>::min();
  std::vector<float> values(3 * frame().data.pixels(), 7);
  for (const std::ptrdiff_t stride : {kMost, kLeast, kMost / 2, kMost / 3 + 1, kLeast / 2, kMost / (1 << 20)})
    for (alcove_layout layout : {alcove_layout{width(), height(), 1, ALCOVE_FLOAT, stride, 0, 0},
                                 {width(), height(), 1, ALCOVE_FLOAT, 0, stride, 0},
                                 {width(), height(), 3, ALCOVE_HALF, 0, 0, stride},
                                 {width(), height(), 1, ALCOVE_FLOAT, stride, stride, 0},
                                 {4, 1 << 24, 1, ALCOVE_FLOAT, stride, 0, 0},
                                 {1 << 24, 1, 1, ALCOVE_FLOAT, stride, stride, stride}}) {
      const char* const plane = layout.components == 3 ? "normal" : "depth";
      EXPECT_REFUSED(handle, alcove_plane(handle.get(), plane, values.data(), &layout), ALCOVE_USAGE, "beyond memory");
    }
  EXPECT_EQ(ao_of(handle), truth());  // of the planes that were given before
  alcove_layout beyond = packed(width(), height());
  beyond.row_stride = kMost / 2;
  EXPECT_REFUSED(handle, alcove_get(handle.get(), "ao", values.data(), &beyond), ALCOVE_USAGE, "beyond memory");
  EXPECT_EQ(values, std::vector<float>(values.size(), 7));
}

TEST_F(Library, refuses_what_the_pixels_speak_against) {
  const Handle handle = with_planes();
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_STREQ(alcove_notes(handle.get()), "");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "view"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "better fits 'normal-space' world");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "world"));
  EXPECT_OK(handle, alcove_set(handle.get(), "flip-normal", "xyz"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "better fits 'normal-space' world (");
  EXPECT_OK(handle, alcove_set(handle.get(), "flip-normal", nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", "unorm"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "'normal-encoding' signed");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", nullptr));
  std::vector<float> changed = frame().normal;
  for (float& x : changed) x = 0.5F + 0.5F * x;
  alcove_layout three = packed(width(), height(), 3);
  three.pixel_stride = sizeof(float);
  three.component_stride = std::ptrdiff_t(sizeof(float)) * width() * height();
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", changed.data(), &three));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "'normal-encoding' unorm");
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", "unorm"));
  EXPECT_OK(handle, alcove_run(handle.get(), 0));
  EXPECT_OK(handle, alcove_set(handle.get(), "normal-encoding", nullptr));
  std::vector<float> mirrored = frame().depth, normals = frame().normal;
  for (auto* plane : {&mirrored, &normals})
    for (auto row = plane->begin(); row != plane->end(); row += width()) std::reverse(row, row + width());
  const alcove_layout plain = packed(width(), height());
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", mirrored.data(), &plain));
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", normals.data(), &three));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_INPUT, "mirror the picture, then");
  EXPECT_OK(handle, alcove_plane(handle.get(), "normal", nullptr, nullptr));
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", frame().depth.data(), &plain));
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
  const Handle handle = with_planes();
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "only one of them");
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", nullptr));
  EXPECT_OK(handle, alcove_set(handle.get(), "near", "0.1"));
  EXPECT_REFUSED(handle, alcove_run(handle.get(), 0), ALCOVE_USAGE, "'near' has no effect");
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
      "depth-channel normal-channels position-channels beauty-channels ambient shadow-layers material-ao-channel "
      "albedo-channels matte-channel matte-object layer view supersampling roi source strict allow camera "
      "chan-rotation behind behind-channel deep deep-opacity other-views around motion motion-channels "
      "motion-kind frames output-offset chunk missing keep-going warnings-as-errors resume overwrite dry-run "
      "output environment lights ao-name filter filter-width composite fog-density gain tint mix composite-layers "
      "composite-compression append-ao preview debug type compression no-mkdir ocio display view-transform "
      "preview-style memory threads preset project stats progress log-json verbose quiet print-config shareable set");
  std::set<std::string> refused;
  for (const auto& row : option_table()) {
    const Handle handle(alcove_new());
    const auto words = row.is_key() ? row.words({}) : Words();
    const std::string name = row.key(), value = words.empty() ? "1" : words.front();
    if (alcove_set(handle.get(), name.c_str(), value.c_str()) == ALCOVE_OK) continue;
    const std::string error = alcove_error(handle.get());
    if (error.find("not available in the library") != error.npos || error.find(": alcove_") != error.npos)
      refused.insert(name);
    else
      EXPECT_THAT(error, HasSubstr(name)) << "a value that is none, but the option is known";
  }
  EXPECT_EQ(refused, std::set<std::string>(names.begin(), names.end()));
}

// What is said.

/// Values to try: the words of an option, numbers of every size, and what is no value.
Words tried_values(const SettingRow& row) {
  Words values{"", "x", "-1", "0", "0.5", "1", "3", "1e30", "0.1,0.2", "true"};
  std::istringstream words(row.value);
  for (std::string word; std::getline(words, word, '|');) values.push_back(word);
  return values;
}

/// All that handles said.
class Said {
 public:
  void call(const Handle& handle, alcove_code code) {
    if (code == ALCOVE_OK) return;
    sentences_.insert(alcove_error(handle.get()));
  }
  const std::set<std::string>& sentences() const { return sentences_; }

 private:
  std::set<std::string> sentences_;
};

/// An option with a value that the library takes.
struct Choice {
  std::string option, value;
};

TEST_F(Library, speaks_of_its_own_parameters_alone) {
  Said said;
  const Handle handle(alcove_new());
  const std::vector<float> depth{1, 2, 1, 2, 3, 2, 1, 4}, colours(24, 0.5F);
  const alcove_layout one = packed(4, 2), three = packed(4, 2, 3);
  const auto set = [&](const Choice& choice) {
    const alcove_code code = alcove_set(handle.get(), choice.option.c_str(), choice.value.c_str());
    said.call(handle, code);
    return code == ALCOVE_OK;
  };
  const auto run = [&] { said.call(handle, alcove_run(handle.get(), 0)); };
  std::vector<Choice> choices;
  for (const auto& row : option_table())
    for (const auto& value : tried_values(row))
      if (set({row.key(), value})) {
        if (row.key() != "device") choices.push_back({row.key(), value});
        alcove_set(handle.get(), row.key().c_str(), nullptr);
      }
  EXPECT_GT(choices.size(), 150);
  EXPECT_OK(handle, alcove_set(handle.get(), "device", "nothing of the kind"));
  run();
  EXPECT_OK(handle, alcove_plane(handle.get(), "depth", depth.data(), &one));
  run();
  EXPECT_OK(handle, alcove_set(handle.get(), "radius", "1"));
  run();
  EXPECT_OK(handle, alcove_set(handle.get(), "fov", "60"));
  const auto with_each = [&](const auto& then) {
    for (const Choice& choice : choices) {
      set(choice);
      then();
      const bool is_needed = choice.option == "radius" || choice.option == "fov";
      alcove_set(handle.get(), choice.option.c_str(), !is_needed ? nullptr : choice.option == "fov" ? "60" : "1");
    }
  };
  with_each(run);
  // A plane of another size ends a run before it asks for a device, which takes time.
  const alcove_layout other = packed(2, 4);
  EXPECT_OK(handle, alcove_plane(handle.get(), "material-ao", depth.data(), &other));
  for (const char* plane : {"normal", "albedo", "matte", "occluders", "ignore", "behind"}) {
    const bool is_colour = plane == std::string("normal") || plane == std::string("albedo");
    EXPECT_OK(handle,
              alcove_plane(handle.get(), plane, is_colour ? colours.data() : depth.data(), is_colour ? &three : &one));
    with_each(run);
    EXPECT_OK(handle, alcove_plane(handle.get(), plane, nullptr, nullptr));
  }
  for (const char* aov : {"relight", "error", "hidden", "bent-normal", "ao-scales", "transfer", "albedo", "nothing"}) {
    EXPECT_OK(handle, alcove_set(handle.get(), "aov", aov));
    with_each(run);
  }
  EXPECT_OK(handle, alcove_set(handle.get(), "aov", nullptr));
  for (const Choice& first : choices) {
    if (first.option == "radius" || first.option == "fov" || first.option == "aov") continue;
    set(first);
    with_each(run);
    alcove_set(handle.get(), first.option.c_str(), nullptr);
  }
  for (const char* camera : {"", "[]", "{}", R"({"resolution": [4, 2]})", R"({"resolution": [4, 2], "fx": 0, "fy": 1})",
                             R"({"resolution": [9, 2], "fx": 1, "fy": 1, "cx": 0, "cy": 0})",
                             R"({"resolution": [4, 2], "fx": 1, "fy": 1, "cx": 0, "cy": 0, "frames": []})"}) {
    EXPECT_OK(handle, alcove_camera_json(handle.get(), camera));
    run();
    EXPECT_OK(handle, alcove_set(handle.get(), "fov", nullptr));
    run();
  }
  EXPECT_GT(said.sentences().size(), 500);
  for (const std::string& sentence : said.sentences())
    EXPECT_THAT(sentence, Not(AnyOf(HasSubstr("--"), HasSubstr(".exr"), HasSubstr(".EXR"))));
}

}  // namespace
}  // namespace alcove::library_refusals_test
