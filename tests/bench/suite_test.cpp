// Suites of the benchmark: at which radius each candidate is measured, with how much grain, and with how much mottle.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/measure/metrics.h"
#include "tests/support/command_line.h"

namespace alcove::suite_test {
namespace {

using namespace test;

class SuiteRadius : public CommandLine {
 protected:
  /// Measures the candidates on the wall, whose truth is what a run computes at the radius 1. Gives the RMSE of each.
  std::map<std::string, double> errors_of(const std::string& candidates) {
    EXPECT_EQ(run({"--type", "float"}).code, 0);
    write_bytes(folder / "suite.toml",
                "title = \"radii\"\nrepeats = 1\nreference-slices = 0\n[[frame]]\nname = \"wall\"\ninput = "
                "\"wall.0042.exr\"\ncamera = \"camera.json\"\nradius = 1\ntruth = \"ao.exr\"\n" +
                    candidates);
    const std::string file = folder / "report.json";
    run_well({"bench", folder / "suite.toml", "-q", "--json", file});
    const auto report = json::parse(read_bytes(file));
    std::map<std::string, double> errors;
    for (const auto& row : report["rows"]) errors[row["candidate"]] = row["rmse"];
    return errors;
  }
};

TEST_F(SuiteRadius, is_the_candidates_own_where_it_names_one) {
  const auto errors = errors_of(
      "[[candidate]]\nname = \"the frame's\"\nslices = 4\n"
      "[[candidate]]\nname = \"its own\"\nradius = 0.1\n"
      "[[sweep]]\nradius = [1, 0.1]\n");
  EXPECT_LT(errors.at("the frame's"), 1e-6);
  EXPECT_GT(errors.at("its own"), 0.01);
  EXPECT_LT(errors.at("radius 1"), 1e-6);
  EXPECT_EQ(errors.at("radius 0.1"), errors.at("its own"));
}

TEST_F(SuiteRadius, is_the_frames_whatever_a_preset_says) {
  write_bytes(folder / "one.toml", "radius = 0.1\n");
  write_bytes(folder / "two.toml", "radius = [0.1, 0.2]\n");
  const auto errors = errors_of("[[candidate]]\nname = \"one\"\npreset = \"" + folder / "one.toml" +
                                "\"\n[[candidate]]\nname = \"two\"\npreset = \"" + folder / "two.toml" + "\"\n");
  EXPECT_LT(errors.at("one"), 1e-6);
  EXPECT_LT(errors.at("two"), 1e-6);
}

class SuiteGrain : public CommandLine {
 protected:
  SuiteGrain() {
    compute(frame, camera, ao, "1");
    compute(frame, camera, second, "2");
    compute(frame, camera, far, "4");
    const Window window{0, 0, 16, 16};  // too few for a plain pixel
    wall_frame(window, window).write(folder / "small.exr");
    write_bytes(folder / "small.json", wall_camera(window).dump());
    compute(folder / "small.exr", folder / "small.json", folder / "small-ao.exr", "1");
  }

  /// Runs once for all cases.
  static void compute(const std::string& input, const std::string& seen_by, const std::string& output,
                      const std::string& radius) {
    static std::map<std::string, std::string> made;
    std::string& bytes = made[fs::path(output).filename()];
    if (bytes.empty()) {
      const Finished finished =
          run_well({"run", input, "-o", output, "--camera", seen_by, "--type", "float", "--radius", radius});
      bytes = read_bytes(output);
    }
    write_bytes(output, bytes);
  }

  static std::string frame_table(const std::string& name, const std::string& input, const std::string& camera_name,
                                 const std::string& truth) {
    return fmt::format("[[frame]]\nname = '{}'\ninput = '{}'\ncamera = '{}'\nradius = 1\ntruth = {}\n", name, input,
                       camera_name, truth);
  }

  Finished bench(const std::string& frames, const Options& more) const {
    write_bytes(folder / "suite.toml", "title = \"grain\"\nrepeats = 1\nreference-slices = 0\n" + frames +
                                           "[[candidate]]\nname = \"far\"\nradius = 4\n");
    return run_program(joined({"bench", folder / "suite.toml"}, more));
  }

  json report_of(const std::string& frames) const {
    const Finished finished = bench(frames, {"--json", folder / "report.json", "-q"});
    EXPECT_EQ(finished.code, 0) << finished;
    return json::parse(read_bytes(folder / "report.json"));
  }

  double compared(const Options& more) const {
    return json::parse(run_program(joined({"compare", far, ao, "--depth", frame, "--json"}, more)).out)["grain"];
  }

  /// A measure that the small frame has no pixels for. `behind` it: what the CSV goes on with.
  void expect_only_of_wall(const std::string& measure, const std::string& behind) const {
    const auto report = report_of(both);
    const double value = report["rows"][0][measure];
    EXPECT_TRUE(report["rows"][1].contains(measure) && report["rows"][1][measure].is_null());
    EXPECT_EQ(report["candidates"][0][measure], value);
    const Finished finished = bench(both, {"--csv", folder / "report.csv", "--report", folder / "page.html"});
    EXPECT_EQ(finished.code, 0) << finished;
    const std::string digits = fmt::format("{:.10f}", value).substr(0, 6);
    EXPECT_THAT(lines_of(finished.out)[0], HasSubstr("   " + measure + " "));
    EXPECT_THAT(lines_of(finished.out)[1], HasSubstr(fmt::format("{:.4f}", value)));
    const auto csv = lines_of(read_bytes(folder / "report.csv"));
    EXPECT_THAT(csv[0], testing::EndsWith(",grain,mottle"));
    EXPECT_THAT(csv[1], ContainsRegex("," + digits + "[0-9]*" + behind));
    EXPECT_THAT(csv[2], testing::EndsWith(",,"));
    EXPECT_THAT(read_bytes(folder / "page.html"),
                AllOf(HasSubstr("\"" + measure + "\": " + digits), HasSubstr("heading: '" + measure + "'")));
  }

