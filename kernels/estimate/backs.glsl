// How far back a pixel's surface is solid, by what else is seen of it, packed into a word. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

const uint kBackLinked = 0x80000000u;  // only while it is made: the pixel goes on from the one before

/// What is seen along a line tells no more than so many times the width across it: the rod of a railing is not as deep
/// as the balcony below it.
const float kBackPerWidth = 1.5;

/// What a line tells of a pixel.
struct Back {
  float depth;          // how much deeper than its front it is solid
  float width;          // of its surface along the line
  float before, after;  // as depth, by the rounded outline before it and after it; below 0: there is none
};

uint pack_mirrored(float depth, float radius) {
  return depth < 0.0 ? 0u : uint(sqrt(min(depth / (kMostBack * radius), 1.0)) * 62.0 + 0.5) + 1u;
}
float unpack_mirrored(uint word, float radius) {
  const float part = (float(word & 63u) - 1.0) / 62.0;
  return (word & 63u) == 0u ? -1.0 : part * part * kMostBack * radius;
}

uint pack_depth(float depth, float radius) { return uint(clamp(depth / (kMostBack * radius), 0.0, 1.0) * 255.0 + 0.5); }
float unpack_depth(uint word, float radius) { return float(word & 255u) * (kMostBack / 255.0) * radius; }

uint pack_line(Back back, float radius) {
  const uint width = uint(clamp(back.width / (2.0 * kLongestChain * radius), 0.0, 1.0) * 2047.0 + 0.5);
  return pack_depth(back.depth, radius) | pack_mirrored(back.before, radius) << 8 |
         pack_mirrored(back.after, radius) << 14 | width << 20;
}

Back unpack_line(uint word, float radius) {
  return Back(unpack_depth(word, radius), float(word >> 20 & 2047u) * (2.0 * kLongestChain / 2047.0) * radius,
              unpack_mirrored(word >> 8, radius), unpack_mirrored(word >> 14, radius));
}

uint pack_back(float depth, vec4 mirrored, float radius) {
  return pack_depth(depth, radius) | pack_mirrored(mirrored.x, radius) << 8 | pack_mirrored(mirrored.y, radius) << 14 |
         pack_mirrored(mirrored.z, radius) << 20 | pack_mirrored(mirrored.w, radius) << 26;
}

/// Where in a word the outline is told that lies towards a receiver from which samples go this way.
uint outline_of(vec2 direction) {
  const bool across = abs(direction.x) >= abs(direction.y);
  return across ? (direction.x > 0.0 ? 8u : 14u) : (direction.y > 0.0 ? 20u : 26u);
}
