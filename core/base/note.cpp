// The table of codes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/note.h"

#include <algorithm>
#include <iterator>

#include "core/base/text.h"

namespace alcove {
namespace {

using enum NoteCode;

constexpr NoteFacts kTable[] = {
    {unusual_reading, "unusual-reading", true, "the pixels decided for another reading than the usual one"},
    {assumed_reading, "assumed-reading", false,
     "neither the pixels nor the program show how the frame is read, so the usual reading is taken"},
    {proven_reading, "proven-reading", false, "the pixels prove another reading than the usual one"},
    {said_otherwise, "said-otherwise", true, "the pixels contradict an option or file"},
    {near_plane, "near-plane", true, "two sources give different near planes"},
    {negative_depth, "negative-depth", false, "all depth is below 0 and is read as a distance"},
    {depth_below_1, "depth-below-1", true, "all depth lies within 0 to 1 and may be normalized"},
    {finite_sky, "finite-sky", false, "one distance far behind all others may be the sky"},
    {beyond_planes, "beyond-planes", false, "normalized depth goes on beyond its planes"},
    {default_view, "default-view", false, "a stereo file's default view is taken"},
    {several_objects, "several-objects", false, "a pattern stands for several objects"},
    {normals_disagree, "normals-disagree", true, "the normals do not agree with the depth"},
    {principal_point, "principal-point", false, "no pixel shows whether the picture's centre is right"},
    {field_of_view, "field-of-view", true, "another camera fits the normals or the positions better"},
    {positions_disagree, "positions-disagree", true, "the positions beside the depth do not agree with it"},
    {camera_scaled, "camera-scaled", false, "the camera file is for another resolution"},
    {no_surfaces, "no-surfaces", true, "no pixel shows a surface"},
    {holes_in_depth, "holes-in-depth", true, "surfaces have holes, which count as sky"},
    {enlarged_depth, "enlarged-depth", true, "depth was enlarged by repeating pixels"},
    {smoothed_depth, "smoothed-depth", true, "depth was blurred or interpolated"},
    {noisy_depth, "noisy-depth", true, "depth is noisy all over the picture"},
    {half_depth, "half-depth", true, "depth values are as coarse as half floats, or coarser"},
    {overflown_depth, "overflown-depth", true,
     "surfaces beyond the largest half float became infinite, and count as sky"},
    {jittered_depth, "jittered-depth", true, "depth was sampled beside the pixels' centres"},
    {letterbox_bars, "letterbox-bars", true, "rows or columns along two opposite borders are empty, and count as sky"},
    {part_of_picture, "part-of-picture", true, "the picture is only a part of the file's pixels"},
    {missing_tile, "missing-tile", true, "a rectangle was not rendered, and counts as sky"},
    {depth_offset, "depth-offset", true, "depth does not count from the eye"},
    {depth_curve, "depth-curve", true, "depth went through a curve, such as a gamma or a logarithm"},
    {clamped_depth, "clamped-depth", true, "depth was clamped at a largest value"},
    {wrapped_depth, "wrapped-depth", true, "depth began at 0 again beyond its range"},
    {displaced_normals, "displaced-normals", true,
     "along outlines the normals belong to another surface than the depth"},
    {antialiased_depth, "antialiased-depth", true, "depth was averaged over edges"},
    {shortened_normals, "shortened-normals", true, "normals were averaged over pixels"},
    {averaged_normals, "averaged-normals", false, "normals were averaged over pixels, as the program always does"},
    {scaled_normals, "scaled-normals", false, "normals have another length than 1, and their direction counts"},
    {cut_normals, "cut-normals", true, "normals lost their components below 0"},
    {lossy_compression, "lossy-compression", true, "a codec has damaged data"},
    {damaged_file, "damaged-file", true, "a part of a file cannot be read"},
    {windows_differ, "windows-differ", false, "parts, data and display windows differ"},
    {radius_below_precision, "radius-below-precision", true, "the radius is near the depth's precision"},
    {radius_below_pixel, "radius-below-pixel", true, "the radius is less than a pixel"},
    {radius_beyond_picture, "radius-beyond-picture", true, "the radius is larger than the picture"},
    {empty_layer, "empty-layer", false, "a layer of hidden surfaces has none"},
    {nothing_hidden, "nothing-hidden", true, "a layer of hidden surfaces shows nothing new"},
    {before_first, "before-first", true, "a layer of hidden surfaces lies before the first one"},
    {repaired_samples, "repaired-samples", true, "deep samples with impossible values were repaired",
     InHeader::meaning},
    {repaired_depth, "repaired-depth", true, "pixels had no usable depth", InHeader::meaning},
    {repaired_normals, "repaired-normals", true, "pixels had no usable normal", InHeader::meaning},
    {turned_normals, "turned-normals", false, "normals that faced away from the eye were turned round",
     InHeader::meaning},
    {repaired_material_ao, "repaired-material-ao", true, "pixels had no usable material AO", InHeader::meaning},
    {repaired_beauty, "repaired-beauty", true, "pixels had no usable beauty", InHeader::meaning},
    {transparent_beauty, "transparent-beauty", true, "alpha is 0 everywhere, so nothing is dimmed"},
    {negative_composite, "negative-composite", true, "the composite is far below 0 where the beauty is not"},
    {no_normals, "no-normals", false, "normals were reconstructed from depth"},
    {unused_input, "unused-input", true, "no channel of INPUT is used, and there are no normals"},
    {unread_ranks, "unread-ranks", false, "a Cryptomatte has more ranks than are read"},
    {no_indirect_light, "no-indirect-light", true, "the composite dims direct light too"},
    {light_passes, "light-passes", true, "the light passes do not add up to the beauty"},
    {sun_in_sky, "sun-in-sky", true, "nine colours do not hold the light of the sky"},
    {dark_light, "dark-light", true, "a light reaches no surface, or is below the horizon"},
    {far_lamp, "far-lamp", false, "a lamp is far beyond all surfaces"},
    {device_memory, "device-memory", false, "the device had too little memory at first"},
    {in_parts, "in-parts", false, "the frame was too large to compute at once", InHeader::nothing},
    {no_gpu, "no-gpu", false, "there is no GPU, so the CPU computed"},
    {sequence_hole, "sequence-hole", true, "numbers are left out between the frames on the disk", InHeader::nothing},
    {frame_number, "frame-number", false, "the number in a file's name chose the camera"},
    {other_frame, "other-frame", true, "the number in a file's name is that of another frame"},
    {automatic_radius, "automatic-radius", false, "the radius was chosen by the frame"},
    {computed_again, "computed-again", false, "why --resume computes frames that are there"},
    {ao_layer, "ao-layer", false, "the AO of a comparison was found by its layer's name"},
    {sky_differs, "sky-differs", true, "sky of 0 against 1 decides a comparison"},
    {holes, "holes", true, "pixels of a comparison are NaN or infinite in one file only"},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < std::size(kTable); i++)
    if (std::size_t(kTable[i].code) != i) return false;
  return true;
}
static_assert(is_in_order());

}  // namespace

