// The words that settings are made of, such as kinds of depth and of normals, and their spelling in options.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace alcove {

// surfaces in a file of --behind. surfaces: fronts or backs; fronts: surfaces seen from outside, as culled peels and
// other elements are; backs: surfaces seen from inside, which close the solid before them; thickness: how far the first
// surface's solid goes on along the depth
enum class BehindKind { surfaces, fronts, backs, thickness };
// the frame that motion vectors point to
enum class MotionKind { automatic, previous, next };
enum class DepthKind { automatic, planar, ray, inverse, device, normalized, log, position, disparity };
// device depth between the near and the far plane; zero_to_one: Vulkan, Direct3D, and automatic, as nobody says so;
// minus_one_to_one: OpenGL
enum class DeviceRange { automatic, zero_to_one, minus_one_to_one };
enum class NormalSpace { automatic, world, view };
enum class PositionSpace { automatic, world, view };
enum class NormalEncoding { automatic, signed_float, unorm, octahedral, spheremap };
enum class Falloff : std::uint32_t { none, linear, quadratic, smooth };
enum class Estimator { gtao, bitmask, hbao, crytek };
// samples of gtao along a slice: at so many steps; at all pixels, by their outlines; at each pixel by itself
enum class SliceSearch { steps, quick, exact };
// the plane from which HBAO measures a horizon: the plane across the view ray, or the surface
enum class Elevation { view, surface };
// distribution of Crytek's samples in the hemisphere: more near the receiver, or even in volume
enum class SampleKernel { clustered, uniform };
// fading of Crytek's hits by the difference of depth between receiver and hit
enum class RangeCheck { none, ratio, smoothstep };
enum class ThicknessKind { automatic, infinite, constant };
// places where surfaces are taken to go on unseen: none; beyond the picture's border; there and behind nearer surfaces
enum class Completion { none, border, all };
// pixels with an estimate of their own: evenly over the image; more where surfaces show few pixels; and many beside
// edges of depth
enum class Density { uniform, adaptive, edges };
// pixels of the frame per pixel of the estimate, in x and in y
enum class Resolution { full = 1, half = 2, quarter = 4 };
enum class Denoise { none, bilateral, box };
enum class Noise { fixed, animated };  // the pattern of sample noise: the same in all frames, or one per frame
// filter by which a renderer makes a pixel from samples around its centre; see core/chain/results/results.cpp
enum class PixelFilterKind { box, gaussian, blackman_harris };
enum class AoChannels { mono, rgb };
enum class OutputType { half_float, single_float };
enum class Missing { error, skip };  // treatment of a frame without its input

/// The numbers by which device, normalized and log depth, and disparity, are counted.
struct DepthRange {
  // distance of the planes, in the file's units, 0 < near < far; far may be infinite (device only)
  std::optional<double> near, far;
  bool reversed = false;  // the near plane has the largest value
  DeviceRange device = DeviceRange::automatic;
  double log_constant = 1;  // C of z = ((1 + C far)^d - 1) / C, 1 / the file's units, > 0
  // a and b of disparity d = a / z + b, a > 0; a in values times the file's units. Of a, b and the planes, at which d
  // is 1 and 0, two say all
  std::optional<double> disparity_scale = std::nullopt, disparity_shift = std::nullopt;
  double disparity_error = 0;  // values that are no more than this above b are as good as infinitely far
  // planar, ray and inverse depth: the values are below 0; view positions: their z is not as the camera's
  bool negative = false;
  // normalized depth: values go on beyond the near plane, or beyond the far plane, and were not cut off there
  bool goes_before_near = false, goes_beyond_far = false;
};

/// The axes of normals that point the other way.
struct NormalFlips {
  bool x = false, y = false, z = false;
};

/// The files of one option, each at its own index; "" for none.
constexpr std::size_t kMostBehind = 8;
using FileList = std::array<std::string, kMostBehind>;

template <class T>
using Word = std::pair<const char*, T>;

/// The words of an enumeration, in alphabetical order.
template <class T>
inline constexpr int kWordsOf = 0;
template <>
inline constexpr Word<DepthKind> kWordsOf<DepthKind>[] = {
    {"auto", DepthKind::automatic},  {"device", DepthKind::device},     {"disparity", DepthKind::disparity},
    {"inverse", DepthKind::inverse}, {"log", DepthKind::log},           {"normalized", DepthKind::normalized},
    {"planar", DepthKind::planar},   {"position", DepthKind::position}, {"ray", DepthKind::ray}};
template <>
inline constexpr Word<BehindKind> kWordsOf<BehindKind>[] = {{"backs", BehindKind::backs},
                                                            {"fronts", BehindKind::fronts},
                                                            {"surfaces", BehindKind::surfaces},
                                                            {"thickness", BehindKind::thickness}};
