// Refuses depth within 0 to 1 that nothing shows to be distances.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <vector>

#include "core/base/error.h"
#include "core/frame/settle/depth_settlement.h"

namespace alcove {
namespace {

class FractionRules : private DepthSettlement {
 public:
  FractionRules(const DepthSettlement& depth, DepthKind usual) : DepthSettlement(depth), usual_(usual) {}

  void run() {
    if (!is_fraction()) return;
    const auto& scores = seen_.depth_scores;
    const double straight = scores.empty() ? 0 : scores[0].straight, from_1 = straightness_from_1();
    if (from_1 >= kLeastStraight && from_1 > kClear * straight)
      fail(ErrorKind::input,
           "{}: {}, and flat surfaces are straight on {:.0f} % as 1 - depth, on {:.0f} % as depth: it is normalized, "
           "with 1 at the eye: give {}; if it is a distance all the same, give --depth-kind planar",
           path_, text_of_range(), 100 * from_1, 100 * straight, normalized_line(true));
    const bool is_supported = straight >= kSurelyStraight;
    const bool is_inverse =
        straight >= kLeastStraight && scores[0].kind == DepthKind::inverse && straight >= kClear * scores[1].straight;
    if (facts_.program.rules->depth_kind != DepthKind::automatic && !is_supported && !is_inverse)
      return note_fractions();
    if (facts_.program.rules->depth_kind != DepthKind::automatic || is_inverse) return;
    refuse_plateau();
    if (!is_supported)
      fail(ErrorKind::input,
           "{}: {}, and no flat surfaces show that these are distances: if it is 0 at the eye, give {}; if it is 1 at "
           "the eye, {}; if it is a distance, --depth-kind planar; if it is 1/z, --depth-kind inverse; if it is a "
           "z-buffer, --depth-kind device with --near and --far{}",
           path_, text_of_range(), normalized_line(false), normalized_line(true), kDisparityHint);
    refuse_before_near_plane();
    note_fractions();
  }

 private:
  /// It is all that is said where the program is known to write distances: those of a macro scene are below 1.
  void note_fractions() {
    if (!is_distance(usual_)) return;
    note(NoteCode::depth_below_1,
         fmt::format("{} and is read as distances of less than 1 scene unit; if it is normalized, give {}",
                     text_of_range(), normalized_line(false)));
  }

  /// No surface is seen that is nearer than the near plane, so the depth of such is no distance.
  void refuse_before_near_plane() const {
    constexpr double kMostNearer = 0.01;  // of the surfaces: matrices and planes are rounded
    if (!reading_.camera.near) return;
    const double near = 0.99 * *reading_.camera.near / reading_.depth_scale;
    std::size_t count = 0, nearer = 0;
    for (std::size_t i = 0; i < raw_.depth.size(); i += values_.step)
      if (raw_.depth[i] > 0 && raw_.depth[i] < settings_.sky) count++, nearer += raw_.depth[i] < near;
    if (double(nearer) <= kMostNearer * double(count)) return;
    fail(ErrorKind::input,
         "{}: {}, and {:.0f} % of it is nearer than the camera's near plane at {:.3g}, so these are no distances: if "
         "they are normalized, give {}; if they are distances all the same, give --depth-kind planar",
         path_, text_of_range(), 100 * double(nearer) / double(count), *reading_.camera.near, normalized_line(false));
  }

  /// A background of exactly 1 behind depths of 0 to 1 is the far end of a range.
  void refuse_plateau() const {
    if (values_.all.least < 0 || values_.all.most != 1 ||
        double(values_.all.one) < kPlateau * double(values_.all.pixels))
      return;
    fail(ErrorKind::input,
         "{}: the depth may be normalized or planar (all in 0 to 1, {:.1f} % of exactly 1): say --depth-kind "
         "normalized with --near and --far (or log, with "
         "--far and --set log-constant), or --depth-kind planar",
         path_, 100 * double(values_.all.one) / double(values_.all.pixels));
  }

  DepthKind usual_;  // of the program
};

}  // namespace

void refuse_fractions(const DepthSettlement& depth, DepthKind usual) { FractionRules(depth, usual).run(); }

}  // namespace alcove
