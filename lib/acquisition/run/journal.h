// The journal of a run: what was about to be done and what came of it, one JSON object a line, flushed to the disk
// before anything follows from it. After a power cut the last line may be torn, or blocks that never reached the disk
// may be zeros: every line carries a check of itself, and what follows the first line that fails it is cut off.
//
//   {"check": "1f0c9a...", "event": {"what": "frame", "image": "v017", ...}}
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "manifest/value.h"

namespace gonio::acquisition {

class Journal {
 public:
  // `head`: what the run is of ("plan", "laboratory", ...); it is the first line. Not resumed: Error(cannot_create)
  // where `path` is there. Resumed: Error(data) where its head is another; where there is none, it begins anew.
  Journal(const std::filesystem::path& path, const manifest::Value& head, bool resume);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // Returns once the line is on the disk. Error(io) where it is not: a full disk.
  void write(const manifest::Value& event);
  const std::vector<manifest::Value>& earlier() const { return earlier_; }  // events of the runs before, the head apart

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::vector<manifest::Value> earlier_;
};

// The events of a journal, head first, up to the first line that is torn; `sound_bytes`: how much of the file they are.
std::vector<manifest::Value> read_journal(std::string_view text, std::size_t* sound_bytes = nullptr);

}  // namespace gonio::acquisition
