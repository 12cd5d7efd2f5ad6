// Finds settings that contradict each other, and names the option that mends each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/check.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/debug_view.h"

namespace alcove {
namespace {

// Each scale costs a search and a plane of its own.
constexpr std::size_t kMostRadii = 8;

/// An estimate by its error is a mean over exact searches of every pixel.
void check_tolerance(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.tolerance == 0) {
    if (wants(settings.output, &FrameOutputs::error))
      fail(ErrorKind::usage, "--aov error: only an estimate with a --tolerance knows its error");
    return;
  }
  if (e.estimator != Estimator::gtao) fail(ErrorKind::usage, "--tolerance: only of --estimator gtao");
  if (e.resolution != Resolution::full)
    fail(ErrorKind::usage, "--tolerance: the error is that of every pixel: give --resolution full");
}

/// Leaving out nearly open tiles needs a proof, which only two estimators have.
void check_skipping(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.skip_tolerance == 0) return;
  if (searches_exactly(e))
    fail(ErrorKind::usage, "--skip-tolerance: an exact search leaves out nothing; --search steps does");
  if (e.estimator != Estimator::gtao && e.estimator != Estimator::bitmask)
    fail(ErrorKind::usage,
         "--skip-tolerance: only of --estimator gtao and bitmask, whose AO is weighted by the cosine");
  if (e.no_skip) fail(ErrorKind::usage, "--skip-tolerance and --no-skip: give only one of them");
}

/// An exact search has no samples: it knows no fading hits and no pixels left out.
void check_search(const Settings& settings) {
  const auto& e = settings.estimator;
  if (!searches_exactly(e)) return;
  for (const auto* view : debug_views_of(settings.output))
    if (view->source == DebugSource::tiles)
      fail(ErrorKind::usage, "--debug tiles: an exact search leaves out none; --search steps does");
  if (e.falloff != Falloff::none)
    fail(ErrorKind::usage,
         "--falloff: in an exact search all within the radius blocks fully; give --falloff none or --search steps");
  if (e.stride > 1)
    fail(ErrorKind::usage, "--stride {}: an exact search is made at every pixel; give --stride 1 or --search steps",
         e.stride);
}

/// A view of what is completed needs something that is.
void check_completion(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto views = debug_views_of(settings.output);
  const bool is_shown = std::ranges::find(views, DebugSource::completed, &DebugView::source) != views.end();
  if (!is_shown || completes_anywhere(e)) return;
  if (e.complete == Completion::none)
    fail(ErrorKind::usage, "--debug completed: with --complete none nothing is; border and all complete surfaces");
  fail(ErrorKind::usage, "--debug completed: --estimator {} completes no surfaces; gtao and bitmask do",
       e.estimator == Estimator::hbao ? "hbao" : "crytek");
}

/// Several radii make sense once each; bent normals need an estimator that finds open directions.
void check_scales(const Settings& settings) {
  const auto& e = settings.estimator;
  if (wants(settings.output, &FrameOutputs::bent_normal) && !searches_slices(e))
    fail(ErrorKind::usage, "--aov bent-normal: --estimator {} finds no open directions; gtao and bitmask do",
         e.estimator == Estimator::hbao ? "hbao" : "crytek");
  if (e.further_radii.empty()) return;
  const auto radii = radii_of(e);
  if (radii.size() > kMostRadii)
    fail(ErrorKind::usage, "--radius: there are {}, and at most {} scales", radii.size(), kMostRadii);
  if (const auto twice = std::ranges::adjacent_find(radii); twice != radii.end())
    fail(ErrorKind::usage, "--radius {} is there twice: give each scale once", *twice);
}

/// Options of the fade, the albedo and the fog, each with what it is useless without.
void check_shading(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto& o = settings.output;
  if (e.fade_start.has_value() != e.fade_end.has_value())
    fail(ErrorKind::usage, "--fade-start and --fade-end belong together: depths in scene units");
  if (e.fade_end && *e.fade_end <= *e.fade_start)
    fail(ErrorKind::usage, "--fade-end {} is not beyond --fade-start {}", *e.fade_end, *e.fade_start);
  const bool has_albedo =
      !settings.input.albedo.empty() || settings.input.albedo_value || !settings.input.albedo_channels.empty();
  if (has_albedo && !o.multi_bounce)
    fail(ErrorKind::usage, "--albedo and --albedo-channels are for --multi-bounce: give it too");
  if (o.multi_bounce && o.composite.empty() && !wants(o, &FrameOutputs::color_ao))
    fail(ErrorKind::usage,
         "--multi-bounce shows in the AO with --ao-channels rgb, and in a --composite: ask for one of them");
  if (o.fog_density > 0 && o.composite.empty())
    fail(ErrorKind::usage, "--fog-density is for a composite: name its file with --composite");
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (settings.input.input.empty() && settings.input.depth.empty() && settings.input.position.empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.input.depth.empty() && !settings.input.position.empty())
    fail(ErrorKind::usage, "--depth and --position are two ways to say the same: give one");
  if (!settings.estimator.radius && needs_ao(settings.output))
    fail(ErrorKind::usage, "no radius: say with --radius how far occluders reach, in scene units");
  check_tolerance(settings);
  check_skipping(settings);
  check_search(settings);
  check_completion(settings);
  check_scales(settings);
  if (settings.estimator.estimator != Estimator::crytek && settings.estimator.bias >= 1)
    fail(ErrorKind::usage, "--bias {}: of every estimator but crytek it is the sine of an elevation, below 1",
         settings.estimator.bias);
  if (settings.estimator.falloff_end <= settings.estimator.falloff_start)
    fail(ErrorKind::usage, "--falloff-end {} is not above --falloff-start {}", settings.estimator.falloff_end,
         settings.estimator.falloff_start);
  if (settings.estimator.stride > 1 && settings.estimator.denoise != Denoise::bilateral)
    fail(ErrorKind::usage, "--stride {} leaves pixels to the denoiser: give --denoise bilateral, or --stride 1",
         settings.estimator.stride);
  if (settings.input.focal.has_value() != settings.input.aperture.has_value())
    fail(ErrorKind::usage, "--focal and --aperture belong together: focal length and width of the film back in mm");
  if (!settings.input.beauty.empty() && settings.output.composite.empty() && !settings.output.multi_bounce)
    fail(ErrorKind::usage, "--beauty is for a composite: name its file with --composite");
  check_shading(settings);
  if (settings.frames.chunk > settings.frames.chunks)
    fail(ErrorKind::usage, "--chunk {}/{}: there is no such chunk", settings.frames.chunk, settings.frames.chunks);
}

}  // namespace alcove
