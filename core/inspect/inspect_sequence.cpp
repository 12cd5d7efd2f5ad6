// Compares the headers of all frames and the pixels of a few.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/frame/settle/settle.h"
#include "core/inspect/inspect.h"

namespace alcove {
namespace {

constexpr std::size_t kReadFrames = 5;  // whose pixels are looked at, from the first to the last
constexpr double kDegrees = 180 / std::numbers::pi;

using Values = std::map<std::string, std::string>;  // what is compared, by its name

/// The channels of all files of a frame, with their types.
std::string channels_of(const FrameSource& source) {
  std::string text;
  for (const auto& file : source.files)
    for (const auto& part : file.parts())
      for (const auto& channel : part.channels)
        text += fmt::format("{}{}{}{} ({})", text.empty() ? "" : ", ", part.name, part.name.empty() ? "" : ": ",
                            channel.name, name_of(channel.type));
  return text;
}

std::string names_of(const std::vector<ChannelRef>& channels) {
  std::string text;
  for (const auto& channel : channels) text += (text.empty() ? "" : ", ") + channel.channel;
  return text.empty() ? "none" : text;
}

std::string plane_text(const std::optional<double>& distance) {
  return distance ? fmt::format("{:.6g}", *distance) : "unknown";
}

/// What the headers of a frame say.
Values values_of(const FrameSource& source, bool has_camera) {
  Values values{{"data window", to_string(source.reading.data)},
                {"display window", to_string(source.reading.display)},
                {"pixel aspect", fmt::format("{:.4g}", source.reading.pixel_aspect)},
                {"channels", channels_of(source)},
                {"depth", names_of(source.channels[RawPlane::depth])},
                {"normals", names_of(source.channels[RawPlane::normal])},
                {"source", source.program.rules->name}};
  if (!has_camera) return values;
  values["camera by"] = source.camera_from.empty() ? "options" : source.camera_from;
  values["near plane"] = plane_text(source.reading.camera.near);
  values["far plane"] = plane_text(source.reading.camera.far);
  return values;
}

/// How a frame would be read by itself.
std::string reading_of(const FrameSource& source) {
  std::string text = word_of(source.reading.depth_kind) + " depth";
  if (source.channels[RawPlane::normal].empty()) return text;
  text += fmt::format(", {} normals, {}", word_of(source.reading.normal_space),
                      encoding_name(source.reading.normal_encoding, source.reading.normal_unorm));
  if (to_string(source.reading.flip_normal) != "none") text += ", flips " + to_string(source.reading.flip_normal);
  return text;
}

Vector3 eye_of(const Camera& camera) {
  return scaled(times(transposed(*camera.view_from_world), camera.view_from_world_offset), -1);
}

/// The angle of the rotation from one camera to the other, in degrees. Its sine is by what differs between entries
/// across the diagonal: of equal matrices that is 0, also where rounding has made them no exact rotations.
double turn(const Camera& a, const Camera& b) {
  const Matrix3 m = product(*a.view_from_world, transposed(*b.view_from_world));
  const double sine = 0.5 * std::hypot(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]);
  const double cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1);
  return std::atan2(sine, cosine) * kDegrees;
}

/// From there on a turn is more than the rounding of a matrix to single precision, in degrees; and the same of a way,
/// by the eye's distance from the world's origin.
constexpr double kLeastTurn = 2e-5, kLeastWay = 4e-7;

/// The way from one camera to the other; 0 below what single precision can tell.
double way(const Camera& a, const Camera& b) {
  const Vector3 from = eye_of(a), path = difference(from, eye_of(b));
  const double way = std::hypot(path[0], path[1], path[2]);
  return way > kLeastWay * std::hypot(from[0], from[1], from[2]) ? way : 0;
}

double width_of(const Camera& camera) {
  return camera.orthographic ? camera.width / camera.fx : 2 * std::atan(0.5 * camera.width / camera.fx) * kDegrees;
}

/// A sequence being looked at.
class SequenceInspector {
 public:
  SequenceInspector(const FramePlan& plan, const CommandNames& run) : plan_(plan), run_(run) {}

  Inspection inspect() {
    Inspection found = first_that_shows();
    shown_.shown = shown_frame_;
    shown_.frames = plan_.frames();
    shown_.absent = plan_.missing();
    has_camera_ = look_for_camera(plan_.at(shown_frame_).input, shown_frame_).is_found;
    for (const int frame : plan_.frames()) look_at_header(frame);
    for (const int frame : few()) look_at_pixels(frame);
    sort_out();
    found.sequence = std::move(shown_);
    return found;
  }

