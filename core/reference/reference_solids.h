// Which neighbours on a slice show one surface, and how far back behind its front it is solid: the rules of
// docs/completion.md, by the normals of the first surfaces.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/reference/reference_slice.h"

namespace alcove {

/// The rules at one side of a slice. Its arguments must outlive it.
class ReferenceSolids {
 public:
  ReferenceSolids(const ReferenceScene& scene, const ReferenceReceiver& receiver, const ReferenceSide& side,
                  const ReferenceSettings& settings)
      : scene_(scene), receiver_(receiver), side_(side), settings_(settings) {}

  /// Whether two samples of neighbouring steps, the nearer step first, are one surface. is_own: it is the receiver's.
  bool connect(const ReferenceLine& line, int a, int b, bool is_own) const;

  /// Whether a run that holds two samples is so long that no more of its width counts, and its other end tells nothing.
  bool is_long(const ReferenceLine& line, int first, int last) const;

  /// Sets the thickness of the samples of a run that is not the receiver's, by its width and by how far back it is seen
  /// to reach, and adds the hidden face that closes it towards the receiver.
  void thicken(ReferenceLine& line, const std::vector<int>& run) const;

  /// That of a run that may be the receiver's own, but is not sure to be: by its width alone.
  double thickness_of_rest(const ReferenceLine& line, const std::vector<int>& run) const {
    return by_width(line, run, false);
  }

 private:
  /// Rules hold for `auto`, and between first surfaces: others have no normals.
  bool has_normals(const ReferenceLine& line, int a, int b) const;
  bool are_coplanar(const ReferenceSample& a, const ReferenceSample& b, double least_dot, double most_pixels) const;
  bool are_parallel(const ReferenceSample& a, const ReferenceSample& b) const;
  bool meet_at_edge(const ReferenceLine& line, int a, int b) const;
  bool comes_to(const ReferenceSample& far, const ReferenceSample& near) const;
  /// The first surface of the pixel one step from a sample, away from the receiver (way 1) or towards it (-1).
  ReferenceSample first_beside(const ReferenceLine& line, int sample, int way) const;
  /// Whether three samples are first surfaces, and in one plane.
  bool is_flat(const ReferenceLine& line, int a, int b, int c) const;
  bool hides(const ReferenceLine& line, int first) const;
  double pixels_at(double depth) const;
  double distance_from_eye(const ReferenceSample& sample) const;
  Vector in_slice(Vector normal) const;
  /// The width that counts at most of the run that begins with a sample, in scene units.
  double widest(const ReferenceLine& line, int first) const;
  bool mirrors(const ReferenceLine& line, const std::vector<int>& run) const;
  double by_width(const ReferenceLine& line, const std::vector<int>& run, bool may_be_flat = true) const;
  double reaches_back(const ReferenceLine& line, int i, const std::vector<int>& run) const;
  void close(ReferenceLine& line, const std::vector<int>& run) const;

  const ReferenceScene& scene_;
  const ReferenceReceiver& receiver_;
  const ReferenceSide& side_;
  const ReferenceSettings& settings_;
};

}  // namespace alcove
