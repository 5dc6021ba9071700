/// Files that are whole or absent: a run that is killed leaves what it had written before, never half of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace stickslip {

/// Writes `content` to a temporary file beside `path` and renames it over `path`; missing folders are made. A reader
/// sees the old file or the new one, whole. Throws std::system_error with the path where the disk refuses; the
/// temporary file is then gone.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Name of the temporary file of a process, by its number.
std::string temporary_of(const std::string& name, const std::string& process);

/// Whether the folder has a file of the name; false where the folder is none, or its name no name at all.
bool holds(const std::filesystem::path& folder, const char* file);

/// Throws InputFault where something that is no directory has the name.
void check_folder(const std::filesystem::path& folder);

/// Appends `line` and a newline in one write, and returns once they are on the disk (fsync). A torn last line, left by
/// a process that was killed, is cut off first; so is what a full disk took of this one. pre: `line` holds no newline.
/// Throws std::system_error.
void append_line(const std::filesystem::path& path, std::string_view line);

/// The whole lines of a file that append_line() wrote, without their newlines; a torn last line is left out. Empty
/// where the file does not exist. Throws std::system_error where it cannot be read.
std::vector<std::string> read_lines(const std::filesystem::path& path);

/// Why a file is not to be read: "is a directory; must be a file", "is a pipe; ...", "is a device; ..." (neither need
/// ever end), "cannot be read", or more than `most` bytes; "" where nothing speaks against it.
std::string unreadable(const std::filesystem::path& path, std::uintmax_t most);

/// A file opened for reading. Throws InputFault where the path names a pipe or a device, std::system_error where it
/// cannot be read.
std::ifstream open_to_read(const std::filesystem::path& path);

/// The content of a file. Throws what open_to_read() throws.
std::string read_file(const std::filesystem::path& path);

}  // namespace stickslip
