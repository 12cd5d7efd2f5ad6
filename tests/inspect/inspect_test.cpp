// `alcove inspect`: what it says is what `run` does, and what is missing is named with the option that gives it.
// SPDX-License-Identifier: BSD-3-Clause
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/formats/exr.h"
#include "tests/support/command_line.h"

namespace alcove {
namespace {

using namespace test;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

class Inspect : public CommandLine {
 protected:
  Finished inspect(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"inspect", frame};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }

  json inspected(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = more;
    arguments.emplace_back("--json");
    const Finished finished = inspect(arguments);
    EXPECT_EQ(finished.code, 0) << finished;
    EXPECT_EQ(finished.err, "");
    return json::parse(finished.out);
  }
};

TEST_F(Inspect, lists_files_channels_and_attributes) {
  FrameFile file = wall_frame();
  file.halves = {"ViewLayer.Normal.X"};
  file.attributes["Camera"] = "Camera.001";
  file.write(frame);
  const json all = inspected({"--camera", camera});
  const json& part = all["files"][0]["parts"][0];
  EXPECT_EQ(all["files"][0]["path"], frame);
  EXPECT_EQ(part["channels"][0], (json{{"name", "ViewLayer.Depth.Z"}, {"type", "float"}}));
  EXPECT_EQ(part["channels"][1], (json{{"name", "ViewLayer.Normal.X"}, {"type", "half"}}));
  EXPECT_EQ(part["attributes"]["Camera"], "Camera.001");
  EXPECT_EQ(part["data_window"], "64x36 at (0, 0)");
}

TEST_F(Inspect, says_what_would_be_used_and_how_it_is_understood) {
  const json all = inspected({"--camera", camera});
  EXPECT_EQ(all["aovs"]["depth"]["channels"], json::array({"ViewLayer.Depth.Z"}));
  EXPECT_EQ(all["aovs"]["normal"]["channels"],
            json::array({"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"}));
  EXPECT_EQ(all["depth"]["kind"], "planar");
  EXPECT_NEAR(all["depth"]["farthest"].get<double>(), 6, 1e-6);
  EXPECT_EQ(all["depth"]["sky_share"], 0);
  EXPECT_EQ(all["normals"]["space"], "world");
  EXPECT_EQ(all["normals"]["unit_share"], 1);
  EXPECT_GT(all["normals"]["agreement"], 0.95);
  EXPECT_EQ(all["normals"]["facing"], 1);
  EXPECT_EQ(all["camera"]["world_to_camera"], true);
  EXPECT_NEAR(all["camera"]["horizontal_fov"].get<double>(), 56.145, 1e-3);
}

TEST_F(Inspect, counts_sky_and_sentinels) {
  FrameFile file = wall_frame();
  auto& depth = file.planes["ViewLayer.Depth.Z"];
  depth[0] = std::numeric_limits<float>::quiet_NaN();
  depth[1] = 0;
  depth[2] = -1;
  depth[3] = 1e10f;
  depth[4] = std::numeric_limits<float>::infinity();
  file.write(frame);
  const json all = inspected({"--camera", camera})["depth"];
  for (const char* what : {"nan", "zero", "negative", "infinite"}) EXPECT_EQ(all[what], 1) << what;
  EXPECT_NEAR(all["sky_share"].get<double>(), 5.0 / (64 * 36), 1e-9);
}

TEST_F(Inspect, the_command_it_gives_runs_and_guesses_nothing) {
  json fields = wall_camera();
  fields.erase("depth");
  fields.erase("normal_space");
  write_bytes(camera, fields.dump());
  const json all = inspected({"--camera", camera});
  EXPECT_FALSE(all["guesses"].empty());
  std::istringstream words(all["command"].get<std::string>());
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) arguments.push_back(word == "ao.exr" ? ao : word);
  ASSERT_EQ(arguments[0], "alcove");
  arguments.erase(arguments.begin());
  arguments.emplace_back("--strict");
  const Finished finished = run_program(arguments);
  EXPECT_EQ(finished.code, 0) << finished;
}