  /// A limit of a measure that is `value` on the wall.
  void expect_limit(const std::string& measure, double value, const Options& words) const {
    const auto limited = [&](const std::string& name, double most) {
      write_bytes(folder / "limits.toml",
                  fmt::format("[[limit]]\nframe = \"{}\"\ncandidate = \"far\"\n{} = {}\n", name, measure, most));
      return bench(both, {"--limits", folder / "limits.toml", "-q"});
    };
    EXPECT_EQ(limited("wall", value + 1e-4).code, 0);
    const Finished broken = limited("wall", value - 1e-4);
    EXPECT_EQ(broken.code, 6) << broken;
    EXPECT_THAT(broken.err, StartsWith("alcove: far on wall: " + measure + " is "));
    test::expect_refused(limited("small", 1), 3, joined({"far on small: " + measure, "--limits"}, words));
  }

  const std::string second = folder / "second.exr", far = folder / "far.exr";
  const std::string wall = frame_table("wall", "wall.0042.exr", "camera.json", "\"ao.exr\"");
  const std::string both = wall + frame_table("small", "small.exr", "small.json", "\"small-ao.exr\"");
};

TEST_F(SuiteGrain, is_what_compare_says) {
  const double expected = compared({});
  EXPECT_GT(expected, 1e-3);
  EXPECT_NEAR(report_of(wall)["rows"][0]["grain"], expected, 1e-6);
  const std::string two = frame_table("wall", "wall.0042.exr", "camera.json", "[\"ao.exr\", \"second.exr\"]");
  const double of_two = compared({"--reference-b", second});
  EXPECT_GT(std::abs(of_two - expected), 1e-5);
  EXPECT_NEAR(report_of(two)["rows"][0]["grain"], of_two, 1e-6);
}

TEST_F(SuiteGrain, is_looked_for_in_planar_depth_whatever_the_file_has) {
  FrameFile ray = wall_frame();
  json ray_camera = wall_camera();
  ray_camera["depth"] = "ray";
  auto& depth = ray.planes["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < depth.size(); i++) depth[i] *= float(ray_length(i));
  ray.write(folder / "ray.exr");
  write_bytes(folder / "ray.json", ray_camera.dump());
  const auto row = report_of(frame_table("ray", "ray.exr", "ray.json", "\"ao.exr\""))["rows"][0];
  EXPECT_NEAR(row["grain"], compared({}), 1e-4);
}

TEST_F(SuiteGrain, of_a_frame_without_plain_pixels_is_nothing_and_in_no_mean) { expect_only_of_wall("grain", ","); }

TEST_F(SuiteGrain, has_a_limit_that_holds_breaks_or_cannot_be_checked) { expect_limit("grain", compared({}), {}); }

class SuiteMottle : public SuiteGrain {
 protected:
  /// Between what `alcove run` gives for the seeds 1 to 3.
  double expected() const {
    std::vector<std::vector<float>> results;
    for (const char* seed : {"1", "2", "3"}) results.push_back(written({"--radius", "4", "--seed", seed}).pixels);
    write_bytes(ao, truth);
    const auto planes = wall_frame().planes;
    std::vector<float> normal;
    for (const char* axis : {"X", "Y", "Z"}) {
      const auto& plane = planes.at(std::string("ViewLayer.Normal.") + axis);
      normal.insert(normal.end(), plane.begin(), plane.end());
    }
    const auto half =
        half_shadow(64, 36, planes.at("ViewLayer.Depth.Z"), 1e9, normal, read_exr_image(folder / "ao.exr").pixels);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < half.size(); i++) {
      if (!half[i]) continue;
      const double a = results[0][i], b = results[1][i], c = results[2][i], mean = (a + b + c) / 3;
      sum += (std::pow(a - mean, 2) + std::pow(b - mean, 2) + std::pow(c - mean, 2)) / 2;
      count++;
    }
    return std::sqrt(sum / count);
  }

  const std::string truth = read_bytes(ao);
};

TEST_F(SuiteMottle, is_the_deviation_between_runs_with_three_seeds) {
  const double deviation = expected();
  EXPECT_GT(deviation, 1e-3);
  EXPECT_NEAR(report_of(wall)["rows"][0]["mottle"], deviation, 1e-6);
}

TEST_F(SuiteMottle, of_a_frame_without_half_shadow_is_nothing_and_in_no_mean) { expect_only_of_wall("mottle", "$"); }

TEST_F(SuiteMottle, has_a_limit_that_holds_breaks_or_cannot_be_checked) {
  expect_limit("mottle", expected(), {"half shadow"});
}

TEST(Presets, of_quality_have_limits_on_every_frame_of_the_suite) {
  const std::string root = ALCOVE_SOURCE_DIR "/", suite = read_bytes(root + "examples/bench/suite.toml"),
                    limits = read_bytes(root + "examples/bench/limits.toml");
  const auto count = [](const std::string& text, const std::string& line) {
    return std::ranges::count(lines_of(text), line);
  };
  for (const auto& file : names_in(root + "presets")) {
    if (file.find('/') != file.npos || !file.ends_with(".toml")) continue;
    const std::string name = fs::path(file).stem().string();
    EXPECT_THAT(suite, HasSubstr("preset = \"" + name + "\""));
    EXPECT_EQ(count(limits, "candidate = \"" + name + "\""), count(suite, "[[frame]]")) << name;
  }
}

}  // namespace
}  // namespace alcove::suite_test
