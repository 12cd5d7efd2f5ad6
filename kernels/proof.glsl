// What the proof of classify.comp computes with: boxes and rectangles that hold all that may be within reach, and the
// heights above the tangent planes of a block's receivers. Pure: no bindings; to be included after view.glsl,
// clearance.glsl and tiles.glsl.
// SPDX-License-Identifier: BSD-3-Clause

/// Receivers are treated together in blocks of so many tiles in x and y, where they lie on one plane.
const int kBlock = 2;
const uint kLevel = kTilePlanes - 1u;
const float kFar = 1e30;
const float kHalfTile = 0.5 * float(kTile - 1);
const int kGroupSide = kTile * kTileGroup;  // px

/// Of what is harmless (clearance.glsl) the proof claims this part. So heights may be off by a tenth of it and more: at
/// a pixel's distance an estimator allows kLeastRise pixels and the proof 0.9 * 0.5 of them (harmless_height), which
/// leaves 0.55 * 4e-3 * tangent_per_pixel. What is added without the depth is at most 2 t for a surface seen aslant, t
/// the tangent at the image's border, and its sum of four terms is off by 4 * 2^-24 * 2 t: less as long as the image is
/// less than 9,000 pixels wide, and three times that if errors add up as random ones do.
const float kClaimed = 0.9;

/// The rounding of what is added with the depth, as part of it: the proof and an estimator each compute a height from a
/// dozen operations, and 32 of them are off by no more than 32 * 2^-24.
const float kRounding = 2e-6;

/// Of the tolerated height the proof claims this part: 2 % of the tolerance, which goes with the square, for rounding
/// and for the approximation of square roots.
const float kToleranceClaimed = 0.99;

/// Where a sphere reaches nearer to the eye than this part of its box's depth, all of the image is searched. Down to
/// it, the difference of depth and reach is off by 200 * 2^-24 of itself at most, and so is what is divided by it: on
/// 65,535 pixels that is less than the pixel that image_of_reach() adds.
const float kLeastNear = 0.01;

ivec2 tile_of_block(ivec2 first, int i) { return first + ivec2(i % kBlock, i / kBlock); }

struct Box {
  vec3 least, most;  // tangents times depth, and depth
};

/// At the image's border a tile's surface does not rise to kLeastRisen beyond it if its normals differ from a
/// receiver's by no more than this: it rises by at most so much of the way that it goes, which is at most 1 + kFarEnd
/// radii, and stands no higher where it begins than what is harmless, kLeastRise radii, and kFeignedHeight.
const float kSameSlope = 0.03;

/// The part of the radius that errors of depth may feign of a height where that is used.
const float kFeignedHeight = 0.02;

/// The box that holds what is seen in so many tiles in x and y between two depths.
Box box_of(View view, ivec2 tile, int tiles, float near, float far) {
  const vec2 a = tangent_of(view, vec2(tile * kTile) + 0.5);
  const vec2 b = tangent_of(view, vec2(min((tile + tiles) * kTile, view.size)) - 0.5);
  const vec2 least = min(a, b);
  const vec2 most = max(a, b);
  const vec2 scale = view.orthographic != 0 ? vec2(1) : vec2(near, far);
  return Box(vec3(min(least * scale.x, least * scale.y), near), vec3(max(most * scale.x, most * scale.y), far));
}

float distance_sq(Box a, Box b) {
  const vec3 gap = max(max(a.least - b.most, b.least - a.most), 0.0);
  return dot(gap, gap);
}

/// The depth of a nearness.
float depth_of(View view, float nearness) { return view.orthographic != 0 ? -nearness : 1.0 / nearness; }

/// From pixels' centres to the samples of receivers up to this depth: one lies up to half a pixel beside its slice, and
/// is moved into it.
float reach_of_samples(View view, float radius, float far) {
  const float pixel = max(abs(view.tangent_per_pixel.x), abs(view.tangent_per_pixel.y));
  return radius + 2.0 * pixel * (view.orthographic != 0 ? 1.0 : far + radius);
}

