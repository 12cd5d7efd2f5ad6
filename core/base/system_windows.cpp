// Windows, behind the plain functions of system.h.
// SPDX-License-Identifier: BSD-3-Clause
//
// Texts are UTF-8 on this side of the header, and UTF-16 on that of Windows. cli/alcove.manifest makes UTF-8 of what
// the C library takes, too.
#include "core/base/system.h"

// The order of these two matters.
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <psapi.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cwchar>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

namespace alcove {
namespace {

namespace fs = std::filesystem;

std::error_code last_error() { return {int(::GetLastError()), std::system_category()}; }

/// The path as the system takes it. Those too long for it by themselves are whole, and marked as such.
std::wstring wide(const std::string& path) {
  const fs::path name(path);
  if (name.native().size() < MAX_PATH - 12 || name.native().starts_with(L"\\\\")) return name.native();
  return L"\\\\?\\" + fs::absolute(name).lexically_normal().make_preferred().native();
}

/// A handle as the descriptor of LockedFile, and back: the system's handles are small numbers, also in 64 bits.
HANDLE handle_of(int descriptor) { return reinterpret_cast<HANDLE>(std::intptr_t(descriptor)); }
int descriptor_of(HANDLE handle) { return int(reinterpret_cast<std::intptr_t>(handle)); }  // -1 for none

/// A handle that is closed at the end.
using Handle = std::unique_ptr<void, decltype([](HANDLE handle) { ::CloseHandle(handle); })>;

/// Opens a file, or a folder that exists, for others as free as if it were not open; null if that fails.
Handle open_shared(const std::string& path, DWORD access, DWORD manner = OPEN_EXISTING,
                   DWORD flags = FILE_FLAG_BACKUP_SEMANTICS) {
  const HANDLE handle =
      ::CreateFileW(wide(path).c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr, manner,
                    flags, nullptr);
  return Handle(handle == INVALID_HANDLE_VALUE ? nullptr : handle);
}

PROCESS_MEMORY_COUNTERS memory_of_process() {
  PROCESS_MEMORY_COUNTERS counters{};
  ::GetProcessMemoryInfo(::GetCurrentProcess(), &counters, sizeof(counters));
  return counters;
}

/// A function of the kernel's own library, which names what headers hide; null if it has none such.
template <class Function>
Function* kernel_function(const char* name) {
  const auto address = ::GetProcAddress(::GetModuleHandleW(L"ntdll.dll"), name);
  return reinterpret_cast<Function*>(reinterpret_cast<void*>(address));
}

std::string folder_of_variable(const wchar_t* name) {
  const wchar_t* folder = ::_wgetenv(name);
  return folder && fs::path(folder).is_absolute() ? fs::path(folder).string() : "";
}

std::atomic<int> signal_number = 0;

/// Remembers the first event of the console as the signal that it is elsewhere. Windows runs it in a thread of its own.
BOOL WINAPI remember_event(DWORD event) {
  const bool is_key = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
  int none = 0;
  const bool is_first = signal_number.compare_exchange_strong(none, is_key ? SIGINT : SIGTERM);
  if (is_key) return is_first;  // the second one ends the process
  // The console closes, or the user logs off: the process ends with this function, at the latest after 5 seconds.
  ::Sleep(INFINITE);
  return TRUE;
}

}  // namespace

int process_id() { return int(::GetCurrentProcessId()); }

std::string program_folder() {
  HMODULE module = nullptr;
  ::GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                       reinterpret_cast<LPCWSTR>(&program_folder), &module);
  std::wstring name(1 << 15, L'\0');  // the longest that there are
  name.resize(::GetModuleFileNameW(module, name.data(), DWORD(name.size())));
  return fs::path(name).parent_path().string();
}

std::string system_name() {
  std::string name = "Windows";
  RTL_OSVERSIONINFOW version{};
  version.dwOSVersionInfoSize = sizeof(version);
  // GetVersionEx() tells programs the version that their manifest knows.
  if (const auto get = kernel_function<LONG WINAPI(RTL_OSVERSIONINFOW*)>("RtlGetVersion"); get && get(&version) == 0)
    name += " " + std::to_string(version.dwMajorVersion) + "." + std::to_string(version.dwMinorVersion) + "." +
            std::to_string(version.dwBuildNumber);
  name += " x86_64";
  if (const auto wine = kernel_function<const char*()>("wine_get_version")) name += std::string(", Wine ") + wine();
  return name;
}

