// Matches names with those that have been seen of back faces and of peels.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/hidden_guesses.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <regex>

#include "core/base/option_words.h"
#include "core/base/text.h"
#include "core/frame/views.h"

namespace alcove {
namespace {

/// What a channel of this full name, in lower case, may hold.
std::optional<BehindKind> kind_by(const std::string& name) {
  static const std::regex backs(R"((.*\.)?(zback|z\.back|depth_back|backz))");
  static const std::regex peels(R"((.*\.)?(peel[^.]*|depth[2-9]|layer[2-9])(\.z)?)");
  if (std::regex_match(name, backs)) return BehindKind::backs;
  return std::regex_match(name, peels) ? std::optional(BehindKind::surfaces) : std::nullopt;
}

/// Whether the frame reads the channel already.
bool is_read(const FrameSource& source, const ChannelRef& ref) {
  const auto has = [&](const std::vector<ChannelRef>& plane) { return std::ranges::find(plane, ref) != plane.end(); };
  return std::ranges::any_of(source.planes.entries, has);
}

}  // namespace

std::vector<HiddenGuess> hidden_guesses(const FrameSource& source, const InputSettings& settings) {
  std::vector<HiddenGuess> guesses;
  for (std::size_t file = 0; file < source.files.size(); file++) {
    const ExrFile& of = source.files[file];
    const std::string view = view_in(of, source.view);
    const bool is_of_view = view.empty() || source.view.empty() || same_name(view, source.view);
    if (!is_of_view || of.display() != source.display) continue;
    for (const auto& channel : channels_in(of, file, settings.layer, view)) {
      std::optional<BehindKind> kind;
      for (const auto& name : channel.spellings)
        if (!kind) kind = kind_by(name);
      const bool fits = kind && !channel.subsampled && source.part_of(channel.ref).data == source.file_data &&
                        channel.full.find(',') == channel.full.npos;
      if (fits && !is_read(source, channel.ref)) guesses.push_back({of.path(), channel.full, *kind});
    }
  }
  const std::size_t room =
      kMostBehind - std::size_t(std::ranges::count_if(settings.behind, [](const auto& path) { return !path.empty(); }));
  if (guesses.size() > room) guesses.resize(room);
  return guesses;
}

std::string options_for(const std::vector<HiddenGuess>& guesses) {
  std::string files, channels, kinds;
  for (const auto& guess : guesses) {
    files += fmt::format(" --behind {}", for_shell(guess.file));
    channels += (channels.empty() ? "" : ",") + guess.channel;
    kinds += (kinds.empty() ? "" : ",") + word_of(guess.kind);
  }
  if (guesses.empty()) return "";
  return fmt::format("{} --set behind-channel={} --behind-kind {}", files.substr(1), for_shell(channels), kinds);
}

}  // namespace alcove
