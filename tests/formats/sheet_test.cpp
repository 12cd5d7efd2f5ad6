// A sheet lays pictures out in rows, shrinks large ones by whole numbers, and writes labels that tell letters apart.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/formats/sheet.h"

#include "core/formats/picture.h"
#include "tests/support/program.h"

namespace alcove::sheet_test {
namespace {

using namespace test;

/// A written sheet, read again: display values of its first channel.
struct Written {
  Window window{};
  std::vector<float> values;

  float at(int x, int y) const { return values[std::size_t(y) * std::size_t(window.width) + std::size_t(x)]; }
};

class Sheets : public testing::Test {
 protected:
  Written written(Sheet& sheet) const {
    sheet.write(file);
    if (!fs::exists(file)) return {};
    ExrFile picture = open_image(file, "the test", Formats::all);
    Written result{picture.parts()[0].data, {}};
    result.values.resize(result.window.pixels());
    picture.read(std::vector<ExrRead>{{0, picture.parts()[0].channels[0].name, result.values.data()}});
    return result;
  }
  static ShownPicture grey(int width, int height, float value) {
    return {width, height, 1, std::vector<float>(std::size_t(width) * std::size_t(height), value)};
  }

  TemporaryFolder folder;
  const std::string file = folder / "sheet.png";
};

TEST_F(Sheets, lay_cells_out_in_rows_with_room_for_labels) {
  Sheet sheet(3, 2);
  const std::vector<ShownPicture> pair{grey(200, 50, 0.25F), grey(200, 50, 0.75F)};
  for (std::size_t cell = 0; cell < 3; cell++) sheet.put(cell, "", pair);
  const Written picture = written(sheet);
  ASSERT_EQ(picture.window.width, 2 * 208 + 8);
  ASSERT_EQ(picture.window.height, 2 * (24 + 2 * 58) + 8);
  for (const auto& [x, y] : {std::pair(8, 32), {216, 32}, {8, 172}}) {
    EXPECT_NEAR(picture.at(x, y), 0.25, 0.01) << x << " " << y;
    EXPECT_NEAR(picture.at(x + 199, y + 49), 0.25, 0.01) << x << " " << y;
    EXPECT_NEAR(picture.at(x, y + 58), 0.75, 0.01) << x << " " << y;
  }
  EXPECT_LT(picture.at(216, 172), 0.2) << "the last place has no cell";
}

TEST_F(Sheets, shrink_large_pictures_by_the_mean_of_whole_blocks) {
  Sheet sheet(4, 2);
  ShownPicture large = grey(4000, 300, 0);
  for (std::size_t i = 0; i < large.pixels.size(); i++) large.pixels[i] = i % 3 == 0 ? 0.9F : 0;
  sheet.put(0, "", {&large, 1});
  const ShownPicture other = grey(9000, 900, 0.5F);  // of another size: it makes all cells as large
  sheet.put(1, "", {&other, 1});
  const Written picture = written(sheet);
  ASSERT_EQ(picture.window.width, 2 * (1800 + 8) + 8);
  EXPECT_NEAR(picture.at(100, 60), 0.3, 0.01);
  EXPECT_NEAR(picture.at(8 + 1808 + 10, 60), 0.5, 0.01);
  EXPECT_NEAR(picture.at(8 + 1808 + 10, 8 + 40 + 179), 0.5, 0.01);
  EXPECT_LT(picture.at(100, 8 + 40 + 101), 0.2);
}

TEST_F(Sheets, draw_each_letter_in_another_way) {
  std::string letters;
  for (char c = ' '; c <= '~'; c++) letters += c;
  Sheet sheet(1);
  const ShownPicture wide = grey(590, 20, 0);  // 49 letters
  sheet.put(0, letters, {&wide, 1});
  const Written picture = written(sheet);
  std::set<std::vector<bool>> shapes;
  for (int letter = 0; letter < int(letters.size()); letter++) {
    std::vector<bool> shape;
    for (int y = 0; y < 16; y++)
      for (int x = 0; x < 12; x++)
        shape.push_back(picture.at(8 + 12 * (letter % 49) + x, 8 + 20 * (letter / 49) + y) > 0.5F);
    EXPECT_EQ(std::ranges::count(shape, true) == 0, letter == 0) << letters[std::size_t(letter)];
    shapes.insert(shape);
  }
  EXPECT_EQ(shapes.size(), letters.size());
}

// A look of many settings differs from others by its last words, in cells as narrow as those of a large sheet.
TEST_F(Sheets, draw_whole_labels_of_letters_that_can_be_read) {
  const auto ink_of = [&](const std::string& label, int width) {
    Sheet sheet(2);
    const ShownPicture picture = grey(width, 4, 0);
    sheet.put(0, label, {&picture, 1});
    const Written drawn = written(sheet);
    return std::ranges::count_if(drawn.values, [](float value) { return value > 0.5F; });
  };
  const auto of_a = ink_of("a", 120);
  EXPECT_EQ(of_a, ink_of("a", 10)) << "no cell is too narrow for ten letters";
  EXPECT_EQ(ink_of("a", 960), of_a * 9 / 4) << "letters grow with the cells";
  EXPECT_EQ(ink_of("aaaa aaaaaaaaa aaaaaaaaaaaaaaaaaaaaaaa a", 120), 37 * of_a) << "no letter is left out or smaller";
}

TEST_F(Sheets, without_a_picture_are_not_written) {
  Sheet sheet(2);
  sheet.put(0, "1001 failed", {});
  EXPECT_EQ(written(sheet).values.size(), 0);
}

}  // namespace
}  // namespace alcove::sheet_test
