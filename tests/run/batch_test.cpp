// Sequences: which frames are computed, from and to which files, and what is told of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/plan.h"
#include "tests/support/command_line.h"

namespace alcove::batch_test {
namespace {

using namespace test;

class Batch : public SequenceFolder {
 protected:
  /// A run on other files with the camera and a radius of 1.
  Finished run_alone(const Options& more) const {
    return run_program(joined({"run", "--camera", camera, "--radius", "1"}, more));
  }
  void done_alone(const Options& more) const {
    const Finished finished = run_alone(more);
    EXPECT_EQ(finished.code, 0) << finished;
  }
};

/// What is behind a file's header, which has the digest of the options and the warnings, and behind its 3 offsets.
std::string pixels(const std::string& bytes) {
  const std::string last = std::string("screenWindowWidth\0float\0", 24);
  constexpr std::size_t kSizeValueAndEnd = 4 + 4 + 1, kOffsets = 3 * 8;
  return bytes.substr(bytes.find(last) + last.size() + kSizeValueAndEnd + kOffsets);
}

TEST_F(Batch, a_sequence_is_its_frames_one_by_one) {
  write_frames(8, 12);
  done({"--noise", "animated"});
  const auto together = outputs();
  EXPECT_EQ(together.size(), 5);
  EXPECT_NE(pixels(together.at("ao.0008.exr")), pixels(together.at("ao.0009.exr")))
      << "or else frames share their noise";
  for (int frame = 8; frame <= 12; frame++) {
    done_alone({input(frame), "-o", folder / "alone.exr", "--noise", "animated"});
    EXPECT_TRUE(read_bytes(folder / "alone.exr") == read_bytes(output(frame))) << frame;
  }
}

TEST(Chunks, share_the_frames_evenly) {
  const std::vector<int> frames{5, 6, 7, 8, 9, 10, 11};
  std::vector<int> all;
  for (int chunk = 1; chunk <= 3; chunk++) {
    const auto part = chunk_of(frames, chunk, 3);
    EXPECT_TRUE(part.size() == 2 || part.size() == 3);
    all.insert(all.end(), part.begin(), part.end());
  }
  EXPECT_EQ(all, frames);
  EXPECT_THAT(chunk_of({1}, 1, 2), IsEmpty());
  EXPECT_THAT(chunk_of({1}, 2, 2), ElementsAre(1));
}

TEST_F(Batch, every_file_has_a_pattern_of_its_own_and_a_static_one_serves_all_frames) {
  FrameFile depth = wall_frame(), normal = depth;
  depth.erase("Normal");
  normal.erase("Depth");
  for (const char* frame : {"-02", "-01", "000"}) depth.write(in + "/d" + frame + ".exr");
  for (const char* frame : {"-2", "-1", "0"}) normal.write(in + "/n." + frame + ".exr");
  done_alone(typed("--depth " + in + "/d@@@.exr --normal " + in + "/n.$F.exr -o " + out +
                   "/<f4>.exr --set output-offset=100 --frames -2-0"));
  EXPECT_THAT(names_in(out), ElementsAre("0098.exr", "0099.exr", "0100.exr"));
  remove_outputs();
  wall_frame().write(folder / "still.exr");
  done_alone({folder / "still.exr", "-o", out + "/ao.#.exr", "--frames", "3"});
  EXPECT_THAT(names_in(out), ElementsAre("ao.0003.exr"));
}

TEST_F(Batch, every_frame_has_its_camera) {
  write_frames(1, 2);
  json moving = wall_camera(), zoomed = moving;
  moving["frames"] = {{{"frame", 1}}, {{"frame", 2}, {"fx", 80.0}, {"fy", 80.0}}};
  write_bytes(folder / "moving.json", moving.dump());
  zoomed["fx"] = zoomed["fy"] = 80.0;
  write_bytes(folder / "zoom.0002.json", zoomed.dump());
  write_bytes(folder / "zoom.0001.json", wall_camera().dump());
  done({"--camera", folder / "moving.json"});
  const auto moved = read_bytes(output(2));
  done({"--camera", folder / "zoom.####.json"});
  EXPECT_EQ(pixels(read_bytes(output(2))), pixels(moved)) << "headers differ by the digest of the camera file";
  done();
  EXPECT_NE(pixels(read_bytes(output(2))), pixels(moved));
}

TEST_F(Batch, missing_frames_are_listed_before_any_work) {
  expect_refused(3, {}, {"f.0001.exr", "INPUT"});
  write_frames(1, 8);
  for (const int frame : {3, 5, 6}) fs::remove(input(frame));
  const Finished finished = run({"--frames", "1-8"});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, AllOf(HasSubstr("3 of 8 frames are missing: 3, 5-6"), HasSubstr("f.0003.exr"),
                                  HasSubstr("--set missing=skip")));
  EXPECT_THAT(names_in(out), IsEmpty());
  EXPECT_THAT(done(typed("--frames 1-8 --set missing=skip")).err, HasSubstr("3 missing (3, 5-6)"));
  EXPECT_THAT(names_in(out), ElementsAre("ao.0001.exr", "ao.0002.exr", "ao.0004.exr", "ao.0007.exr", "ao.0008.exr"));
  EXPECT_EQ(run(typed("--frames 3,5 --set missing=skip")).code, 3) << "nothing is left";
}

TEST_F(Batch, files_that_frames_would_share_are_refused) {
  write_frames(1, 3);
  expect_refused(2, {"-o", out + "/ao.exr"}, {"ao.exr", "all 3 frames", "%04d"});
  // The mirror of that: one frame with many numbers.
  const Options still{"run",      input(1), "--frames", "1-100", "-o", out + "/ao.%d.exr",
                      "--camera", camera,   "--radius", "1"};
  test::expect_refused(run_program(still), 2, {input(1), "all 100 frames", "%04d"});
  EXPECT_TRUE(names_in(out).empty());
}

TEST_F(Batch, a_preview_without_a_number_is_the_contact_sheet_of_the_shot) {
  write_frames(1, 5);
  const std::string sheet = out + "/sheet.png";
  constexpr int kLeastCell = 120;  // px, of small pictures
  const Options with_sheet{"--preview", sheet};
  const auto size_of = [&](std::size_t at) {  // a number of four bytes in the header of the PNG
    int number = 0;
    for (const char byte : read_bytes(sheet).substr(at, 4)) number = 256 * number + static_cast<unsigned char>(byte);
    return number;
  };
  done(with_sheet);
  EXPECT_EQ(names_in(out).size(), 6);
  EXPECT_EQ(size_of(16), 3 * (kLeastCell + 8) + 8);
  EXPECT_EQ(size_of(20), 2 * (24 + kWallWindow.height + 8) + 8);
  const std::string whole = read_bytes(sheet);
  done(joined(with_sheet, {"--threads", "1"}));
  EXPECT_TRUE(read_bytes(sheet) == whole) << "the cells do not depend on who is done first";
  expect_refused(2, joined(with_sheet, {"--resume"}), {"--preview", "contact sheet", "--resume", "%04d"});
  expect_refused(2, joined(with_sheet, typed("--chunk 1/2")), {"--preview", "all 5 frames", "--chunk", "%04d"});
  // A frame that fails has its number in its cell; a run that ends before all frames has no sheet.
  fs::remove(sheet);
  write_bytes(input(1), "no frame");
  EXPECT_EQ(run(with_sheet).code, 3);
  EXPECT_FALSE(fs::exists(sheet));
  EXPECT_EQ(run(joined(with_sheet, {"--keep-going"})).code, 1);
  EXPECT_EQ(size_of(16), 3 * (kLeastCell + 8) + 8);
  EXPECT_TRUE(read_bytes(sheet) != whole);
}

TEST_F(Batch, a_dry_run_tells_the_plan_and_does_nothing) {
  write_frames(1, 4);
  const auto before = names_in(folder.path());
  EXPECT_THAT(done(typed("--dry-run --frames 1-4 --device 99")).out,
              AllOf(HasSubstr("4: 1-4"), HasSubstr("f.0001.exr to "), HasSubstr("ao.0004.exr"), HasSubstr("64x36"),
                    HasSubstr("Depth"), HasSubstr("MiB")));
  EXPECT_EQ(names_in(folder.path()), before);
  done();
  fs::remove(output(2));
  EXPECT_THAT(lines_of(run({"--dry-run", "--resume"}).out), Contains(testing::MatchesRegex("kept +3: .*")));
}

TEST_F(Batch, guesses_are_made_once_by_the_first_frame_that_shows_anything) {
  FrameFile coded = wall_frame();
  coded.change("Normal", [](float n) { return 0.5f + 0.5f * n; });
  coded.write(input(2));
  FrameFile sky = coded, odd = coded;
  sky.change("Depth", [](float) { return 1e10f; });
  sky.write(input(1));
  // By itself it would be taken for signed; every normal of it is of unit length either way.
  odd.change("Normal", [](float n) { return n > 0.9f ? 1.0f : 0.0f; });
  odd.write(input(3));
  done(typed("--frames 1-3 --normal-space world"));
  const auto guessed = outputs();
  done(typed("--frames 1-3 --normal-space world --normal-encoding unorm"));
  for (const auto& [name, bytes] : outputs()) EXPECT_EQ(pixels(bytes), pixels(guessed.at(name))) << name;
  done(typed("--frames 3 --normal-space world"));
  EXPECT_NE(pixels(read_bytes(output(3))), pixels(guessed.at("ao.0003.exr")))
      << "or else the frames of this test show nothing";
}

TEST_F(Batch, sky_at_the_beginning_decides_nothing_however_long_it_is) {
  FrameFile sky = wall_frame(), coded = wall_frame();
  sky.change("Depth", [](float) { return 1e10f; });
  coded.change("Normal", [](float n) { return 0.5f + 0.5f * n; });
  write_frames(1, 11, sky);
  write_frames(12, 13, coded);
  done({"--frames", "12"});
  const std::string alone = read_bytes(output(12));
  remove_outputs();
  const Finished finished = done();
  EXPECT_EQ(pixels(read_bytes(output(12))), pixels(alone)) << finished;
  done(typed("--frames 1-100 --set missing=skip"));
  EXPECT_EQ(pixels(read_bytes(output(12))), pixels(alone)) << "of a sequence of which most frames are missing";
  // What is refused is refused behind sky, too, and before it.
  auto turned = wall_camera();
  turned["world_to_camera"] = {{0, 0, 1, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}};
  write_bytes(camera, turned.dump());
  wall_frame().write(input(12));
  sky.write(input(13));
  for (const char* frames : {"11-12", "12-13"}) {
    const Finished refused = run({"--frames", frames, "--keep-going"});
    EXPECT_EQ(refused.code, 1) << refused;
    EXPECT_THAT(refused.err, HasSubstr("--normal none")) << frames;
  }
}

TEST_F(Batch, progress_for_farms_goes_to_the_standard_output) {
  write_frames(1, 4);
  const auto percents_of = [](const std::string& out) {
    std::vector<int> percents;
    for (const auto& line : lines_of(out)) {
      EXPECT_TRUE(line.starts_with("Progress: ") && line.ends_with("%")) << line;
      percents.push_back(std::stoi(line.substr(10)));
    }
    EXPECT_TRUE(std::ranges::is_sorted(percents)) << out;
    return percents;
  };
  EXPECT_THAT(percents_of(run({"--progress", "percent", "--threads", "1"}).out), IsSupersetOf({25, 50, 75, 100}));
  const Finished quiet = run({"--progress", "percent", "--threads", "1", "-q"});
  EXPECT_THAT(percents_of(quiet.out), IsSupersetOf({25, 50, 75, 100})) << quiet;
  EXPECT_THAT(quiet.err, IsEmpty());
  const auto lines = lines_of(run({"--progress", "openjd", "--threads", "1"}).out);
  const auto at = [&](const char* begin) {
    return std::ranges::find_if(lines, [&](const std::string& line) { return line.starts_with(begin); });
  };
  ASSERT_NE(at("openjd_status: frame 1"), lines.end());
  EXPECT_EQ(*std::prev(at("openjd_status: frame 1")), "openjd_progress: 25.0");
  ASSERT_NE(at("openjd_status: frame 4"), lines.end());
  EXPECT_EQ(*std::prev(at("openjd_status: frame 4")), "openjd_progress: 100.0");
}

TEST_F(Batch, resume_says_why_frames_are_computed_again_and_no_pace_of_those_that_are_kept) {
  write_frames(1, 3);
  EXPECT_THAT(run().err, Not(HasSubstr("computed-again")));
  const Finished kept = run({"--resume"});
  EXPECT_THAT(kept.err, AllOf(HasSubstr("whole, kept (1 of 3)"), Not(HasSubstr("frames/s")),
                              Not(HasSubstr("no device")), Not(HasSubstr("computed-again"))));
  const auto expect_said = [&](const Options& more, const std::string& why) {
    const std::string text = "--resume computes again " + why + " [computed-again]";
    EXPECT_THAT(run(joined(more, {"--resume", "--dry-run"})).out, HasSubstr(text));
    EXPECT_THAT(lines_of(run(joined(more, {"--resume"})).err),
                Contains("alcove: note: " + in + "/f.%04d.exr: " + text));
  };
  write_bytes(output(2), read_bytes(output(2)).substr(0, 300));
  fs::remove(output(3));  // which is not made again
  expect_said({}, "frame 2: --output is no whole file of Alcove");
  expect_said({"--set", "intensity=0.5"}, "frames 1-3: other settings made them");
  expect_said({"--radius", "0.5"}, "frames 1-3: other settings made them, with the radius 1, not 0.5");
}

TEST_F(Batch, a_dry_run_says_how_many_frames_there_are_at_once_and_why) {
  write_frames(1, 3);
  EXPECT_THAT(run({"--dry-run", "--threads", "2"}).out, HasSubstr(": 2 at once on a CPU, one per thread (--threads)"));
  EXPECT_THAT(run({"--dry-run", "--threads", "9"}).out, HasSubstr(": 3 at once, since there are no more"));
}

TEST_F(Batch, plain_progress_is_whole_lines_and_a_summary_at_the_end) {
  write_frames(1, 3);
  const Finished finished = run();
  EXPECT_THAT(finished.out, IsEmpty());
  EXPECT_THAT(finished.err,
              AllOf(HasSubstr("(1 of 3, "), HasSubstr("frames/s"), HasSubstr("0:00 left"), Not(HasSubstr("\r"))));
  EXPECT_THAT(lines_of(finished.err).back(), StartsWith("alcove: 3 frames done, in "));
  EXPECT_THAT(run({"-q"}).err, IsEmpty());
  EXPECT_THAT(run({"--progress", "bar"}).err, HasSubstr("\r"));
  EXPECT_EQ(lines_of(run({"--progress", "none"}).err).back().substr(0, 21), "alcove: 3 frames done");
}

TEST_F(Batch, the_log_has_an_object_a_line) {
  write_frames(1, 3);
  const std::string log = folder / "log.jsonl";
  const json totals = stats_of({"--log-json", log, "--threads", "2"})["totals"];
  const auto lines = lines_of(read_bytes(log));
  ASSERT_EQ(lines.size(), 5);
  EXPECT_EQ(json::parse(lines[0])["event"], "begin");
  EXPECT_EQ(json::parse(lines[0])["frames"], 3);
  for (int i = 1; i <= 3; i++) {
    const json frame = json::parse(lines[std::size_t(i)]);
    EXPECT_EQ(frame["frame"], i);
    EXPECT_EQ(frame["state"], "done");
    EXPECT_GT(frame["ms"]["total"], 0);
    EXPECT_GT(frame["time"], 1.6e9);
  }
  EXPECT_EQ(json::parse(lines[4])["done"], 3);
  EXPECT_EQ(totals["frames"], 3);
  EXPECT_EQ(totals["at_once"], 2);
  EXPECT_THAT(run({"--log-json", "-", "--progress", "none"}).out, StartsWith("{\"event\":\"begin\""));
  EXPECT_EQ(run({"--log-json", folder / "none/log", "--set", "no-mkdir=true"}).code, 4);
}

TEST_F(Batch, memory_does_not_grow_with_the_frames) {
#if defined(ALCOVE_SANITIZE_ADDRESS) || defined(ALCOVE_SANITIZE_THREAD)
  GTEST_SKIP() << "sanitizers keep what is freed, and what they know of each access";
#endif
  write_frames(1, 200);
  const auto peak = [&](const char* frames) {
    return stats_of({"--frames", frames, "--threads", "2", "-q"})["totals"]["peak_rss_mb"].get<double>();
  };
  EXPECT_LT(peak("1-200"), peak("1-20") + 6);
}

}  // namespace
}  // namespace alcove::batch_test
