// Rows of the tables of options: an option's text in help and docs/options.md, and how its value is read and written.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/option_words.h"
#include "core/base/settings.h"

namespace alcove {

/// The effect of an option on the pixels of an output: --resume decides by it whether a file is still valid.
enum class Effect {
  none,    // The pixels come out the same: a device, threads, a report, the name or compression of an output.
  pixels,  // Its value counts. Of an input, only its being given does, since it is known by its bytes (alcove/inputs).
};

/// The use of an option's files: input, one output for each frame, or one report for the run.
enum class FileRole { none, input, output, report };

using Words = std::vector<std::string>;

/// An option as help shows it.
struct OptionRow {
  std::string group = {};
  // As typed, "--radius" or "-o,--output"; "filter-width" of a key, which is no option but set by --set and presets.
  std::string name;
  std::string value = {};         // its value in help: FILE, NUMBER, the words to choose from; "" for a flag
  std::string unit = {};          // of a number; "" where there is none
  std::string range = {};         // the same
  std::string sentence = {};      // ends without a full stop
  std::string default_text = {};  // "" where there is none
  Effect effect = Effect::none;
  bool repeats = false;            // each value is one more
  bool is_required = false;        // of arguments without a name
  bool is_common = false;          // among the few that --help shows; --help-all shows all
  bool in_library = false;         // libalcove takes it: it names no file, frame, report or file format
  FileRole role = FileRole::none;  // of its files
  bool is_of_frame = false;        // they may have a place for the frame number
  std::function<bool(const std::string&)> is_file = nullptr;  // which of its values name one; null: all

  /// Whether it is set by --set and presets alone.
  bool is_only_key() const;
  bool is_flag() const { return value.empty() && (name.starts_with('-') || is_only_key()); }
  /// The name in messages: "--output" of "-o,--output", "--set filter-width" of a key.
  std::string long_name() const;
  /// The key in presets and of --set: "output".
  std::string key() const;
};

/// An option whose value is a part of an `Options`.
template <class Options>
struct RowOf : OptionRow {
  // Gives the value as it would be typed, exactly, or nothing where it is not set. Only an option that repeats may have
  // several words.
  std::function<Words(const Options&)> words = nullptr;
  // Takes a value. Fails with ErrorKind::usage, naming the option, its mistake, and the nearest words. Null: the
  // option is of the command line alone, and no part of `Options`.
  std::function<void(Options&, const Words&)> read = nullptr;
  // Each gives the reason why the value has no effect beside the others, in a sentence; "" if it has an effect, or asks
  // for nothing. A typed value without effect is refused; a preset's is left out.
  std::vector<std::function<std::string(const Options&)>> idle_reasons = {};
  // Gives the option's files if its words do not name them; null: the words that are file names.
  std::function<Words(const Options&)> derived_files = nullptr;
  Words usual = {};                 // the words of the default
  bool usual_asks_nothing = false;  // the default is never refused, beside any other value

  /// Adds a reason by which a value may have no effect. Reads as "idle unless denoised".
  RowOf& idle(std::function<std::string(const Options&)> why) {
    idle_reasons.push_back(std::move(why));
    return *this;
  }
  /// The same of a row whose default asks for nothing.
  RowOf& others_idle(std::function<std::string(const Options&)> why) {
    usual_asks_nothing = true;
    return idle(std::move(why));
  }

  /// Says that the option's words name files, and which of them do.
  RowOf& names(FileRole file_role, std::function<bool(const std::string&)> names_file = nullptr) {
    role = file_role;
    is_of_frame = role != FileRole::report;
    is_file = std::move(names_file);
    return *this;
  }
  /// The same of files that its words are not the names of.
  RowOf& implies(FileRole file_role, std::function<Words(const Options&)> files) {
    role = file_role;
    derived_files = std::move(files);
    return *this;
  }
  /// Whether a word of it is the name of a file.
  bool names_file(const std::string& word) const {
    return role != FileRole::none && !derived_files && !word.empty() && (!is_file || is_file(word));
  }
  /// The files that it names, if it has this role.
  std::vector<NamedFile> files(const Options& options, FileRole wanted) const {
    std::vector<NamedFile> found;
    if (role != wanted) return found;
    for (const auto& word : derived_files ? derived_files(options) : words(options))
      if (derived_files ? !word.empty() : names_file(word)) found.push_back({long_name(), word});
    return found;
  }

  /// Whether presets and --set may hold it.
  bool is_key() const { return read != nullptr; }
  /// Whether the value is another than the default.
  bool is_given(const Options& options) const { return words(options) != usual; }
};

/// The files that options name in a role, in the order of the rows.
template <class Options>
std::vector<NamedFile> files_of(const std::vector<RowOf<Options>>& rows, const Options& options, FileRole role) {
  std::vector<NamedFile> files;
  for (const auto& row : rows) std::ranges::copy(row.files(options, role), std::back_inserter(files));
  return files;
}

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
Range strictly_between(double low, double high);
Range above_to(double low, double high);

/// A text as messages quote it: an empty one by its quotation marks.
std::string visible(const std::string& text);

/// Reads a text that is a whole number which an int can hold, and nothing else.
std::optional<int> whole_number_of(const std::string& text);

// How values are read. All fail with ErrorKind::usage; the row names its option before the sentence.

/// Reads a finite number of the range.
double number_in(const Range& range, const std::string& text);
/// Reads a whole number of the range.
double whole_number_in(const Range& range, const std::string& text);
/// Reads the state of a switch, as it stands in a preset or behind an equals sign.
bool read_switch(const std::string& text);
/// Gives the one of the words that the text is, in any case.
std::string one_of(const Words& words, const std::string& text);
/// Reads by `read`, and puts the name of the option before the sentence of an Error.
void read_named(const std::string& option, const std::function<void()>& read);

/// Leads from a struct to a member of one of its members.
template <class Outer, class Inner>
auto within(Outer outer, Inner inner) {
  return [=](auto& object) -> auto& { return object.*outer.*inner; };
}

/// Appends rows of one group and one effect to a table. `part` leads from `Options` to the struct that has the values;
/// `member` leads from there to a value. Both are pointers to members, or functions. The defaults are those of
/// Options{}.
template <class Options, class Part = std::identity>
class OptionGroup {
 public:
  using Struct = std::remove_reference_t<std::invoke_result_t<Part, Options&>>;
  using Row = RowOf<Options>;

