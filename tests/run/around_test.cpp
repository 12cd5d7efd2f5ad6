// Runs with --around beside what else changes a frame: files of hidden surfaces, other searches and estimators, frames
// without normals, and tiles.
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "cli/options.h"
#include "core/formats/exr.h"
#include "core/run/batch.h"
#include "tests/support/difference.h"
#include "tests/support/walked_shot.h"

namespace alcove {
namespace {

using namespace test;

using Options = std::vector<std::string>;

constexpr int kFrames = 5;

class Around : public WalkedShot {
 protected:
  /// What lies behind the board, of each frame; 0 where nothing does.
  void write_peels() const {
    for (int frame = 1; frame <= kFrames; frame++) {
      const auto first = with_board(frame).planes.at("ViewLayer.Depth.Z");
      FrameFile peel;
      auto& z = peel.planes["Z"] = wall_frame().planes.at("ViewLayer.Depth.Z");
      for (std::size_t i = 0; i < z.size(); i++) z[i] = z[i] == first[i] ? 0 : z[i];
      peel.write(folder / fmt::format("peel.{}.exr", frame));
    }
  }

  std::vector<float> ao_of(int frame, Options more) const {
    more.insert(more.end(), {"--frames", std::to_string(frame), "--type", "float"});
    const Finished finished = run(more);
    EXPECT_EQ(finished.code, 0) << finished;
    return finished.code == 0 ? read_exr_image(output(frame)).pixels : std::vector<float>();
  }

  const Options peels{"--behind", folder / "peel.%d.exr"};
};

Options joined(Options options, const Options& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

TEST_F(Around, chunks_and_threads_change_no_bit_of_any_search) {
  write_shot(kFrames);
  write_peels();
  for (const Options& options :
       {Options{"--preset", "reference"}, Options{"--estimator", "bitmask"}, joined(peels, {"--search", "exact"})}) {
    const Options around = joined(options, {"--around", "1"});
    remove_outputs();
    ASSERT_EQ(run(joined(around, {"--threads", "1"})).code, 0) << testing::PrintToString(options);
    expect_same_outputs(outputs(), {joined(around, {"--chunk", "2/2", "--threads", "2"}),
                                    joined(around, {"--chunk", "1/2", "--threads", "2"})});
  }
}

TEST_F(Around, frames_without_normals_are_as_right_as_alone) {
  write_shot(kFrames);
  constexpr int kFrame = 3;
  const auto off = [&](const Options& options) {
    return difference(ao_of(kFrame, joined(options, {"--normal", "none"})), ao_of(kFrame, options)).rmse;
  };
  const Options plain{"--denoise", "none", "--slices", "8"};
  EXPECT_LE(off(joined(plain, {"--around", "2"})), off(plain) + 0.002);
}

TEST_F(Around, files_that_know_what_is_hidden_leave_others_nothing_to_add) {
  write_shot(kFrames);
  write_peels();
  const Options all = joined(peels, {"--set", "complete=none"});
  EXPECT_LT(difference(ao_of(3, joined(all, {"--around", "2"})), ao_of(3, all)).rmse, 0.01);
}

TEST_F(Around, tiles_have_the_bits_of_the_whole) {
  write_shot(3, {0, 0, 512, 288});
  expect_tiles_as_the_whole({"--around", "1"}, 40);
}

}  // namespace
}  // namespace alcove
