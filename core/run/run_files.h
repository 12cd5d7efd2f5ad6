// The files of a run: what is read of each frame, and the outputs, which are checked before any work.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/options/files.h"
#include "core/run/plan.h"

namespace alcove {

/// Whether the preview is the composite as a display shows it, and not the AO as data.
bool shows_composite(const OutputSettings& output);

/// All files that a frame is made from: those that options name, and those that follow from them, which are manifests
/// of Cryptomattes and the configuration of the display, but not the tables that it names. Opens files with
/// Cryptomattes; one that cannot be read has no manifest.
std::vector<NamedFile> inputs_of(const Settings& frame);

/// Adds the inputs of the frames of all chunks, of the frames around them, and of all that are on the disk: each may be
/// computed by a run of its own.
void add_inputs(FileUses& uses, const FramePlan& plan);

/// Adds all that the run writes. `run` names it in messages where there are several.
void add_outputs(FileUses& uses, const FramePlan& plan, const std::string& run = "");

/// Fails with ErrorKind::usage where the run would write a file that it reads, or one file twice.
void refuse_overwriting(const FramePlan& plan);

/// Fails with ErrorKind::output where an output cannot be made. Removes unfinished files that killed runs have left
/// beside the outputs.
void prepare_outputs(const FramePlan& plan);

/// Fails with ErrorKind::usage where the name of an output does not end as its format does.
void require_endings(const OutputSettings& output);

/// Makes the folders of these files, unless the settings say not to. Fails with ErrorKind::output.
void make_folders(const std::vector<NamedFile>& files, const OutputSettings& settings);

/// The folders of a run's files that are not there before it. The destructor removes those that are empty, so that
/// nothing is left of a run that is refused only once its frames are read.
class NewFolders {
 public:
  explicit NewFolders(const FramePlan& plan);
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

 private:
  std::set<std::string> folders_;  // what lies in another one comes after it
};

}  // namespace alcove
