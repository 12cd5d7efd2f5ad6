// A set of angles of a side of a slice, as bits: sectors are even in slope_of(), and the bits of the largest slopes are
// the highest. Pure: no bindings; to be included after slice.glsl and noise.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// The boundaries of what is added move by a `shift` in [0, 1) that is even over pixels: then the expected arc is the
// exact one, read linearly in each sector.

const int kSectorCount = 24;

/// The part of the arc integral in each sector, times cos gamma and times sin gamma: the differences of sin^2(theta) /
/// 2 and (theta - sin(theta) cos(theta)) / 2 between its ends, the slopes -1 + 2 k / 24.
const vec2 kSectorArc[kSectorCount] =
    vec2[](vec2(-0.00409836, 0.00024798), vec2(-0.01513241, 0.00229596), vec2(-0.03076923, 0.00833134),
           vec2(-0.05000000, 0.02094853), vec2(-0.06891892, 0.04181445), vec2(-0.08108108, 0.06906083),
           vec2(-0.08108108, 0.09608785), vec2(-0.06891892, 0.11478742), vec2(-0.05000000, 0.12094853),
           vec2(-0.03076923, 0.11602365), vec2(-0.01513241, 0.10443972), vec2(-0.00409836, 0.09041191),
           vec2(0.00409836, 0.09041191), vec2(0.01513241, 0.10443972), vec2(0.03076923, 0.11602365),
           vec2(0.05000000, 0.12094853), vec2(0.06891892, 0.11478742), vec2(0.08108108, 0.09608785),
           vec2(0.08108108, 0.06906083), vec2(0.06891892, 0.04181445), vec2(0.05000000, 0.02094853),
           vec2(0.03076923, 0.00833134), vec2(0.01513241, 0.00229596), vec2(0.00409836, 0.00024798));

/// The same for first_to(): the differences of sin^3 / 3, (1 - cos)^2 (2 + cos) / 3 and (1 - cos^3) / 3, which its
/// terms in cos gamma and sin gamma have as factors.
const vec3 kSectorFirst[kSectorCount] =
    vec3[](vec3(-0.00024737, 0.00001684, 0.00408995), vec3(-0.00226694, 0.00035783, 0.01495470),
           vec3(-0.00802662, 0.00221369, 0.02968369), vec3(-0.01927331, 0.00816504, 0.04609107),
           vec3(-0.03564051, 0.02178764, 0.05890608), vec3(-0.05239638, 0.04486998, 0.06175671),
           vec3(-0.06175671, 0.07347221, 0.05239638), vec3(-0.05890608, 0.09838409, 0.03564051),
           vec3(-0.04609107, 0.11171252, 0.01927331), vec3(-0.02968369, 0.11208501, 0.00802662),
           vec3(-0.01495470, 0.10331345, 0.00226694), vec3(-0.00408995, 0.09028838, 0.00024737),
           vec3(0.00408995, 0.09028838, 0.00024737), vec3(0.01495470, 0.10331345, 0.00226694),
           vec3(0.02968369, 0.11208501, 0.00802662), vec3(0.04609107, 0.11171252, 0.01927331),
           vec3(0.05890608, 0.09838409, 0.03564051), vec3(0.06175671, 0.07347221, 0.05239638),
           vec3(0.05239638, 0.04486998, 0.06175671), vec3(0.03564051, 0.02178764, 0.05890608),
           vec3(0.01927331, 0.00816504, 0.04609107), vec3(0.00802662, 0.00221369, 0.02968369),
           vec3(0.00226694, 0.00035783, 0.01495470), vec3(0.00024737, 0.00001684, 0.00408995));

/// The same for second_to(): of sin^4 / 4, (theta - sin cos (1 - 2 sin^2)) / 8 and (1 - cos^4) / 4.
const vec3 kSectorSecond[kSectorCount] =
    vec3[](vec3(-0.00001680, 0.00024676, -0.00408156), vec3(-0.00035303, 0.00223834, -0.01477938),
           vec3(-0.00213018, 0.00773372, -0.02863905), vec3(-0.00750000, 0.01773713, -0.04250000),
           vec3(-0.01853360, 0.03040065, -0.05038532), vec3(-0.03396640, 0.03981816, -0.04711468),
           vec3(-0.04711468, 0.03981816, -0.03396640), vec3(-0.05038532, 0.03040065, -0.01853360),
           vec3(-0.04250000, 0.01773713, -0.00750000), vec3(-0.02863905, 0.00773372, -0.00213018),
           vec3(-0.01477938, 0.00223834, -0.00035303), vec3(-0.00408156, 0.00024676, -0.00001680),
           vec3(0.00408156, 0.00024676, 0.00001680), vec3(0.01477938, 0.00223834, 0.00035303),
           vec3(0.02863905, 0.00773372, 0.00213018), vec3(0.04250000, 0.01773713, 0.00750000),
           vec3(0.05038532, 0.03040065, 0.01853360), vec3(0.04711468, 0.03981816, 0.03396640),
           vec3(0.03396640, 0.03981816, 0.04711468), vec3(0.01853360, 0.03040065, 0.05038532),
           vec3(0.00750000, 0.01773713, 0.04250000), vec3(0.00213018, 0.00773372, 0.02863905),
           vec3(0.00035303, 0.00223834, 0.01477938), vec3(0.00001680, 0.00024676, 0.00408156));

/// Random numbers in [0, 1) of one side.
struct Draw {
  float jitter;  // of its steps
  float shift;   // of the boundaries of sectors
};

/// Random numbers of a side, from those of its pixel. The boundaries of the sectors move by the fraction of a multiple
/// of the steps' jitter. Of a number that is even in [0, 1), the fraction of m times it is even too, and their
/// correlation is 1 / m: here 9 %.
Draw draw_of(vec2 noise, uint slice, uint side) {
  const float jitter = fract(noise.y + kGolden * float(2u * slice + side));
  return Draw(jitter, fract(11.0 * jitter));
}

uint sectors_below(float slope, float shift) {
  return (1u << uint(0.5 * float(kSectorCount) * (slope + 1.0) + shift)) - 1u;
}

/// The sectors between two slopes, the larger one first; none if it is not the larger.
uint sectors_between(vec2 slopes, float shift) {
  return slopes.x >= slopes.y ? sectors_below(slopes.x, shift) & ~sectors_below(slopes.y, shift) : 0u;
}

/// The arc integral over a set.
float arc_of(Side side, uint sectors) {
  vec2 sum = vec2(0);
  for (int k = 0; k < kSectorCount; k++) sum += float((sectors >> k) & 1u) * kSectorArc[k];
  return sum.x * side.cos_gamma + sum.y * side.sin_gamma;
}

/// first_to() over a set.
vec2 first_of(Side side, uint sectors) {
  vec3 sum = vec3(0);
  for (int k = 0; k < kSectorCount; k++) sum += float((sectors >> k) & 1u) * kSectorFirst[k];
  return vec2(sum.x * side.cos_gamma + sum.y * side.sin_gamma, sum.z * side.cos_gamma + sum.x * side.sin_gamma);
}

/// second_to() over a set.
vec2 second_of(Side side, uint sectors) {
  vec3 sum = vec3(0);
  for (int k = 0; k < kSectorCount; k++) sum += float((sectors >> k) & 1u) * kSectorSecond[k];
  return vec2(sum.y * side.cos_gamma + sum.x * side.sin_gamma, sum.z * side.cos_gamma + sum.y * side.sin_gamma);
}
