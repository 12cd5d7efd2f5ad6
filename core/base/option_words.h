// The words that options take, and what each of them stands for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "core/base/settings.h"

namespace alcove {

template <class T>
const std::map<std::string, T>& names_of();
template <>
inline const std::map<std::string, DepthKind>& names_of() {
  static const std::map<std::string, DepthKind> names = {
      {"auto", DepthKind::automatic},  {"planar", DepthKind::planar},    {"ray", DepthKind::ray},
      {"inverse", DepthKind::inverse}, {"device", DepthKind::device},    {"normalized", DepthKind::normalized},
      {"log", DepthKind::log},         {"position", DepthKind::position}};
  return names;
}
template <>
inline const std::map<std::string, BehindKind>& names_of() {
  static const std::map<std::string, BehindKind> names = {{"surfaces", BehindKind::surfaces},
                                                          {"fronts", BehindKind::fronts},
                                                          {"backs", BehindKind::backs},
                                                          {"thickness", BehindKind::thickness}};
  return names;
}
template <>
inline const std::map<std::string, MotionKind>& names_of() {
  static const std::map<std::string, MotionKind> names = {
      {"auto", MotionKind::automatic}, {"previous", MotionKind::previous}, {"next", MotionKind::next}};
  return names;
}
template <>
inline const std::map<std::string, DeviceRange>& names_of() {
  static const std::map<std::string, DeviceRange> names = {{"0..1", DeviceRange::zero_to_one},
                                                           {"-1..1", DeviceRange::minus_one_to_one}};
  return names;
}
template <>
inline const std::map<std::string, PositionSpace>& names_of() {
  static const std::map<std::string, PositionSpace> names = {
      {"auto", PositionSpace::automatic}, {"world", PositionSpace::world}, {"view", PositionSpace::view}};
  return names;
}
template <>
inline const std::map<std::string, NormalEncoding>& names_of() {
  static const std::map<std::string, NormalEncoding> names = {{"auto", NormalEncoding::automatic},
                                                              {"signed", NormalEncoding::signed_float},
                                                              {"unorm", NormalEncoding::unorm},
                                                              {"octahedral", NormalEncoding::octahedral},
                                                              {"spheremap", NormalEncoding::spheremap}};
  return names;
}
template <>
inline const std::map<std::string, NormalSpace>& names_of() {
  static const std::map<std::string, NormalSpace> names = {
      {"auto", NormalSpace::automatic}, {"world", NormalSpace::world}, {"view", NormalSpace::view}};
  return names;
}
template <>
inline const std::map<std::string, Falloff>& names_of() {
  static const std::map<std::string, Falloff> names = {{"none", Falloff::none},
                                                       {"linear", Falloff::linear},
                                                       {"quadratic", Falloff::quadratic},
                                                       {"smooth", Falloff::smooth}};
  return names;
}
template <>
inline const std::map<std::string, Estimator>& names_of() {
  static const std::map<std::string, Estimator> names = {{"gtao", Estimator::gtao},
                                                         {"bitmask", Estimator::bitmask},
                                                         {"hbao", Estimator::hbao},
                                                         {"crytek", Estimator::crytek}};
  return names;
}
template <>
inline const std::map<std::string, SliceSearch>& names_of() {
  static const std::map<std::string, SliceSearch> names = {
      {"steps", SliceSearch::steps}, {"exact", SliceSearch::exact}, {"every-pixel", SliceSearch::every_pixel}};
  return names;
}
template <>
inline const std::map<std::string, Elevation>& names_of() {
  static const std::map<std::string, Elevation> names = {{"view", Elevation::view}, {"surface", Elevation::surface}};
  return names;
}
template <>
inline const std::map<std::string, SampleKernel>& names_of() {
  static const std::map<std::string, SampleKernel> names = {{"clustered", SampleKernel::clustered},
                                                            {"uniform", SampleKernel::uniform}};
  return names;
}
template <>
inline const std::map<std::string, RangeCheck>& names_of() {
  static const std::map<std::string, RangeCheck> names = {
      {"none", RangeCheck::none}, {"ratio", RangeCheck::ratio}, {"smoothstep", RangeCheck::smoothstep}};
  return names;
}
template <>
inline const std::map<std::string, Completion>& names_of() {
  static const std::map<std::string, Completion> names = {
      {"none", Completion::none}, {"border", Completion::border}, {"all", Completion::all}};
  return names;
}
template <>
inline const std::map<std::string, Density>& names_of() {
  static const std::map<std::string, Density> names = {{"uniform", Density::uniform}, {"adaptive", Density::adaptive}};
  return names;
}
template <>
inline const std::map<std::string, Resolution>& names_of() {
  static const std::map<std::string, Resolution> names = {
      {"full", Resolution::full}, {"half", Resolution::half}, {"quarter", Resolution::quarter}};
  return names;
}
template <>
inline const std::map<std::string, Denoise>& names_of() {
  static const std::map<std::string, Denoise> names = {
      {"none", Denoise::none}, {"bilateral", Denoise::bilateral}, {"box", Denoise::box}};
  return names;
}
template <>
inline const std::map<std::string, Noise>& names_of() {
  static const std::map<std::string, Noise> names{{"fixed", Noise::fixed}, {"animated", Noise::animated}};
  return names;
}
template <>
inline const std::map<std::string, PixelFilterKind>& names_of() {
  static const std::map<std::string, PixelFilterKind> names = {{"box", PixelFilterKind::box},
                                                               {"gaussian", PixelFilterKind::gaussian},
                                                               {"blackman-harris", PixelFilterKind::blackman_harris}};
  return names;
}
template <>
inline const std::map<std::string, AoChannels>& names_of() {
  static const std::map<std::string, AoChannels> names = {{"mono", AoChannels::mono}, {"rgb", AoChannels::rgb}};
  return names;
}
template <>
inline const std::map<std::string, OutputType>& names_of() {
  static const std::map<std::string, OutputType> names = {{"half", OutputType::half_float},
                                                          {"float", OutputType::single_float}};
  return names;
}
template <>
inline const std::map<std::string, Missing>& names_of() {
  static const std::map<std::string, Missing> names = {{"error", Missing::error}, {"skip", Missing::skip}};
  return names;
}

/// The word that stands for the value.
template <class T>
std::string word_of(T value) {
  for (const auto& [word, meaning] : names_of<T>())
    if (meaning == value) return word;
  return "";
}

}  // namespace alcove
