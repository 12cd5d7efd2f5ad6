# Writes OUTPUT, a C++ source with the report page as one array: PAGE with the files FILES (separated by commas) in place of their marks {{NAME}}.
# SPDX-License-Identifier: BSD-3-Clause
string(REPLACE "," ";" files "${FILES}")
file(READ "${PAGE}" page)

# Stops the build if the page has no mark of that name.
macro(require_mark name)
  string(FIND "${page}" "{{${name}}}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "${PAGE} has no mark {{${name}}}")
  endif()
endmacro()

require_mark(report.json)
foreach(file ${files})
  get_filename_component(name "${file}" NAME)
  require_mark(${name})
  file(READ "${file}" text)
  if(text MATCHES "</(script|style)")
    message(FATAL_ERROR "${file} holds a closing tag, which would end the block around it")
  endif()
  string(REPLACE "{{${name}}}" "${text}" page "${page}")
endforeach()

# The page goes through a file, as CMake reads hexadecimal digits only from files.
file(WRITE "${OUTPUT}.html" "${page}")
file(READ "${OUTPUT}.html" hex HEX)
string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${hex}")
file(WRITE "${OUTPUT}"
  "// Generated from report/ by cmake/embed_report.cmake.\n#include \"core/measure/report.h\"\n\nnamespace alcove {\nnamespace {\nconstexpr char k_page[] = {${bytes}};\n}  // namespace\n\n"
  "std::string_view report_template() { return {k_page, sizeof k_page}; }\n\n}  // namespace alcove\n")
