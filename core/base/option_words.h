// The words that options take, and what each of them stands for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "core/base/settings.h"

namespace alcove {

template <class T>
using Word = std::pair<const char*, T>;

/// The words of an enumeration, in the order of the alphabet.
template <class T>
inline constexpr int kWordsOf = 0;
template <>
inline constexpr Word<DepthKind> kWordsOf<DepthKind>[] = {
    {"auto", DepthKind::automatic},        {"device", DepthKind::device},
    {"inverse", DepthKind::inverse},       {"log", DepthKind::log},
    {"normalized", DepthKind::normalized}, {"planar", DepthKind::planar},
    {"position", DepthKind::position},     {"ray", DepthKind::ray}};
template <>
inline constexpr Word<BehindKind> kWordsOf<BehindKind>[] = {{"backs", BehindKind::backs},
                                                            {"fronts", BehindKind::fronts},
                                                            {"surfaces", BehindKind::surfaces},
                                                            {"thickness", BehindKind::thickness}};
template <>
inline constexpr Word<MotionKind> kWordsOf<MotionKind>[] = {
    {"auto", MotionKind::automatic}, {"next", MotionKind::next}, {"previous", MotionKind::previous}};
template <>
inline constexpr Word<DeviceRange> kWordsOf<DeviceRange>[] = {{"-1..1", DeviceRange::minus_one_to_one},
                                                              {"0..1", DeviceRange::zero_to_one}};
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
    {"every-pixel", SliceSearch::every_pixel}, {"exact", SliceSearch::exact}, {"steps", SliceSearch::steps}};
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
inline constexpr Word<Density> kWordsOf<Density>[] = {{"adaptive", Density::adaptive}, {"uniform", Density::uniform}};
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
