// Surfaces behind the first one: the planes that --behind names, the samples of deep files, and checks of their pixels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/frame/find/frame_source.h"

namespace alcove {

// Deep samples: the frame's depth, or surfaces behind it.

/// Gives the deep parts that --layer and --view choose: the parts of that name, or else all parts of the view; none if
/// the file has none. Their samples count together.
std::vector<int> deep_parts_of(const ExrFile& file, const std::string& layer, const std::string& view);

/// Gives the frame's depth if deep samples are it: the file at `depth_file` holds nothing else, or --deep is given and
/// that file has no flat depth. Else gives nothing.
std::vector<ChannelRef> find_deep_depth(FrameSource& source, ChannelSearch& search, std::size_t depth_file,
                                        const InputSettings& settings);

/// Adds the planes of samples behind the first surface. The depth must be found. Fails with ErrorKind::input if the
/// file of --deep is flat, or has another window than the depth.
void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Gives the rules by which samples of these parts are surfaces. The frame's camera must be known.
DeepRules deep_rules(const FrameSource& source, const ExrFile& file, const std::vector<int>& parts,
                     const InputSettings& settings);

/// Opens the samples. The camera must be found: it tells the distance of two surfaces in a pixel. Fails as
/// ExrFile::take_deep() does.
void take_deep(FrameSource& source, const InputSettings& settings);

/// Settles kind (planar or along the ray) and scale of samples beside a flat depth, and whether they list hidden
/// surfaces. Fails with ErrorKind::input if their first surfaces differ from the depth.
void settle_deep(FrameSource& source, const RawPart& raw);

/// Reads the planes of samples as the frame's meaning says.
void read_deep_like_meaning(FrameSource& source);

/// Gives a note on repaired samples, once they are read.
Notes deep_notes(const FrameSource& source);

// Planes of --behind.

/// Finds the channels of --behind. Depth and rules of the frame must be found. A file may be one that the frame has
/// already. Fails with ErrorKind::input if a channel is not found, is the frame's own depth, or has other windows or
/// another view than the depth; the message names both files and the option that mends it.
void find_behind(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Gives the sources of hidden surfaces for the header of an output, sorted: "peel2.exr Z surfaces; ..."; "" if there
/// are none.
std::string hidden_sources_text(const FrameSource& source);

/// Counts of a plane's pixels, compared with the first surface.
struct BehindCounts {
  std::size_t surfaces = 0;   // with a surface in the plane and in the frame
  std::size_t before = 0;     // surfaces before the first one
  std::size_t same = 0;       // surfaces that are the first one
  std::size_t known = 0;      // surfaces that are the first one, or that an earlier plane has
  std::size_t as_deep = 0;    // of a thickness: no less than the depth
  std::size_t negative = 0;   // values below 0
  std::size_t oblique = 0;    // surfaces on rays that are clearly longer than their depth
  std::size_t as_read = 0;    // oblique ones with the depth of the first surface
  std::size_t otherwise = 0;  // oblique ones that had it if the plane were of the other kind, planar or along the ray
  std::vector<float> parts;   // depth of the surfaces as parts of the first one's
};

/// Compares planes behind the first surface with it, over a part of a frame's pixels.
class BehindSample {
 public:
  /// Adds the pixels of `window` that belong to a sample of `whole`. A pixel counts once, however many windows share
  /// it: the result does not depend on how the whole is cut. `depth` and `behind` are as read, over the window.
  void add(const Reading& reading, std::span<const float> depth, std::span<const float> behind, const Window& window,
           const Window& whole);

  /// Notes useless planes. Fails with ErrorKind::input if a plane of --behind contradicts its kind: it lies before the
  /// first surface, is along the ray and the depth is planar or the reverse, or is a thickness below 0.
  Notes notes(const FrameSource& source) const;

 private:
  Notes notes_of(const FrameSource& source, std::size_t plane) const;

  std::vector<bool> taken_;  // pixels of the sample
  std::vector<BehindCounts> planes_;
};

}  // namespace alcove
