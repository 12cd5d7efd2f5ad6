// What surfaces reflect of a sky: white ones, bad ones, one with a sun; again, and as numbers for compositors.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/formats/exr.h"
#include "core/frame/find/lights.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::relight_test {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;
const Window kWindow{0, 0, 90, 60};

using Light = std::function<float(double x, double y, double z, std::size_t channel)>;

/// A lat-long picture of what comes from each direction.
std::vector<float> sky_planes(int width, int height, const Light& light) {
  std::vector<float> planes;
  for (std::size_t c = 0; c < 3; c++)
    for (int j = 0; j < height; j++)
      for (int i = 0; i < width; i++) {
        const double turn = (0.5 - (i + 0.5) / width) * 2 * kPi, up = (0.5 - (j + 0.5) / height) * kPi;
        planes.push_back(light(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up), c));
      }
  return planes;
}

/// Blue above and brown below, without a sun.
float gradient(double, double, double z, std::size_t c) {
  const double up = 0.5 + 0.5 * z, t = 1 / (1 + std::exp(-25 * z));
  const double low[] = {0.9, 0.85, 0.8}, high[] = {0.25, 0.45, 0.9}, ground[] = {0.22, 0.17, 0.12};
  return float(ground[c] + (std::pow(1 - up, 4) * low[c] + up * high[c] - ground[c]) * t);
}

float with_sun(double x, double y, double z, std::size_t c) {
  return gradient(x, y, z, c) + float(14 * std::exp((0.6 * x + 0.8 * z - 1) / (1 - std::cos(12 * kPi / 180))));
}

class Relight : public CommandLine {
 protected:
  Relight() {
    wall_frame(kWindow, kWindow).write(frame);
    write_bytes(camera, wall_camera(kWindow).dump());
  }
  void write_sky(const Light& light, int width = 64, int height = 32) const {
    write_planes(sky_planes(width, height, light), width, height);
  }
  void write_planes(const std::vector<float>& planes, int width, int height) const {
    FrameFile file;
    file.data = file.display = {0, 0, width, height};
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    for (std::size_t c = 0; c < 3; c++)
      file.planes[std::string(1, "RGB"[c])] = {planes.begin() + std::ptrdiff_t(c * pixels),
                                               planes.begin() + std::ptrdiff_t((c + 1) * pixels)};
    file.write(sky);
  }
  Options lit(const std::string& more = {}) const { return joined({"--environment", sky}, typed(more)); }
  const std::string sky = folder / "sky.exr";
};

TEST_F(Relight, of_a_white_sky_is_the_ao) {
  write_sky([](double, double, double, std::size_t) { return 1.0f; });
  for (const char* more : {"", "--preset reference", "--tolerance 0.01", "--radius 0.2 --aov ao-scales"}) {
    const Image image = computed(lit(more));
    const bool has_scales = std::ranges::count(image.names, "scale2.Y") > 0;
    const auto ao = image.plane(has_scales ? "scale2.Y" : "Y");
    for (const char* channel : {"relight.R", "relight.G", "relight.B"}) {
      const auto light = image.plane(channel);
      int surfaces = 0;
      for (std::size_t i = 0; i < light.size(); i++) {
        const float white = light[i] == 0 ? 0 : ao[i];  // sky reflects nothing
        ASSERT_NEAR(light[i], white, 1e-3) << more << " " << i;
        surfaces += light[i] > 0;
      }
      EXPECT_GT(surfaces, 4000) << more;
    }
  }
}

