// Every number and choice that a user may set, with unit, range, default and reason. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/option_words.h"

namespace alcove {

/// The frames to compute, and the treatment of frames that cannot or need not be computed.
struct FrameSettings {
  // a list for core/formats/sequence.h; empty: the files on the disk of the first input with a pattern
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
  bool overwrite = false;  // compute all of them, even with `resume`
};

/// The input files, and how to read them.
struct InputSettings {
  std::string input;                            // an EXR file with every AOV not named below
  std::string depth, normal, position, beauty;  // files of single AOVs; empty: the input
  std::string depth_channel;                    // a channel's full name; empty: found by its usual names
  // three names with commas, or a layer; empty: found. Normals may have two
  std::string normal_channels, beauty_channels, position_channels;
  // the light that AO may dim, see core/frame/find/frame_source.cpp; empty: found
  std::string ambient;
  // layers of the beauty's file that shadows of --lights dim: NAME:LAYER, with commas
  std::string shadow_layers;
  // the materials' own AO: a file, and the full name of a channel. Empty file: the input, if a channel is named; empty
  // name: found
  std::string material_ao, material_ao_channel;
  // the matte, where AO is wanted: a file and a channel as for material AO, and objects, see core/frame/find/matte.h;
  // and the AO outside of it, 0 to 1
  std::string matte, matte_channel, matte_object;
  double matte_outside = 1;
  // first surfaces that are occluders: these alone, or all but these. Given as a file of coverage, or as objects, names
  // or numbers with commas; at most one of the four is not empty
  std::string occluders, occluder_objects, ignore, ignored_objects;
  // source of those objects: a file, empty: the input; a channel of numbers or a Cryptomatte's layer, empty: found
  std::string objects, object_channel;
  // the diffuse colour for multi-bounce: a file; empty: the beauty's. Three names, or a layer; empty: found
  std::string albedo, albedo_channels;
  std::optional<double> albedo_value;  // instead: one for all surfaces, 0 to 1
  // surfaces behind the first, or before it as seen from there: files of depth, in any order
  FileList behind;
  // depth channels of those files, full names, and their kinds: none, one for all, or one for each
  std::vector<std::string> behind_channels;
  std::vector<BehindKind> behind_kinds;
  FileList deep;              // deep EXR files of the frame, whose samples count together
  double deep_opacity = 0.5;  // the least opacity of a sample that is a surface, 0 to 1
  bool other_views = false;   // surfaces that the other views of a stereo file see count too
  // frames to each side, 0 to 32, whose static surfaces count where they are hidden in this one
  int around = 0;
  bool around_all = false;  // instead: all frames of the shot
  // frames to each side, 0 to 16, whose estimates go into the mean with this frame's
  int accumulate = 0;
  // motion vectors: a file, two channels, and the frame that they point to
  std::string motion, motion_channels;
  MotionKind motion_kind = MotionKind::automatic;
  std::string layer;  // look only at channels of this layer or part
  std::string view;   // of a stereo file; empty: its default
  // pixels of depth and normals for each of the picture, in x and in y, 1 to 4; auto: 1
  std::string supersampling = "auto";
  // compute and write no more than this, in px of the picture from its upper left corner; none: the data window
  std::optional<Window> roi;
  // the program that wrote the frame, of presets/input; auto: by its header and channels
  std::string source = "auto";
  DepthKind depth_kind = DepthKind::automatic;  // automatic: as the camera file says, else planar
  DepthRange depth_range;                       // near and far: else the camera file's
  double depth_scale = 1;                       // scene units per unit of the depth channel, > 0
  // depth at or beyond it is sky, in the file's units, > 0; below every known sentinel
  double sky = 1e9;
  std::string ramps = "keep";  // of depth that was blurred across outlines; cut: see core/frame/pixels/ramps.h
  NormalSpace normal_space = NormalSpace::automatic;  // automatic: as the camera file says, else world
  // automatic: as the camera file says, else signed or unorm by their values
  NormalEncoding normal_encoding = NormalEncoding::automatic;
  NormalFlips flip_normal;  // in the normals' own space, before anything else
  // automatic: the one whose points lie on the rays of their pixels
  PositionSpace position_space = PositionSpace::automatic;
  bool strict = false;                    // guesses and warnings are errors
  std::string allow;                      // codes of warnings, with commas, that are no errors
  std::string camera;                     // a camera file: JSON, or .chan
  std::string chan_rotation = "zxy";      // of a .chan file: the axes in the order of their turns
  std::optional<double> fov;              // horizontal, degrees, 0 to 180 exclusive
  std::optional<double> vertical_fov;     // the same over the height
  std::optional<double> focal_px;         // of the display window's width, > 0
  std::optional<double> focal, aperture;  // mm, > 0: focal length and width of the film back
  std::optional<double> ortho_width;      // scene units across the display window, > 0
  // options that presets set, by their long names, and the presets; without effect, they are ignored
  std::map<std::string, std::string> from_presets;
};

/// The estimate of ambient occlusion. The defaults are the preset `standard`.
struct EstimatorSettings {
  Estimator estimator = Estimator::gtao;
  std::optional<double> radius;    // scene units, > 0; no default, since no number fits all scenes
  bool radius_auto = false;        // instead: as core/frame/pixels/radius.h proposes
  bool radius_in_medians = false;  // the radii are parts of the median depth until a frame of the run tells it
  // scene units, > 0: more scales. The AO is the mean of all: that is AO itself, with a falloff that drops by a step at
  // each radius
  std::vector<double> further_radii;
  Falloff falloff = Falloff::none;  // none: as with the distance of renderers' own AO passes
  double falloff_start = 0;         // fraction of the radius where the falloff begins, 0 to 1 exclusive
  // fraction of the radius where it ends, above the start to 1; nothing beyond blocks
  double falloff_end = 1;
  // directions per pixel, 1 to 64; with fewer than 3 each pixel by itself is noisy, and the
  // denoiser must share those of its neighbours
  int slices = 4;
  int steps = 16;  // samples to each side of a slice, 1 to 4096; they matter more than slices
  // of gtao: the RMS error of the visibility that an exact search may leave, 0 to 1. Each tile gets as many directions
  // as that takes; 0: as `slices` says
  double tolerance = 0;
  // of estimator gtao; exact needs falloff none and stride 1
  SliceSearch search = SliceSearch::steps;
  // of an exact search, for tests: it looks at each pixel, not at the outlines of runs of them
  bool every_pixel = false;
  int samples = 16;  // of estimator crytek, in the hemisphere, 4 to 64
  // the least height that blocks, >= 0; crytek: scene units of depth; others: sine of the elevation above the tangent
  // plane, < 1
  double bias = 0;
  Elevation elevation = Elevation::view;                 // of estimator hbao
  SampleKernel sample_kernel = SampleKernel::clustered;  // of estimator crytek
  // of estimator crytek; ratio: hits within the radius count fully, so that none is lost
  RangeCheck range_check = RangeCheck::ratio;
  // thickness of occluders. automatic: as deep as wide, and half of that in an exact search that completes surfaces
  // behind nearer ones
  ThicknessKind thickness = ThicknessKind::automatic;
  double thickness_length = 0;  // scene units, > 0; with ThicknessKind::constant
  // of gtao and bitmask: places where surfaces go on straight although the frame does not show it. none: only visible
  // surfaces block; border: beyond the picture's border; all: also behind nearer surfaces. It is a guess; on all
  // rendered scenes it brought the AO nearer to ray tracing.
  Completion complete = Completion::all;
  int hidden = 3;  // surfaces kept behind the first of a pixel, 0 to 3, where the frame has any
  // scene units: surfaces closer together than this are one; none: by the depth's precision and a pixel's slope
  std::optional<double> separation;
  Resolution resolution = Resolution::full;
  // pixels per estimate: 1, 2, 4, 8 or 16. The bilateral denoiser gives the others theirs. Density::adaptive makes at
  // least so many estimates; 0: see spacing_of
  int stride = 0;
  // adaptive: more estimates where a surface shows too few pixels for its neighbours to give it one; edges: more
  // beside edges of depth, too; for gtao by steps, and for bitmask
  Density density = Density::adaptive;
  Denoise denoise = Denoise::bilateral;
  // pixels of the estimate to each side, 1 to 8; with Denoise::bilateral; 0: see denoise_radius_of
  int denoise_radius = 0;
  // instead of the radius: 2 to 9 weights from the centre outwards, none negative, the centre's above 0; empty: a
  // Gaussian, or interpolate's parabola
  std::vector<double> denoise_kernel;
  // part of the depth, 0 to 100: a step of this size weighs 1/e; 0: weighs by planes and normals instead
  double denoise_depth_sigma = 0;
  double intensity = 1;                // factor on the occlusion, 0 to 100
  double power = 1;                    // exponent of the visibility, above 0 to 100
  std::optional<double> shadow_reach;  // scene units, > 0: the farthest blocker of a light; none: anywhere
  std::string sun;                     // the light that these turn; empty: the only sun
  std::optional<double> sun_azimuth, sun_elevation;  // degrees: see docs/inputs.md; none: as the lights file says
  double least = 0;  // the lowest AO after all shaping, 0 to 1; a matte's outside may be lower
  // scene units of planar depth, both or none, 0 <= start < end: the AO fades to 1 from one to the other
  std::optional<double> fade_start, fade_end;
  // perceptual roughness of all surfaces for specular occlusion, 0 to 1; by default half way, as in engines' default
  // materials
  double roughness = 0.5;
  std::uint32_t seed = 0;  // shifts the noise pattern
  // fixed: static surfaces do not flicker and may be used again; animated: for a mean over frames, which removes the
  // noise
  Noise noise = Noise::fixed;
  bool no_skip = false;  // estimate sky and unchanged tiles too; the result is the same
};

struct LightsFile;  // of core/frame/find/lights.h

/// The look of AO in the beauty: see composite.comp.
struct CompositeLook {
  // density of the exponential fog in the beauty, which hides AO; 1 / scene units, >= 0
  double fog_density = 0;
  double gain = 1;                      // factor on the occlusion, 0 to 100
  std::array<double, 3> tint{0, 0, 0};  // the colour of fully occluded white light, each 0 to 1
  double mix = 1;                       // 0: the beauty, 1: the composite
};

/// The filter by which pixels of a G-buffer larger than the picture make one of the picture's.
struct PixelFilter {
  PixelFilterKind kind = PixelFilterKind::blackman_harris;
  std::optional<double> width;  // px of the picture from one end to the other, 1 to 16; none: see usual_width()
};
/// The widths that renderers set: Arnold and RenderMan 2 for Gaussian; Cycles 3 for Blackman-Harris, which it calls
/// 1.5.
constexpr double usual_width(PixelFilterKind kind) {
  return kind == PixelFilterKind::box ? 1 : kind == PixelFilterKind::gaussian ? 2 : 3;
}

/// The output files, and their contents.
struct OutputSettings {
  std::string output;     // the AO EXR
  std::string composite;  // the composite EXR
  std::string preview;    // a PNG, see preview_style
  // AOVs in the file of `output`: names with commas, see core/chain/results/outputs.h
  std::string aovs = "ao";
  std::string environment;  // a lat-long picture of the light for the AOVs relight and relight-open
  std::string lights;       // a file of suns and lamps, for the AOV shadow, which it asks for
  std::shared_ptr<const LightsFile> read_lights;  // its content; null before RunPreview::prepare()
  // mono: Y; rgb: R, G, B, as compositors expect, and coloured with multi_bounce
  AoChannels ao_channels = AoChannels::mono;
  // space of directions; automatic: world if the camera has world_to_camera, else view
  NormalSpace aov_space = NormalSpace::automatic;
  // light reflected by occluders brightens the rgb AO, and the composite's ambient light
  bool multi_bounce = false;
  PixelFilter filter;  // with InputSettings::supersampling
  CompositeLook look;
  // all: the composite is the beauty's file with another beauty; rgba: R, G, B and A alone
  std::string composite_layers = "all";
  // compression of the beauty in the composite, as in ExrOutput; keep: as the file has it, or zip if that loses bits
  std::string composite_compression = "keep";
  std::string append_ao;  // the composite's channel, or layer, for the AO; empty: none
  // name of the AO in `output`: of its channel, or with rgb of its layer; empty: Y, or R, G, B
  std::string ao_name;
  // debug views, names of core/chain/results/debug.h with commas: a picture of each beside `output`
  std::string debug;
  OutputType type = OutputType::half_float;  // of all channels of `output`; depth is always float
  std::string compression = "zip";           // of the AO file: none, rle, zips, zip or piz
  std::string ocio;                          // an OpenColorIO configuration for the preview
  std::string display, view_transform;       // of that configuration; empty: its defaults
  // auto: the composite, or the AO without one; ao; composite; split: the beauty beside the composite
  std::string preview_style = "auto";
  std::string stats;      // a JSON file
  bool no_mkdir = false;  // a missing folder is an error; else it is made
  // a file of JSON objects, one per line, or - for the standard output; written by the watcher of the run
  std::string log_json;
};

/// The device, and its limits.
struct DeviceSettings {
  std::string device = "auto";  // auto | cpu | index | name | UUID
  bool require_gpu = false;
  bool validate = false;
  int threads = 0;           // of the CPU device and of the codecs; 0: one per core
  std::uint64_t memory = 0;  // bytes that the process may take; 0: half of the free memory
  // bytes that frames get however small `memory` is; not an option: tests cut small frames into tiles by it
  std::uint64_t least_memory = 0;
};

/// How a run reports its progress.
struct ProgressSettings {
  std::string kind = "auto";  // auto, bar, plain, percent, openjd or none; auto: a bar on a terminal, else plain
  bool verbose = false, quiet = false;
};

struct Settings {
  std::vector<std::string> preset_files;  // from which the command line has taken values
  FrameSettings frames;
  InputSettings input;
  EstimatorSettings estimator;
  OutputSettings output;
  DeviceSettings device;
  ProgressSettings progress;
};

}  // namespace alcove