TEST_F(Inspect, names_what_is_missing_and_the_option_that_gives_it) {
  FrameFile file = wall_frame();
  for (const char* name : {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"}) file.planes.erase(name);
  file.write(frame);
  const Finished finished = inspect();
  EXPECT_EQ(finished.code, 0) << finished;
  for (const char* word :
       {"missing: camera", "--camera", "--fov", "missing: normals", "--normal-channels", "missing: beauty"})
    EXPECT_THAT(finished.out, HasSubstr(word));
}

TEST_F(Inspect, a_frame_without_depth_is_described_with_what_is_missing) {
  FrameFile file = wall_frame();
  file.planes.erase("ViewLayer.Depth.Z");
  file.write(frame);
  const json all = inspected({"--camera", camera});
  EXPECT_EQ(all["files"][0]["parts"][0]["channels"].size(), 3);
  EXPECT_THAT(all["missing"].dump(), HasSubstr("--depth-channel"));
  EXPECT_EQ(all["depth"], nullptr);
}

TEST_F(Inspect, what_run_would_refuse_is_part_of_the_answer) {
  const json all = inspected({"--camera", camera, "--depth-kind", "device"});
  EXPECT_THAT(all["missing"].dump(), HasSubstr("--near"));
  EXPECT_EQ(all["depth"]["kind"], "device");
}

TEST_F(Inspect, text_and_json_say_the_same) {
  const json all = inspected({"--camera", camera});
  const std::string text = inspect({"--camera", camera}).out;
  EXPECT_THAT(text, HasSubstr(all["command"].get<std::string>()));
  EXPECT_THAT(text, HasSubstr("depth: planar"));
  EXPECT_THAT(text, HasSubstr("normals: world space, signed"));
}

TEST_F(Inspect, says_which_program_wrote_the_frame) {
  EXPECT_EQ(inspected({"--camera", camera})["source"]["name"], "cycles");
  const json said = inspected({"--camera", camera, "--preset", "input/generic"});
  EXPECT_EQ(said["source"]["name"], "generic");
  EXPECT_EQ(said["source"]["by"], "--source");
  EXPECT_THAT(said["command"].get<std::string>(), HasSubstr("--source generic"));
  const Finished finished = inspect({"--source", "blendr5"});
  EXPECT_EQ(finished.code, 2);
  EXPECT_THAT(finished.err, HasSubstr("blender5"));
}

TEST_F(Inspect, what_is_suspicious_is_said) {
  EXPECT_EQ(inspected({"--camera", camera})["suspicious"].size(), 0);
  FrameFile file = wall_frame({-4, 0, 72, 36});
  for (const char* name : {"ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"})
    for (std::size_t i = 0; i < file.planes[name].size(); i += 4) file.planes[name][i] *= 0.5f;
  file.write(frame);
  const std::string suspicious = inspected({"--camera", camera})["suspicious"].dump();
  EXPECT_THAT(suspicious, HasSubstr("25 % of the normals"));
  EXPECT_THAT(suspicious, HasSubstr("data window is 72x36"));
}

TEST_F(Inspect, half_depth_is_suspicious) {
  FrameFile file = wall_frame();
  file.halves = {"ViewLayer.Depth.Z"};
  file.write(frame);
  const json suspicious = inspected({"--camera", camera})["suspicious"];
  ASSERT_EQ(suspicious.size(), 1) << suspicious;
  EXPECT_THAT(suspicious[0].get<std::string>(), testing::AllOf(HasSubstr("half float"), HasSubstr("steps of")));
}

TEST_F(Inspect, channels_that_dwa_damages_are_suspicious) {
  FrameFile file = wall_frame();
  for (const auto& [axis, color] : {std::pair("X", "R"), {"Y", "G"}, {"Z", "B"}})
    file.rename(std::string("ViewLayer.Normal.") + axis, std::string("ViewLayer.Normal.") + color);
  for (const auto compression : {Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    Imf::Header header(file.data.width, file.data.height);
    header.compression() = compression;
    Imf::FrameBuffer pixels;
    for (const auto& [name, plane] : file.planes) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      pixels.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), header.dataWindow()));
    }
    {
      Imf::OutputFile out(frame.c_str(), header);
      out.setFrameBuffer(pixels);
      out.writePixels(file.data.height);
    }
    const std::string suspicious = inspected({"--camera", camera})["suspicious"].dump();
    const bool is_lossy = compression != Imf::ZIP_COMPRESSION;
    for (const char* color : {"R", "G", "B"})
      EXPECT_EQ(suspicious.find(std::string("ViewLayer.Normal.") + color + " is compressed by DWA") != suspicious.npos,
                is_lossy)
          << suspicious;
    EXPECT_EQ(suspicious.find("Depth.Z"), suspicious.npos) << "DWA keeps a channel of that name";
  }
}

