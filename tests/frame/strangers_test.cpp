// Files as strangers bring them: every case of tests/strangers is read right, or is refused or warned about with its
// true cause.
// SPDX-License-Identifier: BSD-3-Clause
#include <regex>

#include "core/base/half.h"
#include "core/formats/exr.h"
#include "core/frame/camera/camera.h"
#include "core/frame/camera/linear.h"
#include "tests/support/program.h"
#include "tests/support/scenes.h"
#include "tests/support/wall_frame.h"

namespace alcove::strangers_test {
namespace {

using namespace test;
using Planes = std::map<std::string, std::vector<float>>;
using Texts = std::map<std::string, std::string>;

const std::string kFolder = std::string(ALCOVE_SOURCE_DIR) + "/tests/strangers";

/// The surfaces of a plain form, whose sky has depth 0, for those who store them in other numbers by other names.
class Surfaces {
 public:
  explicit Surfaces(const std::string& name)
      : image_(read_exr_image(kFolder + "/plain/" + name + ".exr")),
        camera_(read_camera(kFolder + "/plain/" + name + ".json", 0)) {}

  double z(std::size_t i) const { return image_.plane("Z")[i]; }
  Vector3 normal(std::size_t i) const {
    return {image_.plane("N.X")[i], image_.plane("N.Y")[i], image_.plane("N.Z")[i]};
  }
  Vector3 view_normal(std::size_t i) const { return times(*camera_.view_from_world, normal(i)); }
  /// Its place from the eye, in view space.
  Vector3 seen(std::size_t i) const {
    const auto width = std::size_t(image_.data.width);
    const double x = double(i % width) + 0.5 - camera_.cx, y = double(i / width) + 0.5 - camera_.cy;
    return {x / camera_.fx * z(i), -y / camera_.fy * z(i), -z(i)};
  }
  Vector3 place(std::size_t i) const {
    return times(transposed(*camera_.view_from_world), difference(seen(i), camera_.view_from_world_offset));
  }

  std::vector<float> plane(double sky, const std::function<double(std::size_t)>& value) const {
    std::vector<float> plane;
    for (std::size_t i = 0; i < image_.data.pixels(); i++) plane.push_back(float(z(i) == 0 ? sky : value(i)));
    return plane;
  }
  std::vector<float> depth(
      double sky, const std::function<double(double)>& value = [](double z) { return z; }) const {
    return plane(sky, [&](std::size_t i) { return value(z(i)); });
  }
  /// Depth and normals, which are nothing in the sky.
  Planes with_normals(std::vector<float> depth, const std::function<Vector3(std::size_t)>& normal) const {
    Planes planes{{"Z", std::move(depth)}};
    for (const std::size_t k : {0, 1, 2})
      planes[std::string("N.") + "XYZ"[k]] = plane(0, [&](std::size_t i) { return normal(i)[k]; });
    return planes;
  }

