// Names: case, lists, distances and suggestions.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/text.h"

#include "core/base/error.h"
#include "core/base/toml.h"
#include "tests/support/test.h"

namespace alcove::text_test {
namespace {

using namespace test;
using Names = std::vector<std::string>;

TEST(Text, lower_case_changes_ascii_letters_only) {
  EXPECT_EQ(lower_case("ViewLayer.Depth.Z_09"), "viewlayer.depth.z_09");
  EXPECT_EQ(lower_case(""), "");
  EXPECT_EQ(lower_case("\xc3\x9c"), "\xc3\x9c") << "bytes of UTF-8 stay";
}

TEST(Text, one_thing_is_counted_without_an_s) {
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(21, "frame"), "21 frames");
}

TEST(Text, printable_leaves_no_control_and_nothing_that_turns_the_direction_of_writing) {
  for (char32_t c = 0; c < 0x2100; c++) {
    std::string text;
    if (c < 0x80)
      text = {char(c)};
    else if (c < 0x800)
      text = {char(0xc0 | c >> 6), char(0x80 | (c & 63))};
    else
      text = {char(0xe0 | c >> 12), char(0x80 | (c >> 6 & 63)), char(0x80 | (c & 63))};
    const bool is_control = c < 0x20 || (c >= 0x7f && c < 0xa0);
    const bool turns =
        c == 0x61c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
    EXPECT_EQ(printable("a" + text + "b"), "a" + (is_control || turns ? "?" : text) + "b") << std::hex << unsigned(c);
  }
}

TEST(Text, bytes_that_are_no_character_are_escaped) {
  const std::pair<std::string, std::string> shown[] = {
      {"plain, caf\xc3\xa9, \xe2\x82\xac, \xf0\x9f\x98\x80", "plain, caf\xc3\xa9, \xe2\x82\xac, \xf0\x9f\x98\x80"},
      {"caf\xe9!", "caf\\xe9!"},
      {"\xff\xfe", "\\xff\\xfe"},
      {"cut short \xe2\x80", "cut short \\xe2\\x80"},
      {"cut short \xe2\x80 and on", "cut short \\xe2\\x80 and on"},
      {"overlong \xc0\xaf \xe0\x80\xaf \xf0\x80\x80\xaf", "overlong \\xc0\\xaf \\xe0\\x80\\xaf \\xf0\\x80\\x80\\xaf"},
      {"half a pair \xed\xa0\x80", "half a pair \\xed\\xa0\\x80"},
      {"beyond the last \xf4\x90\x80\x80 \xf5\x80\x80\x80",
       "beyond the last \\xf4\\x90\\x80\\x80 \\xf5\\x80\\x80\\x80"},
  };
  for (const auto& [text, expected] : shown) {
    EXPECT_EQ(printable(text), expected);
    EXPECT_EQ(as_utf8(text), expected);
  }
  EXPECT_EQ(as_utf8("\x1b[2J\n\xc2\x80"), "\x1b[2J\n\xc2\x80") << "controls are UTF-8";
}

TEST(Text, json_is_utf8_whatever_its_keys_and_strings_hold) {
  const nlohmann::ordered_json json = {
      {"b\xff", {"x\xe9", 1, nullptr, true}}, {"a", {{"deep", "\xc3"}}}, {"n", {}}, {"f", 0.5}};
  EXPECT_EQ(json_text(json), R"({"b\\xff":["x\\xe9",1,null,true],"a":{"deep":"\\xc3"},"n":null,"f":0.5})");
}

TEST(Text, a_list_ends_with_how_many_more) {
  EXPECT_EQ(list_of(Names{}), "nothing");
  EXPECT_EQ(list_of(Names{"a"}), "a");
  EXPECT_EQ(list_of(Names{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(list_of(Names{"a", "b", "c"}, 3), "a, b, c");
  EXPECT_EQ(list_of(Names{"a", "b", "c"}, 2), "a, b and 1 more");
  EXPECT_EQ(list_of(Names(100, "x"), 1), "x and 99 more");
  EXPECT_THAT(list_of(Names(25, "x")), HasSubstr("and 1 more"));
}

TEST(Text, edit_distance_counts_insertions_deletions_and_replacements) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("flaw", "lawn"), 2);
  EXPECT_EQ(edit_distance("radius", "radis"), 1);
  EXPECT_EQ(edit_distance("ab", "ba"), 2) << "a swap is two replacements";
  EXPECT_EQ(edit_distance("Depth.Z", "dEPTH.z"), 0) << "case is ignored";
}

/// The same by the definition, without a table.
std::size_t slow_distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const auto rest_a = a.substr(1), rest_b = b.substr(1);
  return std::min(
      {slow_distance(rest_a, rest_b) + (a[0] != b[0]), slow_distance(rest_a, b) + 1, slow_distance(a, rest_b) + 1});
}

TEST(Text, edit_distance_agrees_with_its_definition) {
  Names words{""};
  for (std::size_t i = 0; i < 31; i++)
    for (const char c : {'a', 'b'}) words.push_back(words[i] + c);  // all words of up to 4 letters, and some of 5
  for (const auto& a : words)
    for (const auto& b : words) ASSERT_EQ(edit_distance(a, b), slow_distance(a, b)) << a << " " << b;
}

TEST(Text, nearest_names_come_nearest_first) {
  EXPECT_THAT(nearest_names("radis", Names{"radius", "ratios", "seed"}), ElementsAre("radius", "ratios"));
  EXPECT_THAT(nearest_names("standrad", Names{"draft", "production", "standard"}), ElementsAre("standard"));
  EXPECT_THAT(nearest_names("depth.z", Names{"ViewLayer.Depth.Z", "Depth.Z"}),
              ElementsAre("Depth.Z", "ViewLayer.Depth.Z"))
      << "the same name but for case is nearest";
  EXPECT_THAT(nearest_names("Depth.Z", Names{"ViewLayer.Depth.Z", "Dept.Z"}),
              ElementsAre("ViewLayer.Depth.Z", "Dept.Z"));
}

TEST(Text, a_misspelt_name_below_another_layer_is_near) {
  EXPECT_THAT(nearest_names("Depth.Z", Names{"ViewLayer.Deph.Z", "ViewLayer.Combined.R"}),
              ElementsAre("ViewLayer.Deph.Z"));
  EXPECT_THAT(nearest_names("Normal.X", Names{"ViewLayer.Depth.Z", "RenderLayer.Norml.X"}),
              ElementsAre("RenderLayer.Norml.X"));
}

TEST(Text, far_names_are_not_suggested) {
  EXPECT_THAT(nearest_names("quadratic", Names{"none", "linear"}), IsEmpty());
  EXPECT_THAT(nearest_names("anything", Names{}), IsEmpty());
  EXPECT_EQ(suggestion("anything", Names{"none", "linear"}), "");
}

TEST(Text, at_most_so_many_names_are_suggested) {
  const Names many(10, "radius");
  EXPECT_EQ(nearest_names("radis", many).size(), 3);
  EXPECT_EQ(nearest_names("radis", many, 1).size(), 1);
  EXPECT_THAT(nearest_names("radis", many, 0), IsEmpty());
}

TEST(Text, a_suggestion_is_a_question) {
  EXPECT_EQ(suggestion("radis", Names{"radius"}), " (did you mean radius?)");
  EXPECT_EQ(suggestion("radis", Names{"radius", "radios"}), " (did you mean radius or radios?)");
}

TEST(Numbers, are_read_whole_and_with_a_point) {
  const std::vector<std::pair<const char*, double>> known{
      {"0.5", 0.5},   {"-3", -3},   {"+2", 2},     {".25", 0.25},     {"4.", 4},
      {"1e-3", 1e-3}, {"2E2", 200}, {"1e-999", 0}, {"inf", INFINITY}, {"-1e999", -INFINITY}};
  for (const auto& [text, value] : known) EXPECT_EQ(number_of(text), value) << text;
  EXPECT_EQ(number_of(std::string(400, '9')), INFINITY);
  EXPECT_EQ(number_of("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(number_of("1" + std::string(400, '0') + "e-50"), INFINITY);
  EXPECT_EQ(number_of("-0." + std::string(400, '0') + "1e+50"), 0);
  EXPECT_EQ(number_of("1e99999999999"), INFINITY);
  EXPECT_EQ(number_of("1e-99999999999"), 0);
  for (const char* text : {"", "x", "1x", "0,5", "1 2", "+-1", "--1", "1e", "."})
    EXPECT_EQ(number_of(text), std::nullopt) << text;
}

TEST(Toml, has_letters_beyond_ascii_in_quotes_and_comments_only) {
  for (const char* text :
       {"a = \"\xc3\xbc \\\" \xc3\xbc\" # \xc3\xbc", "a = '\xc3\xbc'", "# it's \xc3\xbc\na = 1",
        "a = \"\"\"\n\xc3\xbc \"\n\"\"\"", "a = \"\"\"\xc3\xbc\"\"\"\"\"", "\"a\" = [ 'x', \"\xc3\xbc\"]",
        "\xef\xbb\xbf"
        "a = 1"})
    EXPECT_EQ(parse_flat_toml(text).size(), 1) << text;
  for (const char* text : {"gr\xc3\xb6 = 1", "a = 1\xc3\xbc", "a = '' \xc2\xa0", "a = \"x\" \xe2\x80\x80"})
    EXPECT_THROW(parse_flat_toml(text), Error) << text;
}

TEST(Toml, keeps_letters_and_percents_of_strings) {
  EXPECT_EQ(parse_flat_toml("a = '\u00fc %41 %'")[0].values[0], "\u00fc %41 %");
  EXPECT_EQ(parse_flat_toml("a = [\"\"\"\\\n\u0327 %%\"\"\"]")[0].values[0], "\u0327 %%");
  EXPECT_EQ(parse_flat_toml("a = \"\\u00fc\"")[0].values[0], "\u00fc");
  EXPECT_THROW(parse_flat_toml("a = \"\\u002541\""), Error);
}

// Found by fuzzing: toml++ asks of each of these letters whether it is a blank, by a table that not all letters are in.
TEST(Toml, refuses_letters_beyond_ascii_outside_of_strings) {
  for (const char* text : {"a = -&-\"\"\"\xc5\xae\"\"\"", "a = -&=\"\"\"\xc5\xae\"\"\"", "a = x'\xc5\xae'", "\xcc\xaa",
                           "a = 0x1f['[-&-\"\"\"\xc5\xae\"\"\""})
    EXPECT_THROW(parse_flat_toml(text), Error) << text;
}

}  // namespace
}  // namespace alcove::text_test