template <>
inline constexpr Word<MotionKind> kWordsOf<MotionKind>[] = {
    {"auto", MotionKind::automatic}, {"next", MotionKind::next}, {"previous", MotionKind::previous}};
template <>
inline constexpr Word<DeviceRange> kWordsOf<DeviceRange>[] = {
    {"-1..1", DeviceRange::minus_one_to_one}, {"0..1", DeviceRange::zero_to_one}, {"auto", DeviceRange::automatic}};
template <>
inline constexpr Word<PositionSpace> kWordsOf<PositionSpace>[] = {
    {"auto", PositionSpace::automatic}, {"view", PositionSpace::view}, {"world", PositionSpace::world}};
template <>
inline constexpr Word<NormalEncoding> kWordsOf<NormalEncoding>[] = {{"auto", NormalEncoding::automatic},
                                                                    {"octahedral", NormalEncoding::octahedral},
                                                                    {"signed", NormalEncoding::signed_float},
                                                                    {"spheremap", NormalEncoding::spheremap},
                                                                    {"unorm", NormalEncoding::unorm}};
template <>
inline constexpr Word<NormalSpace> kWordsOf<NormalSpace>[] = {
    {"auto", NormalSpace::automatic}, {"view", NormalSpace::view}, {"world", NormalSpace::world}};
template <>
inline constexpr Word<Falloff> kWordsOf<Falloff>[] = {{"linear", Falloff::linear},
                                                      {"none", Falloff::none},
                                                      {"quadratic", Falloff::quadratic},
                                                      {"smooth", Falloff::smooth}};
template <>
inline constexpr Word<Estimator> kWordsOf<Estimator>[] = {{"bitmask", Estimator::bitmask},
                                                          {"crytek", Estimator::crytek},
                                                          {"gtao", Estimator::gtao},
                                                          {"hbao", Estimator::hbao}};
template <>
inline constexpr Word<SliceSearch> kWordsOf<SliceSearch>[] = {
    {"exact", SliceSearch::exact}, {"quick", SliceSearch::quick}, {"steps", SliceSearch::steps}};
template <>
inline constexpr Word<Elevation> kWordsOf<Elevation>[] = {{"surface", Elevation::surface}, {"view", Elevation::view}};
template <>
inline constexpr Word<SampleKernel> kWordsOf<SampleKernel>[] = {{"clustered", SampleKernel::clustered},
                                                                {"uniform", SampleKernel::uniform}};
template <>
inline constexpr Word<RangeCheck> kWordsOf<RangeCheck>[] = {
    {"none", RangeCheck::none}, {"ratio", RangeCheck::ratio}, {"smoothstep", RangeCheck::smoothstep}};
template <>
inline constexpr Word<Completion> kWordsOf<Completion>[] = {
    {"all", Completion::all}, {"border", Completion::border}, {"none", Completion::none}};
template <>
inline constexpr Word<Density> kWordsOf<Density>[] = {
    {"adaptive", Density::adaptive}, {"edges", Density::edges}, {"uniform", Density::uniform}};
template <>
inline constexpr Word<Resolution> kWordsOf<Resolution>[] = {
    {"full", Resolution::full}, {"half", Resolution::half}, {"quarter", Resolution::quarter}};
template <>
inline constexpr Word<Denoise> kWordsOf<Denoise>[] = {
    {"bilateral", Denoise::bilateral}, {"box", Denoise::box}, {"none", Denoise::none}};
template <>
inline constexpr Word<Noise> kWordsOf<Noise>[] = {{"animated", Noise::animated}, {"fixed", Noise::fixed}};
template <>
inline constexpr Word<PixelFilterKind> kWordsOf<PixelFilterKind>[] = {
    {"blackman-harris", PixelFilterKind::blackman_harris},
    {"box", PixelFilterKind::box},
    {"gaussian", PixelFilterKind::gaussian}};
template <>
inline constexpr Word<AoChannels> kWordsOf<AoChannels>[] = {{"mono", AoChannels::mono}, {"rgb", AoChannels::rgb}};
template <>
inline constexpr Word<OutputType> kWordsOf<OutputType>[] = {{"float", OutputType::single_float},
                                                            {"half", OutputType::half_float}};
template <>
inline constexpr Word<Missing> kWordsOf<Missing>[] = {{"error", Missing::error}, {"skip", Missing::skip}};

/// The word that stands for the value.
template <class T>
std::string word_of(T value) {
  for (const auto& [word, meaning] : kWordsOf<T>)
    if (meaning == value) return word;
  return "";
}

}  // namespace alcove