  OptionGroup(std::vector<Row>& rows, std::string group, Effect effect, Part part = {}, bool in_library = false)
      : rows_(rows), group_(std::move(group)), effect_(effect), part_(part), in_library_(in_library) {}

  /// Gives a copy of the group that adds this reason to each of its rows, as RowOf::others_idle() does.
  OptionGroup others_idle(std::function<std::string(const Options&)> why) const {
    OptionGroup group = *this;
    group.others_idle_ = std::move(why);
    return group;
  }

  template <class Member>
  Row& text(const char* name, Member member, const char* value, const std::string& sentence) {
    return own(
        {name, value, "", "", sentence}, [=](const Struct& s) -> std::string { return std::invoke(member, s); },
        [=](Struct& s, const std::string& text) {
          std::invoke(member, s) = text;
          return true;
        });
  }

  template <class Member>
  Row& flag(const char* name, Member member, const std::string& sentence) {
    Row& row = add(
        {name, "", "", "", sentence}, [=](const Struct& s) { return std::invoke(member, s) ? Words{"true"} : Words{}; },
        [=](Struct& s, const Words& words) { std::invoke(member, s) = read_switch(words.front()); });
    row.default_text.clear();
    return row;
  }

  /// One of a few words.
  template <class Member>
  Row& word(const char* name, Member member, const Words& words, const std::string& sentence) {
    return add(
        {name, fmt::format("{}", fmt::join(words, "|")), "", "", sentence},
        [=](const Struct& s) { return Words{std::invoke(member, s)}; },
        [=](Struct& s, const Words& given) { std::invoke(member, s) = one_of(words, given.front()); });
  }

  /// One of the words of an enumeration.
  template <class Member>
  Row& choice(const char* name, Member member, const std::string& sentence) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Member, Struct&>>;
    Words words;
    for (const auto& [word, meaning] : kWordsOf<Value>) words.push_back(word);
    return add(
        {name, fmt::format("{}", fmt::join(words, "|")), "", "", sentence},
        [=](const Struct& s) { return Words{word_of(std::invoke(member, s))}; },
        [=](Struct& s, const Words& given) {
          const std::string text = one_of(words, given.front());
          for (const auto& [word, meaning] : kWordsOf<Value>)
            if (word == text) std::invoke(member, s) = meaning;
        });
  }

  /// A finite number, which may be none where the member is an optional one.
  template <class Member>
  Row& number(const char* name, Member member, const char* unit, const Range& range, const std::string& sentence) {
    using Value = std::remove_cvref_t<std::invoke_result_t<Member, Struct&>>;
    return add(
        {name, "NUMBER", unit, range.text, sentence},
        [=](const Struct& s) {
          const std::optional number = std::invoke(member, s);
          return number ? Words{fmt::format("{}", *number)} : Words{};
        },
        [=](Struct& s, const Words& words) {
          const std::string& text = words.front();
          std::invoke(member, s) =
              Value(std::is_integral_v<Value> ? whole_number_in(range, text) : number_in(range, text));
        });
  }

  /// The help of an option of its own kind.
  struct Shown {
    std::string name, value, unit, range, sentence;
  };

  /// `say` gives the present value, or "" where it is not set. `take` reads a text, and tells whether it is a value;
  /// where it is none, `complaint` follows the text in the message.
  Row& own(const Shown& shown, std::function<std::string(const Struct&)> say,
           std::function<bool(Struct&, const std::string&)> take, const std::string& complaint = "") {
    return add(
        shown,
        [=](const Struct& s) {
          const std::string text = say(s);
          return text.empty() ? Words{} : Words{text};
        },
        [=](Struct& s, const Words& words) {
          if (!take(s, words.front())) fail(ErrorKind::usage, "{} {}", visible(words.front()), complaint);
        });
  }

  Row& add(const Shown& shown, std::function<Words(const Struct&)> words,
           std::function<void(Struct&, const Words&)> read) {
    Row& row = show(shown);
    row.words = [=, part = part_](const Options& options) { return words(std::invoke(part, options)); };
    row.read = [=, part = part_, option = row.long_name()](Options& options, const Words& given) {
      read_named(option, [&] { read(std::invoke(part, options), given); });
    };
    row.usual = row.words(Options{});
    if (!row.usual.empty()) row.default_text = row.usual.front();
    return others_idle_ ? row.others_idle(others_idle_) : row;
  }

  /// An option of the command line alone.
  Row& show(const Shown& shown) {
    const auto& [name, value, unit, range, sentence] = shown;
    return rows_.emplace_back(Row{{.group = group_,
                                   .name = name,
                                   .value = value,
                                   .unit = unit,
                                   .range = range,
                                   .sentence = sentence,
                                   .effect = effect_,
                                   .in_library = in_library_}});
  }

 private:
  std::vector<Row>& rows_;
  const std::string group_;
  const Effect effect_;
  const Part part_;
  const bool in_library_;
  std::function<std::string(const Options&)> others_idle_ = nullptr;
};

/// The options that are settings.
using SettingRow = RowOf<Settings>;

}  // namespace alcove
