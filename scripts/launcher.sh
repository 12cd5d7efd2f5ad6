#!/bin/sh
# Starts Alcove from its archive on any Linux. Drivers of GPUs are the system's own and need its C library. If that is
# at least as new as the archive's, it is taken, with what else of the system such drivers need. Elsewhere the archive's
# own is taken, with which older drivers work.
# SPDX-License-Identifier: BSD-3-Clause
root=$(dirname "$(dirname "$(readlink -f "$0")")")
own=$(echo "$root"/lib/system/ld-linux-*)
version() { "$1" --version 2>/dev/null | sed -n '1s/.* version 2\.\([0-9]*\).*/\1/p'; }  # nothing before glibc 2.33
loader=$own folders=$root/lib/alcove:$root/lib/system
for system in "/lib64/${own##*/}" "/lib/${own##*/}"; do
  if [ "$(version "$system")0" -ge "$(version "$own")0" ]; then
    loader=$system
    of_machine=$(uname -m)-linux-gnu
    folders=$root/lib/alcove:/lib/$of_machine:/usr/lib/$of_machine:/lib64:/usr/lib64:/lib:/usr/lib:$root/lib/system
    break
  fi
done
# The software driver, beside those of the system's manifests.
export VK_ADD_DRIVER_FILES="$root/share/vulkan/icd.d/lavapipe.json${VK_ADD_DRIVER_FILES:+:$VK_ADD_DRIVER_FILES}"
exec "$loader" --library-path "$folders" "$root/libexec/alcove" "$@"
