// Camera JSON, with the projection that kernels get.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/camera/camera.h"

#include <cmath>

#include "tests/fuzz/fuzz.h"

using namespace alcove;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile input(data, size);
  for (const int frame : {0, 1, 1001})
    fuzz::accepts([&] {
      const Camera camera = read_camera(input.path(), frame);
      fuzz::require(camera.width > 0 && camera.height > 0, "a camera has pixels");
      for (const double x : {camera.fx, camera.fy})
        fuzz::require(x > 0 && std::isfinite(x), "a camera has a field of view");
      for (const double x : {camera.cx, camera.cy}) fuzz::require(std::isfinite(x), "a camera has a centre");
      if (camera.view_from_world)
        for (const auto& row : view_from_normal(camera, NormalSpace::world, {}))
          for (const double x : row) fuzz::require(std::abs(x) < 1.01, "the rotation is one");
      for (const auto& plane : {camera.near, camera.far})
        fuzz::require(!plane || *plane > 0, "a clip plane lies before the eye");
      const Window window{0, 0, camera.width, camera.height};
      const View view = view_of(camera, window, window);
      for (const float x : {view.tangent_per_pixel.x, view.tangent_per_pixel.y})
        fuzz::require(x != 0 && std::isfinite(x), "a pixel covers an angle");
      for (const float x : {view.center.x, view.center.y})
        fuzz::require(std::isfinite(x), "the axis meets the image's plane");
    });
  return 0;
}
