// The usual mistakes of cameras, each undone and tried on the normals.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/frame/pixels/normal_scores.h"

namespace alcove {

/// A tried camera, its score, and the given camera's fault if the tried one is right.
struct OtherCamera {
  std::string what;  // the sentence with the remedy, without a full stop
  NormalScore score;
};

/// Gives the best of the usual mistakes by which a camera turns the world or the picture: the inverse of its matrix,
/// axes of another convention, another axis up, angles in another order, a picture that is upside down. None if too
/// little of the frame is smooth, or if even then some normals disagree. `as` is the tried reading of the normals.
std::optional<OtherCamera> best_turned_camera(const NormalPlanes& planes, const NormalScore& as);

/// Gives the camera, turned by a small angle within the normals' world so that all of them agree. In view space this
/// world is the given camera's own. None if too little of the frame is smooth.
std::optional<OtherCamera> slightly_turned_camera(NormalPlanes planes, const NormalScore& as);

/// Gives the best of the orders in which the angles of a .chan file may turn the camera; none for other cameras, and
/// for normals in view space.
std::optional<OtherCamera> best_other_rotation(const NormalPlanes& planes, const NormalScore& as);

/// Gives the best of the cameras with the principal point on the other side of the picture's centre, by x, by y or by
/// both, or in the centre.
std::optional<OtherCamera> best_other_point(const NormalPlanes& planes, const NormalScore& as);

/// The score with pixels as high as wide.
std::optional<NormalScore> square_pixels(NormalPlanes planes, const NormalScore& as);

/// Gives the best of a few wider and narrower fields of view; none for an orthographic camera.
std::optional<OtherCamera> best_other_width(const NormalPlanes& planes, const NormalScore& as);

/// Whether the principal point is so far from the picture's centre that it matters on which side.
bool is_off_centre(const Camera& camera);

}  // namespace alcove
