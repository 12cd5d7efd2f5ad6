#!/usr/bin/env bash
# Builds the zip for Windows, and runs what is in it under Wine, on lavapipe, beside the program for Linux: the same bits, and files as Windows has them.
# Wine is no Windows: docs/limits.md says what this proves. Minutes, and half an hour where the libraries are to be built. Needs no root once packages are there.
#   tests/windows.sh [ZIP]     ZIP: one that is built already
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
fail() {
  echo "tests/windows.sh: $*" >&2
  exit 1
}
step() { echo "$(date +%T) $*"; }
tests=0
passed() {
  tests=$((tests + 1))
  echo "  $*"
}

step "build"
scripts/setup.sh --only-packages run windows-test
scripts/setup.sh --only-program
if [ -z "${1:-}" ]; then scripts/package.sh windows; fi
zip=$(realpath "${1:-$(echo build-windows/alcove-*-windows-x86_64.zip)}")
[ "$(stat -c %s "$zip")" -le 12000000 ] || fail "$zip has more than 12 MB"
passed "$(stat -c '%s bytes: %n' "$zip")"

folder=$(mktemp -d)
export WINEPREFIX=$folder/prefix WINEDEBUG=-all
display=$folder/display
Xvfb -displayfd 3 -screen 0 640x480x24 3>"$display" >/dev/null 2>&1 &  # Wine 8 finds Vulkan by its display
xvfb=$!
trap 'WINEPREFIX=$folder/prefix wineserver -k >/dev/null 2>&1 || true; kill $xvfb; rm -rf "$folder"' EXIT
until [ -s "$display" ]; do kill -0 $xvfb 2>/dev/null || fail "Xvfb does not start"; sleep 0.1; done
DISPLAY=:$(cat "$display")
export DISPLAY
wineboot -i >/dev/null 2>&1
unzip -q "$zip" -d "$folder"
root=$(echo "$folder"/alcove-*)
grep -qF 'bin\alcove doctor' "$root/README.txt" || fail "the first steps are not at the top of the zip"
frame=$root/share/doc/alcove/examples/interior.gbuffer.exr
camera=$root/share/doc/alcove/examples/interior.camera.json
beauty=$root/share/doc/alcove/examples/interior.beauty.exr
linux() { "$build/alcove" "$@"; }
windows() { wine "$root/bin/alcove.exe" "$@"; }
path() { echo "Z:${1//\//\\}"; }  # as Windows spells it
ao() { run=$1 && shift && $run run "$frame" --camera "$camera" --radius 0.35 -q "$@"; }
expect() {  # the exit code, a text that standard error has, and the command
  local code=$1 text=$2 is=0
  shift 2
  "$@" >"$folder/said" 2>&1 || is=$?
  [ "$is" = "$code" ] || fail "exit code $is instead of $code of $*: $(cat "$folder/said")"
  grep -qF -- "$text" "$folder/said" || fail "no '$text' of $*: $(cat "$folder/said")"
}
same() { cmp "$1" "$2" || fail "$3: other bytes than on Linux"; }
cd "$folder"  # paths that are not whole begin here
build=$OLDPWD/build

step "the first picture"
begun=$(date +%s%N)
ao windows -o first.exr
passed "first picture: $((($(date +%s%N) - begun) / 1000000)) ms, kernels not compiled before"
begun=$(date +%s%N)
ao windows -o first.exr
passed "the second time: $((($(date +%s%N) - begun) / 1000000)) ms"

page=$root/share/doc/alcove/docs/getting-started.md
sed -n 's/^ *\(bin\\alcove .*\)/@\1\r\n@if errorlevel 1 exit 1\r/p' "$page" >"$root/first.cmd"
[ "$(grep -c '^@bin' "$root/first.cmd")" -ge 2 ] || fail "the page has no first commands"
(cd "$root" && wine cmd /c first.cmd >"$folder/said" 2>&1) || fail "the first commands of the page: $(cat said)"
[ -s "$root/ao.exr" ] && [ -s "$root/ao.png" ] || fail "the first commands of the page write nothing: $(cat said)"
passed "cmd runs the first commands of the page"

step "the bits of Linux"
for preset in draft standard production reference source/forfun-crytek source/forfun-hbao; do
  for system in linux windows; do ao $system --preset "$preset" --aov ao,confidence -o "$system.exr"; done
  same linux.exr windows.exr "$preset"
  passed "$preset: the file has Linux's bytes"
