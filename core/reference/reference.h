// The estimators a second time, slow, in double precision, on the CPU: the oracle that kernels and presets are tested
// against.
// SPDX-License-Identifier: BSD-3-Clause
//
// The reference looks at every pixel along each slice, and has no noise. The distance of a kernel to it is the
// *estimator error*; its own distance to ray tracing is the *missing-geometry error*, due to geometry that one depth
// layer cannot show.
#pragma once

#include <vector>

#include "core/base/settings.h"
#include "core/frame/reading.h"
#include "core/reference/reference_scene.h"

namespace alcove {

/// The thickness of occluders behind the surface that the depth buffer shows.
enum class ThicknessRule {
  infinite,  // as far as the sphere of the radius
  constant,  // a length along the sample's own view ray
  // the width of the sample's run of neighbours along the slice (its chord and a pixel), times width_share, and
  // width_pixels more pixels. The receiver's own run is infinite. Except with Completion::none, a run that the
  // picture's border cuts is at least half a radius thick.
  width,
};

struct ReferenceSettings {
  double radius = 0;                // scene units, > 0
  double size = 0;                  // scene units: the radius by which thickness levels off; 0: the same
  Falloff falloff = Falloff::none;  // as EstimatorSettings
  double falloff_start = 0;         // fraction of the radius
  int slices = 16;                  // per pixel, even in azimuth about the view ray; > 0
  ThicknessRule thickness = ThicknessRule::infinite;
  double thickness_length = 0;  // scene units, > 0; with ThicknessRule::constant
  double width_share = 1;       // > 0; with ThicknessRule::width
  double width_pixels = 0;      // px, >= 0; with ThicknessRule::width
  // Places where surfaces go on straight although the picture does not show it: docs/completion.md. Behind nearer
  // surfaces they go on only if occluders have an end.
  Completion complete = Completion::none;
  int hidden = 3;                   // the most surfaces behind the first that count; 0 to 3
  double separation = -1;           // scene units: surfaces closer together are one; below 0: as in layers.comp
  double bias = 0;                  // sine of the elevation above the tangent plane below which nothing blocks
  std::vector<std::size_t> pixels;  // indices of the pixels to compute; empty: all
};

/// The radius by which thickness levels off.
inline double size_of(const ReferenceSettings& settings) { return settings.size > 0 ? settings.size : settings.radius; }

/// The settings for the values that the estimators gtao and bitmask aim at with these settings, before intensity and
/// power. settings.radius must be set. `with_hidden`: for a frame with known surfaces behind the first.
ReferenceSettings reference_settings_of(const EstimatorSettings& settings, bool with_hidden = false);

/// Gives the visibility in [0, 1] of each pixel; 1 on sky and at pixels that were not asked for. The frame must have
/// planar depth and normals. Fails with ErrorKind::input otherwise.
std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings);

/// Gives the visibility in [0, 1] of each pixel by the settings' estimator (gtao, hbao, crytek) with its radius, bias,
/// falloff and kernel, intensity and power. That is its result at full resolution with so many directions and samples
/// that nothing is left to smooth; slices, steps, resolution, denoiser and seed are ignored. `pixels` are the indices
/// to compute; empty: all. The others and sky have 1. The radius must be set. The frame must have planar depth and
/// normals. Fails with ErrorKind::input otherwise, and with ErrorKind::usage on another estimator.
std::vector<float> reference_estimate(const HostFrame& frame, const EstimatorSettings& settings,
                                      const std::vector<std::size_t>& pixels = {});

}  // namespace alcove
