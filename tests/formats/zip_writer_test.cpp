// What our own writer of ZIP and ZIPS writes, OpenEXR reads, and its header is the one that OpenEXR would write.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/error.h"
#include "core/base/half.h"
#include "core/formats/exr.h"
#include "core/formats/sample_loops.h"
#include "tests/support/openexr.h"
#include "tests/support/program.h"
#include "tests/support/wall_frame.h"

namespace alcove::zip_writer_test {
namespace {

using namespace test;

std::mt19937 random_numbers(1);

/// A ramp, or what nothing packs.
std::vector<float> plane_of(const Window& data, bool is_noise) {
  std::vector<float> values(data.pixels());
  std::uniform_real_distribution<float> number(-70000, 70000);
  for (std::size_t i = 0; i < values.size(); i++)
    values[i] = is_noise ? number(random_numbers) : float(i % std::size_t(data.width)) / 64;
  return values;
}

float as_half(float value) {
  std::uint16_t half = 0;
  narrow(&value, 1, &half);
  return from_half(half);
}

class ZipWriting : public testing::Test {
 protected:
  ~ZipWriting() override { set_exr_threads(0); }

  static FrameFile file_of(const Window& data, const char* compression) {
    FrameFile file{data, data, 1, {}, {"AO.Y", "b"}};
    file.compression = compression;
    for (const char* name : {"Z", "AO.Y", "b"}) file.planes[name] = plane_of(data, *name == 'b');
    return file;
  }

  void expect_pixels(const FrameFile& file) const {
    const auto planes = openexr_planes(path, 0);
    ASSERT_TRUE(planes);
    ASSERT_EQ(planes->size(), file.planes.size());
    for (auto [name, expected] : file.planes) {
      if (file.halves.contains(name)) std::ranges::transform(expected, expected.begin(), as_half);
      EXPECT_EQ(planes->at(name), expected) << name;
    }
  }

  TemporaryFolder folder;
  const std::string path = folder / "a.exr", other = folder / "b.exr";
};

TEST_F(ZipWriting, openexr_reads_the_pixels_that_were_written) {
  for (const Window& data : {Window{0, 0, 1, 1}, {-5, 3, 1, 40}, {7, -9, 33, 15}, {0, 0, 64, 16}, {0, 0, 31, 17}})
    for (const char* compression : {"zip", "zips"}) {
      const FrameFile file = file_of(data, compression);
      file.write(path);
      SCOPED_TRACE(to_string(data) + " " + compression);
      EXPECT_TRUE(is_of_zip_lines(path, 0));
      expect_pixels(file);
    }
}

TEST_F(ZipWriting, writes_the_same_bytes_on_any_threads_and_by_any_rows) {
  const Window data{-3, 10, 50, 203};
  for (const char* compression : {"zip", "zips"}) {
    const FrameFile file = file_of(data, compression);
    file.write(other);
    const std::string bytes = read_bytes(other);
    for (const int threads : {0, 1, 2, 5})
      for (const int step : {1, 7, 16, 17, 64, 203}) {
        set_exr_threads(threads);
        ExrWriter writer(path, file.output());
        for (int row = 0; row < data.height; row += step) {
          const auto count = std::size_t(std::min(step, data.height - row)) * std::size_t(data.width);
          std::vector<std::span<const float>> rows;
          for (const auto& pixels : file.pixels())
            rows.push_back(pixels.subspan(std::size_t(row) * std::size_t(data.width), count));
          writer.write(rows);
        }
        writer.finish();
        EXPECT_TRUE(read_bytes(path) == bytes) << compression << ", " << threads << " threads, " << step << " rows";
      }
    expect_pixels(file);
  }
}

TEST_F(ZipWriting, writes_the_header_that_openexr_writes) {
  for (const std::size_t length : {3, 31, 32, 200}) {
    FrameFile file = file_of({0, 0, 20, 20}, "zip");
    file.display = {-4, -4, 40, 40};
    file.pixel_aspect = 1.5;
    file.attributes = {{"alcove/" + std::string(length, 'n'), "value"}};
    file.write(path);
    Imf::InputFile ours(path.c_str());
    { const Imf::OutputFile theirs(other.c_str(), ours.header()); }
    const std::string bytes = read_bytes(path), expected = read_bytes(other);
    const std::size_t table = 2 * sizeof(std::uint64_t);  // of two chunks
    ASSERT_GT(expected.size(), table);
    const std::size_t header = expected.size() - table;
    EXPECT_TRUE(bytes.substr(0, header) == expected.substr(0, header)) << length << " letters";
  }
}

TEST_F(ZipWriting, carries_attributes_that_come_late_and_leaves_the_chunks) {
  const FrameFile file = file_of({0, 0, 20, 40}, "zip");
  ExrWriter writer(path, file.output());
  writer.write(file.pixels());
  writer.finish({{"alcove/notes", "late"}});
  EXPECT_EQ(attribute_of_whole_exr(path, "alcove/notes"), "late");
  expect_pixels(file);
}

TEST_F(ZipWriting, a_file_whose_rows_are_too_many_is_refused) {
  const ExrOutput output = file_of({0, 0, 20, 20}, "zip").output();
  ExrWriter writer(path, output);
  const std::vector<float> rows(20 * 21);
  EXPECT_THROW(writer.write(std::vector<std::span<const float>>(3, rows)), Error);
  ExrWriter full(path, output);
  full.write(std::vector<std::span<const float>>(3, std::span(rows).first(20 * 20)));
  EXPECT_THROW(full.write(std::vector<std::span<const float>>(3, std::span(rows).first(20))), Error);
}

TEST_F(ZipWriting, rows_that_openexr_cannot_count_are_refused_before_any_is_written) {
  ExrOutput output = file_of({0, 0, 20, 20}, "zip").output();
  output.data.width = 40'000'000;
  expect_error(ErrorKind::output, {path, "2 GiB"}, [&] { ExrWriter(path, output); });
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(ZipWriting, a_file_whose_rows_are_too_few_is_not_finished) {
  const std::vector<float> rows(20 * 19);
  {
    ExrWriter writer(path, file_of({0, 0, 20, 20}, "zip").output());
    writer.write(std::vector<std::span<const float>>(3, rows));
    EXPECT_THROW(writer.finish(), Error);
  }
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace alcove::zip_writer_test
