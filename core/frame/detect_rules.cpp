// Matches the rules with the header of a file.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/text.h"
#include "core/formats/exr.h"
#include "core/frame/input_rules.h"
#include "core/frame/name_pattern.h"

namespace alcove {
namespace {

/// Lists what identifies a file, in lower case: attributes as "name" and "name=value", channels as "channel:name". Nuke
/// puts prefixes before others' attributes.
std::vector<std::string> marks_of(const ExrFile& file) {
  constexpr std::size_t kLongest = 200;  // characters of a mark that count
  std::vector<std::string> marks;
  for (std::size_t p = 0; p < file.parts().size(); p++) {
    for (const auto& [name, value] : file.attribute_texts(int(p))) {
      std::string plain = name.substr(0, kLongest);
      if (plain.starts_with("nuke/exr/")) plain.erase(0, 9);
      if (plain.starts_with("exr/")) plain.erase(0, 4);
      marks.push_back(lower_case(plain));
      marks.push_back(lower_case(plain + "=" + value.substr(0, kLongest)));
    }
    for (const auto& channel : file.parts()[p].channels) {
      marks.push_back("channel:" + lower_case(channel.name.substr(0, kLongest)));
      if (!file.parts()[p].name.empty())
        marks.push_back("channel:" + lower_case((file.parts()[p].name + "." + channel.name).substr(0, kLongest)));
    }
  }
  return marks;
}

}  // namespace

DetectedRules detect_rules(const ExrFile& file) {
  const auto marks = marks_of(file);
  for (const bool last : {false, true})
    for (const auto& rules : all_input_rules())
      for (const auto& pattern : last ? rules.detect_last : rules.detect)
        if (const auto mark = std::ranges::find_if(
                marks, [wanted = lower_case(pattern)](const auto& m) { return fits_pattern(m, wanted); });
            mark != marks.end())
          return {&rules, *mark};
  return {&input_rules("generic"), ""};
}

}  // namespace alcove
