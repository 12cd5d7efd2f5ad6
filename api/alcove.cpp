// The C functions: no exception leaves them.
// SPDX-License-Identifier: BSD-3-Clause
#include "api/alcove/alcove.h"

#include <cmath>
#include <exception>
#include <new>

#include "api/session.h"
#include "core/base/version.h"

struct alcove_session {
  alcove::Session session;
  std::string error;
};

namespace {

/// Keeps the sentence, for which there may be no memory either.
void keep_error(alcove_session& handle, const char* text) noexcept {
  try {
    handle.error = alcove::in_library_words(text);
  } catch (...) {
    handle.error.clear();
  }
}

/// What the call answers; what went wrong stays with the handle.
template <class Call>
alcove_code answer(alcove_session* handle, const Call& call) noexcept {
  if (!handle) return ALCOVE_USAGE;
  try {
    call(handle->session);
    handle->error.clear();
    return ALCOVE_OK;
  } catch (const alcove::Error& error) {
    keep_error(*handle, error.what());
    return alcove_code(error.kind());
  } catch (const std::bad_alloc&) {
    keep_error(*handle, "there is no memory left");
    return ALCOVE_DEVICE;
  } catch (const std::exception& error) {
    keep_error(*handle, error.what());
    return ALCOVE_FAILED;
  }
}

/// A name that is there. Fails with ErrorKind::usage where it is null.
std::string name_in(const char* text, const char* what) {
  if (!text) alcove::fail(alcove::ErrorKind::usage, "a null {}", what);
  return text;
}

}  // namespace

alcove_session* alcove_new(void) { return new (std::nothrow) alcove_session; }

void alcove_free(alcove_session* handle) { delete handle; }

alcove_code alcove_set(alcove_session* handle, const char* option, const char* value) {
  return answer(handle, [&](auto& session) { session.set(name_in(option, "option"), value); });
}

alcove_code alcove_preset(alcove_session* handle, const char* name) {
  return answer(handle, [&](auto& session) { session.preset(name); });
}

alcove_code alcove_plane(alcove_session* handle, const char* name, const void* data, const alcove_layout* layout) {
  return answer(handle, [&](auto& session) { session.plane(name_in(name, "plane"), data, layout); });
}

alcove_code alcove_camera(alcove_session* handle, double fx, double fy, double cx, double cy,
                          const double* world_to_camera) {
  return answer(handle, [&](auto& session) { session.camera({fx, fy, cx, cy}, world_to_camera); });
}

alcove_code alcove_camera_json(alcove_session* handle, const char* text) {
  return answer(handle, [&](auto& session) { session.camera_json(text); });
}

alcove_code alcove_run(alcove_session* handle, int frame) {
  return answer(handle, [&](auto& session) { session.run(frame); });
}

int alcove_components(const alcove_session* handle, const char* aov) {
  try {
    return handle && aov ? int(handle->session.components(aov)) : 0;
  } catch (...) {
    return 0;
  }
}

alcove_code alcove_get(alcove_session* handle, const char* aov, void* data, const alcove_layout* layout) {
  return answer(handle, [&](auto& session) { session.get(name_in(aov, "result"), data, layout); });
}

double alcove_number(const alcove_session* handle, const char* name) {
  try {
    return handle && name ? handle->session.number(name) : NAN;
  } catch (...) {
    return NAN;
  }
}

const char* alcove_device(const alcove_session* handle) { return handle ? handle->session.device().c_str() : ""; }

const char* alcove_notes(const alcove_session* handle) { return handle ? handle->session.notes().c_str() : ""; }

const char* alcove_error(const alcove_session* handle) { return handle ? handle->error.c_str() : "a null handle"; }

const char* alcove_version(void) { return alcove::kVersion; }
