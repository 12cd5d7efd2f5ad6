// Rays against planes, polygons and spheres; cameras; frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/scenes.h"

#include "core/chain/chain.h"
#include "core/chain/estimate/estimate.h"
#include "tests/support/device.h"

namespace alcove::test {

namespace {

/// Parameters along the ray of the one or two places where it meets a surface.
struct Crossings {
  double near = kNowhere, far = kNowhere;
};

Crossings crossings(const Plane& plane, const Ray& ray) {
  return {dot(plane.normal, plane.point - ray.origin) / dot(plane.normal, ray.direction), kNowhere};
}

Plane plane_of(const Polygon& polygon) {
  const auto& c = polygon.corners;
  return {.point = c[0], .normal = unit(cross(c[1] - c[0], c[2] - c[0]))};
}

Crossings crossings(const Polygon& polygon, const Ray& ray) { return crossings(plane_of(polygon), ray); }

Crossings crossings(const Sphere& sphere, const Ray& ray) {
  const Vec3 to_center = sphere.center - ray.origin;
  const double along = dot(to_center, ray.direction) / dot(ray.direction, ray.direction);
  const Vec3 off = to_center - along * ray.direction;
  // NaN: missed
  const double half_chord =
      std::sqrt((sphere.radius * sphere.radius - dot(off, off)) / dot(ray.direction, ray.direction));
  return {along - half_chord, along + half_chord};
}

bool covers(const Plane& plane, Vec3 point) { return length(point - plane.point) >= plane.hole; }

bool covers(const Polygon& polygon, Vec3 point) {
  const auto& c = polygon.corners;
  const Vec3 normal = plane_of(polygon).normal;
  for (std::size_t i = 0; i < c.size(); i++)
    if (dot(normal, cross(c[(i + 1) % c.size()] - c[i], point - c[i])) < 0) return false;
  return true;
}

bool covers(const Sphere& sphere, Vec3 point) {
  return sphere.cos_half_angle <= -1 ||
         dot(point - sphere.center, sphere.axis) >= sphere.radius * sphere.cos_half_angle;
}

Vec3 normal_at(const Plane& plane, Vec3) { return unit(plane.normal); }
Vec3 normal_at(const Polygon& polygon, Vec3) { return plane_of(polygon).normal; }
Vec3 normal_at(const Sphere& sphere, Vec3 point) { return unit(point - sphere.center); }

/// A camera whose optical axis meets the middle of the picture.
Shot aimed(Vec3 eye, Vec3 target, int width, int height, double pixels_per_unit) {
  Shot shot;
  shot.eye = eye;
  shot.back = unit(eye - target);
  const Vec3 sky = std::abs(shot.back.z) < 0.999 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  shot.right = unit(cross(sky, shot.back));
  shot.up = cross(shot.back, shot.right);
  shot.data = shot.display = {0, 0, width, height};
  shot.camera.width = width;
  shot.camera.height = height;
  shot.camera.fx = shot.camera.fy = pixels_per_unit;
  shot.camera.cx = 0.5 * width;
  shot.camera.cy = 0.5 * height;
  return shot;
}

}  // namespace

Polygon parallelogram(Vec3 corner, Vec3 a, Vec3 b) { return {{corner, corner + a, corner + a + b, corner + b}}; }

std::vector<Polygon> parallelepiped(Vec3 corner, Vec3 a, Vec3 b, Vec3 c) {
  return {parallelogram(corner, a, b),     parallelogram(corner, b, c),     parallelogram(corner, c, a),
          parallelogram(corner + c, a, b), parallelogram(corner + a, b, c), parallelogram(corner + b, c, a)};
}

Hit Scene::hit(const Ray& ray) const {
  Hit nearest;
  for (std::size_t i = 0; i < primitives.size(); i++) {
    std::visit(
        [&](const auto& primitive) {
          const Crossings t = crossings(primitive, ray);
          for (const double distance : {t.near, t.far}) {
            if (!(distance > 1e-9 && distance < nearest.distance)) continue;
            const Vec3 position = ray.origin + distance * ray.direction;
            if (!covers(primitive, position)) continue;
            const Vec3 normal = normal_at(primitive, position);
            nearest = {distance, int(i), position, dot(normal, ray.direction) > 0 ? -normal : normal};
          }
        },
        primitives[i]);
  }
  return nearest;
}

Shot Shot::perspective(Vec3 eye, Vec3 target, double fov, int width, int height) {
  return aimed(eye, target, width, height, 0.5 * width / std::tan(fov * std::numbers::pi / 360));
}

Shot Shot::orthographic(Vec3 eye, Vec3 target, double units, int width, int height) {
  Shot shot = aimed(eye, target, width, height, width / units);
  shot.camera.orthographic = true;
  return shot;
}

Ray Shot::ray(double x_px, double y_px) const {
  const Vec3 across = ((x_px - camera.cx) / camera.fx) * right + ((camera.cy - y_px) / camera.fy) * up;
  return camera.orthographic ? Ray{eye + across, -back} : Ray{eye, across - back};
}

bool Shot::sees_ball(Vec3 center, double radius) const {
  const Vec3 p = view_from_world(center - eye);
  const double left = data.x - display.x + 0.5, top = data.y - display.y + 0.5;
  // Signed distance of the ball's centre to the plane that the eye and a line of pixels span, positive towards the
  // picture.
  const auto room = [&](double coordinate, double line, double inwards) {
    return camera.orthographic ? inwards * (coordinate - line)
                               : inwards * (coordinate + line * p.z) / std::sqrt(1 + line * line);
  };
  return room(p.x, (left - camera.cx) / camera.fx, 1) >= radius &&
         room(p.x, (left + data.width - 1 - camera.cx) / camera.fx, -1) >= radius &&
         room(p.y, (camera.cy - top) / camera.fy, -1) >= radius &&
         room(p.y, (camera.cy - top - data.height + 1) / camera.fy, 1) >= radius;
}

int Rendering::primitives_within(int reach_px, int x, int y) const {
  int seen[2]{at(x, y).primitive, 0};
  int count = 1;
  for (int v = std::max(y - reach_px, 0); v <= std::min(y + reach_px, shot.data.height - 1); v++)
    for (int u = std::max(x - reach_px, 0); u <= std::min(x + reach_px, shot.data.width - 1); u++) {
      const int primitive = at(u, v).primitive;
      if (std::find(seen, seen + count, primitive) != seen + count) continue;
      if (count == 2) return 3;
      seen[count++] = primitive;
    }
  return count;
}

double Rendering::footprint(int x, int y) const {
  double largest = 0;
  for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
    if (u >= 0 && v >= 0 && u < shot.data.width && v < shot.data.height)
      largest = std::max(largest, length(at(u, v).position - at(x, y).position));
  return largest;
}

Rendering render(const Scene& scene, const Shot& shot) {
  Rendering result{shot, {}, {}};
  HostFrame& frame = result.frame;
  frame.data = shot.data;
  frame.display = shot.display;
  frame.camera = shot.camera;
  const std::size_t pixels = shot.data.pixels();
  frame.depth.assign(pixels, kSky);
  frame.normal.assign(3 * pixels, 0);
  result.hits.reserve(pixels);
  for (int y = 0; y < shot.data.height; y++) {
    for (int x = 0; x < shot.data.width; x++) {
      const std::size_t index = result.hits.size();
      const Hit hit =
          scene.hit(shot.ray(shot.data.x - shot.display.x + x + 0.5, shot.data.y - shot.display.y + y + 0.5));
      result.hits.push_back(hit);
      if (hit.primitive < 0) continue;
      frame.depth[index] = float(hit.distance);
      put_normal(frame, index, shot.view_from_world(hit.normal));
    }
  }
  return result;
}

// Rays that go on behind what they hit.

HostFrame peeled(const Scene& scene, const Shot& shot, int surfaces) {
  constexpr double kBehind = 1e-9;  // of the depth: where the next surface may begin
  HostFrame frame = render(scene, shot).frame;
  frame.behind.assign(std::size_t(surfaces - 1), {});
  for (int k = 1; k < surfaces; k++)
    for (int y = 0; y < shot.data.height; y++)
      for (int x = 0; x < shot.data.width; x++) {
        Ray ray = shot.ray(shot.data.x + x - shot.display.x + 0.5, shot.data.y + y - shot.display.y + 0.5);
        double depth = 0;
        for (int i = 0; i <= k && depth < kNowhere; i++) {
          const double step = scene.hit(ray).distance;
          depth += step;
          ray.origin = ray.origin + (step * (1 + kBehind)) * ray.direction;
        }
        frame.behind_depth.push_back(depth < kNowhere ? float(depth) : kSky);
      }
  return frame;
}

void add_solid_peels(Rendering& rendering, const Scene& scene, int count, const std::vector<int>& solids, double within,
                     BehindKind fronts) {
  const Shot& shot = rendering.shot;
  const std::size_t pixels = shot.data.pixels();
  HostFrame& frame = rendering.frame;
  for (int i = 0; i < count; i++) {
    frame.behind.push_back({fronts});
    frame.behind.push_back({BehindKind::backs});
  }
  frame.behind_depth.assign(2 * std::size_t(count) * pixels, kSky);
  const auto is_solid = [&](int primitive) { return std::ranges::find(solids, primitive) != solids.end(); };
  for (std::size_t i = 0; i < pixels; i++) {
    if (rendering.hits[i].primitive < 0) continue;
    const int x = int(i) % shot.data.width, y = int(i) / shot.data.width;
    const Ray ray = shot.ray(shot.data.x - shot.display.x + x + 0.5, shot.data.y - shot.display.y + y + 0.5);
    std::vector<int> entered;
    Hit hit = rendering.hits[i];
    double depth = hit.distance;
    for (int k = 0; k <= count && hit.primitive >= 0 && depth - rendering.hits[i].distance < within; k++) {
      const bool leaves = is_solid(hit.primitive) && std::erase(entered, hit.primitive) > 0;
      if (is_solid(hit.primitive) && !leaves) entered.push_back(hit.primitive);
      if (k > 0) frame.behind_depth[(2 * std::size_t(k - 1) + (leaves ? 1 : 0)) * pixels + i] = float(depth);
      const double onward = depth * (1 + kBehindSurface);
      hit = scene.hit({ray.origin + onward * ray.direction, ray.direction});
      depth = onward + hit.distance;
    }
  }
}

// Runs the chain, or the estimator alone, for bent normals.

std::vector<Vec3> vectors_in(std::span<const float> planes, double scale, double offset) {
  const std::size_t pixels = planes.size() / 3;
  std::vector<Vec3> vectors(pixels);
  for (std::size_t i = 0; i < pixels; i++)
    vectors[i] = {scale * planes[i] + offset, scale * planes[i + pixels] + offset,
                  scale * planes[i + 2 * pixels] + offset};
  return vectors;
}

std::vector<Vec3> first_band(std::span<const float> transfer) {
  const std::size_t pixels = transfer.size() / 9;
  const double constant = std::sqrt(3 / std::numbers::pi) / 2;
  std::vector<Vec3> vectors(pixels);
  for (std::size_t i = 0; i < pixels; i++)
    vectors[i] = 1 / constant * Vec3{transfer[i + 3 * pixels], transfer[i + pixels], transfer[i + 2 * pixels]};
  return vectors;
}

std::vector<Vec3> bent_normals(const HostFrame& frame, const EstimatorSettings& settings) {
  OutputSettings output;
  output.aovs = "bent-normal";
  const FrameOutputs outputs = run_chain(recorder(), upload(recorder(), frame), settings, output);
  recorder().run();
  return vectors_in(outputs.bent_normal->as<float>());
}

FrameInputs with_matte(const HostFrame& frame, const std::vector<std::size_t>& pixels) {
  std::vector<float> taken(frame.data.pixels());
  for (const std::size_t i : pixels) taken[i] = 1;
  HostPlanes planes;
  planes[RawPlane::depth] = frame.depth;
  planes[RawPlane::normal] = frame.normal;
  planes[RawPlane::behind] = frame.behind_depth;
  planes[RawPlane::matte] = taken;
  return upload(recorder(), frame, planes, frame.frame);
}

std::vector<Vec3> raw_bent(const HostFrame& frame, const EstimatorSettings& settings,
                           const std::vector<std::size_t>& pixels) {
  gpu::Recorder& gpu = recorder();
  const FrameInputs inputs = pixels.empty() ? upload(gpu, frame) : with_matte(frame, pixels);
  const GBuffer whole = prepare(gpu, inputs);
  reconstruct(gpu, whole);
  const GBuffer gbuffer = needed(gpu, whole, inputs, matte(gpu, inputs), 0);
  const Estimate result = estimate(gpu, gbuffer, sites(gpu, gbuffer, site_rule_of(settings)), inputs, settings, 1);
  gpu.download(*result.moments);
  gpu.run();
  std::vector<Vec3> vectors = vectors_in(result.moments->as<float>(), 2, -1);  // less what is blocked
  const std::vector<Vec3> normals = vectors_in(frame.normal);
  for (std::size_t i = 0; i < vectors.size(); i++)
    if (frame.depth[i] < frame.sky) vectors[i] = vectors[i] + 2.0 / 3 * unit(normals[i]);
  return vectors;
}

}  // namespace alcove::test
