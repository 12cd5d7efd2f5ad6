// The layers hold: who includes what, who prints, and what docs/ shows of that.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "cli/options.h"
#include "tests/support/program.h"

namespace alcove::layers_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

struct SourceFile {
  std::string name;  // from the project's root
  Names lines;

  bool is_in(const std::string& folder) const { return name.starts_with(folder + "/"); }
};

/// Our sources below a folder.
std::vector<SourceFile> sources_in(const std::string& folder) {
  static const Names kEndings{".h", ".cpp", ".comp", ".glsl", ".in"};
  std::vector<SourceFile> files;
  for (const auto& name : names_in(ALCOVE_SOURCE_DIR "/" + folder))
    if (std::ranges::find(kEndings, fs::path(name).extension().string()) != kEndings.end())
      files.push_back({folder + "/" + name, lines_of(read_bytes(ALCOVE_SOURCE_DIR "/" + folder + "/" + name))});
  return files;
}

std::vector<SourceFile> all_sources() {
  std::vector<SourceFile> files;
  for (const char* folder : {"api", "cli", "core", "kernels", "tests"})
    for (auto& file : sources_in(folder)) files.push_back(std::move(file));
  return files;
}

/// Every line that matches, as "file:line: text"; comments do not count.
Names matches(const std::vector<SourceFile>& files, const std::string& pattern,
              const std::function<bool(const SourceFile&)>& where) {
  const std::regex wanted(pattern), comment("//.*");
  Names found;
  for (const auto& file : files) {
    if (!where(file)) continue;
    for (std::size_t i = 0; i < file.lines.size(); i++) {
      // The text of an include is looked at, that of a comment is not.
      if (std::regex_search(std::regex_replace(file.lines[i], comment, ""), wanted))
        found.push_back(file.name + ":" + std::to_string(i + 1) + ": " + file.lines[i]);
    }
  }
  return found;
}

const std::vector<SourceFile>& product() {
  static const std::vector<SourceFile> files = [] {
    auto all = all_sources();
    std::erase_if(all, [](const auto& file) { return file.is_in("tests"); });
    return all;
  }();
  return files;
}

TEST(Layers, the_search_sees_the_sources) {  // or else all below proves nothing
  for (const char* folder : {"api", "cli", "core", "core/gpu", "kernels"})
    EXPECT_TRUE(std::ranges::any_of(product(), [&](const auto& file) { return file.is_in(folder); })) << folder;
  EXPECT_FALSE(matches(product(), "#include <vulkan", [](const auto&) { return true; }).empty());
  EXPECT_FALSE(matches(product(), "#include <Imf", [](const auto&) { return true; }).empty());
}

TEST(Layers, only_core_gpu_names_vulkan) {
  const auto elsewhere = [](const SourceFile& file) { return !file.is_in("core/gpu"); };
  EXPECT_EQ(matches(product(), R"(\bVk[A-Z]\w+|\bvk[A-Z]\w+|\bVK_\w+|#include [<"]vulkan)", elsewhere), Names{});
}

TEST(Layers, only_one_file_includes_each_library) {
  const auto unless = [](const char* name) { return [name](const SourceFile& file) { return file.name != name; }; };
  EXPECT_EQ(matches(product(), R"(#include [<"](OpenEXR/|Imath/)?(Imf|Imath|Iex|Ilm|openexr))",
                    [](const SourceFile& file) { return !file.name.starts_with("core/formats/exr"); }),
            Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"](Imath/)?half\.h)", unless("core/base/half.h")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]zlib)", unless("core/formats/exr_deep.cpp")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]libdeflate)", unless("core/formats/exr_zip.cpp")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]OpenImageIO)", unless("core/formats/image_io.cpp")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]OpenColorIO)", unless("core/formats/color.cpp")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]png\.h)", unless("core/formats/png.cpp")), Names{});
  EXPECT_EQ(matches(product(), R"(#include [<"]CLI)", unless("cli/parsing.cpp")), Names{});
}

