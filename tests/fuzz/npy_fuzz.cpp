// NumPy's arrays: header and numbers.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/fuzz.h"
#include "tests/support/picture_file.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  fuzz::accepts([&] {
    const Image image = test::whole(*open_npy(input.path(), "--depth"));
    fuzz::require(size >= 10, "what is read has a header");
    fuzz::require(image.data.pixels() > 0 && !image.names.empty() && image.names.size() <= 4,
                  "a picture has pixels and up to four channels");
  });
  return 0;
}
