// Every number and choice that a user may set, with unit, range, default and reason. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/input_settings.h"
#include "core/base/output_settings.h"
#include "core/base/setting_words.h"

namespace alcove {

/// The estimate of ambient occlusion. The defaults are the preset `standard`.
struct EstimatorSettings {
  Estimator estimator = Estimator::gtao;
  std::optional<double> radius;  // scene units, > 0; no default, since no number fits all scenes
  bool radius_auto = false;      // instead: as core/frame/radius.h proposes
  // scene units, > 0: more scales. The AO is the mean of all: that is AO itself, with a falloff that drops by a step at
  // each radius
  std::vector<double> further_radii;
  Falloff falloff = Falloff::none;  // none: what renderers' own AO passes mean by a distance
  double falloff_start = 0;         // fraction of the radius where the falloff begins, 0 to 1 exclusive
  // fraction of the radius where it ends, above the start to 1; nothing beyond blocks
  double falloff_end = 1;
  // directions per pixel, 1 to 64; with fewer than 3 each pixel by itself is noisy, and the denoiser must share those
  // of its neighbours
  int slices = 2;
  int steps = 16;  // samples to each side of a slice, 1 to 4096; they matter more than slices
  // of gtao, RMS error of the visibility by the search, 0 to 1: as many directions of an exact search as that takes,
  // tile by tile; 0: as the settings say
  double tolerance = 0;
  // of estimator gtao; but for `steps`, the falloff must be none and the stride 1
  SliceSearch search = SliceSearch::steps;
  int samples = 16;  // of estimator crytek, in the hemisphere, 4 to 64
  // least height that blocks, >= 0; crytek: scene units of depth; others: sine of the elevation above the tangent
  // plane, < 1
  double bias = 0;
  Elevation elevation = Elevation::view;                 // of estimator hbao
  SampleKernel sample_kernel = SampleKernel::clustered;  // of estimator crytek
  // of estimator crytek; ratio: full within the radius, so that no hit in reach is lost
  RangeCheck range_check = RangeCheck::ratio;
  // how far an occluder goes on behind what is seen of it; automatic: as deep as it is wide, and in an exact search
  // half of that where surfaces are completed behind what is nearer
  ThicknessKind thickness = ThicknessKind::automatic;
  double thickness_length = 0;  // scene units, > 0; with ThicknessKind::constant
  // Of gtao and bitmask: where a surface goes on straight although the frame does not show it. That is a guess; on all
  // rendered scenes the AO came nearer to ray tracing by it. none: nowhere, so that only what is seen
  // blocks; border: beyond the picture's border; all: also behind what is nearer to the eye.
  Completion complete = Completion::all;
  int hidden = 3;  // surfaces kept behind the first of a pixel, 0 to 3, where the frame has any
  // scene units: surfaces closer than it are one; none: by the depth's precision and a pixel's slope
  std::optional<double> separation;
  Resolution resolution = Resolution::full;
  // one pixel of so many has an estimate, 1, 2, 4, 8 or 16, and gives it to the others in the bilateral denoiser; with
  // Density::adaptive so many at least; 0: see spacing_of
  int stride = 0;
  // adaptive: more estimates where a surface shows too few pixels for its neighbours to give it one; of gtao by steps,
  // and of bitmask
  Density density = Density::adaptive;
  Denoise denoise = Denoise::bilateral;
  // pixels of the estimate to each side, 1 to 8; with Denoise::bilateral; 0: see denoise_radius_of
  int denoise_radius = 0;
  // instead: 2 to 9 weights from the centre outwards, none negative, the centre's above 0; empty: a Gaussian, or
  // interpolate's parabola
  std::vector<double> denoise_kernel;
  // of the depth, 0 to 100: a step by this part weighs 1/e; 0: weighs by plane distance instead
  double denoise_depth_sigma = 0;
  double intensity = 1;  // factor on the occlusion, 0 to 100
  double power = 1;      // exponent of the visibility, above 0 to 100
  // scene units of planar depth, both or none, 0 <= start < end: the AO fades to 1 from one to the other
  std::optional<double> fade_start, fade_end;
  // of the surface, for specular occlusion, 0 to 1; perceptual, half way by default, as engines' own default materials
  double roughness = 0.5;
  std::uint32_t seed = 0;  // shifts the noise pattern
  // fixed: what stands still does not flicker, and may be used again; animated: for a mean over frames, which takes its
  // noise away
  Noise noise = Noise::fixed;
  bool no_skip = false;  // estimate sky too, and what is as in the frame before; the result is the same
};

/// Where to compute.
struct DeviceSettings {
  std::string device = "auto";  // auto | cpu | index | name | UUID
  bool require_gpu = false;
  bool validate = false;
  bool no_pipeline_cache = false;
  int threads = 0;           // of the CPU device and of the codecs; 0: one per core
  std::uint64_t memory = 0;  // bytes that the process may take; 0: half of what is free
  // bytes that frames get however little `memory` is; no option: tests cut small frames into tiles by it
  std::uint64_t least_memory = 0;
};

/// How a run reports its progress.
struct ProgressSettings {
  std::string kind = "auto";  // auto, bar, plain, percent, openjd or none; auto: a bar on a terminal, else plain
  bool verbose = false, quiet = false;
};

struct Settings {
  FrameSettings frames;
  InputSettings input;
  EstimatorSettings estimator;
  OutputSettings output;
  DeviceSettings device;
  ProgressSettings progress;
};

}  // namespace alcove