// A surface sees 2/3 of what grows with a coordinate along its normal, and 1/4 of what grows with a product of two.
TEST_F(Relight, of_each_direction_comes_from_there) {
  json turned = wall_camera(kWindow);
  turned["world_to_camera"] = {
      {-0.780869, 0.624695, 0, 0}, {-0.399805, -0.499756, 0.768375, 0}, {0.48, 0.6, 0.64, 0}, {0, 0, 0, 1}};
  write_bytes(camera, turned.dump());
  const double n[] = {0.48, 0.6, 0.64};  // of the wall, which faces the camera
  const auto factors = [](auto x, auto y, auto z) {
    return std::array<std::array<double, 3>, 3>{
        {{x, y, z}, {x * y, y * z, z * x}, {x * x - y * y, z * z - 1.0 / 3, 0}}};
  };
  for (std::size_t set = 0; set < 3; set++) {
    write_sky([&](double x, double y, double z, std::size_t c) { return float(1 + 0.9 * factors(x, y, z)[set][c]); },
              256, 128);
    const Image image = computed(lit("--normal none --aov relight-open"));
    for (std::size_t c = 0; c < 3; c++) {
      const auto light = image.plane(std::string("relight-open.") + "RGB"[c]);
      const double seen = 1 + 0.9 * (set == 0 ? 2.0 / 3 : 0.25) * factors(n[0], n[1], n[2])[set][c];
      EXPECT_NEAR(light[light.size() / 2 + 10], seen, 4e-3) << "set " << set << ", channel " << c;
    }
  }
}

TEST_F(Relight, of_open_surfaces_is_that_without_occlusion_and_else_less) {
  write_sky(gradient);
  const Image image = computed(lit("--aov ao,relight-open,normal"));
  const auto ao = image.plane("Y"), light = image.plane("relight.B"), open = image.plane("relight-open.B");
  int blocked = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    if (ao[i] == 1) ASSERT_NEAR(light[i], open[i], 2e-3) << i;
    if (ao[i] < 0.8) ASSERT_LT(light[i], open[i]) << i;
    blocked += ao[i] < 0.8;
  }
  EXPECT_GT(blocked, 50);
}

TEST_F(Relight, is_computed_again_for_another_sky_and_warns_of_a_sun) {
  write_sky(gradient);
  const Options all = lit("--aov ao,relight-open");
  EXPECT_EQ(done(all).code, 0);
  const std::string first = read_bytes(ao);
  EXPECT_THAT(done(joined(all, {"--resume"})).err, Not(HasSubstr("[computed-again]")));
  write_sky(with_sun);
  const Finished again = done(joined(all, {"--resume"}));
  EXPECT_THAT(again.err, AllOf(HasSubstr("[computed-again]"), HasSubstr("[sun-in-sky]"), HasSubstr("% of its light")));
  EXPECT_NE(read_bytes(ao), first);
}

TEST_F(Relight, bad_skies_are_told_in_a_sentence) {
  const auto refused = [&](const Options& texts) { expect_refused(3, lit(), texts); };
  write_sky(gradient, 64, 30);
  refused({"sky.exr", "64 x 30", "twice as wide as high"});
  for (const float bad : {-0.5f, NAN, INFINITY}) {
    auto planes = sky_planes(64, 32, gradient);
    planes[3000] = bad;
    write_planes(planes, 64, 32);
    refused({"sky.exr", fmt::format("{}", bad), "not below 0"});
  }
  write_bytes(folder / "sky.png", "\x89PNG\r\n\x1a\n");
  expect_refused(3, {"--environment", folder / "sky.png"}, {"sky.png", "8 bits"});
  write_sky(gradient);
  auto without = wall_camera(kWindow);
  without.erase("world_to_camera");
  write_bytes(camera, without.dump());
  expect_refused(3, lit("--normal none"), {"--environment", "world_to_camera"});
  expect_refused(2, typed("--aov relight-open"), {"--aov relight-open", "--environment"});
}

