/* The AO of a sphere on a floor, as a picture of characters: a C program with libalcove.
 * SPDX-License-Identifier: BSD-3-Clause
 *
 *     cc sphere.c $(pkg-config --cflags --libs alcove) -lm */
#include <alcove/alcove.h>
#include <math.h>
#include <stdio.h>

enum { WIDTH = 240, HEIGHT = 160 };

/* Planar depth of a sphere of radius 1 that stands on a floor, seen from 1.5 above it; 0: nothing is there. */
static float depth_at(double x, double y) {
  const double floor = -1.5, center[3] = {0, -0.5, -5};
  const double along = x * center[0] + y * center[1] - center[2], squared = x * x + y * y + 1;
  const double distance = center[0] * center[0] + center[1] * center[1] + center[2] * center[2] - 1;
  const double inside = along * along - squared * distance;
  if (inside > 0) return (float)((along - sqrt(inside)) / squared);
  return y < 0 && floor / y < 30 ? (float)(floor / y) : 0;
}

int main(void) {
  static float depth[HEIGHT][WIDTH], ao[HEIGHT][WIDTH];
  const double focal = 200; /* px */
  const alcove_layout layout = {WIDTH, HEIGHT, 1, ALCOVE_FLOAT, 0, 0, 0};
  alcove_session *session = alcove_new();
  if (!session) return 1;

  for (int j = 0; j < HEIGHT; j++)
    for (int i = 0; i < WIDTH; i++)
      depth[j][i] = depth_at((i + 0.5 - WIDTH / 2) / focal, (HEIGHT / 2 - j - 0.5) / focal);

  if (alcove_preset(session, "production") || alcove_set(session, "radius", "1.5") ||
      alcove_camera(session, focal, focal, WIDTH / 2, HEIGHT / 2, NULL) ||
      alcove_plane(session, "depth", depth, &layout) || alcove_run(session, 0) ||
      alcove_get(session, "ao", ao, &layout)) {
    fprintf(stderr, "%s\n", alcove_error(session));
    alcove_free(session);
    return 1;
  }

  for (int j = 2; j < HEIGHT; j += 6) {
    for (int i = 1; i < WIDTH; i += 3) putchar(depth[j][i] == 0 ? ' ' : "#%*+=-:."[(int)(7.99f * ao[j][i])]);
    putchar('\n');
  }
  printf("on %s\n", alcove_device(session));
  alcove_free(session);
  return 0;
}