TEST(Layers, only_one_file_asks_the_operating_system) {
  const auto is_elsewhere = [](const SourceFile& file) {
    return file.name != "core/base/system.cpp" && file.name != "core/base/system_windows.cpp";
  };
  const Names calls = matches(
      product(),
      R"(#include <(sys/|unistd|dlfcn|fcntl|signal|csignal|sched|pthread|poll|pwd|spawn|termios|link\.h|linux/|windows))",
      is_elsewhere);
  EXPECT_EQ(calls, Names{}) << "core/base/system.h has what is to be ported";
  EXPECT_EQ(matches(product(), R"(\bpopen\(|\bfork\(|\bmkdtemp\(|\bsetenv\(|/proc/self/exe)", is_elsewhere), Names{});
}

/// The architecture: what each room may include besides itself. docs/internals.md shows the same table.
const std::map<std::string, Names> kRooms = {
    {"kernels", {}},
    {"core/base", {}},
    {"core/gpu", {"core/base"}},
    {"core/formats", {"core/base"}},
    {"core/frame/camera", {"core/base", "kernels"}},
    {"core/frame", {"core/base", "core/frame/camera", "kernels"}},
    {"core/frame/find", {"core/base", "core/formats", "core/frame", "core/frame/camera", "kernels"}},
    {"core/frame/pixels", {"core/base", "core/frame", "core/frame/camera", "kernels"}},
    {"core/frame/settle",
     {"core/base", "core/formats", "core/frame", "core/frame/camera", "core/frame/find", "core/frame/pixels"}},
    {"core/chain", {"core/base", "core/frame", "core/frame/camera", "core/frame/find", "core/gpu", "kernels"}},
    {"core/options", {"core/base", "core/frame", "core/frame/camera", "core/frame/find", "core/chain"}},
    {"core/run",
     {"core/base", "core/formats", "core/frame", "core/frame/find", "core/frame/pixels", "core/frame/settle",
      "core/chain", "core/gpu", "core/options", "kernels"}},
    {"core/reference", {"core/base", "core/frame", "kernels"}},
    {"core/measure", {"core/base", "core/formats", "core/frame/find"}},
    {"core/inspect",
     {"core/base", "core/formats", "core/frame", "core/frame/camera", "core/frame/find", "core/frame/pixels",
      "core/frame/settle", "core/chain", "core/run"}},
    {"core/wedge",
     {"core/base", "core/formats", "core/frame", "core/chain", "core/options", "core/run", "core/measure"}},
    {"core/bench",
     {"core/base", "core/gpu", "core/formats", "core/frame", "core/frame/find", "core/frame/pixels", "core/chain",
      "core/run", "core/reference", "core/measure"}},
    {"api/alcove", {}},
    {"api",
     {"api/alcove", "core/base", "core/gpu", "core/frame", "core/frame/pixels", "core/frame/settle", "core/chain",
      "core/options"}},
    {"cli",
     {"core/base", "core/gpu", "core/formats", "core/frame", "core/frame/find", "core/chain", "core/options",
      "core/run", "core/measure", "core/inspect", "core/wedge", "core/bench"}},
};

std::string folder_of(const std::string& file) { return fs::path(file).parent_path().string(); }

/// The room that a file is in: these two have folders of their own.
std::string room_of(const std::string& file) {
  for (const char* room : {"core/chain", "kernels"})
    if (file.starts_with(std::string(room) + "/")) return room;
  return folder_of(file);
}

TEST(Layers, rooms_include_only_what_the_table_allows) {
  const std::regex include("^#include \"([^\"]+)\"");
  for (const auto& file : product()) {
    const std::string room = room_of(file.name);
    ASSERT_TRUE(kRooms.contains(room)) << file.name << " is in no room of the table";
    for (const auto& line : file.lines) {
      std::smatch name;
      if (!std::regex_search(line, name, include)) continue;
      const std::string other = room_of(name.str(1));
      if (other == room) continue;
      EXPECT_THAT(kRooms.at(room), Contains(other)) << file.name << ": " << line;
    }
  }
}

