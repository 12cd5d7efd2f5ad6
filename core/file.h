// Files as wholes: text in; bytes out, complete or not at all.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

namespace alcove {

/// Fails with ErrorKind::input unless `path` is a readable file; `what` and `option` are for the message ("camera", "--camera").
void require_readable(const std::string& path, const char* what, const char* option);

/// The whole file. Fails with ErrorKind::input.
std::string read_text(const std::string& path, const char* what, const char* option);

/// Fails with ErrorKind::output unless a file can be made at `path`: its folder exists and is writable, and nothing but
/// a regular file stands there. Called before any work, so that a long job does not fail at its end.
void require_writable(const std::string& path, const char* option);

/// Writes a temporary file beside `path` and renames it when it is complete. On failure (ErrorKind::output) nothing of it
/// is left and what was at `path` is as it was.
void write_whole(const std::string& path, std::span<const char> bytes);

}  // namespace alcove