TEST_F(Inspect, a_file_cut_short_is_suspicious_and_its_header_is_shown) {
  const std::string whole = read_bytes(frame);
  write_bytes(frame, whole.substr(0, whole.size() / 2));
  const Finished finished = inspect({"--camera", camera, "--json"});
  EXPECT_EQ(finished.code, 3);
  EXPECT_THAT(finished.err, HasSubstr("damaged or incomplete"));
  const json all = json::parse(finished.out);
  EXPECT_EQ(all["files"][0]["parts"][0]["channels"].size(), 4);
  EXPECT_THAT(all["suspicious"].dump(), HasSubstr("damaged or incomplete"));
  EXPECT_EQ(all["command"], "");
}

TEST_F(Inspect, without_a_camera_nothing_is_said_that_needs_one) {
  const json all = inspected({});
  EXPECT_EQ(all["camera"], nullptr);
  EXPECT_EQ(all["normals"]["space"], "world") << "as Blender writes them";
  EXPECT_EQ(all["normals"]["scores"].size(), 0);
  EXPECT_FALSE(all["normals"].contains("agreement"));
  EXPECT_EQ(all["notes"].size(), 0) << all["notes"];
  EXPECT_THAT(all["command"].get<std::string>(),
              testing::AllOf(HasSubstr("--camera CAMERA.json"), testing::Not(HasSubstr("--normal-space"))));
  EXPECT_THAT(inspect().out, HasSubstr("missing: camera"));
}

TEST_F(Inspect, lengths_are_of_vectors_only) {
  EXPECT_EQ(inspected({"--camera", camera})["normals"]["mean_length"], 1);
  const json all = inspected({"--camera", camera, "--normal-encoding", "spheremap"})["normals"];
  EXPECT_EQ(all["encoding"], "spheremap");
  EXPECT_EQ(all["mean_length"], nullptr);
  EXPECT_EQ(inspect({"--camera", camera, "--normal-encoding", "spheremap"}).out.find("mean length"), std::string::npos);
}

TEST_F(Inspect, what_a_terminal_would_obey_is_not_printed) {
  FrameFile file = wall_frame();
  file.planes["\x1b[31mred"] = file.planes["ViewLayer.Depth.Z"];
  file.attributes["Camera"] = "a\x1b[2Jb\nc";
  file.write(frame);
  const Finished finished = inspect({"--camera", camera});
  EXPECT_EQ(finished.out.find('\x1b'), std::string::npos);
  EXPECT_THAT(finished.out, HasSubstr("a?[2Jb?c"));
  const Finished refused = inspect({"--camera", camera, "--depth-channel", "none"});
  EXPECT_EQ((refused.out + refused.err).find('\x1b'), std::string::npos);
}

TEST_F(Inspect, bad_files_and_arguments_have_their_exit_codes) {
  EXPECT_EQ(run_program({"inspect", folder / "missing.exr"}).code, 3);
  write_bytes(folder / "text.exr", "no image");
  EXPECT_EQ(run_program({"inspect", folder / "text.exr"}).code, 3);
  EXPECT_EQ(run_program({"inspect"}).code, 2);
  EXPECT_EQ(inspect({"--nonsense"}).code, 2);
  EXPECT_EQ(run_program({"inspect", "--help"}).code, 0);
  const std::string whole = read_bytes(frame);
  write_bytes(frame, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(inspect({"--camera", camera}).code, 3);
}

}  // namespace
}  // namespace alcove