/// What a room may include, as docs/internals.md shows it.
std::string allowed_text(const Names& rooms) {
  if (rooms.empty()) return "&ndash;";
  Names names = rooms;
  for (auto& name : names)
    if (name.starts_with("core/")) name = name.substr(5);
  return fmt::format("{}", fmt::join(names, ", "));
}

TEST(Pages, the_table_of_rooms_is_the_one_that_is_checked) {
  const Names lines = lines_of(read_bytes(ALCOVE_SOURCE_DIR "/docs/internals.md"));
  const auto first = std::ranges::find(lines, "<!-- rooms -->"), last = std::ranges::find(lines, "<!-- /rooms -->");
  ASSERT_NE(last, lines.end());
  ASSERT_EQ(last - first, std::ssize(kRooms) + 3) << "a row for each room below two of the head";
  for (const auto& [room, allowed] : kRooms) {
    const auto row =
        std::find_if(first, last, [&](const auto& line) { return line.starts_with("| `" + room + "` |"); });
    ASSERT_NE(row, last) << room;
    EXPECT_TRUE(row->ends_with("| " + allowed_text(allowed) + " |")) << *row;
  }
}

TEST(Layers, kernels_include_no_library) {
  const auto kernels = [](const SourceFile& file) { return file.is_in("kernels"); };
  EXPECT_EQ(matches(product(), R"(#include <(?!cstdint>|type_traits>))", kernels), Names{});
}

TEST(Layers, only_the_command_line_prints_and_reads_arguments) {
  const auto core = [](const SourceFile& file) { return file.is_in("core") || file.is_in("api"); };
  Names printing = matches(product(), R"(fmt::print|std::cout|std::cerr|std::clog|\bf?printf\(|\bputs\(|spdlog)", core);
  std::erase_if(printing, [](const auto& line) {
    return line.starts_with("core/gpu/device.cpp:") && line.find("vulkan validation") != line.npos;
  });
  EXPECT_EQ(printing, Names{});
  EXPECT_EQ(matches(product(), R"(\bargv\b|\bstd::exit\(|\b_exit\(|\babort\()", core), Names{});
}

// Kernels.

TEST(Pages, the_chain_of_the_page_has_every_kernel) {
  const std::string page = read_bytes(ALCOVE_SOURCE_DIR "/docs/internals.md");
  for (const auto& file : product())
    if (file.name.ends_with(".comp"))
      EXPECT_THAT(page, HasSubstr("[" + fs::path(file.name).stem().string() + "](../" + file.name + ")"));
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) count++;
  return count;
}

TEST(Presets, each_of_ours_has_limits_on_every_frame_of_the_suite) {
  const std::string folder = ALCOVE_SOURCE_DIR "/examples/bench/", suite = read_bytes(folder + "suite.toml"),
                    limits = read_bytes(folder + "limits.toml");
  for (const auto& file : names_in(ALCOVE_SOURCE_DIR "/presets")) {
    if (file.find('/') != std::string::npos || !file.ends_with(".toml")) continue;
    const std::string name = fs::path(file).stem().string();
    EXPECT_THAT(suite, HasSubstr("preset = \"" + name + "\""));
    EXPECT_EQ(count_of(limits, "candidate = \"" + name + "\""), count_of(suite, "[[frame]]")) << name;
  }
}

TEST(Kernels, variants_are_specialization_constants) {
  const auto in_kernels = [](const SourceFile& file) {
    return file.is_in("kernels") && file.name != "kernels/base/shared.h";
  };
  for (const auto& line : matches(product(), R"(#\s*(if|ifdef|elif|else)\b)", in_kernels)) ADD_FAILURE() << line;
  for (const auto& file : product())
    if (file.name.ends_with(".comp"))
      EXPECT_LE(matches({file}, "constant_id", [](const auto&) { return true; }).size(), 5) << file.name;
}