int core_count() { return int(std::max(1u, std::thread::hardware_concurrency())); }

std::uint64_t peak_memory_bytes() { return memory_of_process().PeakWorkingSetSize; }
std::uint64_t resident_memory_bytes() { return memory_of_process().WorkingSetSize; }
void keep_no_spare_memory() {}  // the heap gives large blocks back at once

double cpu_seconds() {
  FILETIME begin, end, system, user;
  if (!::GetProcessTimes(::GetCurrentProcess(), &begin, &end, &system, &user)) return 0;
  constexpr double kUnit = 1e-7;  // seconds
  const auto seconds = [](const FILETIME& time) {
    return kUnit * double(std::uint64_t(time.dwHighDateTime) << 32 | time.dwLowDateTime);
  };
  return seconds(system) + seconds(user);
}

void set_environment(const std::string& name, const std::string& value) { ::_putenv_s(name.c_str(), value.c_str()); }

std::string output_of_command(const std::string& command) {
  // cmd.exe takes away the first and the last quote.
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::_popen(("\"" + command + "\"").c_str(), "rt"), ::_pclose);
  std::string text;
  std::array<char, 256> line;
  while (pipe && std::fgets(line.data(), int(line.size()), pipe.get())) text += line.data();
  return text;
}

void prepare_streams() {
  for (FILE* stream : {stdin, stdout, stderr}) ::_setmode(::_fileno(stream), _O_BINARY);
  _fmode = _O_BINARY;
  // Terminals show UTF-8 for as long as the program runs.
  static const UINT before = ::GetConsoleOutputCP();
  if (before && ::SetConsoleOutputCP(CP_UTF8)) std::atexit([] { ::SetConsoleOutputCP(before); });
}

