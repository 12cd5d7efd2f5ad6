// What lies behind the first surface: the planes that --behind names, the samples of deep files, and whether their
// pixels can be what they are said to be.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/note.h"
#include "core/frame/gbuffer.h"

namespace alcove {

// Deep samples: the frame's depth, or surfaces behind it.

/// The deep parts that --layer and --view choose, whose samples count together: of a part's name, or else all of the
/// view; empty where the file has none.
std::vector<int> deep_parts_of(const ExrFile& file, const std::string& layer, const std::string& view);

/// The frame's depth where deep samples are it: the file at `depth_file` holds nothing else, or there is --deep and
/// that file has no flat depth. Else nothing.
std::vector<ChannelRef> find_deep_depth(FrameSource& source, ChannelSearch& search, std::size_t depth_file,
                                        const InputSettings& settings);

/// Adds the planes behind the first surface that samples give, once the depth is found. Fails with ErrorKind::input
/// where the file of --deep is flat, or has another window than the depth.
void find_deep(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// Which samples of these parts are surfaces, for a frame whose camera is known.
DeepRules deep_rules(const FrameSource& source, const ExrFile& file, const std::vector<int>& parts,
                     const InputSettings& settings);

/// Opens the samples, once the camera is found, for it says how far apart two surfaces are in a pixel. Fails as
/// ExrFile::take_deep() does.
void take_deep(FrameSource& source, const InputSettings& settings);

/// Settles whether samples beside a flat depth are planar or along the ray, and their scale: their first surfaces are
/// those of the depth. Fails with ErrorKind::input where they are not. Tells too
/// whether they list what is hidden.
void settle_deep(FrameSource& source, const RawPart& raw);

/// Reads the planes of samples as the frame's meaning says.
void read_deep_like_meaning(FrameSource& source);

/// What was repaired in the samples that were read.
Notes deep_notes(const FrameSource& source);

// Planes of --behind.

/// Finds the channels of --behind, once the depth of the frame and the rules of its program are found. A file may be
/// one that the frame has already. Fails with ErrorKind::input, naming both files and the option that mends it, where a
/// channel is not found, is the frame's own depth, or has other windows or another view than the depth.
void find_behind(FrameSource& source, ChannelSearch& search, const InputSettings& settings);

/// What the header of an output says of where its hidden surfaces come from: "peel2.exr Z surfaces; ...", in an order
/// that does not depend on how they were given; "" where there are none.
std::string hidden_sources_text(const FrameSource& source);

/// Looks at what planes behind the first surface show beside it, over a part of a frame's pixels.
class BehindSample {
 public:
  /// Takes those of `window` that belong to some of `whole`. Windows that share pixels give each of them once, so that
  /// it is all the same how the whole is cut into windows. `depth` and `behind` are as read, over the window.
  void add(const Reading& reading, std::span<const float> depth, std::span<const float> behind, const Window& window,
           const Window& whole);

  /// Says what of the planes is useless. Fails with ErrorKind::input where a plane cannot be what it is said to be: it
  /// lies before the first surface, is along the ray where the depth is planar or the reverse, or is a thickness below
  /// 0. They are planes of `source` that --behind has named.
  Notes notes(const FrameSource& source) const;

 private:
  /// Numbers of pixels.
  struct Plane {
    std::size_t surfaces = 0;   // where the plane has one, and the frame too
    std::size_t before = 0;     // of those before the first surface
    std::size_t same = 0;       // of those that are the first surface
    std::size_t known = 0;      // of those that are it, or that a plane before this one has
    std::size_t as_deep = 0;    // of a thickness, those where it is no less than the depth
    std::size_t negative = 0;   // whose value is below 0
    std::size_t oblique = 0;    // of the surfaces, those whose rays are clearly longer than their depth
    std::size_t as_read = 0;    // of those that have the depth of the first surface
    std::size_t otherwise = 0;  // of those that would have it if the plane were along the ray, or if it were not
    std::vector<float> parts;   // depth of the surfaces as parts of the first one's
  };
  Notes notes_of(const FrameSource& source, std::size_t plane) const;

  std::vector<bool> taken_;  // pixels of the sample
  std::vector<Plane> planes_;
};

}  // namespace alcove
