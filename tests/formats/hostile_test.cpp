// Files made to do harm: what they say is neither believed nor run, and takes no memory that was not allowed.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/png.h"
#include "core/formats/sequence.h"
#include "core/frame/camera/camera.h"
#include "core/frame/settle/settle.h"
#include "tests/support/command_line.h"
#include "tests/support/test.h"

namespace alcove::hostile_test {
namespace {

using namespace test;

/// A grey PNG of 8 bits without pixels.
std::string png_claiming(std::uint32_t width, std::uint32_t height) {
  const auto word = [](std::uint32_t x) { return std::string{char(x >> 24), char(x >> 16), char(x >> 8), char(x)}; };
  const auto chunk = [&](const std::string& body) {
    std::uint32_t sum = ~0u;
    for (const unsigned char byte : body) {
      sum ^= byte;
      for (int bit = 0; bit < 8; bit++) sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0u);
    }
    return word(std::uint32_t(body.size() - 4)) + body + word(~sum);
  };
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + word(width) + word(height) + std::string("\x08\0\0\0\0", 5)) +
         chunk("IDAT") + chunk("IEND");
}

class Hostile : public CommandLine {
 protected:
  /// The frame, claiming another data window in its header.
  std::string claiming(int width, int height, std::size_t bytes) const {
    std::string file = read_bytes(frame);
    const std::int32_t right_and_bottom[] = {width - 1, height - 1};
    for (const char* name : {"dataWindow", "displayWindow"})
      file.replace(file.find(name) + std::strlen(name) + sizeof("box2i") + 13, 8,
                   reinterpret_cast<const char*>(right_and_bottom), 8);
    file.resize(bytes);
    write_bytes(folder / "claim.exr", file);
    return folder / "claim.exr";
  }
};

// Names. Those in report pages: report_test.

TEST_F(Hostile, inspect_prints_names_of_headers_as_text_that_no_terminal_obeys) {
  FrameFile file = wall_frame();
  file.rename("ViewLayer.Depth.Z", "<script>\x1b[2J.Z");
  file.attributes = {{"Software", "\x1b]0;title\x07\r\n`touch x`"}};
  file.write(frame);
  const auto said = [&](const Options& more) {
    const Finished finished = run_program(joined({"inspect", frame, "--camera", camera}, more));
    EXPECT_THAT(finished.out + finished.err, Not(ContainsRegex("[\x01-\x09\x0b-\x1f\x7f]")));
    return finished;
  };
  EXPECT_THAT(said({"-v"}).out, AllOf(HasSubstr("<script>"), HasSubstr("?]0;title???`touch x`")));
  EXPECT_TRUE(json::accept(said({"--json"}).out));
  EXPECT_THAT(said({"--depth-channel", "none"}).out, HasSubstr("?[2J.Z"));
}

TEST_F(Hostile, a_frame_s_name_is_printed_as_text_that_no_terminal_obeys) {
  const std::string name = folder / "a\nopenjd_fail: \x1b[2J\u009b2J\u202etxt.exr";
  fs::rename(frame, name);
  for (const Options& more : {Options{"-v"}, {"--resume"}, {"--depth", folder / "none\n\u009b.exr"}}) {
    const Options arguments{"run", name, "-o", name + ".ao.exr", "--camera", camera, "--progress", "plain"};
    const Finished finished = run_program(joined(joined(arguments, {"--radius", "1"}), more));
    EXPECT_EQ(finished.code, more[0] == "--depth" ? 3 : 0) << finished;
    EXPECT_THAT(finished.err, Not(ContainsRegex("[\x01-\x09\x0b-\x1f\x7f]"))) << finished;
    EXPECT_THAT(finished.err,
                AllOf(Not(HasSubstr("\nopenjd_fail")), Not(HasSubstr("\u009b")), Not(HasSubstr("\u202e"))))
        << finished;
    EXPECT_THAT(finished.err, HasSubstr(more[0] == "--depth" ? "none??.exr" : "a?openjd_fail: ?[2J?2J?txt.exr"))
        << "or nothing is proved";
  }
}

TEST_F(Hostile, the_command_that_inspect_proposes_quotes_what_a_shell_would_run) {
  const std::string name = folder / "$(touch x)`touch x`'; touch x; '.exr";
  fs::rename(frame, name);
  const Finished inspected = run_well({"inspect", name, "--camera", camera, "--json"});
  const std::string command = json::parse(inspected.out)["command"];
  const std::string echo =
      "cd " + folder.path() + " && set -- " + command.substr(std::strlen("alcove ")) + " && printf %s \"$2\"";
  Launch shell;
  shell.program = "/bin/sh";
  EXPECT_EQ(run_program({"-c", echo}, shell).out, name);
  EXPECT_FALSE(fs::exists(folder / "x"));
}

// Memory.

