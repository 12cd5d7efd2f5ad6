// Raw depth -> planar depth. Pure: no bindings.
// SPDX-License-Identifier: BSD-3-Clause

/// e^x - 1. Near 0, where the 1 would take the digits away, by the first terms of its series, which are as precise as
/// floats.
float exp_minus_1(float x) {
  if (abs(x) > 0.5) return exp(x) - 1.0;
  float sum = 1.0;
  for (int k = 8; k > 1; k--) sum = 1.0 + sum * x / float(k);
  return x * sum;
}

/// Planar depth in scene units, kSkyDepth where there is no surface. raw: of kDepthPosition x, y and z, else x alone.
float planar_depth(uint form, DepthTerms terms, View view, ivec2 pixel, vec3 raw) {
  float z;
  if (form == kDepthPosition) {
    if (raw == vec3(0)) return kSkyDepth;
    z = terms.base + dot(terms.axis, raw);
  } else {
    if (!(raw.x > terms.sky_below && raw.x < terms.sky_above)) return kSkyDepth;
    const float value = terms.slope * (raw.x - terms.origin);
    z = form == kDepthReciprocal    ? 1.0 / (terms.base + value)
        : form == kDepthExponential ? terms.base * exp_minus_1(value)
                                    : terms.base + value;
  }
  if (!is_finite(z) || !(z > 0.0 && z < terms.sky_depth)) return kSkyDepth;
  const vec2 t = tangent_of(view, vec2(pixel) + 0.5);
  if (terms.along_ray != 0) z *= inversesqrt(1.0 + dot(t, t));
  return z < kSkyDepth ? z : kSkyDepth;
}
