# The Debian packages, by cpack, which scripts/package.sh calls.
# SPDX-License-Identifier: BSD-3-Clause
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Alcove developers <alcove@alcove.invalid>")  # the field needs an address; this one does not exist
set(CPACK_STRIP_FILES ON)
# Fixed, so that the umask of the builder does not matter.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_THREADS 0)

find_program(DPKG_DEB dpkg-deb)
# The program, the library for other programs, and Python's package. The module is loaded by its name, so that only its own
# package depends on OpenImageIO.
set(CPACK_COMPONENTS_ALL alcove library dev)
if(DPKG_DEB)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(TARGET alcove_image_io)
  list(APPEND CPACK_COMPONENTS_ALL pictures)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)

# Render nodes have a driver of their own, so drivers are only recommended, in the words of libvulkan1.
set(CPACK_DEBIAN_ALCOVE_PACKAGE_NAME alcove)
set(CPACK_DEBIAN_ALCOVE_PACKAGE_RECOMMENDS "alcove-pictures, mesa-vulkan-drivers | vulkan-icd")
set(CPACK_DEBIAN_ALCOVE_DESCRIPTION "ambient occlusion from rendered depth and normals
Alcove computes ambient occlusion offline from the depth and normals that a
renderer or a game has already written. It reads OpenEXR files and DDS
captures, and writes the AO, and composites with the beauty, as OpenEXR.

It computes with Vulkan: on a GPU, or on the CPU with mesa-vulkan-drivers.")

# The module depends on the version of the program, since the interface between them may change.
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_COMPONENT_PICTURES_DEPENDS alcove)
set(CPACK_DEBIAN_PICTURES_PACKAGE_NAME alcove-pictures)
set(CPACK_DEBIAN_PICTURES_DESCRIPTION "TIFF and other pictures for Alcove
With this module, Alcove reads depth, normals and beauties from TIFF and
other formats that OpenImageIO reads.")
set(CPACK_DEBIAN_PICTURES_PACKAGE_SOURCE alcove)

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libalcove0)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SOURCE alcove)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "ambient occlusion of planes in memory
The library of Alcove, for programs that have depth and normals in memory. It
computes with Vulkan, reads no files, and loads no OpenEXR.")

set(CPACK_COMPONENT_DEV_DEPENDS library)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libalcove-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SOURCE alcove)
set(CPACK_DEBIAN_DEV_DESCRIPTION "ambient occlusion of planes in memory (development files)
The header of libalcove, and its files for CMake and pkg-config.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-alcove)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SOURCE alcove)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS python3)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "alcove, libalcove0, python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "ambient occlusion from Python, of files and of arrays
Runs Alcove over files with its progress and its errors as exceptions, and
computes the AO of numpy arrays with its library.")

# Parts of Debian packages alone: a changelog in Debian's form, and links to shared folders of documents.
set(debian ${CMAKE_BINARY_DIR}/generated/debian)
if(DPKG_DEB)
  execute_process(COMMAND date -uR -d ${ALCOVE_RELEASE_DATE} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  file(WRITE ${debian}/changelog "alcove (${PROJECT_VERSION}) stable; urgency=medium\n\n  * CHANGELOG.md says what changed.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  execute_process(COMMAND gzip -9nc ${debian}/changelog OUTPUT_FILE ${debian}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${debian}/changelog.gz DESTINATION share/doc/alcove EXCLUDE_FROM_ALL)
  file(WRITE ${debian}/triggers "activate-noawait ldconfig\n")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${debian}/triggers)
  # Packages that need another one share its folder of documents.
  file(CREATE_LINK alcove ${debian}/alcove-pictures SYMBOLIC)
  install(FILES ${debian}/alcove-pictures DESTINATION share/doc COMPONENT pictures EXCLUDE_FROM_ALL)
  file(CREATE_LINK libalcove0 ${debian}/libalcove-dev SYMBOLIC)
  install(FILES ${debian}/libalcove-dev DESTINATION share/doc COMPONENT dev EXCLUDE_FROM_ALL)
  foreach(pair library:libalcove0 python:python3-alcove)
    string(REPLACE ":" ";" pair ${pair})
    list(GET pair 0 component)
    list(GET pair 1 package)
    install(FILES ${debian}/changelog.gz ${CMAKE_BINARY_DIR}/generated/copyright DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  endforeach()
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/hosts/python/alcove DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL FILES_MATCHING PATTERN *.py PATTERN py.typed)
endif()
include(CPack)
