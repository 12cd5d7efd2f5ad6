# Writes OUTPUT, a C++ source with the files of FOLDER as texts, found by stem.
# SPDX-License-Identifier: BSD-3-Clause
file(GLOB files "${FOLDER}/*.toml")
set(texts "")
foreach(file ${files})
  get_filename_component(stem "${file}" NAME_WLE)
  file(READ "${file}" text)
  string(APPEND texts "      {\"${stem}\", R\"toml(${text})toml\"},\n")
endforeach()
file(WRITE "${OUTPUT}"
  "// Generated from presets/input/*.toml by cmake/embed_input_presets.cmake.\n#include \"core/frame/input_rules.h\"\n\nnamespace alcove {\n\n"
  "const std::vector<std::pair<std::string, std::string>>& input_preset_texts() {\n"
  "  static const std::vector<std::pair<std::string, std::string>> texts = {\n${texts}  };\n  return texts;\n}\n\n}  // namespace alcove\n")
