// Alcove as a C library: ambient occlusion of one frame, from planes in memory and into planes in memory.
// SPDX-License-Identifier: BSD-3-Clause
//
//     alcove_session *ao = alcove_new();
//     alcove_layout one = {1920, 1080, 1, ALCOVE_FLOAT, 0, 0, 0};
//     alcove_set(ao, "radius", "0.5");
//     alcove_set(ao, "fov", "40");
//     alcove_plane(ao, "depth", depth, &one);
//     if (alcove_run(ao, 0) || alcove_get(ao, "ao", result, &one)) fprintf(stderr, "%s\n", alcove_error(ao));
//     alcove_free(ao);
//
// The library reads no files except presets, which are compiled in, and writes none; drivers keep compiled kernels in
// caches of their own. It leaves locale, environment and signals alone, and prints nothing unless "validate" asks for
// it. Handles are independent: one thread at a time may use a handle, and several threads may use one each. A forked
// process cannot use the handles of its parent. A handle keeps its device, kernels and buffers, so only the first run
// takes some tenths of a second more.
//
// Conventions are those of the program: view space is right-handed, x right, y up, and the camera looks along -z; depth
// is positive; AO is visibility, 1 = open. A pixel is sky if its depth is 0, infinite, NaN, or at least the option
// "sky"; its AO is 1.
#ifndef ALCOVE_ALCOVE_H
#define ALCOVE_ALCOVE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef _MSC_VER
#define ALCOVE_API
#else
#define ALCOVE_API __attribute__((visibility("default")))
#endif

// The answer of a function: 0, or the kind of its failure, by the program's exit codes. alcove_error() has the
// sentence. A call that fails changes nothing, neither in the handle nor in the caller's memory, except that a failed
// run drops the results of an earlier one. The handle stays usable.
typedef enum alcove_code {
  ALCOVE_OK = 0,
  ALCOVE_FAILED = 1,  // a mistake of Alcove's own
  ALCOVE_USAGE = 2,   // an unknown or wrong option or argument, or one that contradicts another
  ALCOVE_INPUT = 3,   // planes or a camera that make no sense
  ALCOVE_DEVICE = 5   // no device, too little of its memory, or a lost device
} alcove_code;

typedef enum alcove_type { ALCOVE_FLOAT = 0, ALCOVE_HALF = 1 } alcove_type;

// The layout of a plane in memory, its upper left pixel first. Strides are in bytes; 0: packed, with the components of
// a pixel beside each other. They may be negative, and need not be multiples of a value's size; none is 128 GiB or
// more. No two values may share bytes. A side has at most 2^24 pixels, and a plane 2^32 values.
typedef struct alcove_layout {
  int width, height;  // px
  int components;
  int type;  // alcove_type
  ptrdiff_t pixel_stride, row_stride, component_stride;
} alcove_layout;

// A frame with its settings.
typedef struct alcove_session alcove_session;

// Makes a handle with the default settings; null if there is no memory. The first run opens the device.
ALCOVE_API alcove_session* alcove_new(void);
// Frees a handle; it may be null.
ALCOVE_API void alcove_free(alcove_session* handle);

// Sets an option by its long name, such as "radius"; docs/options.md lists all. Values are the words of the command
// line, several with commas ("0.1,0.5"); a flag is "true" or "false". Null resets the option. The library does not take
// options that name files, frames or reports. alcove_run() checks whether options go together.
ALCOVE_API alcove_code alcove_set(alcove_session* handle, const char* option, const char* value);
// Adds a preset by its name: draft, standard, production, reference, or one of source/. Options of alcove_set() win
// over presets, and later presets over earlier ones. Null removes all presets.
ALCOVE_API alcove_code alcove_preset(alcove_session* handle, const char* name);

// Sets a plane, which is copied. All planes of a frame have one size. Null data removes the plane. Names:
//   depth        1 component, of depth-kind, planar by default; distances above 0, other kinds within 0 to 1. Integers
//                must be converted: 16 bits are few for distances, and 8 bits are refused
//   position     3, instead of a depth; in position-space, which must be set if the camera has a position
//   normal       3, or 2 by normal-encoding, signed by default; in normal-space, which must be set unless the
//                camera has no position or a camera file says it; without this plane, normals come from depth
//   behind       1, depth behind the first surface, of behind-kind; each call adds one, at most 8
//   material-ao  1, multiplied in
//   matte        1, 0 to 1: where AO is wanted
//   occluders    1, 0 to 1: only these block;  ignore: these do not
//   albedo       3, for multi-bounce with ao-channels rgb
ALCOVE_API alcove_code alcove_plane(alcove_session* handle, const char* name, const void* data,
                                    const alcove_layout* layout);

// Sets a perspective camera: focal lengths and principal point in px of the planes from their upper left corner, and
// world_to_camera, four rows of four for column vectors, a rotation with a translation; null for none. Without a
// camera, the options fov, vertical-fov, focal with aperture, focal-px, or ortho-width give one whose axis is in the
// middle. alcove_run() checks it.
ALCOVE_API alcove_code alcove_camera(alcove_session* handle, double fx, double fy, double cx, double cy,
                                     const double* world_to_camera);
// Sets the camera by the text of a camera file, which also tells orthographic cameras, left-handed ones, near and far,
// and the kinds of depth and normals: docs/camera.schema.json. Null removes the camera.
ALCOVE_API alcove_code alcove_camera_json(alcove_session* handle, const char* text);

// Computes the results that the option "aov" names: "ao" by default. `frame`, the number of the frame, picks the entry
// of a camera file's `frames`, and seeds noise animated. Checks the pixels as the program does: it measures the
// rounding of depth, and fails if the pixels contradict depth, normals or camera. alcove_notes() has the doubts.
ALCOVE_API alcove_code alcove_run(alcove_session* handle, int frame);
// Gives the number of components of a result of the last run; 0 if there is none of that name.
ALCOVE_API int alcove_components(const alcove_session* handle, const char* aov);
// Copies a result of the last run into a plane with its size and its number of components. The plane may overlap planes
// that were given to alcove_plane().
ALCOVE_API alcove_code alcove_get(alcove_session* handle, const char* aov, void* data, const alcove_layout* layout);
// Gives a number of the last run: compute-ms (of the device, 0 if it has no clock), sky-pixels, repaired-depth and
// repaired-normals (pixels that made no sense), turned-normals (pixels whose normals faced away from the eye), radius.
// NaN if there is none of that name.
ALCOVE_API double alcove_number(const alcove_session* handle, const char* name);
// Gives the doubts about the last run if it did not fail, one sentence per line, as the program's notes: depth that was
// rounded, averaged or jittered, or that looks like another kind; a sky that is a number; normals that disagree with
// the depth; a radius too small for the depth's precision or larger than the picture. "" without doubts. The text stays
// until the next run.
ALCOVE_API const char* alcove_notes(const alcove_session* handle);
// Gives the name of the open device; "" if none is open.
ALCOVE_API const char* alcove_device(const alcove_session* handle);

// Gives the failure of the last call that failed, in one sentence; "" if none has. It stays until the next call that
// answers with a code. Sentences have options and planes in single quotes: 'depth-kind'.
ALCOVE_API const char* alcove_error(const alcove_session* handle);
// Gives the library's version, such as "0.2.0".
ALCOVE_API const char* alcove_version(void);

#ifdef __cplusplus
}
#endif

#endif
