// A labelled picture of pictures: the contact sheet of a shot, the looks of a wedge.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace alcove {

/// Interleaved display values in [0, 1], rows from the top.
struct ShownPicture {
  int width = 0, height = 0, channels = 1;  // channels: 1 or 3
  std::vector<float> pixels;
};

/// Cells in rows, each a label with a picture below it. Large pictures are shrunk by a whole number, so that the sheet
/// stays about 3840 px wide.
class Sheet {
 public:
  /// `columns`: 0: about as many as rows.
  explicit Sheet(std::size_t cells, std::size_t columns = 0);
  /// Fills a cell with pictures of one size, one above the other, or with a label alone. Any thread may. ASCII is
  /// drawn, and other characters as ?.
  void put(std::size_t cell, const std::string& label, std::span<const ShownPicture> pictures);
  /// Writes a PNG; nothing where there is no picture. Fails with ErrorKind::output.
  void write(const std::string& path) const;

 private:
  struct Cell {
    std::string label;
    ShownPicture picture;  // of three channels
  };
  const std::size_t cells_, columns_;
  std::mutex mutex_;
  std::map<std::size_t, Cell> filled_;
};

}  // namespace alcove
