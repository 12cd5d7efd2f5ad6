// A shot for tests: a floor, a wall, and a board that stands before the wall, from a camera that walks by.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/options.h"
#include "core/run/batch.h"
#include "tests/support/command_line.h"
#include "tests/support/scenes.h"

namespace alcove::test {

constexpr double kStep = 0.2;  // scene units to the right that the camera moves from frame to frame

/// A rectangle that faces the camera: from `left` to `right`, and as high above the eye as below it.
struct Board {
  double left, right, height, depth;
};
inline constexpr Board kBoard{-0.6, 0.6, 0.7, 4};

/// Puts it into a frame of the wall whose windows are one, of an eye so far to the right.
inline void put_board(FrameFile& file, double eye, const Board& board) {
  const auto width = std::size_t(file.data.width);
  const double focal_px = 60.0 * double(width) / 64;
  auto& depth = file.planes.at("ViewLayer.Depth.Z");
  for (std::size_t i = 0; i < depth.size(); i++) {
    const double x = (double(i % width) + 0.5 - 0.5 * double(width)) / focal_px * board.depth + eye;
    const double y = (0.5 * file.data.height - double(i / width) - 0.5) / focal_px * board.depth;
    if (x < board.left || x > board.right || std::abs(y) > board.height || board.depth > double(depth[i])) continue;
    depth[i] = float(board.depth);
    file.planes.at("ViewLayer.Normal.Y")[i] = -1;
    file.planes.at("ViewLayer.Normal.Z")[i] = 0;
  }
}

inline FrameFile with_board(int frame, const Window& window = kWallWindow) {
  FrameFile file = wall_frame(window, window);
  put_board(file, kStep * frame, kBoard);
  return file;
}

/// Cards before the wall, whose outlines were blurred along rows: ramps of the depth alone.
inline FrameFile with_soft_cards(const Window& window, const Window& display) {
  FrameFile file = wall_frame(window, display);
  std::vector<float>& depth = file.planes.at("ViewLayer.Depth.Z");
  for (std::size_t i = 0; i < depth.size(); i++) {
    const std::size_t column = i % std::size_t(window.width) % 50;
    depth[i] *= 1 - 0.05f * float(std::clamp<std::size_t>(column < 25 ? column : 50 - column, 8, 15) - 8);
  }
  return file;
}

/// A run within this process. With `bytes`, frames may take no more than these, which no option says.
inline RunReport run_here(const Options& arguments, std::uint64_t bytes = 0, const RunWatch& watch = {}) {
  RunOptions options;
  EXPECT_TRUE(parse_run_options(arguments, options));
  if (bytes) options.settings.device.memory = 1;
  if (bytes) options.settings.device.least_memory = bytes;
  RunPreview look(options.settings);
  return run_frames(look, watch);
}

class WalkedShot : public SequenceFolder {
 protected:
  /// Frames 1 to `frames`, and their cameras.
  void write_shot(int frames, const Window& window = kWallWindow) const {
    json cameras = wall_camera(window);
    for (int frame = 1; frame <= frames; frame++) {
      json matrix = cameras["world_to_camera"];
      matrix[0][3] = -kStep * frame;
      cameras["frames"].push_back({{"frame", frame}, {"world_to_camera", matrix}});
      with_board(frame, window).write(input(frame));
    }
    write_bytes(camera, cameras.dump());
  }

  /// Of a run on the shot with a radius of 1.
  Settings settings_of_shot() const {
    Settings settings;
    settings.input.input = in + "/f.####.exr";
    settings.input.camera = camera;
    settings.estimator.radius = 1;
    settings.output.output = out + "/ao.####.exr";
    return settings;
  }
};

}  // namespace alcove::test
