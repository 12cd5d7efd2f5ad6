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
// It reads no files but presets, which are compiled in; writes none but the driver's compiled kernels in the XDG cache
// folder ("no-pipeline-cache" leaves them out); changes neither locale, environment nor signals; and prints nothing
// unless "validate" asks for it. Handles know nothing of each other: each may be used by one thread at a time, several
// by several threads, and none is of use in a process that was forked meanwhile. A handle keeps its device, kernels and
// buffers, so the first run takes some tenths of a second more than others.
//
// Conventions are those of the program: view space is right-handed, x right, y up, and the camera looks along -z; depth
// is positive; AO is visibility, 1 = open. Where there is no surface depth is 0, infinite, NaN, or at or beyond the
// option "sky"; the AO is 1 there.
#ifndef ALCOVE_ALCOVE_H
#define ALCOVE_ALCOVE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ALCOVE_API __attribute__((visibility("default")))

// What a function answers: 0, or why it failed, by the program's exit codes. alcove_error() has the sentence. A call
// that fails changes nothing, but that the results of an earlier run are gone when a run fails.
typedef enum alcove_code {
  ALCOVE_OK = 0,
  ALCOVE_FAILED = 1,  // a mistake of Alcove's own
  ALCOVE_USAGE = 2,   // an option or an argument that is none, or contradicts another
  ALCOVE_INPUT = 3,   // planes or a camera that make no sense
  ALCOVE_DEVICE = 5   // no device, no memory of it, or it was lost
} alcove_code;

typedef enum alcove_type { ALCOVE_FLOAT = 0, ALCOVE_HALF = 1 } alcove_type;

// How a plane lies in memory, its upper left pixel first. Strides are in bytes, and may be negative; 0: packed, the
// components of a pixel beside each other.
typedef struct alcove_layout {
  int width, height;  // px
  int components;
  int type;  // alcove_type
  ptrdiff_t pixel_stride, row_stride, component_stride;
} alcove_layout;

// A frame in work, with its settings.
typedef struct alcove_session alcove_session;

// Gives a handle that has the default settings; null without memory. The device is opened by the first run.
ALCOVE_API alcove_session* alcove_new(void);
// Null is fine.
ALCOVE_API void alcove_free(alcove_session* handle);

// Sets an option by its long name, such as "radius" or "--radius"; docs/options.md lists all. Words are those of the
// command line; of several values they stand with commas ("0.1,0.5"); a flag is "true" or "false"; null: as if it had
// never been set. Options that name files, frames or reports are none of the library's. Whether options go together
// is told by alcove_run().
ALCOVE_API alcove_code alcove_set(alcove_session* handle, const char* option, const char* value);
// Takes a preset by its name: draft, standard, production, reference, or one of source/. What alcove_set() says wins;
// of several presets the later ones. Null: none any more.
ALCOVE_API alcove_code alcove_preset(alcove_session* handle, const char* name);

// Gives a plane, which is copied. All of a frame have one size. Null data: there is none any more. Names:
//   depth        1 component, of --depth-kind, planar by default
//   position     3, instead of a depth; of position-space, which must be said where the camera has a place
//   normal       3, or 2 by --normal-encoding, signed by default; of --normal-space, which must be said unless the
//                camera has no place or says it; without normals they are reconstructed from depth
//   behind       1, depth behind the first surface, of --behind-kind; each call adds one, at most 8
//   material-ao  1, multiplied in
//   matte        1, 0 to 1: where AO is wanted
//   occluders    1, 0 to 1: only these block;  ignore: these do not
//   albedo       3, for multi-bounce with ao-channels rgb
ALCOVE_API alcove_code alcove_plane(alcove_session* handle, const char* name, const void* data,
                                    const alcove_layout* layout);

// Gives a perspective camera: focal lengths and principal point in px of the planes from their upper left corner, and
// world_to_camera, four rows of four for column vectors, a rotation with a translation; null: none. Without a camera
// the options fov, focal with aperture, or ortho-width give one whose axis is in the middle. alcove_run() looks at it.
ALCOVE_API alcove_code alcove_camera(alcove_session* handle, double fx, double fy, double cx, double cy,
                                     const double* world_to_camera);
// The same by the text of a camera file, which also tells orthographic cameras, left-handed ones, near and far, and
// what depth and normals are: docs/camera.schema.json. Null: there is no camera any more.
ALCOVE_API alcove_code alcove_camera_json(alcove_session* handle, const char* text);

// Computes what the option "aov" asks for: "ao" by default. `frame`, the number of the frame, picks the entry of a
// camera file's `frames`, and changes --noise animated. Fails where the pixels speak against depth, normals or camera.
ALCOVE_API alcove_code alcove_run(alcove_session* handle, int frame);
// Tells how many components a result of the last run has; 0: there is none of that name.
ALCOVE_API int alcove_components(const alcove_session* handle, const char* aov);
// Copies a result of the last run, which must have that size and so many components.
ALCOVE_API alcove_code alcove_get(alcove_session* handle, const char* aov, void* data, const alcove_layout* layout);
// Tells a number of the last run: compute-ms (of the device, 0 where it does not tell), sky-pixels, repaired-depth and
// repaired-normals (pixels that made no sense), turned-normals (pixels whose normals faced away from the eye), radius.
// NaN: there is none of that name.
ALCOVE_API double alcove_number(const alcove_session* handle, const char* name);
// Tells what may be wrong although the last run went well, a sentence a line: normals of which few agree with
// the depth, a radius that the depth's precision cannot carry, or that is larger than the picture. "": nothing.
ALCOVE_API const char* alcove_notes(const alcove_session* handle);
// Tells the name of the device that is open; "": none is.
ALCOVE_API const char* alcove_device(const alcove_session* handle);

// Tells what was wrong with the last call that failed, in one sentence; "": none has. It stays until the next call
// that answers with a code.
ALCOVE_API const char* alcove_error(const alcove_session* handle);
// Tells the library's version, such as "0.2.0".
ALCOVE_API const char* alcove_version(void);

#ifdef __cplusplus
}
#endif

#endif
