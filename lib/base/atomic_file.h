// Outputs appear whole or not at all: written to a temporary beside the target, flushed to the disk, renamed.
// Killed at any moment, a program leaves what was there before; on SIGINT, SIGTERM and SIGHUP the temporaries go too.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace gonio {

// Writes `bytes` to `path`. Error(cannot_create) where that cannot be done, Error(io) where it fails midway.
void write_file(const std::filesystem::path& path, std::string_view bytes);

// For libraries that write by file name: `write(temporary)` fills the temporary, which takes the target's place. It
// keeps the target's extension. Whatever `write` throws passes through after the temporary is removed.
void write_file_through(const std::filesystem::path& path,
                        const std::function<void(const std::filesystem::path& temporary)>& write);

// Whole file, at most `limit` bytes. Error(no_input) where it is missing, Error(data) above the limit.
std::string read_file(const std::filesystem::path& path, std::uint64_t limit = std::uint64_t{1} << 32);

// Error(cannot_create) where write_file() could not create `path`: asked before long work, so that it is not lost.
void check_writable(const std::filesystem::path& path);

void make_folder(const std::filesystem::path& path);  // with parents; Error(cannot_create)

// SIGINT, SIGTERM, SIGHUP: the first removes temporaries and sets interrupted(); programs end with try_again at the
// next chunk of a parallel loop; a second one ends at once. SIGPIPE is ignored: a closed pipe surfaces as a write error
// on stdout, which ends the program quietly with exit 74.
void install_signal_handlers();
bool interrupted();
void throw_if_interrupted();  // Error(try_again)

}  // namespace gonio
