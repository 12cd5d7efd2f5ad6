// Plain loops, and those for x86: SSSE3, which nearly all of these processors have, and AVX2 with F16C.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sample_loops.h"

#include <bit>
#include <cmath>

#ifdef __x86_64__
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace alcove {
namespace {

constexpr std::uint8_t kMiddle = 128;  // stands for no difference

std::uint8_t sum_up(std::uint8_t* differences, std::size_t count, std::uint8_t before) {
  for (std::size_t i = 0; i < count; i++) before = differences[i] = std::uint8_t(before + differences[i] - kMiddle);
  return before;
}

std::uint8_t sum_of(const std::uint8_t* differences, std::size_t count, std::uint8_t before) {
  for (std::size_t i = 0; i < count; i++) before = std::uint8_t(before + differences[i] - kMiddle);
  return before;
}

void interleave(const std::uint8_t* even, const std::uint8_t* odd, std::size_t count, std::uint8_t* to) {
  for (std::size_t i = 0; i < count; i++) {
    to[2 * i] = even[i];
    to[2 * i + 1] = odd[i];
  }
}

void split(const std::uint8_t* from, std::size_t count, std::uint8_t* even, std::uint8_t* odd) {
  for (std::size_t i = 0; i < count; i++) {
    even[i] = from[2 * i];
    odd[i] = from[2 * i + 1];
  }
}

/// From the end on, so that the byte before is still there.
void subtract(std::uint8_t* bytes, std::size_t count) {
  for (std::size_t i = count; i-- > 1;) bytes[i] = std::uint8_t(bytes[i] - bytes[i - 1] + kMiddle);
}

float widened(std::uint32_t half) {
  constexpr std::uint32_t kHalfExponent = 31, kFloatExponent = 255, kBias = 127 - 15;
  const std::uint32_t sign = (half & 0x8000) << 16, exponent = half >> 10 & kHalfExponent, fraction = half & 0x3ff;
  if (exponent == 0) {
    const float value = float(fraction) * 0x1p-24f;
    return sign ? -value : value;
  }
  const std::uint32_t wide = exponent == kHalfExponent ? kFloatExponent : exponent + kBias;
  return std::bit_cast<float>(sign | wide << 23 | fraction << 13);
}

void widen(const std::uint8_t* halves, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; i++)
    to[i] = widened(std::uint32_t(halves[2 * i]) | std::uint32_t(halves[2 * i + 1]) << 8);
}

std::uint16_t narrowed(float value) {
  constexpr std::uint32_t kInfinity = 0x7f800000, kLargestHalf = 0x477fe000, kLeastNormalHalf = 0x38800000;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = bits >> 16 & 0x8000, size = bits & 0x7fffffff;
  if (size > kInfinity) {
    const std::uint32_t fraction = size >> 13 & 0x3ff;
    return std::uint16_t(sign | 0x7c00 | fraction | (fraction == 0));
  }
  if (size > kLargestHalf) return std::uint16_t(sign | 0x7bff);
  if (size < kLeastNormalHalf) return std::uint16_t(sign | std::uint32_t(std::nearbyint(std::abs(value) * 0x1p24f)));
  constexpr std::uint32_t kBias = (127 - 15) << 23, kAlmostHalfStep = 0xfff;
  return std::uint16_t(sign | (size - kBias + kAlmostHalfStep + (size >> 13 & 1)) >> 13);
}

void narrow(const float* floats, std::size_t count, std::uint16_t* to) {
  for (std::size_t i = 0; i < count; i++) to[i] = narrowed(floats[i]);
}

constexpr SampleLoops kPlain{sum_up, sum_of, interleave, split, subtract, widen, narrow};

#ifdef __x86_64__

__m128i load(const std::uint8_t* from) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from)); }
void store(std::uint8_t* to, __m128i bytes) { _mm_storeu_si128(reinterpret_cast<__m128i*>(to), bytes); }

/// Sums within 16 bytes take four steps: each adds to every byte the sum of as many bytes before it as it has itself.
__attribute__((target("ssse3"))) std::uint8_t sum_up_ssse3(std::uint8_t* differences, std::size_t count,
                                                           std::uint8_t before) {
  const __m128i middle = _mm_set1_epi8(char(kMiddle)), of_last = _mm_set1_epi8(15);
  __m128i last = _mm_set1_epi8(char(before));
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    __m128i sums = _mm_sub_epi8(load(differences + i), middle);
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 1));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 2));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 4));
    sums = _mm_add_epi8(sums, _mm_slli_si128(sums, 8));
    sums = _mm_add_epi8(sums, last);
    store(differences + i, sums);
    last = _mm_shuffle_epi8(sums, of_last);
  }
  return sum_up(differences + i, count - i, std::uint8_t(_mm_cvtsi128_si32(last)));
}

