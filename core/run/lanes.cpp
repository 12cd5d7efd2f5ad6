// Takes and gives back lanes.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/run/lanes.h"

namespace alcove {

Lanes::Lanes(const gpu::DeviceOptions& options, int count) : options_(options), count_(count) {
  devices_.push_back(std::make_unique<gpu::Device>(options));
}

int Lanes::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

int Lanes::validation_messages() const {
  int messages = 0;
  for (const auto& device : devices_) messages += device->validation_messages();
  return messages;
}

void Lanes::set_count(int count) {
  const std::lock_guard lock(mutex_);
  count_ = count;
  for (auto& place : free_) place.lane.reset();
}

Lanes::Place Lanes::take() {
  const std::lock_guard lock(mutex_);
  if (!free_.empty()) {
    Place place = std::move(free_.back());
    free_.pop_back();
    return place;
  }
  if (is_first_taken_ && device().info().type == gpu::DeviceType::cpu)
    devices_.push_back(std::make_unique<gpu::Device>(options_));
  is_first_taken_ = true;
  return {devices_.back().get(), nullptr};
}

void Lanes::give_back(Place place) {
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(place));
}

Lanes::Lease::Lease(Lanes& lanes) : lanes_(lanes), place_(lanes.take()) {
  try {
    if (!place_.lane) place_.lane = std::make_unique<Lane>(*place_.device);
  } catch (...) {
    lanes_.give_back(std::move(place_));
    throw;
  }
}

Lanes::Lease::~Lease() {
  if (!keeps_buffers_) place_.lane.reset();
  lanes_.give_back(std::move(place_));
}

}  // namespace alcove
