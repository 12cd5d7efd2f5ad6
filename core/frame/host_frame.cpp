// Reads a frame's depth and normals from its files into host memory.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/frame/host_frame.h"

#include "core/frame/gbuffer.h"
#include "core/frame/settle.h"

namespace alcove {

HostFrame read_host_frame(const InputSettings& settings, int number) {
  FrameSource source = find_frame(settings, false, number);
  require_host_room(source.depth_path(), source.data);
  const auto& depth = source[RawPlane::depth];
  const auto& normal = source[RawPlane::normal];
  HostFrame frame;
  frame.depth.resize(depth.size() * source.data.pixels());
  frame.normal.resize(normal.size() * source.data.pixels());
  read_planes(source, {{&depth, frame.depth.data()}, {&normal, frame.normal.data()}});
  settle(source, settings, frame.depth, frame.normal);
  static_cast<Reading&>(frame) = source;
  frame.frame = number;
  return frame;
}

}  // namespace alcove