done
for system in linux windows; do
  ao $system --preset draft --beauty "$beauty" -o $system.exr --composite $system.composite.exr --preview $system.png
done
same linux.composite.exr windows.composite.exr composite
passed "the composite has Linux's bytes"
# Another implementation of the display's curve: at most a rounding of 8 bits.
linux compare windows.png linux.png --max-rmse 0.002 >/dev/null || fail "the preview differs from OpenColorIO's"
passed "the preview is that of OpenColorIO"
ln -s "$frame" frame.exr
for system in linux windows; do
  $system inspect frame.exr --camera "$camera" >$system.txt
  $system inspect frame.exr --camera "$camera" --json >$system.json
  $system presets draft >$system.toml
done
for kind in txt json toml; do same linux.$kind windows.$kind "inspect and presets, $kind"; done
passed "answers of inspect, and a preset, have Linux's bytes: ends of lines too"

step "names"
name_works() {  # the output's name, as Windows is told and as Linux finds it
  mkdir -p "$(dirname "$2")"
  ao windows --preset draft -o "$1"
  [ -s "$2" ] || fail "there is no $2"
  same "$2" draft.exr "$1"
  expect 0 ", Y, " windows inspect "$1" --depth-channel Y --fov 60
  passed "$(cut -c1-60 <<<"$1")${1:60:1}: written and read"
}
ao linux --preset draft -o draft.exr
name_works "$(path "$folder")\\a.exr" a.exr
name_works "Bücher mit Lücken/ä ö 😀.exr" "Bücher mit Lücken/ä ö 😀.exr"
name_works "back\\slash\\ao.exr" back/slash/ao.exr
deep=$(printf 'long%.0s' $(seq 30))/$(printf 'name%.0s' $(seq 30))/$(printf 'deep%.0s' $(seq 25)).exr
name_works "$deep" "$deep"
[ $((${#deep})) -gt 260 ] || fail "the long name has ${#deep} characters"
mkdir "mit Leer zeichen"
cp "$frame" "mit Leer zeichen/a b.exr"
windows inspect "mit Leer zeichen\\a b.exr" --camera "$(path "$camera")" >said
line=$(tail -n 1 said)
printf '@"%s\\alcove.exe" %s -q --preset draft\r\n' "$(path "$root/bin")" "${line#alcove }" >propose.cmd
wine cmd /c propose.cmd || fail "the command that inspect proposes fails: $line"
[ -s ao.exr ] || fail "the command that inspect proposes writes nothing: $line"
passed "cmd runs the command that inspect proposes: $(cut -c1-60 <<<"$line") ..."
printf '[[frame]]\nname = "one"\ninput = %s\ncamera = %s\nradius = 0.35\n' "'$(path "$frame")'" "'$(path "$camera")'" >list.toml
windows run list.toml -q --preset draft -o 'listed\{name}.exr'
same listed/one.exr draft.exr "a list of frames"
printf 'camera = %s\nradius = 0.35\npreset = "draft"\n' "'$(path "$camera")'" >preset.toml
windows run "$frame" -q --preset 'Z:'"${folder//\//\\}"'\preset.toml' -o preset.exr
passed "drive letters and \\ in a list of frames and in a preset"
cp "$frame" a,b.exr
windows inspect a,b.exr | grep -qF 'run "a,b.exr"' || fail "PowerShell would cut a name at its comma"
passed "a name with a comma is quoted"
mkdir -p "$WINEPREFIX/dosdevices/unc/server" show/shots
ln -s "$folder" "$WINEPREFIX/dosdevices/unc/server/share"
share='\\server\share'
cp "$frame" show/shots/
line=$(printf 'camera = %s\nradius = 0.35\n' "'$share${camera#"$folder"}'")
printf '[[frame]]\nname = "one"\ninput = %s\n%s' "'$share\show/shots/interior.gbuffer.exr'" "$line" >share.toml
windows run "$(path "$folder")\\share.toml" -q --preset draft -o "$share\\shared\\{name}.exr"
same shared/one.exr draft.exr "a list of frames on a share"
printf '%s\npreset = "draft"\n' "$line" >show/alcove.toml
windows run "$share\\show\\shots\\interior.gbuffer.exr" -q --project -o shared.exr
same shared.exr draft.exr "the preset of a project on a share"
windows run "$frame" -q --preset "$(path "$folder")\\show\\alcove.toml" -o named.exr
same named.exr draft.exr "a preset that names a share"
passed "\\\\server\\share in a list of frames, in a preset and with --project"

step "a sequence"
mkdir seq
for i in 1 2 3 4 5 6; do cp "$frame" seq/shot.000$i.exr; done
shot() {  # the program, the folder, and more
  local system=$1 to=$2
  shift 2
  $system run 'seq/shot.####.exr' --camera "$camera" --radius 0.35 --preset draft --noise animated -q -o "$to/shot.####.exr" "$@"
}
shot linux whole
same_shot() {
  for i in 1 2 3 4 5 6; do same whole/shot.000$i.exr "$1/shot.000$i.exr" "$2, frame $i"; done
  [ "$(find "$1" -type f | wc -l)" = 6 ] || fail "$2: more than the frames: $(ls -A "$1")"
  passed "$2"
}
# Starts a run to which signals can be sent: its process is $!.
begin() { (exec wine "$root/bin/alcove.exe" run 'seq\shot.####.exr' --camera "$camera" --radius 0.35 --noise animated -q "$@") & }
# Starts a slow run, and sends a signal to it once its first frame is there. The run's exit code is in `code`.
interrupted() {
  mkdir -p "$2"
  exec 4>&2 2>/dev/null  # bash tells of killed jobs
  begin --preset production -o "$2\\shot.####.exr"
  local job=$!
  until compgen -G "$2/shot.*" >/dev/null; do kill -0 $job || { exec 2>&4; fail "the run ended before its first frame"; }; sleep 0.02; done
  kill "-$1" $job
  code=0
  wait $job || code=$?
  exec 2>&4 4>&-
  [ "$(find "$2" -name 'shot.*' | wc -l)" -lt 6 ] || fail "signal $1 came too late"
}
interrupted INT stopped
[ "$code" = 130 ] || fail "Ctrl-C: exit code $code instead of 130"
[ -z "$(find stopped -name '.alcove*')" ] || fail "Ctrl-C leaves unfinished files"
passed "Ctrl-C ends a run between two frames, with exit code 130"
interrupted KILL killed
: >killed/.alcove-1-00000000.tmp  # as a process leaves it that is killed while it writes
shot windows killed --resume --preset production
shot linux whole --preset production
same_shot killed "killed, resumed"
shot linux whole
mkdir both
shot windows both & first=$!
shot windows both & second=$!
wait $first || fail "the first of two processes"
wait $second || fail "the second of two processes"
same_shot both "two processes into one folder at the same time"
# A process that stands still while it writes a frame. Wine removes no open file, so that its lock is asked for.
cat >lock.c <<'END'
#include <stdio.h>
#include <windows.h>
int main(int count, char** words) {  // tries to lock all of a file
  OVERLAPPED begin = {0};
  HANDLE file = CreateFileA(words[count - 1], GENERIC_WRITE, 7, NULL, OPEN_EXISTING, 0, NULL);
  if (file == INVALID_HANDLE_VALUE) return puts("failed");
  return puts(LockFileEx(file, LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, -1, -1, &begin) ? "free" : "locked");
}
END
x86_64-w64-mingw32-gcc lock.c -o lock.exe
mkdir beside
begin --preset draft -o 'beside\shot.####.exr'
first=$!
until compgen -G 'beside/.alcove*' >/dev/null && kill -STOP $first && compgen -G 'beside/.alcove*' >/dev/null; do
  kill -CONT $first 2>/dev/null || fail "no unfinished file was seen"
done
said=$(wine lock.exe beside/.alcove* || true)
kill -CONT $first
[ "${said%$'\r'}" = locked ] || fail "a file in the making is not locked: $said"
wait $first || fail "the process that stood still"
[[ $(wine lock.exe beside/shot.0001.exr || true) = free* ]] || fail "a finished file is locked"
same_shot beside "a file in the making is locked, and a finished one is not"
# Frames that are there already are replaced in one step: never is there none.
cat >deleted.c <<'END'
#include <stdio.h>
#include <sys/inotify.h>
#include <unistd.h>
int main(void) {  // says what is deleted in the folder beside, and which names are moved to
  _Alignas(struct inotify_event) char bytes[4096];
  const int events = inotify_init();
  puts(inotify_add_watch(events, "beside", IN_DELETE | IN_MOVED_TO) < 0 ? "failed" : "watching");
  fflush(stdout);
  for (long size; (size = read(events, bytes, sizeof(bytes))) > 0; fflush(stdout))
    for (char* at = bytes; at < bytes + size;) {
      const struct inotify_event* event = (struct inotify_event*)at;
      printf("%s %s\n", event->mask & IN_DELETE ? "deleted" : "moved", event->name);
      at += sizeof(*event) + event->len;
    }
}
END
gcc deleted.c -o deleted
./deleted >deletions & watcher=$!
until grep -qs watching deletions; do kill -0 $watcher 2>/dev/null || fail "nobody watches the folder"; sleep 0.1; done
shot windows beside
until [ "$(grep -c moved deletions)" -ge 6 ] || grep -q deleted deletions; do kill -0 $watcher || fail "the watcher ended"; sleep 0.1; done
kill $watcher
wait $watcher 2>/dev/null || true
! grep deleted deletions || fail "files were deleted before they were replaced"
same_shot beside "files are replaced in one step"

step "files that cannot be had"
cat >hold.c <<'END'
#include <stdio.h>
#include <windows.h>
int main(int count, char** words) {  // holds a file for itself alone until its standard input ends
  HANDLE file = CreateFileA(words[count - 1], GENERIC_READ, 0, NULL, OPEN_EXISTING, 0, NULL);
  puts(file == INVALID_HANDLE_VALUE ? "failed" : "held");
  fflush(stdout);
  while (getchar() != EOF) continue;
  return 0;
}
END
x86_64-w64-mingw32-gcc hold.c -o hold.exe
cp draft.exr locked.exr
mkfifo end
wine hold.exe locked.exr <end >held &
holder=$!
exec 5>end
until [ -s held ]; do kill -0 $holder 2>/dev/null || fail "hold.exe does not start"; sleep 0.1; done
grep -q held held || fail "the file was not held"
expect 4 "locked.exr: could not rename the finished file to it" ao windows --preset draft -o locked.exr
expect 3 "locked.exr: picture file cannot be read" windows inspect locked.exr
exec 5>&-
wait $holder
same locked.exr draft.exr "the locked file"
[ -z "$(find . -maxdepth 1 -name '.alcove*')" ] || fail "an unfinished file stays beside a locked one"
passed "a locked file is named, and stays as it was"
expect 4 "could not make a temporary file" ao windows --preset draft -o 'Z:\sys\kernel\ao.exr'
passed "a folder that cannot be written is named"
mkdir late
for i in 1 2; do cp "$frame" late/in.000$i.exr; done
: >late/out.0002.exr
chmod a-w late/out.0002.exr
expect 4 "out.0002.exr: is read-only" windows run 'late\in.####.exr' --camera "$camera" --radius 0.35 -o 'late\out.####.exr'
[ ! -e late/out.0001.exr ] || fail "a run begins that cannot replace its last file"
expect 4 "Windows keeps this name for a device" ao windows --preset draft -o 'late\Aux.exr'
passed "a read-only file, and a device's name, are refused before the run"
mkdir case
expect 2 "case" ao windows --preset draft -o 'case\AO.exr' --stats 'case\ao.exr'
passed "names that differ in case only are one file"
expect 3 "not found" windows inspect 'Z:\nowhere\a.exr'
passed "a missing file is named"

step "compare, doctor, the library"
cp linux.exr one.exr
windows compare "$(path "$folder")\\one.exr" one.exr --max-rmse 0 >/dev/null || fail "a file differs from itself"
expect 6 "" windows compare draft.exr whole/shot.0001.exr --max-rmse 0
passed "compare passes a file itself, and fails another"
windows doctor >said
for text in "Windows" "Wine" "llvmpipe" "$(path "$root")\\share\\alcove\\presets" "problems          none"; do
  grep -qF -- "$text" said || fail "doctor does not say '$text': $(cat said)"
done
passed "doctor: $(sed -n 's/^system  *//p' said)"
x86_64-w64-mingw32-gcc -std=c99 -Wall -Wextra -pedantic -Werror -I"$root/include" "$root/share/doc/alcove/examples/library/sphere.c" -o "$root/bin/sphere.exe" \
  -L"$root/lib" -lalcove
wine "$root/bin/sphere.exe" | tr -d '\r' >sphere
grep -q '[#%]' sphere || fail "alcove.dll: there is no shadow below the sphere: $(cat sphere)"
passed "a C program, compiled against the zip's header and alcove.lib, computes with alcove.dll"
step "$tests facts hold"
