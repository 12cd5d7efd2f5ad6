// A row of the table of settings: what stands in help and docs/options.md, and how its value is read and said.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/option_words.h"
#include "core/base/settings.h"

namespace alcove {

/// What an option has to do with the pixels of an output: by this, --resume knows which files were made otherwise.
enum class Effect {
  none,    // The pixels come out the same: a device, threads, a report, the name or compression of an output.
  pixels,  // Its value counts.
  input,   // It names an input, which is known by its bytes (alcove/inputs): only how often it is given counts.
  pixels_or_input,    // A number counts by its value, anything else as the name of an input.
  pixels_or_picture,  // The name of a picture counts as that of an input, anything else by its value.
  content,            // It names a file whose content counts, and not its place.
  display,            // As `content`, but only where a preview shows a composite.
};

using Words = std::vector<std::string>;

/// A row of the table. Only OptionGroup makes them, so that none is without its effect.
struct OptionRow {
  std::string group;
  // As typed, "--radius" or "-o,--output"; "filter-width" of a key, which is no option but set by --set and presets.
  std::string name;
  std::string value;         // what stands behind it in help: FILE, NUMBER, the words to choose from; "" for a flag
  std::string unit, range;   // of a number; "" where there is none
  std::string sentence;      // ends without a full stop
  std::string default_text;  // "" where there is none
  Effect effect;
  // Gives the present value as it would be typed, exactly, or nothing where it is not set. Only an option that
  // repeats may have several words.
  std::function<Words()> words;
  // Takes a value. Fails with ErrorKind::usage, naming the option, what is wrong, and the nearest words.
  std::function<void(const Words&)> read;
  bool repeats = false;      // each value is one more
  bool is_required = false;  // of arguments without a name
  bool is_key = true;        // whether presets may hold it
  bool is_common = false;    // among the few that --help shows; --help-all shows all
  bool in_library = false;   // libalcove takes it: not what names files, frames or reports, or how files are written
  // Tells why the present value has no effect beside the other settings, in a sentence; "" where it has one, or asks
  // for nothing. What is typed and has none is refused; of a preset it is left out. Null: it always has one.
  std::function<std::string(const Settings&)> why_without_effect = nullptr;

  /// The same, of what was set at all.
  std::string objection(const Settings& settings) const;
  /// Whether it is set by --set and presets alone.
  bool is_only_key() const;

  bool is_flag() const { return value.empty() && (name.starts_with('-') || is_only_key()); }
  /// What is typed: "--output" of "-o,--output", "--set filter-width" of a key.
  std::string long_name() const;
  /// The key in presets and of --set: "output".
  std::string key() const;
};

/// A number's allowed range, as text and as a check.
struct Range {
  double low, high;
  bool open_low, open_high;
  std::string text;
  bool holds(double x) const { return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high); }
};

Range above(double low);
Range at_least(double low);
Range between(double low, double high);
Range below_and_at_least(double low, double high);
Range strictly_between(double low, double high);
Range above_to(double low, double high);

/// A given text as messages quote it: an empty one by its quotation marks.
std::string said(const std::string& text);

/// Reads a finite number of the range. Fails with ErrorKind::usage, naming the option.
double number_in(const Range& range, const std::string& name, const std::string& text);
/// Reads a text that is a whole number which an int can hold, and nothing else.
std::optional<int> whole_number_of(const std::string& text);

/// Appends rows of one group and one effect to a table. What they bind must outlive the rows; its present values are
/// the defaults.
class OptionGroup {
 public:
  OptionGroup(std::vector<OptionRow>& rows, std::string group, Effect effect, bool in_library = false)
      : rows_(rows), group_(std::move(group)), effect_(effect), in_library_(in_library) {}

  OptionRow& text(const std::string& name, std::string& value, const char* what, const std::string& sentence);
  OptionRow& flag(const std::string& name, bool& value, const std::string& sentence);
  /// One of a few words.
  OptionRow& word(const std::string& name, std::string& value, const Words& words, const std::string& sentence);
  /// One of the words of an enumeration.
  template <class T>
  OptionRow& choice(const std::string& name, T& value, const std::string& sentence);
  /// A finite number.
  OptionRow& number(const std::string& name, double& value, const char* unit, const Range& range,
                    const std::string& sentence);
  OptionRow& number(const std::string& name, std::optional<double>& value, const char* unit, const Range& range,
                    const std::string& sentence);
  OptionRow& number(const std::string& name, int& value, const char* unit, const Range& range,
                    const std::string& sentence);
  OptionRow& number(const std::string& name, std::uint32_t& value, const char* unit, const Range& range,
                    const std::string& sentence);

  /// What an option of its own kind shows in help.
  struct Shown {
    std::string name, value, unit, range, sentence;
  };
  /// `say` gives the present value, or "" where it is not set. `take` reads a text, and tells whether it is a value;
  /// where it is none, `complaint` follows the text in the message.
  OptionRow& own(const Shown& shown, const std::function<std::string()>& say,
                 const std::function<bool(const std::string&)>& take, const std::string& complaint);
  OptionRow& add(const Shown& shown, std::function<Words()> words, std::function<void(const Words&)> read);

 private:
  OptionRow& choice_row(const std::string& name, const Words& words, const std::string& sentence,
                        const std::function<std::string()>& say, const std::function<void(const std::string&)>& take);
  template <class T>
  OptionRow& number_row(const std::string& name, T& value, const char* unit, const Range& range,
                        const std::string& sentence);

  std::vector<OptionRow>& rows_;
  const std::string group_;
  const Effect effect_;
  const bool in_library_;
};

template <class T>
OptionRow& OptionGroup::choice(const std::string& name, T& value, const std::string& sentence) {
  Words words;
  for (const auto& [word, meaning] : kWordsOf<T>) words.push_back(word);
  const auto say = [&value] { return word_of(value); };
  return choice_row(name, words, sentence, say, [&value](const std::string& text) {
    for (const auto& [word, meaning] : kWordsOf<T>)
      if (word == text) value = meaning;
  });
}

}  // namespace alcove
