// A picture file of any format, with channels found and read by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/formats/exr.h"

namespace alcove {

/// A channel of a picture.
struct PictureChannel {
  std::string name;  // full: an EXR part's name stands for a layer where the channel does not repeat it
  Window data;       // its pixels
  int part = 0;      // EXR only
  std::string name_in_part;
};

/// A file that open_image() has opened. Every failure is ErrorKind::input and names the file; `option` is the one that
/// named it.
class Picture {
 public:
  Picture(const std::string& path, const char* option);

  const std::string& path() const { return path_; }
  const Window& display() const { return file_.display(); }
  /// Lists the channels that have a sample for every pixel.
  const std::vector<PictureChannel>& channels() const { return channels_; }
  std::vector<std::string> names() const;
  /// Lists the layers with their channels: "ViewLayer.Combined (R, G, B)"; a channel alone has its full name.
  std::vector<std::string> layers() const;

  /// Gives the index into channels() of the channel with that full name, or else with that end of its name after a dot:
  /// "R" finds "ViewLayer.Combined.R". Case is ignored. Fails if there is none, naming the nearest, or if there are
  /// several.
  std::size_t find(const std::string& name, const char* option) const;

  /// Reads the planes of channels, one behind the other, row by row. Fails if they do not cover the same pixels.
  std::vector<float> read(std::span<const std::size_t> channels);

 private:
  std::string path_;
  ExrFile file_;
  std::vector<PictureChannel> channels_;
};

/// Two channels to be compared: indices into the channels of two pictures.
struct ChannelPair {
  std::size_t result, reference;
};

/// The pairs of two pictures.
struct ChannelMatch {
  std::vector<ChannelPair> pairs;
  bool by_ao_layer = false;  // a layer's name decided: the user should know which
};

/// Pairs the channels of two pictures. `chosen` is a list with commas of names, or of RESULT=REFERENCE if the names
/// differ. Without it, the first rule with pairs decides: the only channel of each picture, of any name; channels with
/// the same full name; the only layer AO or Ambient Occlusion of one picture, and the other's such layer or its Y;
/// channels with the same last part of the name. The last rule leaves out a channel that belongs to a vector in one
/// picture alone. Case is ignored. Fails with ErrorKind::input, listing the layers of both, if there are no pairs or if
/// a last part stands for several channels.
ChannelMatch match_channels(const Picture& result, const Picture& reference, const std::string& chosen);

}  // namespace alcove
