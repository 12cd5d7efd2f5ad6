// The passes after the visibility: shaping, colour, reflections, confidence, a smaller picture, composites, planes for
// files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"
#include "core/chain/base/planes.h"
#include "core/chain/geometry/geometry.h"
#include "core/chain/results/outputs.h"

namespace alcove {

/// Bends the AO and the planes of the radii by the settings' intensity, power, fade and least value; gives the input if
/// there is none, or nothing bends it. material_ao may be null.
Visibility shape(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility,
                 const EstimatorSettings& settings, const gpu::Buffer* material_ao, const Matte& matte = {});
/// The same for one buffer of planes. Repairs count with the first one of a frame, whose prefix is empty.
gpu::Buffer& shape(gpu::Recorder& gpu, const GBuffer& gbuffer, gpu::Buffer& planes, const EstimatorSettings& settings,
                   const gpu::Buffer* material_ao, const Matte& matte = {}, const std::string& prefix = "");

/// The mean open directions as unit vectors, packed as the normals are; without moments the normals.
gpu::Buffer& bent_normal(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* moments);

/// The nine coefficients of the reflected light, with the AO of the largest radius, in that space; with a light, planes
/// r, g, b of its reflected part. The visibility must have moments of second order, or no planes at all: then nothing
/// is blocked. `name`: of the buffer.
gpu::Buffer& transfer(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility,
                      const Matrix3& space_from_view, const std::string& name, const Environment* light = nullptr);

/// The outputs with the wanted planes of convexity, cavity and curvature of so many radii, from the last planes of the
/// moments, two for each radius.
FrameOutputs curvature(gpu::Recorder& gpu, const GBuffer& gbuffer, const Visibility& visibility, std::size_t radii,
                       const Wanted& wanted, const Matte& matte, FrameOutputs out);

/// Packed directions as planes x, y, z of that name, for the host. aov_from_view rotates them.
gpu::Buffer& directions(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& packed, const std::string& name,
                        const Matrix3& aov_from_view);

/// `open`: the mean open directions, packed as the normals are. roughness: that of the surface, 0 to 1.
gpu::Buffer& specular_occlusion(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& open,
                                const gpu::Buffer& ao, double roughness);

/// Visibility for each of red, green and blue.
gpu::Buffer& multi_bounce(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer& ao, const FrameInputs& frame);

/// The thickness of the thinnest occluders that bracket a visibility, in radii.
inline constexpr double kThin = 0.02;

/// The settings of the two estimates, by slices and steps at full resolution, that bracket the AO of any estimator.
EstimatorSettings bracket_of(const EstimatorSettings& settings);

/// Makes a plane in [0, 1], for the largest radius and any estimator: see confidence.comp.
gpu::Buffer& confidence(gpu::Recorder& gpu, const GBuffer& gbuffer, const FrameInputs& frame,
                        const EstimatorSettings& settings);

/// The number of pixels beyond a part of a frame that count for it; 0 with the factor 1.
int reduce_reach(const PixelFilter& filter, int factor);

/// Filters amounts and directions, as renderers filter their samples, if the frame is larger than its picture: all
/// pixels of a block then have the picture's value. Depths stay.
FrameOutputs reduce(gpu::Recorder& gpu, const FrameInputs& frame, const PixelFilter& filter, const FrameOutputs& out);

/// The beauty's planes, for the host; null if the frame has no beauty. `ao` has one plane, or three with multi-bounce.
/// It dims the lights of frame.ambient; without any, the whole beauty. `shadow` has a plane for each of frame.lights,
/// which dims the lights that name it; may be null. The look's gain takes no AO below `least`.
gpu::Buffer* composite(gpu::Recorder& gpu, const GBuffer& gbuffer, const gpu::Buffer* ao, const gpu::Buffer* shadow,
                       const FrameInputs& frame, const CompositeLook& look, double least);

}  // namespace alcove
