// The lines of one direction over the image, and the plane through the eye that each of them is seen in. Pure: no
// bindings.
// SPDX-License-Identifier: BSD-3-Clause
//
// Lines go along one axis of the image, one pixel per step, and are sheared across it by at most one pixel per step:
// every pixel is on exactly one line, no further than half a pixel beside it. Slopes are whole numbers of 1/kSlopeUnit
// pixel, so that all kernels and devices agree on which. Two lines that are as many pixels apart as the image is wide
// across never share a step; so the lines of an image fill a sheared image of the same size, in which each lies in one
// row.
//
// The plane of a line is spanned by the ray through the line's point that is nearest to the optical axis, and the line.
// A point of planar depth z is in it at (scale * place along the line, z * length of that ray), scale z in perspective,
// 1 orthographic: straight in space is straight there.

struct LinePlane {
  vec2 along;         // unit vector along the line, in units of tangent_of()
  vec2 foot;          // the point of the line that is nearest to the optical axis
  float ray_length;   // of the ray through the foot at unit depth; orthographic: 1
  int origin;         // what to add to a step of the image
  float start, step;  // place along the line of step 0, and what a step adds
};

/// Steps of a line that goes over the whole image, and lines side by side.
ivec2 extent_of(View view, Lines lines) { return mix(view.size, view.size.yx, bvec2(lines.steep != 0)); }

int index_at(View view, Lines lines, int step, int across) {
  return mix(across * view.size.x + step, step * view.size.x + across, lines.steep != 0);
}

/// The pixels that lines have moved across at a step: whole ones, and the rest, in [-0.5, 0.5).
int shift_at(Lines lines, int step) { return (lines.slope * (lines.origin.x + step) + kSlopeUnit / 2) >> kSlopeBits; }
float rest_at(Lines lines, int step) {
  return float(lines.slope * (lines.origin.x + step) - (shift_at(lines, step) << kSlopeBits)) / float(kSlopeUnit);
}

/// A line's row in the sheared image: its number modulo the rows.
int row_of(Lines lines, int line, int rows) { return (line + lines.wrap) % rows; }

/// Two thicknesses of a vertex, within 0.2 %: where one looks along the line in the low half, and against it.
uint pack_thickness(float along, float against) {
  const uvec2 halves = floatBitsToUint(vec2(along, against)) + 0x4000u >> 15;
  return halves.x | halves.y << 16;
}
float unpack_thickness(uint packed, bool along) {
  return uintBitsToFloat((along ? packed & 0xffffu : packed >> 16) << 15);
}

/// Up to where a surface goes on unseen: so many steps further along the line, at most 8191, and there it is so many
/// times as deep. Steps are held within 1/16. Of the depth the change is held, within 1/2048 of itself: so what goes on
/// has its direction too where it is small beside its distance from the eye.
uint pack_goes_on(float steps, float depths) {
  return uint(steps * 8.0 + 0.5) << 16 | packHalf2x16(vec2(depths - 1.0, 0.0));
}
float steps_of_goes_on(uint packed) { return float(packed >> 16) * 0.125; }
float depths_of_goes_on(uint packed) { return 1.0 + unpackHalf2x16(packed).x; }

/// The place of a point of the line in its plane.
vec2 place_at(View view, LinePlane plane, float step, float z) {
  const float scale = view.orthographic != 0 ? 1.0 : z;
  precise const float along = scale * (plane.start + (float(plane.origin) + step) * plane.step);
  return vec2(along, z * plane.ray_length);
}

/// tangent_of() the centre of a pixel, counted along and across from the display window's corner, so that it is the
/// same in a crop.
vec2 tangent_at(View view, Lines lines, ivec2 along_and_across) {
  const ivec2 origin = mix(lines.origin, lines.origin.yx, bvec2(lines.steep != 0));
  const ivec2 pixel = mix(along_and_across, along_and_across.yx, bvec2(lines.steep != 0));
  return (vec2(pixel) + 0.5 - (view.center + vec2(origin))) * view.tangent_per_pixel;
}

LinePlane plane_of(View view, Lines lines, int line) {
  const float slope = float(lines.slope) / float(kSlopeUnit);
  const vec2 first = tangent_at(view, lines, ivec2(0, line + lines.origin.y));
  const vec2 next = (lines.steep != 0 ? vec2(slope, 1) : vec2(1, slope)) * view.tangent_per_pixel;
  LinePlane plane;
  plane.origin = lines.origin.x;
  plane.step = length(next);
  plane.along = next / plane.step;
  plane.start = dot(first, plane.along);
  plane.foot = first - plane.start * plane.along;
  plane.ray_length = view.orthographic != 0 ? 1.0 : sqrt(1.0 + dot(plane.foot, plane.foot));
  return plane;
}

/// The unit vector in the plane of a line that is across the line, away from the eye.
vec3 away_of(View view, LinePlane plane) {
  return view.orthographic == 0 ? vec3(plane.foot, -1) / plane.ray_length : vec3(0, 0, -1);
}

/// A direction within the plane of a line, as a unit vector along the line and away from the eye.
vec2 in_plane(View view, LinePlane plane, vec3 direction) {
  const vec2 projected = vec2(dot(direction.xy, plane.along), dot(direction, away_of(view, plane)));
  return projected * inversesqrt(max(dot(projected, projected), 1e-12));
}

/// The value that is straight along a line where the surface is: disparity, or orthographic depth.
float value_of(bool perspective, float z) { return perspective ? 1.0 / z : z; }

/// The steps of a line that lie on the image, from the first to behind the last.
ivec2 steps_of(Lines lines, ivec2 extent, int line) {
  const float steps_per_pixel = float(kSlopeUnit) / (lines.slope == 0 ? 1.0 : float(lines.slope));
  const float enters = (-0.5 - float(line)) * steps_per_pixel - float(lines.origin.x);
  const float leaves = enters + float(extent.y) * steps_per_pixel;
  // Rounding may put them beside the border: two steps more on either side are searched for it.
  int begin = clamp(int(clamp(min(enters, leaves), -1e6, 1e6)) - 2, 0, extent.x);
  int end = clamp(int(clamp(max(enters, leaves), -1e6, 1e6)) + 3, 0, extent.x);
  if (lines.slope == 0) {
    begin = 0;
    end = extent.x;
  }
  while (begin < end && uint(line + shift_at(lines, begin)) >= uint(extent.y)) begin++;
  while (begin < end && uint(line + shift_at(lines, end - 1)) >= uint(extent.y)) end--;
  return ivec2(begin, end);
}
