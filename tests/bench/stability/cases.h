// Frames at the ends of every axis on which numbers can fail, and every way of estimating them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/scenes.h"

namespace alcove::test {

/// An estimator with its settings; the radius is a case's.
struct Variant {
  std::string name;
  EstimatorSettings settings;
};

/// Every estimator, thickness and search, few samples, no denoiser.
std::vector<Variant> estimators();
/// Those and every preset, at every resolution.
std::vector<Variant> variants();

enum class NormalDefect {
  none,
  missing,
  grazing,
  axis,
  in_slice,
  across_slice,
  zero,
  nan,
  infinite,
  denormal,
  huge,
  backfacing,
  random
};
enum class DepthDefect { none, zero, negative, denormal, infinite, nan, largest, near_plane, any_bits };
enum class Storage {
  single_float,
  half_float,
  bits_16,
  bits_16_reversed,
  bits_24,
  bits_24_reversed,
  device,
  device_reversed,
  far_positions
};
enum class Place { room, corner };

/// A frame of a room, and what is extreme about it. The values of each member are those of the axis.
struct Spec {
  double scale = 1;      // scene units per unit of the room
  double range = 1;      // the background's depth over the room's; 1: there is none but sky
  double fov = 55;       // horizontal, degrees; 0: orthographic. The eye moves so that the room fills the picture
  double shift = 0;      // of the optical axis, in widths of the picture
  double aspect = 1;     // of a pixel
  double radius = 0.15;  // of the room's depth
  int width = 24, height = 16;
  NormalDefect normals = NormalDefect::none;  // of every third pixel; missing: of all
  DepthDefect depth = DepthDefect::none;      // of every third pixel
  Storage storage = Storage::single_float;
  double far = 1e7;  // of positions from their origin, in depths of the room
  Place place = Place::room;
};
std::string to_string(const Spec& spec);

/// Each axis by itself, over all its values, and what only two of them bring about.
std::vector<Spec> sweeps();
/// Values of all axes at once, the number-th draw. Of kRound draws from a multiple of kRound on, each value of each
/// axis is in one at least, and half of an axis' are as usual.
Spec drawn(unsigned number);
constexpr unsigned kRound = 24;

struct Case {
  HostFrame frame;
  double radius, depth;   // scene units; the depth is the room's
  std::vector<bool> sky;  // pixels that are sky for certain
};
Case made(const Spec& spec);

/// The room from that far; see Spec::fov.
Rendering room(double fov, double aspect, double shift, int width, int height);

/// The frame with its depth as that storage holds it; far positions are seen by a camera that is turned. Near and far
/// are 0.1 and 1000 times the room's depth; what is nearer than near has the value next to the near plane's.
HostFrame stored(HostFrame frame, Storage storage, double room_depth, double far = Spec{}.far);

EstimatorSettings with_radius(EstimatorSettings settings, double radius);

}  // namespace alcove::test