bool errors_go_to_terminal() {
  const HANDLE stream = ::GetStdHandle(STD_ERROR_HANDLE);
  DWORD mode = 0;
  // A terminal that does not obey escapes is taken for a file.
  return ::GetConsoleMode(stream, &mode) && ::SetConsoleMode(stream, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

void catch_ending_signals() { ::SetConsoleCtrlHandler(remember_event, TRUE); }
int caught_signal() { return signal_number; }

void* symbol_of(const char* library, const char* symbol, std::string& why) {
  // Never from the working folder, where anybody's files lie.
  const HMODULE loaded = ::LoadLibraryExW(wide(library).c_str(), nullptr,
                                          LOAD_LIBRARY_SEARCH_APPLICATION_DIR | LOAD_LIBRARY_SEARCH_SYSTEM32);
  const auto address = loaded ? ::GetProcAddress(loaded, symbol) : nullptr;
  if (!address) why = std::string(library) + ": " + last_error().message();
  return reinterpret_cast<void*>(address);
}

// What the process may still commit is less than that of the machine where a job limits it.
std::uint64_t memory_left_on_machine(const std::string&) {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof(status);
  if (!::GlobalMemoryStatusEx(&status)) return kNoMemoryLimit;
  return std::min(status.ullAvailPhys, status.ullAvailPageFile);
}

// There are neither control groups nor Slurm on Windows.
std::uint64_t memory_left_in_groups(const std::string&) { return kNoMemoryLimit; }
std::uint64_t memory_of_slurm_job() { return kNoMemoryLimit; }
std::uint64_t free_memory() { return memory_left_on_machine(); }

std::string config_home() { return folder_of_variable(L"APPDATA"); }

std::string file_id(const std::string& path) {
  const Handle file = open_shared(path, 0);
  FILE_ID_INFO id{};
  if (file && ::GetFileInformationByHandleEx(file.get(), FileIdInfo, &id, sizeof(id)))
    return {reinterpret_cast<const char*>(&id), sizeof(id)};
  BY_HANDLE_FILE_INFORMATION old{};
  const bool is_known = file && ::GetFileInformationByHandle(file.get(), &old);
  if (!is_known || (old.nFileIndexHigh == 0 && old.nFileIndexLow == 0)) return "";  // some servers number no files
  return std::to_string(old.dwVolumeSerialNumber) + ":" +
         std::to_string(std::uint64_t(old.nFileIndexHigh) << 32 | old.nFileIndexLow);
}

std::error_code may_read(const std::string& path) {
  return open_shared(path, GENERIC_READ) ? std::error_code() : last_error();
}

std::error_code may_make_files_in(const std::string& folder) {
  return open_shared(folder, FILE_ADD_FILE) ? std::error_code() : last_error();
}

std::error_code rename_over(const std::string& from, const std::string& to) {
  // Virus scanners and search indexes open files for a moment.
  constexpr int kTrials = 20, kPause = 50;  // ms
  for (int trial = 1;; trial++) {
    if (::MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
      return {};
    const std::error_code error = last_error();
    const bool may_pass = error.value() == ERROR_SHARING_VIOLATION || error.value() == ERROR_ACCESS_DENIED;
    if (!may_pass || trial == kTrials) return error;
    ::Sleep(kPause);
  }
}

void sync_folder(const std::string&) {}  // rename_over() writes through

namespace {

/// Marks a file as being written by a lock far beyond its end: others cannot read what a lock covers.
bool lock(int descriptor, DWORD flags) {
  OVERLAPPED place{};
  place.OffsetHigh = 0x7fffffff;
  return ::LockFileEx(handle_of(descriptor), LOCKFILE_EXCLUSIVE_LOCK | flags, 0, 1, 0, &place);
}

}  // namespace

std::error_code LockedFile::make(const std::string& path) {
  close();
  Handle file = open_shared(path, GENERIC_WRITE, CREATE_NEW, FILE_ATTRIBUTE_NORMAL);
  if (!file) return last_error();
  descriptor_ = descriptor_of(file.release());
  is_locked_ = lock(descriptor_, 0);  // waits for a process that looks whether the file is abandoned
  return {};
}

std::error_code LockedFile::open_abandoned(const std::string& path) {
  close();
  Handle file = open_shared(path, GENERIC_WRITE, OPEN_EXISTING, FILE_FLAG_OPEN_REPARSE_POINT);
  if (!file) return last_error();
  descriptor_ = descriptor_of(file.release());
  is_locked_ = lock(descriptor_, LOCKFILE_FAIL_IMMEDIATELY);
  if (is_locked_) return {};
  const std::error_code error = last_error();
  close();
  return error;
}

bool LockedFile::is_removed() const {
  FILE_STANDARD_INFO info{};
  return is_locked_ && ::GetFileInformationByHandleEx(handle_of(descriptor_), FileStandardInfo, &info, sizeof(info)) &&
         (info.DeletePending || info.NumberOfLinks == 0);
}

std::error_code LockedFile::write_at(std::uint64_t offset, std::span<const char> bytes) {
  constexpr std::size_t kMost = 1 << 30;  // of one call
  while (!bytes.empty()) {
    OVERLAPPED place{};
    place.Offset = DWORD(offset);
    place.OffsetHigh = DWORD(offset >> 32);
    DWORD written = 0;
    if (!::WriteFile(handle_of(descriptor_), bytes.data(), DWORD(std::min(bytes.size(), kMost)), &written, &place))
      return last_error();
    bytes = bytes.subspan(written);
    offset += written;
  }
  return {};
}

void LockedFile::take_after(const std::string&) {}  // files have the permissions of their folder

std::error_code LockedFile::sync() {
  return ::FlushFileBuffers(handle_of(descriptor_)) ? std::error_code() : last_error();
}

void LockedFile::close() {
  if (descriptor_ >= 0) ::CloseHandle(handle_of(std::exchange(descriptor_, -1)));
}

}  // namespace alcove

/// Makes UTF-8 of narrow texts where the C++ library turns them into paths: it asks this function of the C library,
/// which else takes each byte for a character. What is no UTF-8 becomes the character that stands for such, so that
/// no file has the name. A character outside of the basic plane is a pair: its second half waits in the state.
extern "C" std::size_t mbrtowc(wchar_t* to, const char* from, std::size_t size, mbstate_t* state) {
  if (!from) return 0;
  if (size == 0) return std::size_t(-2);
  if (*state) {
    *to = wchar_t(std::exchange(*state, 0));
    return 1;
  }
  const auto first = static_cast<unsigned char>(*from);
  const int length = first < 0x80 ? 1 : first < 0xc0 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  std::array<wchar_t, 2> units{0xfffd};
  const bool is_whole = length > 0 && std::size_t(length) <= size;
  const int count = is_whole ? ::MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, from, length, units.data(), 2) : 0;
  if (to) *to = count ? units[0] : wchar_t(0xfffd);
  if (count == 0) return 1;
  if (count == 2) *state = units[1];
  return first == 0 ? 0 : std::size_t(count == 2 ? length - 1 : length);
}
