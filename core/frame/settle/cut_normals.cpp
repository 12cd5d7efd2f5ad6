// Tells normals that lost their components below 0.
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/base/option_words.h"
#include "core/frame/pixels/statistics.h"
#include "core/frame/samples.h"
#include "core/frame/settle/faults.h"
#include "core/frame/settle/normal_settlement.h"

namespace alcove {
namespace {

/// Normals are cut if none is below this, if by depth this part of them should be, and if this part of those is as
/// depth and the cut make them.
constexpr double kBelowZero = -1.0 / 256, kLeastNeeded = 0.02, kLeastCut = 0.8;

class CutNormals : private NormalSettlement {
 public:
  explicit CutNormals(const NormalSettlement& normals) : NormalSettlement(normals) {}

  bool settle(const std::vector<NormalScore>& scores, const NormalStatistics& statistics) {
    if (statistics.least < kBelowZero || !has_lengths(source_) || reading_.normal_unorm || source_.open.camera)
      return false;
    const NormalScore* as = nullptr;
    CutScore best;
    for (const auto& score : scores) {
      if (to_string(score.flips) != "none" || (!source_.open.normal_space && score.space != reading_.normal_space))
        continue;
      const auto cut = score_cut(score.space, planes());
      if (!cut || cut->needed < kLeastNeeded || std::max(cut->absolute, cut->clamped) < kLeastCut) continue;
      if (as && std::max(cut->absolute, cut->clamped) <= std::max(best.absolute, best.clamped)) continue;
      best = *cut;
      as = &score;
    }
    if (!as) return false;
    const std::string why = fmt::format(
        "no component of the normals ({}) is below 0, and by depth {:.0f} % of them need one: {}; save them signed or "
        "as 0.5 + 0.5 n",
        channels(), 100 * best.needed,
        best.absolute > best.clamped ? "their absolute values were saved" : "values below 0 were cut off");
    if (as->explained() < kLeastAgreement) fail(ErrorKind::input, "{}: {}; {}", path_, why, kWithout);
    if (source_.open.normal_space) {
      reading_.normal_space = as->space;
      guess("normal space", word_of(as->space), text_of(*as), "--normal-space", false);
    }
    note(NoteCode::cut_normals, why + "; " + kWithout);
    return true;
  }
};

}  // namespace

bool settle_cut_normals(const NormalSettlement& normals, const std::vector<NormalScore>& scores,
                        const NormalStatistics& statistics) {
  return CutNormals(normals).settle(scores, statistics);
}

}  // namespace alcove