std::uint8_t sum_of_sse2(const std::uint8_t* differences, std::size_t count, std::uint8_t before) {
  __m128i sums = _mm_setzero_si128();
  std::size_t i = 0;
  // The middle counts 16 times, which is nothing in a byte.
  for (; i + 16 <= count; i += 16) sums = _mm_add_epi64(sums, _mm_sad_epu8(load(differences + i), _mm_setzero_si128()));
  sums = _mm_add_epi64(sums, _mm_srli_si128(sums, 8));
  return sum_of(differences + i, count - i, std::uint8_t(before + _mm_cvtsi128_si32(sums)));
}

void interleave_sse2(const std::uint8_t* even, const std::uint8_t* odd, std::size_t count, std::uint8_t* to) {
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    const __m128i evens = load(even + i), odds = load(odd + i);
    store(to + 2 * i, _mm_unpacklo_epi8(evens, odds));
    store(to + 2 * i + 16, _mm_unpackhi_epi8(evens, odds));
  }
  interleave(even + i, odd + i, count - i, to + 2 * i);
}

void split_sse2(const std::uint8_t* from, std::size_t count, std::uint8_t* even, std::uint8_t* odd) {
  const __m128i lower = _mm_set1_epi16(0xff);
  std::size_t i = 0;
  for (; i + 16 <= count; i += 16) {
    const __m128i first = load(from + 2 * i), second = load(from + 2 * i + 16);
    store(even + i, _mm_packus_epi16(_mm_and_si128(first, lower), _mm_and_si128(second, lower)));
    store(odd + i, _mm_packus_epi16(_mm_srli_epi16(first, 8), _mm_srli_epi16(second, 8)));
  }
  split(from + 2 * i, count - i, even + i, odd + i);
}

void subtract_sse2(std::uint8_t* bytes, std::size_t count) {
  const __m128i middle = _mm_set1_epi8(char(kMiddle));
  for (; count > 16; count -= 16) {
    std::uint8_t* const at = bytes + count - 16;
    store(at, _mm_add_epi8(_mm_sub_epi8(load(at), load(at - 1)), middle));
  }
  subtract(bytes, count);
}

/// The instruction makes signalling NaNs quiet, so whoever meets a NaN takes the plain loop.
__attribute__((target("avx2,f16c"))) void widen_f16c(const std::uint8_t* halves, std::size_t count, float* to) {
  const __m128i no_sign = _mm_set1_epi16(0x7fff), infinity = _mm_set1_epi16(0x7c00);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m128i eight = load(halves + 2 * i);
    if (_mm_movemask_epi8(_mm_cmpgt_epi16(_mm_and_si128(eight, no_sign), infinity)) != 0)
      widen(halves + 2 * i, 8, to + i);
    else
      _mm256_storeu_ps(to + i, _mm256_cvtph_ps(eight));
  }
  widen(halves + 2 * i, count - i, to + i);
}

__attribute__((target("avx2,f16c"))) void narrow_f16c(const float* floats, std::size_t count, std::uint16_t* to) {
  const __m256 largest = _mm256_set1_ps(65504), least = _mm256_set1_ps(-65504);
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m256 eight = _mm256_loadu_ps(floats + i);
    if (_mm256_movemask_ps(_mm256_cmp_ps(eight, eight, _CMP_UNORD_Q)) != 0) {
      narrow(floats + i, 8, to + i);
      continue;
    }
    const __m256 within = _mm256_max_ps(_mm256_min_ps(eight, largest), least);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i), _mm256_cvtps_ph(within, _MM_FROUND_TO_NEAREST_INT));
  }
  narrow(floats + i, count - i, to + i);
}

/// Clang 14 has no name for it, and a hypervisor may hide it where there is AVX2.
bool has_f16c() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C) != 0;
}

SampleLoops loops_of_processor() {
  SampleLoops loops{sum_up, sum_of_sse2, interleave_sse2, split_sse2, subtract_sse2, widen, narrow};
  if (__builtin_cpu_supports("ssse3")) loops.sum_up = sum_up_ssse3;
  if (__builtin_cpu_supports("avx2") && has_f16c()) {
    loops.widen = widen_f16c;
    loops.narrow = narrow_f16c;
  }
  return loops;
}

#else

SampleLoops loops_of_processor() { return kPlain; }

#endif

}  // namespace

const SampleLoops& plain_sample_loops() { return kPlain; }

const SampleLoops& fast_sample_loops() {
  static const SampleLoops loops = loops_of_processor();
  return loops;
}

}  // namespace alcove
