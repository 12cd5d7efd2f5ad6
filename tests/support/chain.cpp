// Runs of the chain, closed forms, and planes at every slant.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"

#include "core/frame/find/frame_source.h"

namespace alcove::test {

EstimatorSettings sampled(Estimator estimator, double radius, int slices, int steps) {
  EstimatorSettings settings = plain_settings();
  settings.estimator = estimator;
  settings.radius = radius;
  settings.slices = slices;
  settings.steps = steps;
  return settings;
}

EstimatorSettings exact(double radius, int slices) {
  EstimatorSettings settings = sampled(Estimator::gtao, radius, slices, 64);
  settings.search = SliceSearch::exact;
  settings.thickness = ThicknessKind::automatic;
  return settings;
}

EstimatorSettings shared_directions(double radius) {
  EstimatorSettings settings = exact(radius, 4);
  settings.denoise = Denoise::bilateral;
  settings.denoise_kernel = {1, 0.5};
  return settings;
}

std::string name_of(const EstimatorSettings& s) {
  return fmt::format(
      "estimator {}, radius {}, {} x {} or {}, search {}, tolerance {}, complete {}, thickness {}, falloff {}, "
      "elevation "
      "{}, kernel {}, range check {}, denoise {} by {}, stride {}, density {}, resolution 1/{}",
      int(s.estimator), s.radius.value_or(0), s.slices, s.steps, s.samples, int(s.search), s.tolerance, int(s.complete),
      int(s.thickness), int(s.falloff), int(s.elevation), int(s.sample_kernel), int(s.range_check), int(s.denoise),
      s.denoise_radius, s.stride, int(s.density), int(s.resolution));
}

std::vector<float> values_of(const gpu::Buffer* buffer) {
  if (!buffer) return {};
  const auto values = buffer->as<const float>();
  return {values.begin(), values.end()};
}

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

Planes planes_of(const HostFrame& frame, const EstimatorSettings& settings, const std::string& aovs, bool completed) {
  OutputSettings output;
  output.aovs = aovs;
  if (completed) output.stats = "stats.json";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  if (outputs.completed) recorder().download(*outputs.completed);
  recorder().run();
  Planes planes{values_of(outputs.ao),
                values_of(outputs.scales),
                values_of(outputs.normal),
                values_of(outputs.bent_normal),
                values_of(outputs.transfer),
                values_of(outputs.confidence),
                values_of(outputs.error),
                values_of(outputs.specular_occlusion),
                values_of(outputs.completed),
                values_of(outputs.convexity),
                values_of(outputs.cavity),
                values_of(outputs.curvature),
                {},
                {}};
  if (outputs.tiles) planes.tiles = outputs.tiles->as<TileCounts>()[0];
  for (const auto& pass : recorder().passes()) planes.passes.push_back(pass.name);
  return planes;
}

HostFrame rendered_frame(const std::string& scene) {
  InputSettings input;
  input.input = ALCOVE_SOURCE_DIR "/examples/bench/" + scene + ".gbuffer.exr";
  input.camera = ALCOVE_SOURCE_DIR "/examples/bench/" + scene + ".camera.json";
  return read_host_frame(input, 0);
}

HostFrame crop_of(const HostFrame& whole, const Window& window) {
  HostFrame crop = whole;
  crop.data = window;
  crop.depth = cropped(whole.depth, whole.data, window);
  crop.normal = cropped(whole.normal, whole.data, window);
  return crop;
}

void expect_open(const HostFrame& frame, const EstimatorSettings& settings, double tolerance) {
  const Difference d = difference(ao_of(frame, settings), [](std::size_t) { return 1.0; });
  EXPECT_LE(d.max, tolerance) << name_of(settings) << ", " << place(d, frame);
}

double segment(double x) { return x >= 1 ? 0 : std::acos(x) - x * std::sqrt(1 - x * x); }

double beside_wall(double distance) { return 1 - segment(distance) / kPi; }

double beside_corner(double distance_a, double distance_b) {
  const double a = std::min(1.0, distance_a), b = std::min(1.0, distance_b), far_a = std::sqrt(1 - b * b);
  const auto area = [](double x) { return 0.5 * (x * std::sqrt(1 - x * x) + std::asin(x)); };
  const double both = a * a + b * b >= 1 ? 0 : area(far_a) - area(a) - b * (far_a - a);
  return 1 - (segment(a) + segment(b) - both) / kPi;
}

Errors errors_of(const Rendering& rendering, const std::vector<float>& ao, const Truth& truth, int clear_px) {
  Errors errors;
  for (std::size_t i = 0; i < ao.size(); i++) {
    const int x = int(i) % rendering.shot.data.width, y = int(i) / rendering.shot.data.width;
    const Hit& hit = rendering.hits[i];
    if (hit.primitive < 0 || rendering.primitives_within(clear_px, x, y) > 1 ||
        rendering.primitives_within(2, x, y) > 2)
      continue;
    const double expected = truth(hit), error = ao[i] - expected;
    if (std::isnan(expected)) continue;
    errors.pixels.push_back(i);
    errors.truths.push_back(expected);
    errors.mean += std::abs(error);
    errors.bias += error;
    if (std::abs(error) <= errors.worst) continue;
    errors.worst = std::abs(error);
    errors.where = fmt::format("pixel {} {} of primitive {}: {} for {}", x, y, hit.primitive, ao[i], expected);
  }
  errors.mean /= double(errors.pixels.size());
  errors.bias /= double(errors.pixels.size());
  return errors;
}

Truth wall_truth(const Shot& shot, double radius) {
  return [&shot, radius](const Hit& hit) {
    if (hit.primitive > 1 || !shot.sees_ball(hit.position, radius)) return kNone;
    return beside_wall((hit.primitive == 0 ? hit.position.x : hit.position.z) / radius);
  };
}

Shot along_x(double fov, int width, int height, double units) {
  return fov > 0 ? Shot::perspective({}, {1, 0, 0}, fov, width, height)
                 : Shot::orthographic({}, {1, 0, 0}, units, width, height);
}

std::vector<SlantedPlane> slanted_planes(const std::vector<double>& tilts, const std::vector<double>& turns,
                                         const std::vector<double>& fovs, int width, int height, double distance,
                                         double units) {
  std::vector<SlantedPlane> all;
  for (const double tilt : tilts)
    for (const double turn : turns)
      for (const double fov : fovs) {
        const double sine = std::sin(tilt * kRadian);
        const Vec3 normal{-std::cos(tilt * kRadian), sine * std::cos(turn * kRadian), sine * std::sin(turn * kRadian)};
        all.push_back(
            {fmt::format("tilt {}, turn {}, field of view {}", tilt, turn, fov),
             render({{Plane{.point = {distance, 0, 0}, .normal = normal}}}, along_x(fov, width, height, units))});
      }
  return all;
}

}  // namespace alcove::test
