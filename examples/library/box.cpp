// The AO of a wall with a box before it, from half floats and with bent normals: a C++ program with libalcove.
// SPDX-License-Identifier: BSD-3-Clause
//
//     c++ -std=c++17 box.cpp $(pkg-config --cflags --libs alcove)
#include <alcove/alcove.h>

#include <cstdint>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

/// A session that goes with its scope, and whose failures are exceptions.
class Session {
 public:
  Session() : handle_(alcove_new(), alcove_free) {
    if (!handle_) throw std::bad_alloc();
  }
  void set(const std::string& option, const std::string& value) {
    check(alcove_set(handle_.get(), option.c_str(), value.c_str()));
  }
  void plane(const std::string& name, const void* data, const alcove_layout& layout) {
    check(alcove_plane(handle_.get(), name.c_str(), data, &layout));
  }
  void run() { check(alcove_run(handle_.get(), 0)); }
  std::vector<float> get(const std::string& aov, int width, int height) {
    const alcove_layout layout{width, height, alcove_components(handle_.get(), aov.c_str()), ALCOVE_FLOAT, 0, 0, 0};
    std::vector<float> values(std::size_t(width) * height * layout.components);
    check(alcove_get(handle_.get(), aov.c_str(), values.data(), &layout));
    return values;
  }

 private:
  void check(alcove_code code) {
    if (code != ALCOVE_OK) throw std::runtime_error(alcove_error(handle_.get()));
  }
  std::unique_ptr<alcove_session, decltype(&alcove_free)> handle_;
};

}  // namespace

int main() try {
  constexpr int kWidth = 160, kHeight = 120;
  constexpr std::uint16_t kThree = 0x4200, kFour = 0x4400;  // half floats
  std::vector<std::uint16_t> depth(kWidth * kHeight, kFour);
  for (int j = 40; j < 80; j++)
    for (int i = 60; i < 100; i++) depth[j * kWidth + i] = kThree;

  Session session;
  session.set("radius", "2");
  session.set("fov", "50");
  session.set("aov", "ao,bent-normal");
  session.plane("depth", depth.data(), {kWidth, kHeight, 1, ALCOVE_HALF, 0, 0, 0});
  session.run();
  const auto ao = session.get("ao", kWidth, kHeight), bent = session.get("bent-normal", kWidth, kHeight);

  const auto tell = [&](const char* where, int i, int j) {
    const std::size_t pixel = j * kWidth + i;
    std::cout << where << ": AO " << ao[pixel] << ", most open towards " << bent[3 * pixel] << ' ' << bent[3 * pixel + 1] << ' '
              << bent[3 * pixel + 2] << '\n';
  };
  tell("on the wall, right of the box", 103, 60);
  tell("on the wall, far away", 150, 60);
  tell("on the box", 80, 60);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
