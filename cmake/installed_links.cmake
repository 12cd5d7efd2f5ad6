# Mends the links of the installed documents in `documents`: those into hosts/ and presets/ lead to share/alcove, and those to
# sources, which are not installed, become plain words.
# SPDX-License-Identifier: BSD-3-Clause
file(GLOB pages ${documents}/*.md ${documents}/docs/*.md)
foreach(page ${pages})
  file(READ ${page} text)
  file(RELATIVE_PATH data ${page}/.. ${documents}/../../alcove)
  string(REGEX REPLACE "\\]\\((\\.\\./)?(hosts|presets)/" "](${data}/\\2/" text "${text}")
  string(REGEX REPLACE "\\[([^][]*)\\]\\((\\.\\./)?((core|kernels|cli|api|tests|cmake|examples/bench|examples/ci)[^)]*|packages\\.txt)\\)"
    "\\1" text "${text}")
  file(WRITE ${page} "${text}")
endforeach()
