// README.md and docs/ are right: their commands run, and their links lead somewhere.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>
#include <sstream>

#include "cli/options.h"
#include "tests/support/openexr.h"
#include "tests/support/picture_file.h"
#include "tests/support/source_frame.h"
#include "tests/support/wall_frame.h"

namespace alcove::docs_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

const std::string kProject = ALCOVE_SOURCE_DIR "/";

/// The pages for users and developers, from the project's folder.
Names pages() {
  Names found{"README.md", "CHANGELOG.md", "examples/farm/README.md", "examples/bench/README.md"};
  for (const auto& entry : fs::directory_iterator(kProject + "docs"))
    if (entry.path().extension() == ".md") found.push_back("docs/" + entry.path().filename().string());
  std::ranges::sort(found);
  return found;
}

/// The commands in the blocks of code of a page, by their words.
std::vector<Names> commands_of(const std::string& page) {
  std::vector<Names> commands;
  for (const auto& line : lines_of(read_bytes(kProject + page))) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == line.npos || begin < 4 || !line.substr(begin).starts_with("alcove ")) continue;
    std::istringstream words(line.substr(begin + 7));
    commands.push_back({std::istream_iterator<std::string>(words), {}});
  }
  return commands;
}

/// A folder with the files of the pages' commands.
class Documents : public Sources {
 protected:
  Documents() {
    add_matrices(header, true);
    depth("Z", planar, 1e12F);
    vectors("N", "XYZ", world_normal);
    const std::vector<float> z = planes["Z"];
    for (const char* name : {"Vector.X", "Vector.Y"}) planes[name].assign(z.size(), 0);
    write(folder / "frame.exr");
    give_camera();
    fs::copy_file(folder / "camera.json", folder / "shot.json");
    fs::create_directory_symlink(kProject + "examples", folder / "examples");
    write_hidden(z);
    write_capture(z);
    for (float& distance : planes["Z"]) distance = 3 / distance + 0.7F;
    write(folder / "disparity.exr");
    planes.clear();
    for (const char* layer : {"Combined.", "DiffInd.", "DiffCol."})
      for (const char* color : {"R", "G", "B"}) {
        auto& plane = planes[std::string(layer) + color];
        plane.assign(z.size(), 0.5F);
        plane[0] = 0.25F;  // a picture has more than one colour
      }
    write(folder / "beauty.exr");
    planes = {{"A", std::vector<float>(z.size(), 1)}};
    write(folder / "hero.exr");
    FrameFile sky;
    sky.data = sky.display = {0, 0, 16, 8};
    for (const char* color : {"R", "G", "B"}) sky.planes[color] = std::vector<float>(128, 1);
    sky.write(folder / "sky.exr");
    write_bytes(folder / "lights.json",
                R"({"lights": [{"name": "key", "kind": "sun", "space": "view", "direction": [1, 1, 1]}]})");
    for (int frame = 1001; frame <= 1100; frame++)
      for (const std::string name : {"frame.exr", "beauty.exr"})
        fs::create_hard_link(
            folder / name, fmt::format("{}/{}.{}.exr", folder.path(), name == "frame.exr" ? "shot" : "beauty", frame));
  }

  /// Peels a step behind each surface, and the same as deep samples.
  void write_hidden(const std::vector<float>& z) {
    const auto all = planes;
    DeepFilePart part;
    part.data = {0, 0, 160, 120};
    part.pixels.resize(z.size());
    for (const float step : {0.0F, 0.3F, 0.6F}) {
      planes = {{"Z", z}};
      for (std::size_t i = 0; i < z.size(); i++) {
        if (z[i] < 1e12F) part.pixels[i].push_back({1, z[i] + step});
        planes["Z"][i] += step;
      }
      if (step > 0) write(folder / (step < 0.5F ? "frame.peel2.exr" : "frame.peel3.exr"));
    }
    planes = all;
    write_deep(folder / "frame.deep.exr", {part}, part.data);
  }

  /// Reversed depth between a near plane of 0.1 and none.
  void write_capture(const std::vector<float>& z) const {
    std::vector<float> device;
    for (const float distance : z) device.push_back(distance < 1e12F ? 0.1F / distance : 0);
    write_bytes(folder / "depth.dds", dds(160, 120, 41, bytes_of(device)));
  }

