// Which frames to compute, and how to understand what they hold; see settings.h. No code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/setting_words.h"

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

}  // namespace alcove
