// Runs of the chain, closed forms, and planes at every slant.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/chain.h"

#include "core/chain/filters/filters.h"
#include "core/frame/find/frame_source.h"
#include "tests/support/device.h"

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

Prepared prepared(const HostFrame& frame) {
  Prepared result{upload(recorder(), frame), {}};
  result.gbuffer = reconstruct(recorder(), prepare(recorder(), result.inputs));
  return result;
}

std::vector<float> values_of(const gpu::Buffer* buffer) {
  if (!buffer) return {};
  const auto values = buffer->as<const float>();
  return {values.begin(), values.end()};
}

std::vector<float> ao_of(const HostFrame& frame, const EstimatorSettings& settings) {
  return compute_ao(recorder(), frame, settings).ao;
}

std::vector<float> ao_at(const HostFrame& frame, const EstimatorSettings& settings,
                         const std::vector<std::size_t>& pixels) {
  const FrameOutputs outputs = run_chain(recorder(), with_matte(frame, pixels), settings);
  recorder().run();
  return values_of(outputs.ao);
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

namespace {

/// The pixels that are compared, and their truths.
Errors compared(const Rendering& rendering, const Truth& truth, int clear_px) {
  Errors errors;
  for (std::size_t i = 0; i < rendering.hits.size(); i++) {
    const int x = int(i) % rendering.shot.data.width, y = int(i) / rendering.shot.data.width;
    const Hit& hit = rendering.hits[i];
    if (hit.primitive < 0 || rendering.primitives_within(clear_px, x, y) > 1 ||
        rendering.primitives_within(2, x, y) > 2)
      continue;
    const double expected = truth(hit);
    if (std::isnan(expected)) continue;
    errors.pixels.push_back(i);
    errors.truths.push_back(expected);
  }
  return errors;
}

/// Adds how far the AO is from these truths.
Errors measured(Errors errors, const Rendering& rendering, const std::vector<float>& ao) {
  const auto width = std::size_t(rendering.shot.data.width);
  for (std::size_t k = 0; k < errors.pixels.size(); k++) {
    const std::size_t i = errors.pixels[k];
    const double error = ao[i] - errors.truths[k];
    errors.mean += std::abs(error);
    errors.bias += error;
    if (std::abs(error) <= errors.worst) continue;
    errors.worst = std::abs(error);
    errors.where = fmt::format("pixel {} {} of primitive {}: {} for {}", i % width, i / width,
                               rendering.hits[i].primitive, ao[i], errors.truths[k]);
  }
  errors.mean /= double(errors.pixels.size());
  errors.bias /= double(errors.pixels.size());
  return errors;
}

}  // namespace

Errors errors_of(const Rendering& rendering, const std::vector<float>& ao, const Truth& truth, int clear_px) {
  return measured(compared(rendering, truth, clear_px), rendering, ao);
}

Errors errors_of(const Rendering& rendering, const EstimatorSettings& settings, const Truth& truth, int clear_px) {
  const Errors errors = compared(rendering, truth, clear_px);
  return measured(errors, rendering, ao_at(rendering.frame, settings, errors.pixels));
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

namespace {

std::size_t index_of(int x, int y, int width) { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

}  // namespace

std::vector<float> denoised(const HostFrame& frame, const std::vector<float>& ao, const EstimatorSettings& settings) {
  const GBuffer gbuffer = prepared(frame).gbuffer;
  return downloaded<float>(denoise(recorder(), gbuffer, given("visibility of a test", ao), denoiser_of(settings)));
}

std::vector<float> upsampled(const HostFrame& frame, const std::function<double(int, int)>& ao_of_block,
                             const EstimatorSettings& settings) {
  const Prepared whole = prepared(frame);
  const GBuffer low = downsample(recorder(), whole.gbuffer, block_grid(whole.inputs, int(settings.resolution)));
  std::vector<float> ao;
  for (int y = 0; y < low.view.size.y; y++)
    for (int x = 0; x < low.view.size.x; x++) ao.push_back(float(ao_of_block(x, y)));
  return downloaded<float>(upsample(recorder(), whole.gbuffer, low, given("visibility of a test", ao)));
}

Rendering furnished_room(int width, int height) { return render(kRoom, room_shot(width, height)); }

std::vector<float> mirrored(const std::vector<float>& plane, const HostFrame& frame, bool left_right) {
  const int width = frame.data.width, height = frame.data.height;
  std::vector<float> result;
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      result.push_back(plane[left_right ? index_of(width - 1 - x, y, width) : index_of(x, height - 1 - y, width)]);
  return result;
}

HostFrame mirrored(const HostFrame& frame, bool left_right) {
  HostFrame result = frame;
  const std::size_t pixels = frame.data.pixels();
  result.depth = mirrored(frame.depth, frame, left_right);
  for (std::size_t axis = 0; axis < 3; axis++) {
    const auto from = frame.normal.begin() + std::ptrdiff_t(axis * pixels);
    std::vector<float> plane = mirrored({from, from + std::ptrdiff_t(pixels)}, frame, left_right);
    if (axis == (left_right ? 0 : 1)) std::ranges::transform(plane, plane.begin(), std::negate());
    std::ranges::copy(plane, result.normal.begin() + std::ptrdiff_t(axis * pixels));
  }
  (left_right ? result.camera.cx : result.camera.cy) =
      left_right ? frame.data.width - frame.camera.cx : frame.data.height - frame.camera.cy;
  return result;
}

HostFrame scaled(HostFrame frame, int exponent) {
  for (auto* depths : {&frame.depth, &frame.behind_depth})
    for (float& z : *depths) z = std::ldexp(z, exponent);
  if (frame.camera.orthographic)
    frame.camera.fx = std::ldexp(frame.camera.fx, -exponent), frame.camera.fy = std::ldexp(frame.camera.fy, -exponent);
  frame.sky = std::ldexp(frame.sky, exponent);
  return frame;
}

HostFrame random_bits(int width, int height, unsigned seed) {
  HostFrame frame = furnished_room(width, height).frame;
  std::mt19937 random(seed);
  for (auto* plane : {&frame.depth, &frame.normal})
    for (float& value : *plane)
      if (random() % 3) value = std::bit_cast<float>(std::uint32_t(random()));
  return frame;
}

FloorByWalls floor_by_walls(int walls, const Shot& shot, double radius) {
  Scene scene{{kFloor, kWallX}};
  if (walls > 1) scene.primitives.emplace_back(kWallY);
  FloorByWalls floor{walls, radius, render(scene, shot), {}};
  int seen = 0;
  for (std::size_t i = 0; i < floor.rendering.hits.size(); i++) {
    const Hit& hit = floor.rendering.hits[i];
    const int x = int(i % std::size_t(shot.data.width)), y = int(i / std::size_t(shot.data.width));
    if (hit.primitive == 0 && floor.rendering.primitives_within(2, x, y) == 1 &&
        12 * floor.rendering.footprint(x, y) <= radius && shot.sees_ball(hit.position, radius) &&
        hit.position.x <= 0.9 * radius && ++seen % 13 == 0)
      floor.pixels.push_back(i);
  }
  EXPECT_GE(floor.pixels.size(), 30u);
  return floor;
}

Shot rolled(Shot shot, double roll) {
  const Vec3 right = shot.right, up = shot.up;
  shot.right = std::cos(roll * kRadian) * right + std::sin(roll * kRadian) * up;
  shot.up = std::cos(roll * kRadian) * up - std::sin(roll * kRadian) * right;
  return shot;
}

Means means_of(const Scene& scene, const Shot& shot, const Chosen& chosen, int every,
               const std::function<std::vector<float>(const HostFrame&, const std::vector<std::size_t>&)>& ao_at) {
  const Rendering rendering = render(scene, shot);
  std::vector<std::size_t> pixels;
  for (int y = 1; y < shot.data.height - 1; y += every)
    for (int x = 1; x < shot.data.width - 1; x += every) {
      const Hit& hit = rendering.at(x, y);
      if (hit.primitive >= 0 && rendering.primitives_within(1, x, y) == 1 && chosen(hit))
        pixels.push_back(index_of(x, y, shot.data.width));
    }
  EXPECT_GE(pixels.size(), 30u);
  const std::vector<float> ao = ao_at(rendering.frame, pixels);
  Means means;
  const double share = 1 / double(pixels.size());
  for (const std::size_t i : pixels) {
    const double truth = true_ao(scene, rendering.hits[i], 1, 40);
    means.truth += share * truth;
    means.ao += share * ao[i];
    means.error += share * std::abs(ao[i] - truth);
  }
  return means;
}

Scene box_above_floor(double depth, double above, double height) {
  Scene scene{{kFloor}};
  scene.add(parallelepiped({-depth, -1.5, above}, {depth, 0, 0}, {0, 3, 0}, {0, 0, height}));
  return scene;
}

Scene round_hole(double radius, double depth, int sides) {
  Scene scene{
      {Plane{.point = {}, .normal = {0, 0, 1}, .hole = radius}, Plane{.point = {0, 0, -depth}, .normal = {0, 0, 1}}}};
  const auto corner = [&](int i) {
    const double azimuth = 2 * kPi * (i + 0.5) / sides, r = radius / std::cos(kPi / sides);
    return Vec3{r * std::cos(azimuth), r * std::sin(azimuth), -depth};
  };
  for (int i = 0; i < sides; i++)
    scene.primitives.emplace_back(parallelogram(corner(i), corner(i + 1) - corner(i), {0, 0, depth}));
  return scene;
}

}  // namespace alcove::test
