// See journal.h.
#include "acquisition/run/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;
namespace fs = std::filesystem;

constexpr std::size_t check_digits = 16;

std::string check_of(const std::string& event) {
  return sha256(event).substr(0, check_digits);
}

std::string journal_line(const Value& event) {
  const std::string text = manifest::print_json(event, -1);
  return "{\"check\": \"" + check_of(text) + "\", \"event\": " + text + "}\n";
}

// The event of a line as journal_line() writes it; null for any other.
Value event_of(std::string_view line) {
  try {
    const Value v = manifest::parse_json(line, "journal");
    const Value *check = v.find("check"), *event = v.find("event");
    if (check == nullptr || event == nullptr || !check->is_string() || !event->is_object()) return {};
    return check_of(manifest::print_json(*event, -1)) == check->as_string() ? *event : Value();
  } catch (const Error&) {
    return {};
  }
}

void flush_folder(const fs::path& path) {
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  ::fsync(handle);
  ::close(handle);
}

}  // namespace

std::vector<Value> read_journal(std::string_view text, std::size_t* sound_bytes) {
  std::vector<Value> events;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) break;
    Value event = event_of(text.substr(at, end - at));
    if (event.is_null()) break;
    events.push_back(std::move(event));
    at = end + 1;
  }
  if (sound_bytes != nullptr) *sound_bytes = at;
  return events;
}

Journal::Journal(const fs::path& path, const Value& head, bool resume) : path_(path) {
  std::size_t sound = 0;
  const bool there = fs::exists(path);
  if (there && !resume)
    throw Error(Exit::cannot_create, path.string(), "is the journal of a run that is there already",
                "go on with it (--resume), or give another folder (--out)");
  if (there) {
    earlier_ = read_journal(read_file(path), &sound);
    if (!earlier_.empty()) {
      if (!(earlier_.front() == head))
        throw Error(Exit::data, path.string(), "is the journal of another plan or laboratory",
                    "resume with the manifest that it was made with, or give another folder (--out)");
      earlier_.erase(earlier_.begin());
    }
  }
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) throw Error(Exit::cannot_create, path.string(), std::strerror(errno));
  if (there && ::ftruncate(file_, static_cast<off_t>(sound)) != 0)
    throw Error(Exit::io, path.string(), std::strerror(errno));
  if (sound == 0) write(head);
  flush_folder(path);
}

Journal::~Journal() {
  if (file_ >= 0) ::close(file_);
}

void Journal::write(const Value& event) {
  const std::string line = journal_line(event);
  const off_t before = ::lseek(file_, 0, SEEK_END);
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t count = ::write(file_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const std::string why = std::strerror(errno);
      if (::ftruncate(file_, before) != 0) {  // a torn line is cut off when the run resumes
      }
      throw Error(Exit::io, path_.string(), "cannot be written: " + why, "make room, then go on with --resume");
    }
    done += static_cast<std::size_t>(count);
  }
  if (::fdatasync(file_) != 0) throw Error(Exit::io, path_.string(), std::strerror(errno));
}

}  // namespace gonio::acquisition
