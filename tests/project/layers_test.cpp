// The layers hold: rooms include only what docs/internals.md allows, and each library has one door.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/base/text.h"
#include "tests/support/program.h"

namespace alcove::layers_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

const std::string kProject = ALCOVE_SOURCE_DIR "/";

struct SourceFile {
  std::string name;  // from the project's root
  Names lines;
  bool is_in(const std::string& folder) const { return name.starts_with(folder + "/"); }
};

std::vector<SourceFile> sources_in(std::initializer_list<const char*> folders) {
  static const Names kEndings{".h", ".cpp", ".comp", ".glsl", ".in"};
  std::vector<SourceFile> files;
  for (const std::string folder : folders)
    for (const auto& name : names_in(kProject + folder))
      if (std::ranges::find(kEndings, fs::path(name).extension().string()) != kEndings.end())
        files.push_back({folder + "/" + name, lines_of(read_bytes(kProject + folder + "/" + name))});
  return files;
}

const std::vector<SourceFile>& product() {
  static const auto files = sources_in({"api", "cli", "core", "kernels"});
  return files;
}

/// Every line outside of comments that matches, as "file:line: text", of the files that `where` accepts.
template <class Where>
Names matches(const std::string& pattern, const Where& where) {
  const std::regex wanted(pattern), comment("//.*");
  Names found;
  for (const auto& file : product())
    for (std::size_t i = 0; where(file) && i < file.lines.size(); i++)
      if (std::regex_search(std::regex_replace(file.lines[i], comment, ""), wanted))
        found.push_back(fmt::format("{}:{}: {}", file.name, i + 1, file.lines[i]));
  return found;
}

/// Only files whose names begin with `home` match, and at least one does: else the pattern would find nothing anywhere.
void expect_only(const std::string& home, const std::string& pattern) {
  EXPECT_EQ(matches(pattern, [&](const auto& file) { return !file.name.starts_with(home); }), Names{});
  EXPECT_NE(matches(pattern, [&](const auto& file) { return file.name.starts_with(home); }), Names{}) << pattern;
}

TEST(Layers, only_core_gpu_names_vulkan) {
  expect_only("core/gpu/", R"(\bVk[A-Z]\w+|\bvk[A-Z]\w+|\bVK_\w+|#include [<"]vulkan)");
}

TEST(Layers, each_library_has_one_door) {
  expect_only("core/formats/exr", R"(#include [<"](OpenEXR/|Imath/)?(Imf|Imath|Iex|Ilm|openexr))");
  expect_only("core/base/half.h", R"(#include [<"](Imath/)?half\.h)");
  expect_only("core/formats/exr_deep.cpp", R"(#include [<"]zlib)");
  expect_only("core/formats/exr_zip.cpp", R"(#include [<"]libdeflate)");
  expect_only("core/formats/image_io.cpp", R"(#include [<"]OpenImageIO)");
  expect_only("core/formats/color.cpp", R"(#include [<"]OpenColorIO)");
  expect_only("core/formats/png.cpp", R"(#include [<"]png\.h)");
  expect_only("cli/parsing.cpp", R"(#include [<"]CLI)");
}

TEST(Layers, only_core_base_system_asks_the_operating_system) {
  expect_only(
      "core/base/system",
      R"(#include <(sys/|unistd|dlfcn|fcntl|signal|csignal|sched|pthread|poll|pwd|spawn|termios|link\.h|linux/|windows))");
  expect_only("core/base/system", R"(\bpopen\(|\bfork\(|\bmkdtemp\(|\bsetenv\(|/proc/self/exe)");
}

TEST(Layers, only_the_command_line_prints_and_reads_arguments) {
  expect_only("cli/",
              R"(fmt::print|std::cout|std::cerr|std::clog|\bf?printf\(|\bputs\(|\bargv\b|\bstd::exit\(|\b_exit\()");
}

/// What each room may include besides itself, by the table of docs/internals.md: `room` | question | allowed.
std::map<std::string, Names> rooms() {
  std::map<std::string, Names> rooms;
  const std::string page = read_bytes(kProject + "docs/internals.md");
  const std::size_t begin = page.find("<!-- rooms -->");
  const std::regex row(R"(^\| `([^`]+)` \|.*\| ([^|]+) \|$)");
  for (const auto& line : lines_of(page.substr(begin, page.find("<!-- /rooms -->") - begin))) {
    std::smatch found;
    if (!std::regex_match(line, found, row)) continue;
    Names& allowed = rooms[found.str(1)];
    if (found.str(2) == "&ndash;") continue;
    for (const auto& name : split(found.str(2)))
      allowed.push_back(name == "kernels" || name.starts_with("api") ? name : "core/" + name);
  }
  return rooms;
}

/// The room of a file. `core/chain` and `kernels` have folders of their own.
std::string room_of(const std::string& file) {
  for (const char* room : {"core/chain", "kernels"})
    if (file.starts_with(std::string(room) + "/")) return room;
  return fs::path(file).parent_path().string();
}

TEST(Layers, rooms_include_only_what_the_table_allows) {
  const auto allowed = rooms();
  std::set<std::string> seen;
  const std::regex include("^#include \"([^\"]+)\"");
  for (const auto& file : product()) {
    const std::string room = room_of(file.name);
    ASSERT_TRUE(allowed.contains(room)) << file.name << " is in no room of docs/internals.md";
    seen.insert(room);
    for (const auto& line : file.lines) {
      std::smatch name;
      if (!std::regex_search(line, name, include) || room_of(name.str(1)) == room) continue;
      EXPECT_THAT(allowed.at(room), Contains(room_of(name.str(1)))) << file.name << ": " << line;
    }
  }
  for (const auto& [room, others] : allowed) EXPECT_TRUE(seen.contains(room)) << room << " has no sources";
}

TEST(Kernels, are_all_in_the_chain_of_the_page) {
  const std::string page = read_bytes(kProject + "docs/internals.md");
  for (const auto& file : product())
    if (file.name.ends_with(".comp")) EXPECT_THAT(page, HasSubstr("](../" + file.name + ")"));
}

TEST(Kernels, have_variants_by_constants_and_tell_nan_by_bits) {  // see kernels/base/shared.h
  EXPECT_EQ(matches(R"(#\s*(if|ifdef|elif|else)\b|\b(isnan|isinf)\()",
                    [](const auto& file) { return file.is_in("kernels") && file.name != "kernels/base/shared.h"; }),
            Names{});
}

TEST(Form, lines_have_at_most_120_columns) {
  const std::regex begin(R"re(\bR"\w*\()re"), end(R"re(\)\w*")re");  // of raw strings: texts of files and pages
  for (const auto& file : sources_in({"api", "cli", "core", "kernels", "tests"})) {
    bool is_raw = false;
    for (std::size_t i = 0; i < file.lines.size(); i++) {
      const std::string& line = file.lines[i];
      is_raw = is_raw || (line.find("R\"") != line.npos && std::regex_search(line, begin));
      const auto columns = std::ranges::count_if(line, [](char byte) { return (byte & 0xc0) != 0x80; });
      if (!is_raw) EXPECT_LE(columns, 120) << file.name << ":" << i + 1;
      is_raw = is_raw && !std::regex_search(line, end);
    }
  }
}

}  // namespace
}  // namespace alcove::layers_test