 private:
  Image image_;
  Camera camera_;
};

double half(double value) { return from_half(to_half(float(value))); }

/// What Movie Render Queue says of the camera, in centimetres, z up; the lens is told for a pass.
Texts unreal(const std::string& pass) {
  return {{"unreal/camera/curPos/x", "-90.0"},     {"unreal/camera/curPos/y", "15.0"},
          {"unreal/camera/curPos/z", "135.0"},     {"unreal/camera/curRot/yaw", "-3.4"},
          {"unreal/camera/curRot/pitch", "-11.5"}, {"unreal/camera/curRot/roll", "0.0"},
          {"unreal/engineVersion", "5.4"},         {"unreal/camera/" + pass + "/fov", "55.5"}};
}

/// Makes the files that hold the surfaces of plain forms in other numbers, under other names.
void make_files(const std::string& folder) {
  const Surfaces main("main");
  const auto write = [&](const std::string& name, const Planes& planes, const Texts& attributes = {},
                         const std::set<std::string>& halves = {}) {
    const Window window{0, 0, 192, 108};
    FrameFile{window, window, 1, planes, halves, attributes}.write(folder + "/" + name);
  };
  const auto normal = [&](std::size_t i) { return main.normal(i); };

  write("q01.exr", {{"Z", main.depth(0, half)}});
  const std::string unreal_depth = "FinalImageMovieRenderQueue_WorldDepth";
  const auto centimetres = [](double z) { return 100 * z; };
  write("q04.exr", {{unreal_depth + ".R", main.depth(65504, [](double z) { return half(100 * z); })}},
        unreal("FinalImage"));
  write("u01.exr", {{unreal_depth + ".R", main.depth(65504, centimetres)}}, unreal("PathTracer"));
  write("u02.exr", {{unreal_depth + "_CineCam_A.R", main.depth(65504, centimetres)}}, unreal("FinalImage_CineCam_A"));
  write("r01.exr", {{"Z", main.plane(0, [&](std::size_t i) { return length(main.seen(i)); })}}, {}, {"Z"});
  write("s01.exr", main.with_normals(main.depth(1e10, std::negate()), normal));
  write("s02.exr", main.with_normals(main.depth(1000), normal));

  // Normalized and device depth.
  write("m01.exr", {{"zDepth.R", main.depth(1e10, [](double z) { return (z - 3) / 3; })}},
        {{"vrayInfo/vrayversion", "6"}});
  double near = 1e9, far = 0;
  for (const float z : main.depth(0))
    if (z > 0) near = std::min(near, double(z)), far = std::max(far, double(z));
  write("m02.exr", {{"Z", main.depth(0, [&](double z) { return (far - z) / (far - near) * 1.0000017; })}});
  write("d01.exr", {{"R", main.depth(1, [](double z) { return 1000.0 / 999 * (1 - 1 / z); })}});

  // Normals.
  const auto turned_where = [&](const std::function<bool(const Vector3& place)>& is_turned) {
    return main.with_normals(main.depth(0),
                             [&](std::size_t i) { return scaled(main.normal(i), is_turned(main.place(i)) ? -1 : 1); });
  };
  write("n01.exr", turned_where([](const Vector3& place) {
          return length(difference(place, {0.25, 0.45, -3.2})) < 0.4501;  // of a ball
        }));
  write("n02.exr", turned_where([](const Vector3& place) { return place[1] < 1e-4; }));  // of the floor
  write("n03.exr", main.with_normals(main.depth(0), [&](std::size_t i) {
    const Vector3 n = main.normal(i);
    return Vector3{std::abs(n[0]), std::abs(n[1]), std::abs(n[2])};
  }));
  write("zpass.exr", {{"Z", main.depth(0)}});
  Planes named{{"Depth.V", main.depth(1e10)}}, colours;
  for (const std::size_t k : {0, 1, 2}) {
    named[std::string("Normal.") + "XYZ"[k]] = main.plane(0, [&](std::size_t i) { return main.normal(i)[k]; });
    colours[{"RGB"[k]}] = main.plane(0, [&](std::size_t i) { return 0.5 + 0.5 * main.normal(i)[k]; });
    named[std::string("Image.") + "RGB"[k]] = colours["R"];
  }
  write("npass.exr", colours);
  write("b01.exr", named, {}, {"Image.R", "Image.G", "Image.B"});
  for (const std::string name : {"t01", "t02"}) {
    const Surfaces turned(name);
    write(name + ".exr", turned.with_normals(turned.depth(0), [&](std::size_t i) { return turned.view_normal(i); }));
  }
  // In the world of a camera that is turned about x, then z, as Blender turns it.
  const auto turn = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return std::pair{std::cos(angle), std::sin(angle)};
  };
  const auto [cx, sx] = turn(90 - 11.5);
  const auto [cz, sz] = turn(25);
  const Matrix3 world_from_view =
      product({{{cz, -sz, 0}, {sz, cz, 0}, {0, 0, 1}}}, {{{1, 0, 0}, {0, cx, -sx}, {0, sx, cx}}});
  write("z01.0001.exr",
        main.with_normals(main.depth(0), [&](std::size_t i) { return times(world_from_view, main.view_normal(i)); }));
}

const json& all_cases() {
  static const json cases = json::parse(read_bytes(kFolder + "/cases.json"));
  return cases;
}

class Strangers : public testing::TestWithParam<std::size_t> {
 protected:
  /// A folder of all files, those that are kept and those that are made.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    make_files(folder_->path());
    for (const auto& entry : fs::directory_iterator(kFolder))
      fs::create_symlink(entry.path(), *folder_ / entry.path().filename());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Finished call(const std::string& command, const Options& arguments, const std::string& output) {
    const Options all = joined({command}, arguments);
    const Options run{"-o", *folder_ / output, "--progress", "none"};
    return run_program(command == "run" ? joined(all, run) : all, {.folder = folder_->path()});
  }

  /// The AO that it should be: by ray tracing, or of the run of a plain form with the rest of its arguments.
  static std::vector<float> truth_of(const std::string& to, const Options& more) {
    if (!to.starts_with("plain/")) return read_exr_image(*folder_ / to, {"Y"}).pixels;
    static std::map<Options, std::vector<float>> computed;
    Options run{to, "--camera", fs::path(to).replace_extension(".json"), "--radius", "0.6", "--depth-kind", "planar"};
    run.insert(run.end(), more.begin(), more.end());
    auto& ao = computed[run];
    if (!ao.empty()) return ao;
    const Finished finished = call("run", run, "plain.ao.exr");
    EXPECT_EQ(finished.code, 0) << finished;
    return ao = read_exr_image(*folder_ / "plain.ao.exr", {"Y"}).pixels;
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_P(Strangers, AreReadRightOrToldWhatIsWrong) {
  const json& row = all_cases()[GetParam()];
  SCOPED_TRACE(row["what"].get<std::string>());
  const std::string command = row.contains("inspect") ? "inspect" : "run";
  const Finished finished = call(command, row[command].get<Options>(), "ao.exr");
  EXPECT_EQ(finished.code, row.value("exit", 0)) << finished;
  const std::string said = command == "inspect" ? finished.out + finished.err : finished.err;
  for (const char* key : {"says", "not_says"})
    for (const auto& pattern : row.value(key, Options()))
      EXPECT_EQ(std::regex_search(said, std::regex(pattern, std::regex::icase)), key == std::string("says"))
          << key << " /" << pattern << "/ " << finished;
  if (!row.contains("rmse") || finished.code != 0) return;
  const std::vector<float> ao = read_exr_image(*folder_ / "ao.exr", {"Y"}).pixels,
                           truth = truth_of(row["to"], row.value("plain", Options{"--normal-space", "world",
                                                                                  "--normal-encoding", "signed"}));
  ASSERT_EQ(ao.size(), truth.size());
  EXPECT_LE(difference(ao, truth).rmse, row["rmse"].get<double>()) << finished;
}

INSTANTIATE_TEST_SUITE_P(Pack, Strangers, testing::Range(std::size_t(0), all_cases().size()), [](const auto& info) {
  std::string name = all_cases()[info.param]["name"];
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace alcove::strangers_test
