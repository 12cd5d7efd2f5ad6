// Warnings and notes: where they are said and recorded, and how they end a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/note.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_header.h"
#include "tests/support/wall_frame.h"

namespace alcove::notes_test {
namespace {

using namespace test;

/// A frame with a warning, since its depth is half.
FrameFile half_frame() {
  FrameFile file = wall_frame();
  file.halves = {"ViewLayer.Depth.Z"};
  return file;
}

/// A frame with a note and without a warning, since it has no normals.
FrameFile frame_without_normals() {
  FrameFile file = wall_frame();
  file.erase("Normal");
  return file;
}

/// A frame of which so many pixels have no normal.
FrameFile frame_with_repairs(std::size_t count) {
  FrameFile file = wall_frame();
  for (std::size_t i = 0; i < count; i++) file.planes.at("ViewLayer.Normal.X")[900 + i] = std::nanf("");
  return file;
}

/// Posts that stand before the wall, with a pixel between either side and what is behind as wide filters make it.
void write_with_averaged_edges(const std::string& path) {
  FrameFile file = wall_frame();
  auto& depth = file.planes.at("ViewLayer.Depth.Z");
  constexpr std::array<float, 8> kPosts = {1, 1, 1, 0.9f, 0.8f, 0.8f, 0.8f, 0.9f};
  for (std::size_t i = 0; i < depth.size(); i++) depth[i] *= kPosts[i % kPosts.size()];
  file.write(path);
}

void write_with_short_normals(const std::string& path) {
  FrameFile file = wall_frame();
  int i = 0;
  file.change("Normal", [&](float n) { return i++ % 4 ? n : 0.5f * n; });
  // Not Blender's names: its Cycles averages them always.
  file.rename("ViewLayer.Depth.Z", "Z");
  for (const std::string axis : {"X", "Y", "Z"}) file.rename("ViewLayer.Normal." + axis, "N." + axis);
  file.write(path);
}

void write_with_lossy_normals(const std::string& path) { write_with_dwa(path, Imf::DWAA_COMPRESSION); }

std::vector<std::string> codes_in(const json& notes) {
  std::vector<std::string> codes;
  for (const auto& note : notes) codes.push_back(note["code"]);
  return codes;
}

class Notes : public CommandLine {
 protected:
  /// The warnings in the header of a file.
  static std::string notes_in(const std::string& path) { return text_in(read_header(path), "alcove/notes"); }
};
class SequenceNotes : public SequenceFolder {};

TEST_F(Notes, have_their_level_and_their_code) {
  half_frame().write(frame);
  EXPECT_THAT(lines_of(run({}).err), Contains(AllOf(StartsWith("alcove: warning: " + frame + ": "),
                                                    HasSubstr("half float"), testing::EndsWith(" [half-depth]"))));
  frame_without_normals().write(frame);
  EXPECT_THAT(lines_of(run({}).err),
              Contains(AllOf(StartsWith("alcove: note: " + frame + ": "), testing::EndsWith(" [no-normals]"))));
  EXPECT_THAT(run({"-q"}).err, IsEmpty());
}

TEST_F(Notes, stand_in_log_and_statistics) {
  half_frame().write(frame);
  const std::string log = folder / "log.jsonl";
  const json all = stats_of({"--log-json", log, "-q"}), notes = all["frames"][0]["notes"];
  ASSERT_THAT(codes_in(notes), ElementsAre("half-depth"));
  EXPECT_EQ(notes[0]["level"], "warning");
  EXPECT_THAT(notes[0]["text"].get<std::string>(), HasSubstr("half float"));
  EXPECT_EQ(all["totals"]["warned"], 1);
  EXPECT_EQ(json::parse(lines_of(read_bytes(log))[1])["notes"], notes);
}

TEST_F(Notes, that_are_warnings_stand_in_the_header) {
  half_frame().write(frame);
  const std::string composite = folder / "composite.exr";
  done();
  EXPECT_THAT(notes_in(ao), StartsWith("half-depth: ViewLayer.Depth.Z is stored as half"));
  FrameFile repaired = frame_with_repairs(3);
  add_beauty(repaired);
  repaired.write(frame);
  done({"--composite", composite, "--set", "ambient=beauty"});
  for (const std::string& path : {ao, composite})
    EXPECT_EQ(notes_in(path), "repaired-normals: pixels had no usable normal");
  FrameFile made = frame_without_normals();
  made.attributes = {{"alcove/notes", "half-depth: of another file"}, {"owner", "a studio"}};
  made.write(frame);
  done();
  EXPECT_EQ(notes_in(ao), "(none)") << "a note is no warning, nor is that of an input the output's";
  EXPECT_EQ(text_in(read_header(ao), "owner"), "a studio");
}

TEST_F(Notes, tell_of_frames_whose_making_harms_ao) {
  for (const auto& [write, code, words] :
       {std::tuple(&write_with_averaged_edges, "antialiased-depth", "render it without filtering"),
        {&write_with_short_normals, "shortened-normals", "were averaged over pixels"},
        {&write_with_lossy_normals, "lossy-compression", "write data with zip"}}) {
    write(frame);
    const Finished finished = done();
    EXPECT_THAT(lines_of(finished.err), Contains(AllOf(StartsWith("alcove: warning: " + frame + ": "), HasSubstr(words),
                                                       testing::EndsWith(fmt::format(" [{}]", code)))))
        << finished;
    EXPECT_THAT(notes_in(ao), HasSubstr(std::string(code) + ": "));
    fs::remove(ao);
    EXPECT_EQ(run({"--set", "warnings-as-errors=true"}).code, 3);
    EXPECT_FALSE(fs::exists(ao)) << code;
  }
}

TEST_F(Notes, that_are_warnings_fail_where_they_count_as_errors) {
  write_bytes(ao, "what was there");
  for (const FrameFile& file : {half_frame(), frame_with_repairs(1)})
    for (const auto& [option, said] :
         {std::pair("--set=warnings-as-errors=true", "--set warnings-as-errors"), std::pair("--strict", "--strict")}) {
      file.write(frame);
      const Finished finished =
          run({option, "--depth-kind", "planar", "--normal-space", "world", "--normal-encoding", "signed"});
      EXPECT_EQ(finished.code, 3) << finished;
      EXPECT_THAT(finished.err,
                  AllOf(HasSubstr(frame), HasSubstr(said), ContainsRegex("\\[(half-depth|repaired-normals)\\]")));
      EXPECT_EQ(read_bytes(ao), "what was there");
      EXPECT_THAT(names_in(folder.path()), ElementsAre("ao.exr", "camera.json", "wall.0042.exr"));
    }
  frame_without_normals().write(frame);
  EXPECT_EQ(run({"--set", "warnings-as-errors=true"}).code, 0) << "a note is no warning";
}

TEST_F(Notes, on_a_file_that_another_option_gives_name_it) {
  wall_frame().write(frame);
  const std::string depth = folder / "depth.exr", beauty = folder / "beauty.exr";
  write_with_averaged_edges(depth);
  FrameFile other = wall_frame();
  add_beauty(other);
  for (auto& [name, plane] : other.planes)
    if (name.ends_with("Combined.R")) plane[900] = std::nanf("");
  other.write(beauty);
  const Options said{"--depth", depth, "--beauty", beauty, "--composite", folder / "c.exr"};
  const auto lines = lines_of(done(said).err);
  for (const auto& [file, code] : {std::pair(depth, "[antialiased-depth]"), {beauty, "[repaired-beauty]"}})
    EXPECT_THAT(lines, Contains(AllOf(StartsWith("alcove: warning: " + file + ": "), testing::EndsWith(code)))) << code;
  FrameFile broken = wall_frame();
  broken.planes.at("ViewLayer.Depth.Z")[900] = std::nanf("");
  broken.write(depth);
  EXPECT_THAT(lines_of(done(said).err),
              Contains(AllOf(StartsWith("alcove: warning: " + depth), testing::EndsWith("[repaired-depth]"))));
  const Options without_input = typed("run --radius 1 --chunk 1/2 --camera " + camera + " -o " + ao);
  EXPECT_THAT(run_program(joined(without_input, {"--depth", folder / "missing.exr"})).err,
              HasSubstr("missing.exr: file not found (--depth)"));
}

TEST_F(Notes, that_are_allowed_by_their_codes_are_no_errors) {
  half_frame().write(frame);
  const auto strictly = [&](const std::string& codes, const char* more = "--no-skip") {
    return run({more, "--set", "warnings-as-errors=true", "--set", "allow=" + codes});
  };
  const Finished allowed = strictly("half-depth,repaired-depth");
  EXPECT_EQ(allowed.code, 0) << allowed;
  EXPECT_THAT(allowed.err, HasSubstr("[half-depth]")) << "it is said all the same";
  EXPECT_THAT(strictly("half-depth", "--resume").err, HasSubstr("kept")) << "nor a reason to compute it again";
  EXPECT_EQ(strictly("repaired-depth").code, 3);
  const Finished misspelt = strictly("half-depht");
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_THAT(misspelt.err, AllOf(HasSubstr("--set allow"), HasSubstr("half-depth?")));
}

TEST_F(SequenceNotes, are_said_once_and_recorded_for_every_frame) {
  write_frames(1, 3, half_frame());
  const Finished finished = done({"--stats", folder / "stats.json"});
  const std::size_t first = finished.err.find("[half-depth]");
  EXPECT_NE(first, std::string::npos) << finished;
  EXPECT_EQ(finished.err.rfind("[half-depth]"), first) << finished;
  const json all = json::parse(read_bytes(folder / "stats.json"));
  EXPECT_THAT(codes_in(all["notes"]), Contains("half-depth"));
  for (const int frame : {1, 2, 3}) {
    EXPECT_THAT(codes_in(all["frames"][std::size_t(frame - 1)]["notes"]), ElementsAre("half-depth")) << frame;
    EXPECT_THAT(text_in(read_header(output(frame)), "alcove/notes"), StartsWith("half-depth: ")) << frame;
  }
  EXPECT_THAT(lines_of(finished.err).back(), HasSubstr(", 3 with warnings"));
}

TEST_F(SequenceNotes, of_single_frames_are_said_once_and_counted) {
  wall_frame().write(input(1));
  for (const int frame : {2, 3, 4}) frame_with_repairs(std::size_t(frame)).write(input(frame));
  const Finished finished = done({"--stats", folder / "stats.json"});
  std::vector<std::string> said = lines_of(finished.err);
  std::erase_if(said, [](const std::string& line) { return line.find("[repaired-normals]") == std::string::npos; });
  ASSERT_EQ(said.size(), 2) << finished;
  EXPECT_THAT(said[0], AllOf(HasSubstr(input(2)), HasSubstr("2 pixels")));
  EXPECT_THAT(said[1], AllOf(StartsWith("alcove: warning: "), HasSubstr("2 further frames")));
  const json frames = json::parse(read_bytes(folder / "stats.json"))["frames"];
  EXPECT_THAT(frames[0]["notes"], IsEmpty());
  EXPECT_THAT(frames[3]["notes"][0]["text"].get<std::string>(), HasSubstr("4 pixels"));
}

TEST_F(SequenceNotes, tell_of_an_empty_frame_amid_others) {
  write_frames(1, 3);
  FrameFile black = wall_frame();
  black.change("ViewLayer", [](float) { return 0.0f; });
  black.write(input(2));
  done({"--stats", folder / "stats.json"});
  const json frames = json::parse(read_bytes(folder / "stats.json"))["frames"];
  EXPECT_THAT(codes_in(frames[0]["notes"]), IsEmpty());
  EXPECT_THAT(codes_in(frames[1]["notes"]), Contains("no-surfaces"));
  EXPECT_THAT(codes_in(frames[2]["notes"]), IsEmpty());
}

TEST_F(SequenceNotes, that_are_warnings_fail_only_their_frames) {
  for (const int frame : {1, 2, 3}) frame_with_repairs(frame == 2).write(input(frame));
  ASSERT_EQ(run().code, 0);
  ASSERT_EQ(run({"--resume"}).code, 0);
  const Finished going = run({"--resume", "--set", "warnings-as-errors=true", "--keep-going"});
  EXPECT_EQ(going.code, 1) << going;
  EXPECT_THAT(going.err, AllOf(HasSubstr("2 kept"), HasSubstr("1 failed (2)"))) << "no bad output looks good";
  remove_outputs();
  EXPECT_EQ(run({"--set", "warnings-as-errors=true", "--keep-going"}).code, 1);
  EXPECT_THAT(names_in(out), ElementsAre("ao.0001.exr", "ao.0003.exr"));
  EXPECT_EQ(run({"--set", "warnings-as-errors=true"}).code, 3);
}

TEST(NoteTable, is_that_of_the_page) {
  const std::string page = read_bytes(ALCOVE_SOURCE_DIR "/docs/troubleshooting.md"), begin = "<!-- notes -->\n";
  const std::size_t from = page.find(begin) + begin.size(), to = page.find("<!-- /notes -->");
  ASSERT_LE(from, to);
  std::string table;
  for (const auto& facts : note_table())
    table += fmt::format("- `{}`{}: {}\n", facts.name, facts.is_warning ? "" : " (note)", facts.meaning);
  EXPECT_TRUE(page.substr(from, to - from) == table) << table;
}

}  // namespace
}  // namespace alcove::notes_test
