# Writes OUTPUT, a C++ source whose FUNCTION, declared in HEADER, gives the presets of FOLDER as texts, by their paths without .toml. Presets below EXCEPT are left out.
# SPDX-License-Identifier: BSD-3-Clause
file(GLOB_RECURSE files RELATIVE "${FOLDER}" "${FOLDER}/*.toml")
set(texts "")
foreach(file ${files})
  if(EXCEPT AND file MATCHES "^${EXCEPT}/")
    continue()
  endif()
  file(READ "${FOLDER}/${file}" text)
  string(REGEX REPLACE "\\.toml$" "" name "${file}")
  string(APPEND texts "      {\"${name}\", R\"toml(${text})toml\"},\n")
endforeach()
file(WRITE "${OUTPUT}"
  "// Generated from presets by cmake/embed_presets.cmake.\n#include \"${HEADER}\"\n\nnamespace alcove {\n\n"
  "const std::vector<std::pair<std::string, std::string>>& ${FUNCTION}() {\n"
  "  static const std::vector<std::pair<std::string, std::string>> texts = {\n${texts}  };\n  return texts;\n}\n\n}  // namespace alcove\n")
