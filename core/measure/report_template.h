// The report page as the build has made it of report/ and its libraries; defined in a generated source.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace alcove {

/// The page with the mark "{{report.json}}" where the JSON goes; cmake/embed_report.cmake checks that it is there.
std::string_view report_template();

}  // namespace alcove
