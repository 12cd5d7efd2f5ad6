// Patterns, frame lists and listings of the disk.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sequence.h"

#include "core/base/text.h"

#include "tests/support/program.h"
#include "tests/support/test.h"

namespace alcove::sequence_test {
namespace {

using namespace test;

TEST(FramePattern, every_token_is_understood_and_a_number_may_be_longer_and_negative) {
  for (const auto& [pattern, frame, path] :
       std::vector<std::tuple<std::string, int, std::string>>{{"shot.%04d.exr", 7, "shot.0007.exr"},
                                                              {"shot.%d.exr", 7, "shot.7.exr"},
                                                              {"shot.%010d.exr", 7, "shot.0000000007.exr"},
                                                              {"shot.#.exr", 7, "shot.0007.exr"},
                                                              {"shot.##.exr", 7, "shot.07.exr"},
                                                              {"shot.######.exr", 7, "shot.000007.exr"},
                                                              {"shot.@@@.exr", 7, "shot.007.exr"},
                                                              {"shot.$F4.exr", 7, "shot.0007.exr"},
                                                              {"shot.$F.exr", 7, "shot.7.exr"},
                                                              {"shot.<f4>.exr", 7, "shot.0007.exr"},
                                                              {"shot.<F>.exr", 7, "shot.7.exr"},
                                                              {"a.%04d.exr", 123456, "a.123456.exr"},
                                                              {"a.%04d.exr", -7, "a.-007.exr"},
                                                              {"a.%d.exr", -7, "a.-7.exr"},
                                                              {"a.##.exr", 3, "a.03.exr"},
                                                              {"a.##.exr", -1, "a.-1.exr"},
                                                              {"a.##.exr", 100, "a.100.exr"}})
    EXPECT_EQ(frame_pattern(pattern).value().path(frame), path) << pattern;
}

TEST(FramePattern, other_names_are_none) {
  for (const char* name : {"", "shot.0007.exr", "user@host.exr", "50%.exr", "%s.exr", "<f.exr", "a<b>.exr", "%4d.exr",
                           "%0", "$", "$G", "<", "%017d", "#################"})
    EXPECT_FALSE(frame_pattern(name)) << name;
}

TEST(FramePattern, two_tokens_are_an_error) {
  EXPECT_THAT(error_of(ErrorKind::usage, [] { frame_pattern("%04d/shot.####.exr"); }),
              AllOf(HasSubstr("%04d and ####"), HasSubstr("two places")));
}

TEST(ParseFrames, numbers_ranges_steps_and_lists) {
  for (const auto& [list, frames] :
       std::vector<std::pair<std::string, std::vector<int>>>{{"7", {7}},
                                                             {"0007", {7}},
                                                             {"5-5", {5}},
                                                             {"1001-1003", {1001, 1002, 1003}},
                                                             {"1-10x3", {1, 4, 7, 10}},
                                                             {"1-10:4", {1, 5, 9}},
                                                             {"1,5-6, 9", {1, 5, 6, 9}},
                                                             {" 1 5-6 ", {1, 5, 6}},
                                                             {"3,1-4,3", {3, 1, 2, 4}},  // no frame twice
                                                             {"-3", {-3}},
                                                             {"-5--3", {-5, -4, -3}},
                                                             {"-1-1", {-1, 0, 1}},
                                                             {"1--1", {1, 0, -1}},
                                                             {"3-1", {3, 2, 1}},
                                                             {"10-1x4", {10, 6, 2}},
                                                             {"10-1x-4", {10, 6, 2}}})
    EXPECT_EQ(parse_frames(list), frames) << list;
}

TEST(ParseFrames, anything_else_is_an_error_that_quotes_it) {
  for (const char* list : {"", "a", "1-", "-", "1-2-3", "1-10x", "1-10y2", "1.5", "1,,2", ",1", "1,", "1-10x2x3",
                           "12345678901", "1-2147483648", "0x10", "1e3", "1-+3", "99999999999999999999"})
    EXPECT_THAT(error_of(ErrorKind::usage, [&] { parse_frames(list); }), HasSubstr(list)) << list;
  EXPECT_THAT(error_of(ErrorKind::usage, [] { parse_frames("  "); }), HasSubstr("empty"));
  for (const char* number : {"1000000000", "-1000000000", "2000000000", "99999999999999999999"})
    EXPECT_THAT(error_of(ErrorKind::usage, [&] { parse_frames(std::string("1-") + number); }),
                HasSubstr(std::string(": ") + number + " is too far from 0: numbers have 9 digits at most"));
  EXPECT_THAT(error_of(ErrorKind::usage, [] { parse_frames("1-10x0"); }), HasSubstr("step"));
  EXPECT_THAT(error_of(ErrorKind::usage, [] { parse_frames("1-10x-2"); }), HasSubstr("backwards"));
  EXPECT_THAT(error_of(ErrorKind::usage, [] { parse_frames("1-100000000"); }), HasSubstr("more than 1000000 frames"));
  EXPECT_THAT(error_of(ErrorKind::usage, [] { parse_frames("1-900000,1000001-1900000"); }),
              HasSubstr("more than 1000000 frames"));
}

TEST(FramesText, is_short_and_means_the_same) {
  EXPECT_EQ(frames_text({1010, 1003, 1012, 1011}), "1003, 1010-1012");
  EXPECT_EQ(frames_text({-2, -1, 1}), "-2--1, 1");
  EXPECT_EQ(frames_text({}), "");
  EXPECT_EQ(short_frames_text({3, 1, 2}), "1-3");
  EXPECT_EQ(short_frames_text({22, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20}), "11 frames from 2 to 22");
  EXPECT_EQ(parse_frames(frames_text({5, 1, 2, 3, -7})), (std::vector{-7, 1, 2, 3, 5}));
}

class OnDisk : public testing::Test {
 protected:
  std::vector<int> frames(const std::string& name) const {
    return frames_on_disk(frame_pattern(folder / name).value(), "RESULT");
  }
  void touch(const std::vector<std::string>& names) const {
    for (const auto& name : names) write_bytes(folder / name, "");
  }
  TemporaryFolder folder;
};

TEST_F(OnDisk, frames_are_found_in_rising_order) {
  touch({"a.0010.exr", "a.0002.exr", "a.12345.exr", "a.-003.exr"});
  EXPECT_THAT(frames("a.%04d.exr"), ElementsAre(-3, 2, 10, 12345));
  touch({"a.2147483647.exr", "a.-2147483648.exr", "a.1000000001.exr"});
  EXPECT_THAT(frames("a.%04d.exr"), ElementsAre(-3, 2, 10, 12345)) << "as --frames takes none so large";
}

TEST_F(OnDisk, other_names_are_passed_by) {
  touch({"a.0001.exr", "a.00002.exr", "a.3.exr", "a..exr", "a.0004.png", "b.0005.exr", "a.0006.exr.tmp", "a.x007.exr",
         "a.+008.exr", "a.99999999999.exr"});
  EXPECT_THAT(frames("a.####.exr"), ElementsAre(1));
  EXPECT_THAT(frames("a.%d.exr"), ElementsAre(3));
}

TEST_F(OnDisk, none_is_an_error) {
  EXPECT_THAT(error_of(ErrorKind::input, [&] { frames("a.%04d.exr"); }),
              AllOf(HasSubstr("RESULT"), HasSubstr("a.0001.exr")));
  EXPECT_THAT(error_of(ErrorKind::input, [&] { frames("missing/a.%04d.exr"); }), HasSubstr("cannot be read"));
}

TEST_F(OnDisk, none_is_an_error_that_says_what_is_wrong_with_the_pattern) {
  touch({"a.001.exr", "a.002.exr", "b.7.exr", "shot_C.1001.exr"});
  for (const auto& [pattern, words] : std::vector<std::pair<std::string, std::string>>{
           {"a.####.exr", "3 digits in a.001.exr: write " + (folder / "a.###.exr")},
           {"b.%04d.exr", "1 digit in b.7.exr"},
           {"shot_c_####.exr", "there is " + (folder / "shot_C.1001.exr")},
           {"shto_c_####.exr", "there is " + (folder / "shot_C.1001.exr")},
           {"sot_C.####.exr", "there is " + (folder / "shot_C.1001.exr")},
           {"a.####.exr 1-2", (folder / "a.####.exr") + " with --frames 1-2"},
           {"a.####.exr [1-20x2]", "--frames 1-20x2"},
           {"a.1001-1005#.exr", (folder / "a.####.exr") + " with --frames 1001-1005"},
           {"a.%V.####.exr", "%V is not a pattern"},
           {"%v/a.####.exr", "--view"},
           {"a.<layer>.####.exr", "<layer> is not a pattern"}})
    EXPECT_THAT(error_of(ErrorKind::input, [&, &pattern = pattern] { frames(pattern); }), HasSubstr(words));
}

TEST_F(OnDisk, a_pattern_that_fits_other_frames_is_not_proposed_again) {
  touch({"a.7.exr", "b.0007.exr"});
  for (const char* pattern : {"a.%d.exr", "b.####.exr"})
    EXPECT_THAT(why_no_frames(*frame_pattern(folder / pattern)),
                AllOf(HasSubstr("there is "), Not(HasSubstr("write"))));
}

TEST(ForeignPattern, is_known_in_a_name_without_a_place_for_the_number) {
  for (const auto& [name, words] : {std::pair("a.[1001-1005].exr", "write a.####.exr with --frames 1001-1005"),
                                    std::pair("a.{101..105}.exr", "write a.###.exr with --frames 101-105"),
                                    std::pair("a.1001-1005.exr", "write a.####.exr with --frames 1001-1005"),
                                    std::pair("a.%04i.exr", "%04i is not"), std::pair("a.%04.exr", "%04 is not"),
                                    std::pair("a_%04_left.exr", "%04 is not"), std::pair("a.%4d.exr", "%4d is not"),
                                    std::pair("a.{frame:04d}.exr", "{frame:04d} is not"),
                                    std::pair("a.<UDIM>.exr", "<UDIM> is not"), std::pair("a_%V.exr", "%V is not")})
    EXPECT_THAT(foreign_pattern_in(name), HasSubstr(words));
  for (const char* name : {"a.exr", "2024-11/a.exr", "my%20-%20shots/a.exr", "a-1.exr", "a.1001.exr", "100%.exr"})
    EXPECT_EQ(foreign_pattern_in(name), "") << name;
}

TEST_F(OnDisk, a_token_in_a_folders_name_needs_a_list) {
  EXPECT_THAT(error_of(ErrorKind::usage, [&] { frames("f%04d/a.exr"); }), HasSubstr("--frames"));
}

}  // namespace
}  // namespace alcove::sequence_test
