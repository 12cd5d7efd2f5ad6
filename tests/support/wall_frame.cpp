// The floor and the wall, ray by ray.
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/wall_frame.h"

namespace alcove::test {
namespace {

constexpr double kFocalPx = 60;  // of 64 pixels
constexpr double kWallDistance = 6, kEyeHeight = 1;

double focal_px(const Window& display) { return kFocalPx * display.width / kWallWindow.width; }

/// A number in [0, 1) that differs from its neighbours.
float uneven(std::size_t index) { return float(std::fmod(double(index) * 0.6180339887498949, 1.0)); }

}  // namespace

ExrOutput FrameFile::output() const {
  ExrOutput output{data, display, pixel_aspect, compression, input_attributes, attributes, {}};
  for (const auto& [name, pixels] : planes)
    output.planes.push_back({name, halves.contains(name) ? SampleType::half_float : SampleType::single_float});
  return output;
}

std::vector<std::span<const float>> FrameFile::pixels() const {
  std::vector<std::span<const float>> all;
  for (const auto& [name, pixels] : planes) all.emplace_back(pixels);
  return all;
}

void FrameFile::write(const std::string& path) const {
  ExrWriter writer(path, output());
  writer.write(pixels());
  writer.finish();
}

void FrameFile::rename(const std::string& from, const std::string& to) {
  auto plane = planes.extract(from);
  plane.key() = to;
  planes.insert(std::move(plane));
}

void FrameFile::erase(const std::string& text) {
  std::erase_if(planes, [&](const auto& plane) { return plane.first.find(text) != std::string::npos; });
}

void FrameFile::change(const std::string& text, const std::function<float(float)>& value_of) {
  for (auto& [name, plane] : planes)
    if (name.find(text) != std::string::npos)
      for (float& value : plane) value = value_of(value);
}

void write_plane(const std::string& path, const std::string& channel, const std::vector<float>& plane,
                 const Window& data, const std::optional<Window>& display) {
  FrameFile{data, display.value_or(data), 1, {{channel, plane}}, {}, {}}.write(path);
}

FrameFile wall_frame(const Window& data, const Window& display, double pixel_aspect) {
  FrameFile frame{data, display, pixel_aspect, {}, {}, {}};
  auto plane = [&](const std::string& name) -> std::vector<float>& {
    return frame.planes["ViewLayer." + name] = std::vector<float>(data.pixels());
  };
  auto &z = plane("Depth.Z"), &x = plane("Normal.X"), &y = plane("Normal.Y"), &up = plane("Normal.Z");
  for (std::size_t i = 0; i < data.pixels(); i++) {
    const double row = double(i / std::size_t(data.width)) + 0.5 + data.y - display.y;
    // of the ray, up an unit forward
    const double slope = -(row - 0.5 * display.height) / (focal_px(display) * pixel_aspect);
    const bool is_floor = -slope * kWallDistance > kEyeHeight;
    z[i] = float(is_floor ? kEyeHeight / -slope : kWallDistance);
    x[i] = 0;
    y[i] = is_floor ? 0 : -1;
    up[i] = is_floor ? 1 : 0;
  }
  return frame;
}

void turn_normals_to_view(FrameFile& frame) {
  auto &y = frame.planes.at("ViewLayer.Normal.Y"), &z = frame.planes.at("ViewLayer.Normal.Z");
  y.swap(z);
  for (float& toward : z) toward = -toward;
}

void add_beauty(FrameFile& frame) {
  std::size_t index = 1;
  for (const char* layer : {"Combined", "DiffInd", "DiffCol"})
    for (const char* component : {"R", "G", "B"})
      for (auto& value :
           frame.planes["ViewLayer." + std::string(layer) + "." + component] = std::vector<float>(frame.data.pixels()))
        value = 2 * uneven(index++);
  auto& alpha = frame.planes["ViewLayer.Combined.A"] = std::vector<float>(frame.data.pixels(), 1);
  for (std::size_t i = 0; i < alpha.size(); i += 3) alpha[i] = uneven(i);
}

float beauty_at(int x, int y, int channel) {
  return 0.25f + float(((x + 50) * 7 + (y + 50) * 13 + channel * 5) % 32) / 16;
}

FrameFile beauty_over(const Window& data, const Window& display) {
  FrameFile file{data, display, 1, {}, {}, {}};
  for (int c = 0; c < 3; c++)
    for (int y = data.y; y < data.y + data.height; y++)
      for (int x = data.x; x < data.x + data.width; x++)
        file.planes[std::string(1, "RGB"[c])].push_back(beauty_at(x, y, c));
  return file;
}

json wall_camera(const Window& display, double pixel_aspect) {
  return {{"resolution", {display.width, display.height}},
          {"fx", focal_px(display)},
          {"fy", focal_px(display) * pixel_aspect},
          {"cx", 0.5 * display.width},
          {"cy", 0.5 * display.height},
          {"pixel_aspect", pixel_aspect},
          {"projection", "perspective"},
          {"world_to_camera", {{1, 0, 0, 0.5}, {0, 0, 1, -2}, {0, -1, 0, 3}, {0, 0, 0, 1}}},
          {"depth", "planar"},
          {"normal_space", "world"}};
}

}  // namespace alcove::test
