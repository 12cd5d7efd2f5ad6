// Which of two pixels show one surface, by their depths and their normals, and how far back it is solid. Pure: no
// bindings; to be included after view.glsl.
// SPDX-License-Identifier: BSD-3-Clause
//
// docs/completion.md has the rules. They are those of thickness `auto`, for first surfaces: others have no normals.
// Where normals are rough, or coarse, few of these conditions hold, and depth alone decides. "Pixels" are pixels'
// widths at the nearer one of two depths.

/// The receiver's own surface has no end behind it. So it must be sure: fewer pixels of slope than others'.
const float kOwnSlope = 4.0;

// What lies in one plane is one surface, however steep it is seen.
const float kPlaneDot = 0.95;  // the least of two normals
const float kPlaneOff = 0.5;   // px: the most from each other's planes
const float kPlaneSlope = 200.0;

// Parallel faces before each other are two: bars of a railing, not books on a shelf.
const float kParallelSlope = 1.0;    // px: nearer together they are one
const float kParallelOff = 1.5;      // px, and
const float kParallelApart = 0.125;  // radii: the least from each other's planes

// An edge between two faces of which the farther one recedes.
const float kEdgeSteps = 1.05;    // within so many steps it comes to the depth of the nearer one
const float kEdgeFacing = -0.01;  // more edge on, its plane tells nothing
const float kClearEdge = 0.8;     // the dot of normals that differ clearly

const float kFlatDot = 0.9995;  // the least of the normals of one flat face
const float kFlatOff = 0.25;    // px from each other's planes

// Rounded outlines.
const float kRoundFacing = 0.35;  // the sine of the angle to the eye's ray below which an outline may be rounded
const float kRoundDot = 0.999;    // the dot of the normals of the first pixel and the third
const int kRoundPixels = 4;

/// The dot of the normals of three pixels that end a flat face, to which a hidden one is joined.
const float kClosingDot = 0.99;

/// A first surface as a pixel shows it; a depth of kSkyDepth and more: none.
struct Facet {
  vec3 position, normal;
  float z;
};

bool are_coplanar(View view, Facet a, Facet b, float least_dot, float most_pixels) {
  const float pixel = pixel_width(view, min(a.z, b.z));
  const vec3 along = b.position - a.position;
  const float off = max(abs(dot(a.normal, along)), abs(dot(b.normal, along)));
  return max(a.z, b.z) < kSkyDepth && dot(a.normal, b.normal) >= least_dot && off < most_pixels * pixel &&
         abs(a.z - b.z) < kPlaneSlope * pixel;
}

/// Whether three pixels show one flat face.
bool are_flat(View view, Facet a, Facet b, Facet c) {
  return are_coplanar(view, a, b, kFlatDot, kFlatOff) && are_coplanar(view, a, c, kFlatDot, kFlatOff);
}

bool are_parallel(View view, Facet a, Facet b, float radius) {
  const float pixel = pixel_width(view, min(a.z, b.z));
  const vec3 along = b.position - a.position;
  const float off = min(abs(dot(a.normal, along)), abs(dot(b.normal, along)));
  return dot(a.normal, b.normal) >= kPlaneDot && off >= max(kParallelOff * pixel, kParallelApart * radius);
}

/// Whether the plane of a facet comes to the depth of a nearer one `toward` pixels away.
bool comes_to(View view, Facet far, Facet near, vec2 toward) {
  const bool perspective = view.orthographic == 0;
  const float facing = perspective ? dot(far.normal, far.position) / far.z : -far.normal.z;
  const float change = perspective ? 1.0 / near.z - 1.0 / far.z : far.z - near.z;
  const float a_step = dot(far.normal.xy, toward * view.tangent_per_pixel) / facing / (perspective ? far.z : 1.0);
  return facing <= kEdgeFacing && change * a_step > 0.0 && abs(change) < kEdgeSteps * abs(a_step);
}

/// Whether a receding face meets one before it at an edge. next: the pixel behind it. toward: px to the nearer one.
bool meet_at_edge(View view, Facet far, Facet near, Facet next, vec2 toward) {
  return comes_to(view, far, near, toward) &&
         (dot(far.normal, near.normal) < kClearEdge || are_coplanar(view, far, next, kFlatDot, kFlatOff));
}
