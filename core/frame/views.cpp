// The views of stereo files: as parts, and as words of channels' names.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/views.h"

#include <algorithm>

#include "core/base/text.h"

namespace alcove {
namespace {

/// A view's name among the words of a channel's name.
struct ViewWord {
  std::size_t begin, end;  // the dot behind it is at the end
};

/// Finds the view that a name holds: before the last word, by the convention of OpenEXR ("depth.right.Z"), or as the
/// first word, as Nuke has it ("right.depth.Z"). Gives nothing where neither is one of the views.
std::optional<ViewWord> view_word(const std::string& name, const std::vector<std::string>& views) {
  const std::size_t last = name.rfind('.');
  if (last == name.npos) return std::nullopt;
  const std::size_t before = last == 0 ? name.npos : name.rfind('.', last - 1);
  const ViewWord second_last{before == name.npos ? 0 : before + 1, last}, first{0, name.find('.')};
  for (const ViewWord& word : {second_last, first}) {
    const std::string text = name.substr(word.begin, word.end - word.begin);
    if (!text.empty() && std::ranges::any_of(views, [&](const auto& view) { return same_name(view, text); }))
      return word;
  }
  return std::nullopt;
}

std::string without(const std::string& name, const ViewWord& word) {
  return name.substr(0, word.begin) + name.substr(word.end + 1);
}

}  // namespace

bool same_name(std::string_view a, std::string_view b) { return lower_case(a) == lower_case(b); }

std::vector<std::string> views_of(const ExrFile& file) {
  std::vector<std::string> views;
  for (const auto& part : file.parts())
    for (const auto& view : part.multi_view.empty() ? std::vector{part.view} : part.multi_view)
      if (!view.empty() && std::ranges::none_of(views, [&](const auto& known) { return same_name(known, view); }))
        views.push_back(view);
  return views;
}

std::string view_in(const ExrFile& file, const std::string& wanted) {
  const auto views = views_of(file);
  const auto found = std::ranges::find_if(views, [&](const auto& view) { return same_name(view, wanted); });
  return found != views.end() ? *found : views.empty() ? "" : views.front();
}

std::string view_of(const ExrPart& part, const std::string& channel) {
  if (part.multi_view.empty()) return part.view;
  const auto word = view_word(channel, part.multi_view);
  return word ? channel.substr(word->begin, word->end - word->begin) : part.multi_view.front();
}

std::optional<std::string> name_in_view(const ExrPart& part, const std::string& channel, const std::string& view) {
  const std::string own = view_of(part, channel);
  const bool is_shared = part.multi_view.empty() && (own.empty() || view.empty());
  if (!is_shared && !same_name(own, view)) return std::nullopt;
  const auto word = view_word(channel, part.multi_view.empty() ? std::vector{part.view} : part.multi_view);
  return word ? without(channel, *word) : channel;
}

std::string layer_of(const ExrPart& part) {
  const auto word = view_word(part.name + ".", {part.view});
  if (!word) return part.name;
  const std::string rest = without(part.name + ".", *word);
  return rest.empty() ? rest : rest.substr(0, rest.size() - 1);
}

}  // namespace alcove