TEST_F(Relight, of_nine_numbers_errs_by_2_percent_of_the_open_light_of_a_gradient) {
  const int width = 128, height = 64;
  const auto planes = sky_planes(width, height, gradient);
  const Environment sky_of = environment_of(planes, width, height);
  EXPECT_LT(sky_of.missed, kMostMissed);
  EXPECT_GT(environment_of(sky_planes(width, height, with_sun), width, height).missed, kMostMissed);
  // A receiver whose normal and whose one occluder turn: none, a half space or a round one.
  double squares[3]{}, open[3]{};
  int count = 0;
  for (int turn = 0; turn < 12; turn++)
    for (int tilt = 0; tilt < 5; tilt++, count++) {
      const double a = 0.9 * turn, b = 0.7 * tilt, c = 2.3 * turn + tilt, d = 1.1 * tilt - 0.5;
      const double n[] = {std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)};
      const double o[] = {std::cos(d) * std::cos(c), std::cos(d) * std::sin(c), std::sin(d)};
      double truth[3]{}, whole[3]{}, transfer[9]{};
      for (int j = 0; j < height; j++)
        for (int i = 0; i < width; i++) {
          const double u = (0.5 - (i + 0.5) / width) * 2 * kPi, v = (0.5 - (j + 0.5) / height) * kPi;
          const double w[] = {std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)};
          const double angle = 2 * kPi / width * kPi / height * std::cos(v);
          const double cosine = std::max(0.0, n[0] * w[0] + n[1] * w[1] + n[2] * w[2]) * angle / kPi;
          const bool is_open = o[0] * w[0] + o[1] * w[1] + o[2] * w[2] < std::array{2.0, 0.0, 0.8}[turn % 3];
          const double y[] = {0.282095,
                              0.488603 * w[1],
                              0.488603 * w[2],
                              0.488603 * w[0],
                              1.092548 * w[0] * w[1],
                              1.092548 * w[1] * w[2],
                              0.315392 * (3 * w[2] * w[2] - 1),
                              1.092548 * w[0] * w[2],
                              0.546274 * (w[0] * w[0] - w[1] * w[1])};
          for (std::size_t k = 0; k < 9; k++) transfer[k] += is_open ? cosine * y[k] : 0;
          for (std::size_t channel = 0; channel < 3; channel++) {
            const double light = cosine * double(gradient(w[0], w[1], w[2], channel));
            whole[channel] += light;
            truth[channel] += is_open ? light : 0;
          }
        }
      for (std::size_t channel = 0; channel < 3; channel++) {
        double sum = 0;
        for (std::size_t k = 0; k < 9; k++) sum += transfer[k] * sky_of.light[k][channel];
        squares[channel] += (sum - truth[channel]) * (sum - truth[channel]);
        open[channel] += whole[channel];
      }
    }
  for (std::size_t channel = 0; channel < 3; channel++)
    EXPECT_LE(std::sqrt(squares[channel] / count), 0.02 * open[channel] / count) << channel;
}

TEST_F(Relight, as_the_node_that_inspect_prints_is_what_a_run_writes) {
  write_sky(gradient);
  const std::string text = run_well({"inspect", sky}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("nine colours"), HasSubstr("% of the light"), HasSubstr("Expression {")));
  const json read = json::parse(run_well({"inspect", sky, "--json"}).out);
  const Image image = computed(lit("--aov transfer"));
  static const std::regex kTerm(R"((-?[0-9.]+)\*(transfer[0-2]\.[XYZ]))");
  for (std::size_t c = 0; c < 3; c++) {
    const std::size_t begin = text.find(fmt::format("expr{} ", c));
    const std::string expression = text.substr(begin, text.find('\n', begin) - begin);
    std::vector<double> sum(kWindow.pixels());
    std::size_t k = 0;
    for (std::sregex_iterator term(expression.begin(), expression.end(), kTerm), end; term != end; ++term, k++) {
      const auto plane = image.plane((*term)[2].str());
      EXPECT_NEAR(std::stod((*term)[1].str()), read["sky"][k][c].get<double>(), 1e-6);
      for (std::size_t i = 0; i < sum.size(); i++) sum[i] += std::stod((*term)[1].str()) * double(plane[i]);
    }
    EXPECT_EQ(k, 9u);
    const auto light = image.plane(fmt::format("relight.{}", "RGB"[c]));
    for (std::size_t i = 0; i < sum.size(); i++) ASSERT_NEAR(light[i], std::max(0.0, sum[i]), 1e-5);
  }
}

}  // namespace
}  // namespace alcove::relight_test
