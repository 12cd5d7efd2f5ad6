// A handle of the C library with the shipped frame, and what the chain makes of that frame.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "api/alcove/alcove.h"
#include "core/chain/compute.h"
#include "core/frame/find/frame_source.h"
#include "core/frame/reading.h"
#include "tests/support/device.h"
#include "tests/support/program.h"

namespace alcove::test {

struct Free {
  void operator()(alcove_session* handle) const { alcove_free(handle); }
};
using Handle = std::unique_ptr<alcove_session, Free>;

inline alcove_layout packed(int width, int height, int components = 1) {
  return {width, height, components, ALCOVE_FLOAT, 0, 0, 0};
}

#define EXPECT_OK(handle, call) EXPECT_EQ(call, ALCOVE_OK) << alcove_error((handle).get())
#define EXPECT_REFUSED(handle, call, code, sentence)                \
  do {                                                              \
    EXPECT_EQ(call, code);                                          \
    EXPECT_THAT(alcove_error((handle).get()), HasSubstr(sentence)); \
  } while (false)

/// The shipped frame, and what the chain makes of it.
struct Library : testing::Test {
  static const HostFrame& frame() {
    static const HostFrame read = [] {
      InputSettings settings;
      settings.input = ALCOVE_SOURCE_DIR "/examples/interior.gbuffer.exr";
      settings.camera = ALCOVE_SOURCE_DIR "/examples/interior.camera.json";
      return read_host_frame(settings, 0);
    }();
    return read;
  }
  static int width() { return frame().data.width; }
  static int height() { return frame().data.height; }
  static std::vector<float> chain_of(const HostFrame& of, double radius = 0.35) {
    EstimatorSettings settings;
    settings.radius = radius;
    return compute_ao(recorder(), of, settings).ao;
  }
  static const std::vector<float>& truth() {
    static const std::vector<float> ao = chain_of(frame());
    return ao;
  }

  /// A handle with all that the frame says but its planes.
  static Handle with_camera() {
    Handle handle(alcove_new());
    const std::string text = read_bytes(ALCOVE_SOURCE_DIR "/examples/interior.camera.json");
    EXPECT_OK(handle, alcove_camera_json(handle.get(), text.c_str()));
    EXPECT_OK(handle, alcove_set(handle.get(), "radius", "0.35"));
    EXPECT_OK(handle, alcove_set(handle.get(), "normal-space", "world"));
    EXPECT_OK(handle, alcove_set(handle.get(), "device", device().info().name.c_str()));
    return handle;
  }
  static void give_planes(const Handle& handle) {
    const alcove_layout one = packed(width(), height());
    alcove_layout three = packed(width(), height(), 3);
    three.pixel_stride = sizeof(float);
    three.component_stride = std::ptrdiff_t(sizeof(float)) * width() * height();
    EXPECT_OK(handle, alcove_plane(handle.get(), "depth", frame().depth.data(), &one));
    EXPECT_OK(handle, alcove_plane(handle.get(), "normal", frame().normal.data(), &three));
  }
  static Handle with_planes() {
    Handle handle = with_camera();
    give_planes(handle);
    return handle;
  }
  static std::vector<float> ao_of(const Handle& handle) {
    std::vector<float> ao(frame().data.pixels(), -1);
    const alcove_layout one = packed(width(), height());
    EXPECT_OK(handle, alcove_run(handle.get(), 0));
    EXPECT_OK(handle, alcove_get(handle.get(), "ao", ao.data(), &one));
    return ao;
  }
};

}  // namespace alcove::test
