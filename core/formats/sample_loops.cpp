// Plain loops, which the compiler vectorizes. Sums, and half floats on x86, are vectorized by hand, since it cannot.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sample_loops.h"

#include <algorithm>

#include "core/base/half.h"

#ifdef __x86_64__
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace alcove {
namespace {

constexpr int kMiddle = 128;  // stands for no difference
constexpr float kLargestHalf = 65504;

// Each function below handles as many values as fill its vectors, and gives their number.
#ifdef __x86_64__

/// Sums up 16 bytes in four steps: each step adds to every byte the sum of as many bytes before it as the byte has
/// itself.
__attribute__((target("ssse3"))) std::size_t sum_up_vectors(std::uint8_t* differences, std::size_t count,
                                                            std::uint8_t before) {
  const __m128i middle = _mm_set1_epi8(char(kMiddle)), of_last = _mm_set1_epi8(15);
  __m128i last = _mm_set1_epi8(char(before));
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    auto* const at = reinterpret_cast<__m128i*>(differences + i);
    __m128i sums = _mm_sub_epi8(_mm_loadu_si128(at), middle);
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 1));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 2));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 4));
    sums = _mm_add_epi8(_mm_add_epi8(sums, _mm_slli_si128(sums, 8)), last);
    _mm_storeu_si128(at, sums);
    last = _mm_shuffle_epi8(sums, of_last);
  }
  return i;
}

/// Stops at a NaN, since the instruction makes signalling NaNs quiet.
__attribute__((target("avx2,f16c"))) std::size_t widen_vectors(const std::uint8_t* halves, std::size_t count,
                                                               float* to) {
  const __m128i no_sign = _mm_set1_epi16(0x7fff), infinity = _mm_set1_epi16(0x7c00);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m128i eight = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves + 2 * i));
    if (_mm_movemask_epi8(_mm_cmpgt_epi16(_mm_and_si128(eight, no_sign), infinity)) != 0) break;
    _mm256_storeu_ps(to + i, _mm256_cvtph_ps(eight));
  }
  return i;
}

__attribute__((target("avx2,f16c"))) std::size_t narrow_vectors(const float* floats, std::size_t count,
                                                                std::uint16_t* to) {
  const __m256 most = _mm256_set1_ps(kLargestHalf), least = _mm256_set1_ps(-kLargestHalf);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256 eight = _mm256_loadu_ps(floats + i);
    if (_mm256_movemask_ps(_mm256_cmp_ps(eight, eight, _CMP_UNORD_Q)) != 0) break;
    const __m256 within = _mm256_max_ps(_mm256_min_ps(eight, most), least);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i), _mm256_cvtps_ph(within, _MM_FROUND_TO_NEAREST_INT));
  }
  return i;
}

/// Whether the processor has AVX2 and F16C. Clang 14 has no name for F16C, and a hypervisor may hide it beside AVX2.
bool has_half_vectors() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __builtin_cpu_supports("avx2") && __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C) != 0;
}

const bool kHasByteVectors = __builtin_cpu_supports("ssse3");
const bool kHasHalfVectors = has_half_vectors();

#else

constexpr bool kHasByteVectors = false, kHasHalfVectors = false;
std::size_t sum_up_vectors(std::uint8_t*, std::size_t, std::uint8_t) { return 0; }
std::size_t widen_vectors(const std::uint8_t*, std::size_t, float*) { return 0; }
std::size_t narrow_vectors(const float*, std::size_t, std::uint16_t*) { return 0; }

#endif

/// Calls vectors(i), which gives the number of values that it has done from i on, and one(i) for some of the rest.
template <class Vectors, class One>
void for_halves(std::size_t count, const Vectors& vectors, const One& one) {
  constexpr std::size_t kSome = 8;
  for (std::size_t i = 0; i < count;) {
    if (kHasHalfVectors) i += vectors(i);
    for (const std::size_t end = std::min(count, i + kSome); i < end; i++) one(i);
  }
}

}  // namespace

std::uint8_t sum_up(std::uint8_t* differences, std::size_t count, std::uint8_t before) {
  std::size_t i = kHasByteVectors ? sum_up_vectors(differences, count, before) : 0;
  if (i > 0) before = differences[i - 1];
  for (; i < count; i++) before = differences[i] = std::uint8_t(before + differences[i] - kMiddle);
  return before;
}

std::uint8_t sum_of(const std::uint8_t* differences, std::size_t count, std::uint8_t before) {
  for (std::size_t i = 0; i < count; i++) before = std::uint8_t(before + differences[i]);
  return std::uint8_t(before - kMiddle * count);
}

void interleave(const std::uint8_t* __restrict even, const std::uint8_t* __restrict odd, std::size_t count,
                std::uint8_t* __restrict to) {
  for (std::size_t i = 0; i < count; i++) {
    to[2 * i] = even[i];
    to[2 * i + 1] = odd[i];
  }
}

void split_to_differences(const std::uint8_t* __restrict from, std::size_t count, std::uint8_t* __restrict to) {
  if (count == 0) return;
  std::uint8_t* const __restrict odd = to + count;
  to[0] = from[0];
  odd[0] = std::uint8_t(from[1] - from[2 * count - 2] + kMiddle);
  for (std::size_t i = 1; i < count; i++) {
    to[i] = std::uint8_t(from[2 * i] - from[2 * i - 2] + kMiddle);
    odd[i] = std::uint8_t(from[2 * i + 1] - from[2 * i - 1] + kMiddle);
  }
}

void widen(const std::uint8_t* halves, std::size_t count, float* to) {
  for_halves(
      count, [&](std::size_t i) { return widen_vectors(halves + 2 * i, count - i, to + i); },
      [&](std::size_t i) { to[i] = from_half(number_at<std::uint16_t>(halves + 2 * i)); });
}

void narrow(const float* floats, std::size_t count, std::uint16_t* to) {
  for_halves(
      count, [&](std::size_t i) { return narrow_vectors(floats + i, count - i, to + i); },
      [&](std::size_t i) { to[i] = to_half(std::clamp(floats[i], -kLargestHalf, kLargestHalf)); });
}

}  // namespace alcove
