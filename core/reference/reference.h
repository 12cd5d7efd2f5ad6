// The estimators again, slow, in double precision, on the CPU: the oracle that kernels are tested against.
// SPDX-License-Identifier: BSD-3-Clause
//
// Every pixel along each slice is looked at; there is no noise. The distance of a kernel to it is the *estimator
// error*; its own distance to ray tracing is the *missing-geometry error*, what one depth layer cannot show.
#pragma once

#include <vector>

#include "core/base/settings.h"
#include "core/frame/reading.h"

namespace alcove {

/// How far an occluder goes on behind the surface that the depth buffer shows.
enum class ThicknessRule {
  infinite,  // for ever, within the sphere of the radius
  constant,  // a length along the sample's own view ray
  // As wide as the run of neighbours along the slice that it belongs to, which is its chord and a pixel, times
  // width_share, and width_pixels more pixels. The receiver's own run is infinite, and but for Completion::none that
  // is a run which the picture's border cuts.
  width,
};

struct ReferenceSettings {
  double radius = 0;                // scene units, > 0
  Falloff falloff = Falloff::none;  // as EstimatorSettings
  double falloff_start = 0;         // fraction of the radius
  int slices = 16;                  // per pixel, even in azimuth about the view ray; > 0
  ThicknessRule thickness = ThicknessRule::infinite;
  double thickness_length = 0;  // scene units, > 0; with ThicknessRule::constant
  double width_share = 1;       // > 0; with ThicknessRule::width
  double width_pixels = 0;      // px, >= 0; with ThicknessRule::width
  // Where surfaces go on straight although the picture does not show it: docs/completion.md. Behind what is nearer they
  // do only where occluders have an end.
  Completion complete = Completion::none;
  int hidden = 3;                   // surfaces behind the first that count, where the frame has any; 0 to 3
  double separation = -1;           // scene units: surfaces closer than it are one; below 0: as layers.comp takes it
  double bias = 0;                  // sine of the elevation above the tangent plane below which nothing blocks
  int threads = 0;                  // 0: one per core
  std::vector<std::size_t> pixels;  // indices of those to compute; empty: all
};

/// What the estimators gtao and bitmask are meant to compute with these settings, but for intensity and power.
/// settings.radius must be set. `with_hidden`: for a frame that knows surfaces behind the first.
ReferenceSettings reference_settings_of(const EstimatorSettings& settings, bool with_hidden = false);

/// One visibility in [0, 1] per pixel, 1 on sky and where no pixel was asked for. The frame must have planar depth and
/// normals. Fails with ErrorKind::input otherwise.
std::vector<float> reference_ao(const HostFrame& frame, const ReferenceSettings& settings);

/// By how much the visibility would be higher without what completed surfaces block, with the same thickness: in [0, 1]
/// per pixel, 0 on sky and where no pixel was asked for.
std::vector<float> reference_completed(const HostFrame& frame, const ReferenceSettings& settings);

/// The mean open direction in view space, cosine weighted, as planes x, y, z: 2/3 of the normal where nothing is
/// blocked; 0 on sky and where no pixel was asked for.
std::vector<float> reference_bent(const HostFrame& frame, const ReferenceSettings& settings);

/// One visibility in [0, 1] per pixel, by the settings' estimator (gtao, hbao, crytek) with its radius, bias, falloff
/// and kernel, intensity and power: what it gives at full resolution with so many directions and samples that nothing
/// is left to smooth; slices, steps, resolution, denoiser and seed are not looked at. 1 on sky and where no pixel was
/// asked for (indices; empty: all). The radius must be set. The frame must have planar depth and normals. Fails with
/// ErrorKind::input otherwise, and with ErrorKind::usage on another estimator.
std::vector<float> reference_estimate(const HostFrame& frame, const EstimatorSettings& settings,
                                      const std::vector<std::size_t>& pixels = {});

}  // namespace alcove