TEST_F(Hostile, no_header_makes_a_run_take_more_memory_than_it_may) {
#ifdef ALCOVE_SANITIZE_ADDRESS
  GTEST_SKIP() << "the address sanitizer takes memory of its own";
#endif
  const long plain = run({"--memory", "184M"}).peak_mib;
  // depth and normals, while it is settled what they mean
  constexpr long evidence = (4 * sizeof(float) * kEvidencePixels) >> 20;
  ASSERT_GT(plain, 0);
  // Each with as many bytes as its table of offsets needs, and as may stand for so many pixels.
  for (const auto& [width, height, bytes] :
       {std::tuple(16384, 16384, 5000), {1 << 26, 1, 2000}, {1, 100000, 60000}, {1 << 20, 64, 3000}}) {
    const std::string claim = claiming(width, height, std::size_t(bytes));
    for (const Options& more : {Options{}, {"--roi", "0,0,1,1"}, {"--preview", folder / "p.png"}}) {
      const Options arguments = typed("--fov 60 --normal-space view --radius 1 --memory 184M");
      const Finished finished = run_program(joined(joined({"run", claim, "-o", ao}, arguments), more));
      EXPECT_TRUE(finished.code == 2 || finished.code == 3 || finished.code == 5) << finished;
      EXPECT_EQ(lines_of(finished.err).size(), 1) << finished;
      EXPECT_LT(finished.peak_mib, plain + 64 + evidence) << width << " x " << height << finished;
    }
  }
}

TEST_F(Hostile, no_display_window_makes_a_preview_take_more_memory_than_it_may) {
  const Window display{0, 0, 60000, 60000};
  wall_frame(kWallWindow, display).write(frame);
  write_bytes(camera, wall_camera(display).dump());
  const Finished refused = run({"--memory", "256M", "--preview", folder / "p.png"});
  EXPECT_EQ(refused.code, 2) << refused;
  EXPECT_THAT(lines_of(refused.err).back(),
              AllOf(HasSubstr(frame), HasSubstr("60000x60000"), HasSubstr("--preview"), HasSubstr("--memory")));
  EXPECT_FALSE(fs::exists(ao));
  EXPECT_EQ(run({"--memory", "256M"}).code, 0) << "without the preview nothing is as large as the display window";
}

TEST_F(Hostile, no_picture_makes_a_run_take_more_memory_than_its_rows) {
#ifdef ALCOVE_SANITIZE_ADDRESS
  GTEST_SKIP() << "the address sanitizer takes memory of its own";
#endif
  const std::string claim = folder / "claim.png", black = folder / "black.png", fits = folder / "fits.png";
  write_bytes(claim, png_claiming(30000, 30000));
  write_png(black, 4000, 4000, 3, std::vector<float>(3 * 4000 * 4000));
  write_png(fits, 64, 36, 3, std::vector<float>(3 * 64 * 36, 0.5f));
  const auto with_normal = [&](const std::string& picture) {
    return run({"--memory", "184M", "--normal", picture, "--normal-space", "view"});
  };
  const Finished plain = with_normal(fits);
  ASSERT_EQ(plain.code, 0) << plain;
  ASSERT_LT(fs::file_size(black), 600'000);
  for (const std::string& picture : {claim, black}) {
    const Finished finished = with_normal(picture);
    EXPECT_EQ(finished.code, 3) << finished;
    EXPECT_THAT(finished.err, AllOf(HasSubstr(picture), HasSubstr(picture == claim ? "cannot hold" : "4000x4000")));
    EXPECT_LT(finished.peak_mib, plain.peak_mib + 32) << finished;
  }
  const Finished compared = run_program({"compare", claim, claim});
  EXPECT_EQ(compared.code, 3) << compared;
  EXPECT_LT(compared.peak_mib, plain.peak_mib + 32) << compared;
}

TEST_F(Hostile, a_header_of_more_pixels_than_its_bytes_can_stand_for_is_refused) {
  const std::string claim = claiming(1 << 14, 1 << 14, 3000), text = "16384 x 16384 pixels";
  expect_error(ErrorKind::input, {text, "3000 bytes"}, [&] { ExrFile(claim, "INPUT"); });
  for (const Options& more : {Options{"inspect", claim, "--camera", camera},
                              {"inspect", claim, "--camera", camera, "--preview", folder / "sheet.png"},
                              {"compare", claim, claim}})
    test::expect_refused(run_program(more), 3, {text});
}

// Text.

TEST_F(Hostile, a_camera_that_nests_without_end_is_refused) {
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  for (const std::string& text :
       {"{\"fx\": " + deep + "}", "{\"frames\": [{\"frame\": 1, \"fx\": " + deep + "}]}", deep}) {
    write_bytes(camera, text);
    EXPECT_THROW(read_camera(camera, 1), Error);
  }
}

TEST_F(Hostile, a_frame_of_a_camera_is_the_number_that_is_written) {
  json fields = wall_camera();
  fields["frames"] = {{{"frame", 4294967297}}};  // 1 in 32 bits
  write_bytes(camera, fields.dump());
  EXPECT_THROW(read_camera(camera, 1), Error);
}

TEST_F(Hostile, frame_numbers_beyond_all_numbers_and_lists_that_repeat_many_are_refused) {
  std::string many = "1-999999";
  for (int i = 0; i < 1000; i++) many += ",1-999999";
  for (const std::string& list :
       {std::string("-9223372036854775808"), std::string("9223372036854775807"),
        std::string("0-9223372036854775807x4611686018427387904"), std::string("1--9223372036854775808"), many})
    EXPECT_THROW(parse_frames(list), Error) << list.substr(0, 60);
}

TEST_F(Hostile, a_zero_byte_in_a_preset_is_refused) {  // or it would end a file's name early
  write_bytes(folder / "p.toml", "depth = \"" + frame + "\\u0000.exr\"\n");
  expect_refused(2, {"--preset", folder / "p.toml"}, {"zero byte"});
}

}  // namespace
}  // namespace alcove::hostile_test
