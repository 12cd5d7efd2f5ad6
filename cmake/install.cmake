# The files of `cmake --install`, for any prefix: the program finds presets and the module of images from its own place.
# SPDX-License-Identifier: BSD-3-Clause

# Man pages and completions, which the program prints itself; Windows has no place for them.
if(NOT WIN32)
set(texts ${CMAKE_BINARY_DIR}/generated/share)
add_custom_command(OUTPUT ${texts}/man/man1/alcove.1.gz
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:alcove> -DFOLDER=${texts} -DCOMMANDS=run,wedge,inspect,compare,bench,presets,devices,doctor
    -P ${CMAKE_SOURCE_DIR}/cmake/generate_texts.cmake
  DEPENDS alcove ${CMAKE_SOURCE_DIR}/cmake/generate_texts.cmake COMMENT "Writing man pages and completions" VERBATIM)
add_custom_target(alcove_texts ALL DEPENDS ${texts}/man/man1/alcove.1.gz)
install(DIRECTORY ${texts} DESTINATION .)
endif()
install(DIRECTORY hosts DESTINATION share/alcove FILES_MATCHING PATTERN *.py PATTERN *.toml PATTERN py.typed)
install(DIRECTORY presets DESTINATION share/alcove FILES_MATCHING PATTERN *.toml)

# The documents, in the folders of their links, and the frame of the first steps.
set(documents share/doc/alcove)
install(FILES README.md CHANGELOG.md DESTINATION ${documents})
install(DIRECTORY docs DESTINATION ${documents} FILES_MATCHING PATTERN *.md PATTERN *.png PATTERN *.svg PATTERN *.json)
install(FILES examples/interior.gbuffer.exr examples/interior.beauty.exr examples/interior.camera.json DESTINATION ${documents}/examples)
install(DIRECTORY examples/farm DESTINATION ${documents}/examples USE_SOURCE_PERMISSIONS)
install(CODE "set(documents \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${documents}\")")
install(SCRIPT cmake/installed_links.cmake)

# Our licence in Debian's format: indented, with a dot on empty lines.
file(READ LICENSE licence)
string(REGEX REPLACE "\n+$" "" licence "${licence}")
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence " ${licence}")
configure_file(cmake/copyright.in ${CMAKE_BINARY_DIR}/generated/copyright @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/generated/copyright DESTINATION ${documents})
