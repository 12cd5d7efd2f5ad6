// What is made of the visibility: shaping, multi-bounce, specular occlusion; each against its definition.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/chain/results/results.h"
#include "kernels/geometry/geometry.h"
#include "tests/support/chain.h"

namespace alcove::shading_test {
namespace {

using namespace test;
using Planes = std::vector<float>;

/// What a pass makes of the frame's G-buffer.
Planes pass(const HostFrame& frame, const std::function<gpu::Buffer&(const GBuffer&, FrameInputs&)>& record,
            FrameCounts* counts = nullptr) {
  Prepared made = prepared(frame);
  const gpu::Buffer& result = record(made.gbuffer, made.inputs);
  recorder().download(*made.gbuffer.counts);
  const Planes planes = downloaded<float>(result);
  if (counts) *counts = made.gbuffer.counts->as<FrameCounts>()[0];
  return planes;
}

/// A ball before a tilted floor, and sky: normals and depths of all kinds.
Rendering ball() {
  return render(
      {{Plane{.point = {0, 0, -1}, .normal = unit({-0.2, 0, 1})}, Sphere{.center = {6, 0.3, 0.4}, .radius = 1.6}}},
      Shot::perspective({}, {1, 0, 0}, 70, 61, 47));
}

bool is_sky(const HostFrame& frame, std::size_t i) { return !(frame.depth[i] < 1e9f); }

/// Visibilities from 0 to 1, both among them, in no order.
Planes uneven_ao(std::size_t count) {
  Planes ao(count);
  for (std::size_t i = 0; i < count; i++) ao[i] = float(i * 37 % 101) / 100.0f;
  return ao;
}

// Shape.

Planes shaped(const HostFrame& frame, const Planes& ao, const EstimatorSettings& settings,
              const Planes* material = nullptr, FrameCounts* counts = nullptr) {
  return pass(
      frame,
      [&](const GBuffer& gbuffer, FrameInputs& inputs) -> gpu::Buffer& {
        if (material) inputs[RawPlane::material_ao] = &given("test material", *material);
        return shape(recorder(), gbuffer, given("test ao", ao), settings, inputs[RawPlane::material_ao]);
      },
      counts);
}

TEST(Shape, material_ao_multiplies_exactly_but_not_the_sky) {
  const HostFrame frame = ball().frame;
  const Planes ao = uneven_ao(frame.depth.size());
  Planes material(ao.size());
  for (std::size_t i = 0; i < ao.size(); i++) material[i] = float(i % 7) / 6.0f;
  const Planes result = shaped(frame, ao, {}, &material);
  for (std::size_t i = 0; i < ao.size(); i++) ASSERT_EQ(result[i], is_sky(frame, i) ? ao[i] : ao[i] * material[i]) << i;
}

TEST(Shape, material_ao_beyond_its_range_is_clamped_and_broken_values_count_as_open) {
  const HostFrame frame = ball().frame;
  const Planes ao(frame.depth.size(), 0.5f);
  const auto surfaces = std::uint32_t(std::ranges::count_if(frame.depth, [](float z) { return z < 1e9f; }));
  const std::tuple<float, float, std::uint32_t> cases[] = {
      {2, 0.5f, 0}, {-1, 0, 0}, {kNan, 0.5f, surfaces}, {kInfinity, 0.5f, surfaces}};
  for (const auto& [value, expected, repaired] : cases) {
    const Planes material(ao.size(), value);
    FrameCounts counts{};
    const Planes result = shaped(frame, ao, {}, &material, &counts);
    for (std::size_t i = 0; i < ao.size(); i++) ASSERT_EQ(result[i], is_sky(frame, i) ? 0.5f : expected) << value;
    EXPECT_EQ(counts.repaired_material, repaired) << value;
  }
}

TEST(Shape, fade_is_exact_at_its_ends_and_linear_between) {
  const HostFrame frame = ball().frame;
  const Planes ao = uneven_ao(frame.depth.size());
  EstimatorSettings settings;
  settings.fade_start = 4.75;
  settings.fade_end = 6.5;
  const Planes result = shaped(frame, ao, settings);
  int before = 0, between = 0, beyond = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    const double z = frame.depth[i], faded = std::clamp((z - 4.75) / (6.5 - 4.75), 0.0, 1.0);
    (z <= 4.75 ? before : z >= 6.5 ? beyond : between)++;
    if (z <= 4.75)
      ASSERT_EQ(result[i], ao[i]) << z;
    else if (z >= 6.5)
      ASSERT_EQ(result[i], 1.0f) << z;
    else
      ASSERT_NEAR(result[i], ao[i] + (1 - ao[i]) * faded, 1e-6) << z;
  }
  EXPECT_GT(std::min({before, between, beyond}), 100);
}

TEST(Shape, fade_is_of_the_screen_space_ao_alone) {
  const HostFrame frame = ball().frame;
  EstimatorSettings settings;
  settings.fade_start = 0;
  settings.fade_end = 1e-3;
  const Planes material(frame.depth.size(), 0.25f),
      result = shaped(frame, uneven_ao(material.size()), settings, &material);
  for (std::size_t i = 0; i < result.size(); i++) ASSERT_EQ(result[i], is_sky(frame, i) ? 1.0f : 0.25f) << i;
}

TEST(Shape, least_is_the_lowest_value_whatever_else_darkens) {
  const HostFrame frame = ball().frame;
  EstimatorSettings settings;
  settings.intensity = 1.5;
  settings.power = 2;
  const Planes ao = uneven_ao(frame.depth.size()), material(ao.size(), 0.5f);
  const Planes without = shaped(frame, ao, settings, &material);
  settings.least = 0.25;
  const Planes result = shaped(frame, ao, settings, &material);
  for (std::size_t i = 0; i < ao.size(); i++) ASSERT_EQ(result[i], std::max(0.25f, without[i])) << i;
  EXPECT_EQ(std::ranges::min(without), 0.0f);
}

// Composite.

/// A white beauty under this AO.
Planes composed(const Planes& ao, double gain, double least) {
  HostFrame frame = ball().frame;
  return pass(frame, [&](const GBuffer& gbuffer, FrameInputs& inputs) -> gpu::Buffer& {
    inputs[RawPlane::beauty] = &given("test beauty", Planes(3 * ao.size(), 1.0f));
    return *composite(recorder(), gbuffer, &given("test ao", ao), nullptr, inputs, {.gain = gain}, least);
  });
}

TEST(Composite, gain_darkens_no_pixel_below_the_least_ao_but_one_that_is_darker_without_it) {
  const Planes ao = uneven_ao(ball().frame.depth.size()), result = composed(ao, 3, 0.25);
  for (std::size_t i = 0; i < result.size(); i++) {
    const float visible = ao[i % ao.size()];
    ASSERT_NEAR(result[i], std::max(1 - 3 * (1 - visible), std::min(visible, 0.25f)), 1e-6) << i;
  }
}

// Multi-bounce.

Planes bounced(const Planes& ao, double albedo, const Planes* colors = nullptr) {
  HostFrame frame = ball().frame;
  return pass(frame, [&](const GBuffer& gbuffer, FrameInputs& inputs) -> gpu::Buffer& {
    inputs.albedo_value = albedo;
    if (colors) inputs[RawPlane::albedo] = &given("test albedo", *colors);
    return multi_bounce(recorder(), gbuffer, given("test ao", ao), inputs);
  });
}

TEST(MultiBounce, agrees_with_numbers_worked_out_by_hand) {
  const std::size_t pixels = ball().frame.depth.size();
  // f = ((a A + b) A + c) A; albedo 0.8: a 1.29992, b -3.19438, c 2.89446; 0.5: a 0.6878, b -1.75585, c 2.0679; 0:
  // below A, which wins.
  const std::tuple<double, float, double> cases[] = {
      {0.8, 0.1f, 0.258802}, {0.8, 0.5f, 0.811125}, {0.5, 0.3f, 0.480914}, {0, 0.5f, 0.5}, {1, 0, 0}};
  for (const auto& [albedo, ao, expected] : cases)
    for (const float value : bounced(Planes(pixels, ao), albedo))
      ASSERT_NEAR(value, expected, 1e-5) << albedo << " " << ao;
}

TEST(MultiBounce, leaves_what_is_open_and_never_darkens) {
  const std::size_t pixels = ball().frame.depth.size();
  const Planes ao = uneven_ao(pixels);
  Planes darker = ao;
  for (double albedo = 0; albedo <= 1; albedo += 0.125) {
    const Planes result = bounced(ao, albedo);
    for (std::size_t i = 0; i < ao.size(); i++) {
      ASSERT_GE(result[i], darker[i]) << albedo << " " << ao[i] << ": a brighter surface returns more";
      if (ao[i] == 1) ASSERT_EQ(result[i], 1.0f) << albedo;
    }
    darker.assign(result.begin(), result.begin() + std::ptrdiff_t(pixels));
  }
}

TEST(MultiBounce, every_colour_takes_its_own_albedo_and_broken_ones_return_nothing) {
  const std::size_t pixels = ball().frame.depth.size();
  const Planes ao = uneven_ao(pixels);
  Planes colors(3 * pixels, 0.2f);
  std::fill_n(colors.begin() + std::ptrdiff_t(pixels), pixels, 3.0f);
  std::fill_n(colors.begin() + std::ptrdiff_t(2 * pixels), pixels, kNan);
  const Planes result = bounced(ao, 0.5, &colors), red = bounced(ao, 0.2), green = bounced(ao, 1),
               blue = bounced(ao, 0);
  for (std::size_t i = 0; i < pixels; i++) {
    ASSERT_EQ(result[i], red[i]);
    ASSERT_EQ(result[i + pixels], green[i]) << "an albedo above 1 is 1";
    ASSERT_EQ(result[i + 2 * pixels], blue[i]) << "no number is no colour";
  }
}

// Specular occlusion.

/// As kernels/base/normal.glsl packs: the octahedral map in 16 bits per coordinate.
float packed_as_float(Vec3 n) {
  const Vec3 flat = octahedral(n);
  const auto bits = [](double v) { return std::uint32_t(std::uint16_t(std::int16_t(std::lround(v * 32767)))); };
  return std::bit_cast<float>(bits(flat.x) | bits(flat.y) << 16);
}

/// `bent`: null: the normals.
Planes specular(const HostFrame& frame, const Planes& ao, double roughness, const Planes* bent = nullptr) {
  return pass(frame, [&](const GBuffer& gbuffer, FrameInputs&) -> gpu::Buffer& {
    gpu::Buffer& visibility = given("test ao", ao);
    return specular_occlusion(recorder(), gbuffer, bent ? given("test bent", *bent) : *gbuffer.normal, visibility,
                              roughness);
  });
}

/// Towards the eye of a perspective camera, and the mirror image of it.
Vec3 mirror_at(const Rendering& rendering, std::size_t i) {
  const auto& hit = rendering.hits[i];
  const Vec3 to_eye = unit(rendering.shot.eye - hit.position);
  return rendering.shot.view_from_world(2 * dot(hit.normal, to_eye) * hit.normal - to_eye);
}

/// Parts of the cone about `axis` that lie in the cone about `other`, by even points of its cap.
double shared(Vec3 axis, double cos_axis, Vec3 other, double cos_other) {
  const Vec3 x = unit(cross(axis, std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0})), y = cross(axis, x);
  constexpr int kRings = 300, kTurns = 300;
  int inside = 0;
  for (int r = 0; r < kRings; r++)
    for (int t = 0; t < kTurns; t++) {
      const double c = 1 - (r + 0.5) / kRings * (1 - cos_axis), s = std::sqrt(1 - c * c),
                   turn = 2 * kPi * (t + 0.5 * (r % 2)) / kTurns;
      inside += dot(c * axis + s * (std::cos(turn) * x + std::sin(turn) * y), other) > cos_other;
    }
  return double(inside) / (kRings * kTurns);
}

