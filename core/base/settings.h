// Every number and choice that a user may set, with unit, range, default and reason. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/option_words.h"

namespace alcove {

/// Which frames of a sequence, and what becomes of those that cannot or need not be computed.
struct FrameSettings {
  // a list for core/formats/sequence.h; empty: those of the first input with a pattern that lie on the disk
  std::string frames;
  int output_offset = 0;  // frames from an input's number to its outputs'
  // compute only the chunk-th of as many parts of the frames, 1 <= chunk <= chunks; all of nearly equal length
  int chunk = 1, chunks = 1;
  Missing missing = Missing::error;
  bool keep_going = false;  // a frame that fails does not end the run
  // a frame with a warning (core/base/note.h) fails before anything of it is written
  bool warnings_as_errors = false;
  // compute only frames whose outputs are missing, broken, older than their inputs, or made with other options
  bool resume = false;
  bool overwrite = false;  // compute all of them whatever `resume` says
};

/// What to read and how to understand it.
struct InputSettings {
  std::string input;                            // an EXR file that holds every AOV not named below
  std::string depth, normal, position, beauty;  // files of single AOVs; empty: the input
  std::string depth_channel;                    // a channel's full name; empty: found by its usual names
  // three names with commas, or a layer; empty: found. Normals may have two
  std::string normal_channels, beauty_channels, position_channels;
  // the light that AO may dim, see core/frame/gbuffer.cpp; empty: found
  std::string ambient;
  // the materials' own AO: a file, empty: the input, where a channel is named; its full name, empty: found
  std::string material_ao, material_ao_channel;
  // where AO is wanted: the same, and what of it, see core/frame/matte.h; the AO elsewhere, 0 to 1
  std::string matte, matte_channel, matte_object;
  double matte_outside = 1;
  // which first surfaces are occluders: these alone, or all but these, as a file of coverage, or as objects, names or
  // numbers with commas; at most one is not empty
  std::string occluders, occluder_objects, ignore, ignored_objects;
  // where those objects are told: a file, empty: the input; a channel of numbers or a Cryptomatte's layer, empty: found
  std::string objects, object_channel;
  // the diffuse colour for multi-bounce: a file; empty: the beauty's. Three names, or a layer; empty: found
  std::string albedo, albedo_channels;
  std::optional<double> albedo_value;  // instead: one for all surfaces, 0 to 1
  // what lies behind the first surface, or before it as seen from there: files of depth, in any order
  FileList behind;
  // their depth channels, full names, and what they hold: none, one for all, or one for each
  std::vector<std::string> behind_channels;
  std::vector<BehindKind> behind_kinds;
  FileList deep;              // deep EXR files of the frame, whose samples count together
  double deep_opacity = 0.5;  // of a sample, from which it is a surface, 0 to 1
  bool other_views = false;   // of a stereo file: what its other views see counts too
  // frames to each side, 0 to 32, whose static surfaces count where they are hidden in this one
  int around = 0;
  bool around_all = false;  // instead: all frames of the shot
  // to each side, 0 to 16, with whose estimates the AO of a frame is a mean
  int accumulate = 0;
  // motion vectors, which tell what moves: a file, two channels, and what they point to
  std::string motion, motion_channels;
  MotionKind motion_kind = MotionKind::automatic;
  std::string layer;  // look only at channels of this layer or part
  std::string view;   // of a stereo file; empty: its default
  // px of depth and normals for each of the picture, in x and in y, 1 to 4; auto: by the beauty's size
  std::string supersampling = "auto";
  std::optional<Region> roi;  // compute and write no more than this, in px of the picture; none: the data window
  // the program that wrote the frame, of presets/input; auto: by its header and channels
  std::string source = "auto";
  DepthKind depth_kind = DepthKind::automatic;  // automatic: what the camera file says, else planar
  DepthRange depth_range;                       // near and far: else the camera file's
  double depth_scale = 1;                       // scene units per unit of the depth channel, > 0
  // depth at or beyond it is sky, in the file's units, > 0; below every known sentinel
  double sky = 1e9;
  NormalSpace normal_space = NormalSpace::automatic;  // automatic: what the camera file says, else world
  // automatic: what the camera file says, else signed or unorm by their values
  NormalEncoding normal_encoding = NormalEncoding::automatic;
  NormalFlips flip_normal;  // in the normals' own space, before anything else
  // automatic: the one whose points lie on the rays of their pixels
  PositionSpace position_space = PositionSpace::automatic;
  bool strict = false;                    // what only a guess could decide is an error, and so is a warning
  std::string camera;                     // a camera file: JSON, or .chan
  std::string chan_rotation = "zxy";      // of a .chan file: the axes in the order of their turns
  std::optional<double> fov;              // horizontal, degrees, 0 to 180 exclusive
  std::optional<double> focal, aperture;  // mm, > 0: focal length and width of the film back
  std::optional<double> ortho_width;      // scene units across the display window, > 0
  std::vector<std::string> from_presets;  // long names of options that only presets say: left out where of no effect
};

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

/// How AO goes into the beauty: see composite.comp.
struct CompositeLook {
  // 1 / scene units, >= 0: of the exponential fog in the beauty, which hides AO
  double fog_density = 0;
  double gain = 1;                      // factor on the occlusion, 0 to 100
  std::array<double, 3> tint{0, 0, 0};  // what occlusion makes of white light, each 0 to 1
  double mix = 1;                       // of the composite and the beauty, 0 to 1
};

/// How pixels of a G-buffer that is larger than the picture make one of the picture's.
struct PixelFilter {
  PixelFilterKind kind = PixelFilterKind::blackman_harris;
  std::optional<double> width;  // px of the picture from one end to the other, 1 to 16; none: see usual_width()
};
/// As renderers set it: Arnold and RenderMan 2 for Gaussian; Cycles 3 for Blackman-Harris, of which it says half.
constexpr double usual_width(PixelFilterKind kind) {
  return kind == PixelFilterKind::box ? 1 : kind == PixelFilterKind::gaussian ? 2 : 3;
}

/// What to write.
struct OutputSettings {
  std::string output;     // the AO EXR
  std::string composite;  // the composite EXR
  std::string preview;    // a PNG, see preview_style
  // what the file of `output` holds: names of AOVs with commas, see core/chain/results/outputs.h
  std::string aovs = "ao";
  // mono: Y; rgb: R, G, B, as compositors' shuffles expect, and coloured with multi_bounce
  AoChannels ao_channels = AoChannels::mono;
  // of directions; automatic: world where the camera has world_to_camera, else view
  NormalSpace aov_space = NormalSpace::automatic;
  // light thrown back by the occluders brightens the rgb AO, and the composite's ambient light
  bool multi_bounce = false;
  PixelFilter filter;  // with InputSettings::supersampling
  CompositeLook look;
  // all: the composite is the beauty's file with another beauty; rgba: R, G, B and A alone
  std::string composite_layers = "all";
  // of the beauty in the composite, as that of ExrOutput; keep: as the file has it, or zip if that loses bits
  std::string composite_compression = "keep";
  std::string append_ao;  // a channel of the composite that the AO becomes, or its layer; empty: none
  // of the AO in `output`: its channel, or with rgb its layer; empty: Y, or R, G, B
  std::string ao_name;
  // names of core/chain/results/debug_view.h with commas: a picture of each beside `output`
  std::string debug;
  OutputType type = OutputType::half_float;  // of all channels of `output` but depth, which is float
  std::string compression = "zip";           // of the AO file: none, rle, zips, zip or piz
  std::string ocio;                          // an OpenColorIO configuration for the preview
  std::string display, view_transform;       // of it; empty: its default ones
  // auto: the composite, or the AO where there is none; ao; composite; split: the beauty beside the composite
  std::string preview_style = "auto";
  std::string stats;      // a JSON file
  bool no_mkdir = false;  // a folder that is missing is an error, and is not made
  // a file of JSON objects, one per line, or - for the standard output; whoever watches the run writes it
  std::string log_json;
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
