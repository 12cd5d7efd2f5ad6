// Strings are escaped first, since the library throws at bytes that are no UTF-8, or hides which they were.
// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/json_text.h"

#include <nlohmann/json.hpp>

#include "core/base/text.h"

namespace alcove {
namespace {

using Json = nlohmann::ordered_json;

Json with_valid_strings(const Json& json) {
  if (json.is_string()) return as_utf8(json.get_ref<const std::string&>());
  if (!json.is_structured()) return json;
  Json valid = json.is_array() ? Json::array() : Json::object();
  for (const auto& [key, value] : json.items()) {
    if (json.is_array())
      valid.push_back(with_valid_strings(value));
    else
      valid[as_utf8(key)] = with_valid_strings(value);
  }
  return valid;
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json, int indent) { return with_valid_strings(json).dump(indent); }

}  // namespace alcove
