// NumPy's arrays are read as they stand, and what is no plain picture is refused with what to do.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/half.h"
#include "tests/support/command_line.h"
#include "tests/support/picture_file.h"
#include "tests/support/test.h"

namespace alcove::npy_test {
namespace {

using namespace test;

/// An array as numpy.save() writes it: its header is padded to 64 bytes.
std::string npy(const std::string& type, const std::string& shape, const std::string& numbers,
                const std::string& order = "False") {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': (" + shape + "), }";
  header.resize((header.size() + 10) / 64 * 64 + 64 - 10 - 1, ' ');
  header += '\n';
  return std::string("\x93NUMPY\1\0", 8) + char(header.size() & 255) + char(header.size() >> 8) + header + numbers;
}

template <class T>
std::string reversed_bytes_of(const std::vector<T>& values) {
  std::string bytes = bytes_of(values);
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) std::reverse(&bytes[i], &bytes[i] + sizeof(T));
  return bytes;
}

class Npy : public CommandLine {
 protected:
  Image read(const std::string& bytes) const {
    write_bytes(path, bytes);
    return whole(*open_npy(path, "--depth"));
  }

  const std::string path = folder / "a.npy";
};

TEST_F(Npy, has_the_numbers_of_each_type_and_order_of_bytes) {
  const std::vector<float> numbers{1.5f, 0.25f, -2, 8, 0, 3};
  const std::vector<double> doubles(numbers.begin(), numbers.end());
  std::vector<std::uint16_t> halves;
  for (const float x : numbers) halves.push_back(to_half(x));
  for (const std::string& bytes :
       {npy("<f4", "2, 3", bytes_of(numbers)), npy(">f4", "2, 3, 1", reversed_bytes_of(numbers)),
        npy("<f8", "2,3", bytes_of(doubles)), npy(">f8", "2, 3", reversed_bytes_of(doubles)),
        npy("<f2", "2, 3", bytes_of(halves)), npy(">f2", "2, 3", reversed_bytes_of(halves))}) {
    const Image image = read(bytes);
    EXPECT_EQ(image.data, (Window{0, 0, 3, 2}));
    EXPECT_THAT(image.names, ElementsAre("Z"));
    EXPECT_EQ(image.pixels, numbers);
  }
  EXPECT_THAT(read(npy("|u1", "1, 2", "\xff\x33")).pixels, ElementsAre(1, 0.2f));
  EXPECT_THAT(read(npy(">u2", "1, 2", std::string("\xff\xff\x33\x33", 4))).pixels, ElementsAre(1, 0.2f));
  EXPECT_THAT(read(npy("<i4", "2, 1", bytes_of<std::int32_t>({-70000, 5}))).pixels, ElementsAre(-70000, 5));
  EXPECT_THAT(read(npy("<f4", "1, 2, 3", bytes_of(numbers))).plane("G"), ElementsAre(0.25f, 0));
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_THAT(read(npy("<f8", "1, 3", bytes_of<double>({1e300, -1e39, 3}))).pixels, ElementsAre(inf, -inf, 3));
  std::string second = npy("<f4", "2, 3", bytes_of(numbers));
  second[6] = 2;
  second.insert(10, 2, '\0');
  EXPECT_EQ(read(second).pixels, numbers) << "its length has four bytes";
}

TEST_F(Npy, that_is_no_picture_is_refused_with_what_to_do) {
  const std::string numbers(64, '\0'), plain = npy("<f4", "2, 3", numbers);
  std::string records = plain;
  records.replace(records.find("'<f4', "), 7, "[('<f4'");
  const auto with = [&](std::size_t at, char byte) {
    std::string bytes = plain;
    bytes[at] = byte;
    return bytes;
  };
  for (const auto& [bytes, word] : std::vector<std::pair<std::string, std::string>>{
           {npy("<f4", "2, 3", numbers, "True"), "numpy.ascontiguousarray"},
           {npy("<c8", "2, 3", numbers), "array.astype('float32')"},
           {npy("<i8", "2, 3", numbers), "type <i8"},
           {npy("|b1", "2, 3", numbers), "type |b1"},
           {npy("", "2, 3", numbers), "records"},
           {npy("<f4", "2.9, 3", numbers), "(height, width)"},
           {npy("<f4", "2e0, 3", numbers), "its shape is (2e0, 3)"},
           {records, "records"},
           {npy("<f4", "6,", numbers), "(height, width)"},
           {npy("<f4", "", numbers), "(height, width)"},
           {npy("<f4", "3, 2, 3, 1", numbers), "array.squeeze()"},
           {npy("<f4", "1, 2, 7", numbers), "numpy.moveaxis(array, 0, -1)"},
           {npy("<f4", "2, 3, 0", numbers), "(2, 3, 0)"},
           {npy("<f4", "0, 3", numbers), "empty"},
           {npy("<f4", "-2, 3", numbers), "its shape"},
           {npy("<f4", "nan, 3", numbers), "its shape"},
           {npy("<f4", "2, 99999999999999999999", numbers), "wider"},
           {npy("<f4", "65536, 65536, 4", numbers), "ends too early"},
           {npy("<f4", "5, 4", numbers), "4 x 5 pixels"},
           {npy("<f4', 'x': (" + std::string(5000, ' '), "2, 3", numbers), "header"},
           {with(8, '\0').substr(0, 20), "records"},
           {with(6, 2), "ends too early"},
       })
    expect_error(ErrorKind::input, {path, word, "--depth"}, [&, &given = bytes] { read(given); });
}

TEST_F(Npy, that_is_cut_short_is_refused_at_every_length) {
  const std::string bytes = npy("<f4", "2, 3", std::string(24, '\0'));
  for (std::size_t size = 0; size < bytes.size(); size++)
    EXPECT_EQ(error_of(ErrorKind::input, [&] { read(bytes.substr(0, size)); }).substr(0, path.size()), path) << size;
  EXPECT_EQ(read(bytes).pixels, std::vector<float>(6, 0));
}

TEST_F(Npy, gives_the_ao_of_the_same_planes_in_an_exr) {
  const std::vector<float> wanted = computed({"--normal-space", "world"}).pixels;
  const FrameFile file = wall_frame();
  std::vector<float> normals;
  for (std::size_t i = 0; i < kWallWindow.pixels(); i++)
    for (const char* axis : {"X", "Y", "Z"})
      normals.push_back(file.planes.at(std::string("ViewLayer.Normal.") + axis)[i]);
  write_bytes(path, npy("<f4", "36, 64", bytes_of(file.planes.at("ViewLayer.Depth.Z"))));
  write_bytes(folder / "n.npy", npy(">f4", "36, 64, 3", reversed_bytes_of(normals)));
  for (const Options& depth : {Options{path}, Options{"--depth", path}}) {
    run_well(joined(joined({"run"}, depth), {"--normal", folder / "n.npy", "--camera", camera, "--radius", "1", "-o",
                                             ao, "--type", "float", "--normal-space", "world"}));
    EXPECT_EQ(read_exr_image(ao).pixels, wanted) << depth.front();
  }
}

}  // namespace
}  // namespace alcove::npy_test