struct Rect {
  vec2 least, most;  // px
};

/// The part of the image in which a sphere about anything in a box is seen: all of it where one may hold the eye.
Rect image_of_reach(View view, Box box, float reach) {
  const bool perspective = view.orthographic == 0;
  const float near = box.least.z - reach, far = box.most.z + reach;
  if (perspective && !(near > kLeastNear * box.least.z)) return Rect(vec2(0), vec2(view.size - 1));
  const vec2 least = box.least.xy - reach, most = box.most.xy + reach;
  const vec2 a = perspective ? min(least / near, least / far) : least;
  const vec2 b = perspective ? max(most / near, most / far) : most;
  const vec2 p = view.center + a / view.tangent_per_pixel;
  const vec2 q = view.center + b / view.tangent_per_pixel;
  return Rect(clamp(min(p, q) - 1.0, vec2(0), vec2(view.size - 1)),
              clamp(max(p, q) + 1.0, vec2(0), vec2(view.size - 1)));
}

/// What the receivers of a block have in common; the members are those of TileBounds.
struct Shared {
  float nearest, farthest;
  uint normal;
  float turned, lowest, highest;
};

/// A block's receivers, as the proof needs them. Its left side is nearness / z + affine + dot(along, pixel).
struct Receivers {
  ivec2 tile;             // the first of the block
  Box box;                // that holds them
  float reach, reach_sq;  // scene units: from their pixels' centres to their samples
  float rise, tolerated;  // heights for every pixel aside: what is harmless, and what is tolerated
  float least;            // what the left side leaves out, in units of depth, or orthographic of height
  ivec2 from, extent;     // groups within reach; more than kMostGroups: not searched
  float nearness;         // factor of 1 / z: c - least; or orthographic of -z: N.z
  float affine;           // at pixel (0, 0)
  vec3 normal;            // N
  // the largest difference from it, or more than kSameSlope where nothing is known of surfaces beyond the border
  float differs;
  vec2 along;  // per pixel
  // What the left side grows by as normals differ: alone, and per nearness. It is the length of the difference times
  // the farthest that anything that may block is from a receiver.
  float turned;
  float turned_by_nearness;
};

/// The most that anything before a plane rises above the receivers' tangent planes, in a square of pixels.
float most_above(Receivers r, vec2 centre, float half_side, vec2 gradient, float at_centre) {
  const vec2 along = r.nearness * gradient + r.along;
  return r.nearness * at_centre + r.affine + dot(r.along, centre) + half_side * (abs(along.x) + abs(along.y));
}

/// Pixels from the block to a square of them, and to its farthest.
ivec2 distances_px(Receivers r, ivec2 first_pixel, int side) {
  const ivec2 offset = first_pixel - r.tile * kTile;
  const ivec2 least = max(-offset - side + 1, offset - kBlock * kTile + 1);
  const ivec2 most = max(abs(offset - kBlock * kTile + 1), abs(offset + side - 1));
  return ivec2(max(max(least.x, least.y), 0), max(most.x, most.y));
}

/// How much may stand above the tangent planes and yet not block, with nearness at most `level`.
float harmless_height(Receivers r, float rise, int distance_px, float level) {
  const float aside = max(float(distance_px) - 0.5, 0.5);
  return rise * aside - kRounding * abs(r.nearness * level) - r.turned - r.turned_by_nearness * level;
}

float harmless_height(Receivers r, int distance_px, float level) {
  return harmless_height(r, r.rise, distance_px, level);
}

/// How much of the left side, at most, takes no more of the visibility than the tolerance.
float tolerated_height(View view, Receivers r, int distance_px, float level) {
  return harmless_height(r, r.tolerated, distance_px, level) - r.least * (view.orthographic != 0 ? 1.0 : level);
}