  /// Results for `compare`, and truths with the same pixels.
  void write_compared() const {
    const Finished made = run_here({"run", "frame.exr", "--radius", "0.5", "-o", "ao.exr"});
    ASSERT_EQ(made.code, 0) << made;
    for (const char* number : {"", ".0001", ".0002"})
      for (const std::string name : {"ao", "truth", "frame"}) {
        const std::string from = folder / (name == "frame" ? "frame.exr" : "ao.exr");
        const std::string to = folder / (name + number + ".exr");
        if (from != to) fs::copy_file(from, to, fs::copy_options::overwrite_existing);
      }
  }

  /// A list of one frame, whose picture is approved.
  void write_list() const {
    fs::create_directory(folder / "approved");
    const Finished made = run_here({"run", "frame.exr", "--radius", "0.5", "-o", "approved/hall.exr"});
    ASSERT_EQ(made.code, 0) << made;
    write_bytes(folder / "frames.toml",
                "[[frame]]\nname = 'hall'\ninput = 'frame.exr'\nradius = 0.5\nreference = 'approved/hall.exr'\n");
  }

  Finished run_here(const Names& words) const { return run_program(words, {.folder = folder.path()}); }
};

TEST_F(Documents, their_commands_run) {
  write_list();
  int count = 0;
  for (const auto& page : pages())
    for (const auto& command : commands_of(page)) {
      // Benchmarks take minutes, and farms put the numbers of frames in.
      const bool is_ours = command[0] != "bench" && std::ranges::find(command, "#FRAMESPEC#") == command.end();
      if (!is_ours) continue;
      if (command[0] == "compare") write_compared();
      const Finished finished = run_here(command);
      EXPECT_EQ(finished.code, 0) << page << ": alcove " << fmt::format("{}", fmt::join(command, " ")) << finished;
      count++;
    }
  EXPECT_GE(count, 15);
}

TEST_F(Documents, a_command_with_a_mistake_would_fail) {
  EXPECT_EQ(run_here({"run", "frame.exr", "--radius", "0.5", "-o", "x.exr", "--denoize", "none"}).code, 2);
  EXPECT_EQ(run_here({"run", "fame.exr", "--radius", "0.5", "-o", "x.exr"}).code, 3);
}

/// The names by which the headings of a page are linked to.
std::set<std::string> anchors_of(const std::string& page) {
  std::set<std::string> anchors;
  for (const auto& line : lines_of(read_bytes(page))) {
    if (!line.starts_with("#")) continue;
    std::string anchor;
    for (const char c : line.substr(line.find_first_not_of("# ")))
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == ' ')
        anchor += c == ' ' ? '-' : char(std::tolower(static_cast<unsigned char>(c)));
    anchors.insert(anchor);
  }
  return anchors;
}

TEST(Pages, links_lead_somewhere) {
  const std::regex link(R"(\]\(([^)#: ]*)(#[^)]*)?\))");
  int count = 0;
  for (const auto& page : pages()) {
    const std::string text = read_bytes(kProject + page), folder = fs::path(kProject + page).parent_path();
    for (auto match = std::sregex_iterator(text.begin(), text.end(), link); match != std::sregex_iterator(); ++match) {
      const std::string to = (*match)[1], anchor = (*match)[2];
      const std::string target = to.empty() ? kProject + page : folder + "/" + to;
      EXPECT_TRUE(fs::exists(target)) << page << ": " << to;
      if (!anchor.empty() && target.ends_with(".md"))
        EXPECT_TRUE(anchors_of(target).contains(anchor.substr(1))) << page << ": " << to << anchor;
      count++;
    }
  }
  EXPECT_GE(count, 100);
}

TEST(Pages, the_options_are_the_programs) {
  const std::string page = read_bytes(kProject + "docs/options.md");
  EXPECT_THAT(page, HasSubstr("<!-- options -->\n" + option_table_markdown() + "<!-- /options -->"))
      << "scripts/docs-options.sh writes them";
}

TEST(Pages, the_first_one_is_short_and_leads_to_all_others) {
  const std::string readme = read_bytes(kProject + "README.md");
  EXPECT_LE(readme.size(), 10000);
  for (const auto& page : pages())
    if (page.starts_with("docs/")) EXPECT_NE(readme.find("(" + page), readme.npos) << page;
}

}  // namespace
}  // namespace alcove::docs_test
