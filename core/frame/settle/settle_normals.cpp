// The order in which a frame's normals are settled.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "core/frame/settle/normal_settlement.h"
#include "core/frame/settle/other_cameras.h"
#include "core/frame/settle/settle.h"

namespace alcove {

const char* encoding_name(NormalEncoding encoding, bool unorm) {
  if (encoding == NormalEncoding::octahedral) return "octahedral";
  if (encoding == NormalEncoding::spheremap) return "spheremap";
  return unorm ? "unorm" : "signed";
}

void note_centre(FrameSource& source) {
  // A renderer writes its own camera into headers.
  if (source.open.camera || !source.camera_from.empty() || !is_off_centre(source.reading.camera)) return;
  source.notes.push_back(
      {NoteCode::principal_point, fmt::format("the principal point is at ({:.6g}, {:.6g}) of {} x {} pixels, and no "
                                              "pixel shows on which side of the centre it belongs",
                                              source.reading.camera.cx, source.reading.camera.cy,
                                              source.reading.camera.width, source.reading.camera.height)});
}

void settle_normals(FrameSource& source, const InputSettings& settings, const RawPart& raw, Evidence& seen) {
  const NormalSettlement normals(source, settings, raw, seen);
  const NormalStatistics statistics = settle_normal_encoding(normals);
  settle_normal_space(normals, statistics);
}

}  // namespace alcove