 private:
  /// The frame that a run would settle the sequence by.
  Inspection first_that_shows() {
    std::optional<Inspection> first;
    for (const int frame : plan_.evidence()) {
      Inspection found = inspect_frame(plan_.at(frame).input, frame, run_);
      if (first && !found.shows_surfaces) continue;
      shown_frame_ = frame;
      first = std::move(found);
      if (first->shows_surfaces) break;
    }
    return *first;
  }

  FrameSource open(int frame) const {
    const InputSettings settings = plan_.at(frame).input;
    FrameSource source = find_frame(has_camera_ ? settings : with_some_camera(settings), false, frame);
    source.open.camera = !has_camera_;
    return source;
  }

  void look_at_header(int frame) {
    try {
      const FrameSource source = open(frame);
      for (const auto& [what, value] : values_of(source, has_camera_)) take(what, value, frame);
      if (has_camera_) follow(source.reading.camera, frame);
    } catch (const Error& error) {
      refuse(error, frame);
    }
  }

  /// Takes down that a frame is refused, without the name of its file, so that frames with one fault stand together.
  void refuse(const Error& error, int frame) {
    std::string text = error.what();
    const std::string name = main_input(plan_.at(frame).input) + ": ";
    if (text.starts_with(name)) text.erase(0, name.size());
    take(kRefused, text, frame);
  }

  void take(const std::string& what, const std::string& value, int frame) {
    auto& values = found_[what];
    const auto known = std::ranges::find(values, value, [](const auto& pair) { return pair.first; });
    if (known == values.end())
      values.push_back({value, {frame}});
    else
      known->second.push_back(frame);
  }

  void follow(const Camera& camera, int frame) {
    SequenceCamera& path = shown_.camera ? *shown_.camera : shown_.camera.emplace();
    const double width = width_of(camera);
    path.widest = std::max(path.widest, width);
    path.narrowest = first_camera_ ? std::min(path.narrowest, width) : width;
    if (camera.view_from_world && first_camera_ && first_camera_->view_from_world) {
      path.is_placed = true;
      path.farthest = std::max(path.farthest, way(camera, *first_camera_));
      const double angle = turn(camera, *first_camera_);
      if (angle > kLeastTurn) path.largest_turn = std::max(path.largest_turn, angle);
      const double step = way(camera, last_camera_);
      if (step > path.largest_step) path.largest_step = step, path.at_largest_step = frame;
    }
    if (!first_camera_) first_camera_ = camera;
    last_camera_ = camera;
  }

  /// The first frame, the last, and a few between them.
  std::set<int> few() const {
    std::set<int> frames{shown_frame_};
    const std::size_t count = std::min(kReadFrames, plan_.frames().size());
    for (std::size_t i = 0; i < count; i++)
      frames.insert(plan_.frames()[i * (plan_.frames().size() - 1) / std::max<std::size_t>(1, count - 1)]);
    return frames;
  }

  void look_at_pixels(int frame) {
    try {
      FrameSource source = open(frame);
      require_host_room(source.depth_path(), source.reading.data);
      const RawFrame raw = read_raw_frame(source, source.reading.data);
      const InputSettings settings = plan_.at(frame).input;
      settle(source, has_camera_ ? settings : with_some_camera(settings), raw);
      if (has_camera_ && source.evidence->tells) take("reading", reading_of(source), frame);
      for (const auto& note : source.suspicious) suspicious_[facts_of(note.code).meaning].insert(frame);
      shown_.depth.push_back({frame, distances_of(source, raw.depth)});
    } catch (const Error& error) {
      refuse(error, frame);
    }
  }

  /// Parts what changes from what is the same in all frames.
  void sort_out() {
    for (const auto& [meaning, frames] : suspicious_)
      if (frames.size() < shown_.depth.size())
        shown_.changes.push_back({"suspicious", {{meaning, {frames.begin(), frames.end()}}}});
    for (auto& [what, values] : found_)
      if (values.size() > 1 || what == kRefused)
        shown_.changes.push_back({what, std::move(values)});
      else
        shown_.same.push_back(what);
  }

  static constexpr const char* kRefused = "refused";

  const FramePlan& plan_;
  const CommandNames& run_;
  int shown_frame_ = 0;
  bool has_camera_ = false;
  InspectedSequence shown_{};
  std::optional<Camera> first_camera_;
  Camera last_camera_;
  std::map<std::string, std::vector<std::pair<std::string, std::vector<int>>>> found_;
  std::map<std::string, std::set<int>> suspicious_;
};

}  // namespace

Inspection inspect_sequence(const FramePlan& plan, const CommandNames& run) {
  return SequenceInspector(plan, run).inspect();
}

}  // namespace alcove
