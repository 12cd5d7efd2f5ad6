// Finds settings that contradict each other, and names the option that mends each.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/options/check.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/estimator_facts.h"
#include "core/chain/aov.h"
#include "core/chain/debug_view.h"
#include "core/frame/input_files.h"
#include "core/options/said.h"

namespace alcove {
namespace {

// Each scale costs a search and a plane of its own.
constexpr std::size_t kMostRadii = 8;

/// Only an estimate by its error knows that error.
void check_tolerance(const Settings& settings) {
  const auto& e = settings.estimator;
  if (e.tolerance == 0 && wants(settings.output, &FrameOutputs::error))
    fail(ErrorKind::usage, "--aov error: only an estimate with a --tolerance knows its error");
}

/// An exact search leaves out no tiles.
void check_search(const Settings& settings) {
  const auto& e = settings.estimator;
  if (!searches_exactly(e)) return;
  for (const auto* view : debug_views_of(settings.output))
    if (view->source == DebugSource::tiles)
      fail(ErrorKind::usage, "--set debug=tiles: an exact search leaves out none; --search steps does");
}

/// A view of what is completed needs something that is.
void check_completion(const Settings& settings) {
  const auto& e = settings.estimator;
  const auto views = debug_views_of(settings.output);
  const bool is_shown = std::ranges::find(views, DebugSource::completed, &DebugView::source) != views.end();
  if (!is_shown || completes_anywhere(e)) return;
  if (e.complete == Completion::none)
    fail(ErrorKind::usage,
         "--set debug=completed: with --set complete=none nothing is; border and all complete surfaces");
  fail(ErrorKind::usage, "--set debug=completed: --estimator {} completes no surfaces; gtao and bitmask do",
       e.estimator == Estimator::hbao ? "hbao" : "crytek");
}

/// Whether a view shows how one frame is estimated.
bool is_of_estimate(DebugSource source) {
  return source == DebugSource::tiles || source == DebugSource::completed || source == DebugSource::sites ||
         source == DebugSource::raw_ao || source == DebugSource::denoised_ao;
}

/// A mean of many frames has no tiles, sites or guesses of one.
void check_accumulation(const Settings& settings) {
  if (settings.input.accumulate == 0) {
    for (const auto* view : debug_views_of(settings.output))
      if (view->source == DebugSource::count)
        fail(ErrorKind::usage, "--set debug=count: a frame is its own estimate; --accumulate takes those of others");
    return;
  }
  for (const auto* view : debug_views_of(settings.output))
    if (is_of_estimate(view->source))
      fail(ErrorKind::usage,
           "--set debug={}: it shows the estimate of one frame, and with --accumulate the AO is the mean of many: "
           "leave one "
           "of them out",
           view->name);
}

/// What shows hidden surfaces needs some that are kept.
void check_hidden(const Settings& settings) {
  const auto views = debug_views_of(settings.output);
  const bool is_drawn = std::ranges::find(views, DebugSource::hidden, &DebugView::source) != views.end();
  const char* const option = wants(settings.output, &FrameOutputs::hidden) ? "--aov "
                             : is_drawn                                    ? "--set debug="
                                                                           : nullptr;
  if (!option) return;
  if (settings.estimator.hidden == 0) fail(ErrorKind::usage, "{}hidden: with --set hidden=0 nothing is kept", option);
  if (!has_hidden_sources(settings.input))
    fail(ErrorKind::usage, "{}hidden: nothing says what is hidden: --behind, --deep, --around and --set other-views do",
         option);
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
    fail(ErrorKind::usage, "--radius: there are {} of them; a run takes at most {}", radii.size(), kMostRadii);
  if (const auto twice = std::ranges::adjacent_find(radii); twice != radii.end())
    fail(ErrorKind::usage, "--radius {} is there twice: give each scale once", *twice);
}

/// Numbers that have an order, or a range of their own beside others.
void check_numbers(const EstimatorSettings& e) {
  if (e.fade_start && e.fade_end && *e.fade_end <= *e.fade_start)
    fail(ErrorKind::usage, "--set fade-end={} is not beyond --set fade-start={}", *e.fade_end, *e.fade_start);
  if (e.estimator != Estimator::crytek && e.bias >= 1)
    fail(ErrorKind::usage, "--set bias={}: of every estimator but crytek it is the sine of an elevation, below 1",
         e.bias);
  if (e.falloff_end <= e.falloff_start)
    fail(ErrorKind::usage, "--set falloff-end={} is not above --set falloff-start={}", e.falloff_end, e.falloff_start);
}

}  // namespace

void check_settings(const Settings& settings) {
  if (settings.output.output.empty()) fail(ErrorKind::usage, "no output: name the AO file with -o FILE.exr");
  if (main_input(settings.input).empty())
    fail(ErrorKind::usage, "no input: name an EXR file, or one with --depth or --position");
  if (!settings.estimator.radius && !settings.estimator.radius_auto && needs_ao(settings.output))
    fail(ErrorKind::usage, "no radius: say with --radius how far occluders reach, in scene units");
  require_effects(settings);
  check_tolerance(settings);
  check_search(settings);
  check_completion(settings);
  check_accumulation(settings);
  check_hidden(settings);
  check_scales(settings);
  check_numbers(settings.estimator);
  if (settings.frames.chunk > settings.frames.chunks)
    fail(ErrorKind::usage, "--chunk {}/{}: there is no such chunk", settings.frames.chunk, settings.frames.chunks);
}

}  // namespace alcove
