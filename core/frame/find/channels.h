// Finds channels in files by the names that renderers use or the user chose; patterns of names, and views.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/settings.h"
#include "core/formats/exr.h"
#include "core/frame/find/input_rules.h"

namespace alcove {

/// Whether a whole name fits a pattern: * stands for any characters, ? for one, and a backslash takes the next of these
/// as it is. Case counts.
bool fits_pattern(std::string_view name, std::string_view pattern);

/// Whether a pattern may stand for several names.
bool is_pattern(std::string_view text);

/// Whether the character at that place is a backslash that takes the next one as it is: * ? , a blank or a backslash.
bool is_escape(std::string_view text, std::size_t at);

/// The name that a text without patterns stands for.
std::string unescaped(std::string_view text);

/// A text that is a number and nothing else.
std::optional<float> number_in(const std::string& text);

// The views of stereo files: as parts, and as words of channels' names.

/// Whether two names are one: case does not count.
bool same_name(std::string_view a, std::string_view b);

/// Gives the views of a stereo file, the default first; any other file has none.
std::vector<std::string> views_of(const ExrFile& file);

/// The view that a file is read by: the wanted one if the file has it, else its default one; "" where it has no views.
std::string view_in(const ExrFile& file, const std::string& wanted);

/// The view of a channel. `multiView` lists views that stand before the last word of names ("depth.right.Z"), or are
/// the first word, as Nuke writes them ("right.depth.Z"); without such a word a channel is of the first of them. Else
/// the view is that of the part, "" where it has none.
std::string view_of(const ExrPart& part, const std::string& channel);

/// Gives a channel's name without its view; nothing if it is of another view. Channels of parts without views belong to
/// all.
std::optional<std::string> name_in_view(const ExrPart& part, const std::string& channel, const std::string& view);

/// The name of a part without its view: "depth.left" and "left.depth" of the view "left" are the layer "depth".
std::string layer_of(const ExrPart& part);

// Channels.

/// A channel of a file of the frame.
struct ChannelRef {
  std::size_t file;
  int part;
  std::string channel;
  auto operator<=>(const ChannelRef&) const = default;
};

/// Each inner list is a set of last name parts that together may spell an AOV, such as {"x", "y", "z"}.
using Components = std::vector<std::vector<std::string>>;

/// The usual names of an AOV, in lower case, the likeliest first.
struct AovNames {
  const char* what;
  const char* channel_option;
  const char* file_option = "";
  std::vector<std::string> layers = {};
  Components in_layer;    // These are looked for below one of the layers.
  Components bare = {};   // These name the AOV by themselves in any file.
  Components alone = {};  // These name it by themselves in a file that was given for this AOV only.
  bool may_have_alpha = false;
  bool is_listed = false;   // The user may name several, with commas: each is a layer.
  bool may_be_two = false;  // The user may name two channels instead of three.
};

extern const AovNames kDepthNames;
extern const AovNames kNormalNames;
extern const AovNames kPositionNames;
extern const AovNames kBeautyNames;
extern const AovNames kIndirectNames;
extern const AovNames kLightNames;
extern const AovNames kDiffuseColorNames;
extern const AovNames kMaterialNames;
extern const AovNames kAlbedoNames;
extern const AovNames kMatteNames;
extern const AovNames kObjectNames;

/// A channel under its full name: in a file of several parts, the part's name stands for a layer where the channel does
/// not repeat it.
struct NamedChannel {
  ChannelRef ref;
  std::string full;
  // These are in lower case and without the chosen layer: the full name, and the name within the part if it differs,
  // without the view and with it.
  std::vector<std::string> spellings;
  bool subsampled;
};

/// Channels that the rules of a program name, and the candidate among them that was there; null if none was.
struct FoundByRules {
  std::vector<ChannelRef> channels;
  const AovCandidate* candidate = nullptr;
};

/// Opens files once each, and searches their channels. Every failure is ErrorKind::input and names file and option.
class ChannelSearch {
 public:
  /// The opened files are appended to `files`, which must outlive the search.
  ChannelSearch(const InputSettings& settings, std::vector<ExrFile>& files)
      : settings_(settings), files_(files), view_(settings.view) {}

  /// Gives the file's place in the list, and opens it if it is new. Fails if the file lacks the chosen view.
  std::size_t open(const std::string& path, const char* option);

  /// The view that files are read by where they have it: the settings' one; or else that of the channels that the
  /// settings name in the first file with views, which is its default one where they name none.
  const std::string& view() const { return view_; }

  /// Finds the AOV by the names that the user chose, or else by its usual names; gives nothing if there is none.
  /// `own_file` says that the file holds nothing else. Fails if two layers hold the AOV.
  std::vector<ChannelRef> find(std::size_t file, const AovNames& names, const std::string& chosen, bool own_file) const;

  /// Finds the AOV by the names of the rules; gives nothing if the user chose, or if the file has none of the
  /// candidates. If several layers fit one pattern, such as one for each camera, the ending of `beside` chooses. Fails
  /// if several remain.
  FoundByRules find_by_rules(std::size_t file, const AovNames& names, const std::string& chosen,
                             const std::vector<AovCandidate>& candidates, const std::string& beside = "") const;

  /// Does the same as find(), but fails if there is nothing. `hint` is the name that near misses are measured by.
  std::vector<ChannelRef> require(std::size_t file, const AovNames& names, const std::string& chosen, bool own_file,
                                  const char* hint) const;

  /// Gives the channel of the same part and layer that has this last word, in lower case; null if there is none.
  const NamedChannel* find_beside(const ChannelRef& ref, const std::string& component) const;
  /// The same; nothing if it is subsampled.
  std::optional<ChannelRef> beside(const ChannelRef& ref, const std::string& component) const;

  /// Adds the alpha channel of the same layer to the r, g, b of a beauty, if there is one.
  std::vector<ChannelRef> with_alpha(std::vector<ChannelRef> beauty) const;

 private:
  /// The layer and the view that a message on a file is about.
  std::string where(std::size_t file) const;

  const InputSettings& settings_;
  std::vector<ExrFile>& files_;
  std::string view_;
  std::vector<std::vector<NamedChannel>> channels_;  // one list per file
};

/// Lists the channels of a view and a layer; without a layer, all of the view. `index` is the file's place.
std::vector<NamedChannel> channels_in(const ExrFile& file, std::size_t index, const std::string& layer,
                                      const std::string& view);

}  // namespace alcove