TEST(Kernels, tell_nan_and_infinity_by_their_bits) {
  const auto in_kernels = [](const SourceFile& file) { return file.is_in("kernels"); };
  for (const auto& line : matches(product(), R"(\b(isnan|isinf)\()", in_kernels))
    ADD_FAILURE() << line << ": see kernels/base/finite.glsl";
}

// Form.

/// Characters of a line of UTF-8.
std::size_t columns_of(const std::string& line) {
  return std::size_t(std::ranges::count_if(line, [](char byte) { return (byte & 0xc0) != 0x80; }));
}

TEST(Form, files_begin_with_what_they_are_for_and_the_licence) {
  for (const auto& file : all_sources()) {
    ASSERT_GE(file.lines.size(), 2) << file.name;
    EXPECT_TRUE(file.lines[0].starts_with("// ") && file.lines[0].find("SPDX") == std::string::npos)
        << file.name << ": " << file.lines[0];
    const auto end = file.lines.begin() + std::min<std::ptrdiff_t>(5, std::ssize(file.lines));
    EXPECT_NE(std::find(file.lines.begin(), end, "// SPDX-License-Identifier: BSD-3-Clause"), end) << file.name;
  }
}

TEST(Form, lines_have_at_most_120_columns) {
  const std::regex raw_begin(R"re(\bR"\w*\()re");  // and not a channel's name, as "R"
  const std::regex raw_end(R"re(\)\w*")re");
  std::size_t skipped = 0;
  std::size_t looked_at = 0;
  for (const auto& file : all_sources()) {
    bool is_raw = false;  // within a raw string, whose text is a file's or a page's
    for (std::size_t i = 0; i < file.lines.size(); i++) {
      const std::string& line = file.lines[i];
      is_raw = is_raw || (line.find("R\"") != line.npos && std::regex_search(line, raw_begin));
      if (!is_raw) EXPECT_LE(columns_of(line), 120) << file.name << ":" << i + 1;
      (is_raw ? skipped : looked_at)++;
      if (is_raw && std::regex_search(line, raw_end)) is_raw = false;
    }
  }
  EXPECT_LT(100 * skipped, looked_at) << "lines that the test does not look at";
}

TEST(Form, no_history_and_nothing_unfinished_is_left_in_comments) {
  // in pieces, so that this line is none
  const std::string words = std::string("TO") + "DO|FIX" + "ME|XX" + "X|HA" + "CK";
  const std::regex wanted("\\b(" + words + ")\\b");
  for (const auto& file : all_sources())
    for (const auto& line : file.lines) EXPECT_FALSE(std::regex_search(line, wanted)) << file.name << ": " << line;
}

// Documents.

TEST(Pages, the_table_of_options_is_the_programs) {
  const std::string page = read_bytes(ALCOVE_SOURCE_DIR "/docs/options.md"), begin = "<!-- options -->\n",
                    end = "<!-- /options -->";
  const std::size_t from = page.find(begin), to = page.find(end);
  ASSERT_NE(from, page.npos);
  ASSERT_NE(to, page.npos);
  EXPECT_EQ(page.substr(from + begin.size(), to - from - begin.size()), option_table_markdown());
}

TEST(Pages, every_option_of_help_is_in_the_table) {
  const std::string help = run_program({"run", "--help-all"}).out, table = option_table_markdown();
  const std::regex option("\n  (-[a-z],)?(--[a-z-]+)");
  int count = 0;
  for (auto match = std::sregex_iterator(help.begin(), help.end(), option); match != std::sregex_iterator();
       ++match, count++)
    if ((*match)[2] != "--help") EXPECT_THAT(table, HasSubstr((*match)[2].str() + "`"));
  EXPECT_GT(count, 20);
}

}  // namespace
}  // namespace alcove::layers_test