std::span<const NoteFacts> note_table() { return kTable; }

const NoteFacts& facts_of(NoteCode code) { return kTable[std::size_t(code)]; }

const char* level_of(const Note& note) { return facts_of(note.code).is_warning ? "warning" : "note"; }

std::string line_of(const Note& note, const std::string& frame) {
  std::string line = note.file.empty() ? frame : note.file;
  if (!line.empty()) line += ": ";
  return line.append(note.text).append(" [").append(facts_of(note.code).name).append("]");
}

void add_new(Notes& notes, const Notes& more) {
  for (const auto& note : more)
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
}

Notes warnings_of(Notes notes) {
  std::erase_if(notes, [](const Note& note) { return !facts_of(note.code).is_warning; });
  return notes;
}

bool is_listed(NoteCode code, const std::string& codes) {
  const auto listed = split(codes);
  return std::ranges::find(listed, facts_of(code).name) != listed.end();
}

std::vector<std::string> texts_of(const Notes& notes) {
  std::vector<std::string> texts;
  for (const auto& note : notes) texts.push_back(note.text);
  return texts;
}

std::string header_text(const Notes& notes) {
  std::string text;
  for (const auto& note : warnings_of(notes)) {
    const NoteFacts& facts = facts_of(note.code);
    if (facts.in_header == InHeader::nothing) continue;
    if (!text.empty()) text += '\n';
    text += std::string(facts.name) + ": " + (facts.in_header == InHeader::text ? note.text : facts.meaning);
  }
  return text;
}

}  // namespace alcove