TEST(SpecularOcclusion, is_1_where_the_surface_is_open_and_0_where_it_is_closed) {
  const HostFrame frame = ball().frame;
  for (const double roughness : {0.0, 0.2, 0.5, 1.0}) {
    for (const float value : specular(frame, Planes(frame.depth.size(), 1), roughness))
      ASSERT_EQ(value, 1.0f) << roughness;
    const Planes closed = specular(frame, Planes(frame.depth.size(), 0), roughness);
    for (std::size_t i = 0; i < closed.size(); i++) ASSERT_EQ(closed[i], is_sky(frame, i) ? 1.0f : 0.0f) << roughness;
  }
}

TEST(SpecularOcclusion, is_the_part_of_the_lobe_that_the_visible_cone_holds) {
  const Rendering rendering = ball();
  const HostFrame& frame = rendering.frame;
  const Planes ao = uneven_ao(frame.depth.size());
  std::mt19937 random(7);
  std::normal_distribution<double> spread(0, 0.35);
  Planes packed(ao.size());
  std::vector<Vec3> bent(ao.size());
  for (std::size_t i = 0; i < ao.size(); i++) {
    bent[i] = is_sky(frame, i) ? Vec3{0, 0, 1}
                               : unit(normal_at(frame, i) + Vec3{spread(random), spread(random), spread(random)});
    packed[i] = packed_as_float(bent[i]);
  }
  for (const double roughness : {0.15, 0.4, 0.8}) {
    const Planes result = specular(frame, ao, roughness, &packed);
    const double cos_lobe = std::exp2(-3.32193 * roughness * roughness);
    int partly = 0;
    for (std::size_t i = 0; i < ao.size(); i += 11) {
      if (is_sky(frame, i)) continue;
      const Vec3 mirror = mirror_at(rendering, i);
      const double seen = shared(mirror, cos_lobe, bent[i], std::sqrt(1 - ao[i])),
                   open = shared(mirror, cos_lobe, normal_at(frame, i), 0);
      ASSERT_NEAR(result[i], std::min(1.0, seen / open), 0.01) << roughness << ", ao " << ao[i];
      partly += result[i] > 0.05 && result[i] < 0.95;
    }
    EXPECT_GT(partly, 20) << roughness;
  }
}

TEST(SpecularOcclusion, of_a_mirror_is_all_or_nothing) {
  const Rendering rendering = ball();
  const HostFrame& frame = rendering.frame;
  const Planes ao = uneven_ao(frame.depth.size()), result = specular(frame, ao, 0);
  const double lobe = std::acos(std::exp2(-3.32193 * 0.05 * 0.05)) + 0.002;
  int seen = 0, hidden = 0;
  for (std::size_t i = 0; i < ao.size(); i++) {
    if (is_sky(frame, i)) continue;
    const double cosine = std::clamp(dot(mirror_at(rendering, i), normal_at(frame, i)), -1.0, 1.0);
    const double beyond = std::acos(cosine) - std::acos(std::sqrt(1 - ao[i]));
    seen += beyond < -lobe;
    hidden += beyond > lobe;
    if (beyond < -lobe) ASSERT_NEAR(result[i], 1, 1e-5);
    if (beyond > lobe) ASSERT_EQ(result[i], 0.0f);
  }
  EXPECT_GT(std::min(seen, hidden), 100);
}

}  // namespace
}  // namespace alcove::shading_test
