// A picture file of any kind, EXR or not, as channels that can be found and read by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/formats/exr.h"

namespace alcove {

/// One channel of a picture.
struct PictureChannel {
  std::string name;  // full: an EXR part's name stands for a layer where the channel does not repeat it
  Window data;       // where it has pixels
  int part = 0;      // EXR only
  std::string name_in_part;
};

/// A file whose header has been read. EXRs are known by their content; all else is read through image_io. Every failure
/// is ErrorKind::input and names the file; `option` says where the user named it.
class Picture {
 public:
  Picture(const std::string& path, const char* option);

  const std::string& path() const { return path_; }
  /// Those that have a sample for every pixel.
  const std::vector<PictureChannel>& channels() const { return channels_; }
  std::vector<std::string> names() const;

  /// The channel of that name: its full name, or else the end of it after a dot, case ignored ("R" is
  /// "ViewLayer.Combined.R"). Fails when there is none, with the nearest names, and when there are several. Gives an
  /// index into channels().
  std::size_t find(const std::string& name, const char* option) const;

  /// Their planes, one behind the other, row by row. Fails when they do not cover the same pixels.
  std::vector<float> read(std::span<const std::size_t> channels);

 private:
  std::string path_;
  ExrFile file_;
  std::vector<PictureChannel> channels_;
};

/// What is compared with what: indices into the channels of two pictures.
struct ChannelPair {
  std::size_t result, reference;
};

/// The channels that two pictures share. `chosen` is a list with commas: a name, or RESULT=REFERENCE where the names
/// differ. Without it: the only channel of each, whatever its name; else those with the same full name; else those with
/// the same last part of the name; case is ignored. Fails with ErrorKind::input, listing the channels of both, when
/// there are none, and when a last part stands for several.
std::vector<ChannelPair> match_channels(const Picture& result, const Picture& reference, const std::string& chosen);

}  // namespace alcove
